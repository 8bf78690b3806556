//! An estimator that takes rows one by one or in blocks.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard};
use std::thread::{self, ThreadId};

use catalogue::estimators::{Estimator as AnyEstimator, Kind, Reports};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use simulation::trace::Trace;

use crate::columns::{copied, edge, edges};
use crate::device::{Built, DeviceFile, Named, PresetsFile, device, named};
use crate::error::{in_python, value_error};
use crate::integer::CountsPerRev;
use crate::modulus::{Moduli, Modulus, Unwrapped};
use crate::stream::{Arrays, Stream, arrays, lack};

/// What an [`Estimator`] changes.
#[derive(Clone)]
struct Running {
    stream: Stream,
    /// The last counts of both encoders, unwrapped.
    unwrapped: Unwrapped,
    /// Reports of the latest row: standard deviation, acceleration, ratio of the damping.
    latest: [Option<f32>; 3],
}

/// An estimator that takes rows as they come.
///
/// The documentation of its methods and properties is that of Python; the class in Python has its own.
#[pyclass(frozen, subclass, module = "limpid")]
pub(crate) struct Estimator {
    kind: &'static Kind,
    estimator: AnyEstimator,
    rate_hz: f64,
    counts_per_rev: u32,
    values: BTreeMap<&'static str, f64>,
    notes: Vec<String>,
    moduli: Moduli,
    varying: bool,
    running: Mutex<Running>,
    /// The thread that holds `running` and may call handlers of signals meanwhile.
    runner: Mutex<Option<ThreadId>>,
}

impl Estimator {
    /// Runs over rows and keeps the reports of the last one.
    fn run(
        &self,
        running: &mut Running,
        mut trace: Trace,
        look: impl FnMut() -> PyResult<()>,
    ) -> PyResult<Reports> {
        lack(self.kind, &trace, self.kind.name).map_err(value_error)?;
        self.moduli.unwrap(&mut trace, &mut running.unwrapped)?;
        let reports = running.stream.run(&trace, look)?;
        let last = |column: &Option<Vec<f32>>| column.as_ref()?.last().copied();
        running.latest = [
            last(&reports.deviation),
            last(&reports.acceleration),
            last(&reports.damping_ratio),
        ];
        Ok(reports)
    }

    fn started(estimator: &AnyEstimator) -> Running {
        Running {
            stream: Stream::new(estimator.clone()),
            unwrapped: Unwrapped::default(),
            latest: [None; 3],
        }
    }

    /// Refuses a call in a handler of a signal that has interrupted this estimator: it would wait for itself.
    fn refuse_own_handler(&self) -> PyResult<()> {
        if *locked(self.runner.lock()) == Some(thread::current().id()) {
            return Err(PyRuntimeError::new_err(
                "estimator: busy; the handler of a signal has interrupted its process(): use another Estimator there",
            ));
        }
        Ok(())
    }

    /// What changes, once no other thread holds it.
    fn running(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Running>> {
        self.refuse_own_handler()?;
        Ok(locked(self.running.lock_py_attached(py)))
    }

    /// The periods before rows at `dt` s from one to the next.
    fn period(&self, dt: Option<f64>) -> PyResult<Option<f32>> {
        match (self.varying, dt) {
            (false, None) => Ok(None),
            (false, Some(_)) => Err(PyValueError::new_err(
                "dt: this estimator assumes a constant period; make it with varying=True",
            )),
            (true, None) => Err(PyValueError::new_err(
                "dt: missing; an estimator made with varying=True needs the time since the row before (s)",
            )),
            (true, Some(dt)) if dt >= 0.0 && dt.is_finite() => Ok(Some((dt * self.rate_hz) as f32)),
            (true, Some(dt)) => Err(PyValueError::new_err(format!(
                "dt={dt}: must be finite and not negative (s)"
            ))),
        }
    }
}

/// A count modulo 2^32.
fn count(object: &Bound<'_, PyAny>, name: &str) -> PyResult<u32> {
    if let Ok(count) = object.extract::<i64>() {
        return Ok(count as u32);
    }
    let refused = || {
        PyTypeError::new_err(format!(
            "{name}: must be an integer; round a float with round(), and pass several rows to process()"
        ))
    };
    let index = object
        .py()
        .import("operator")?
        .call_method1("index", (object,));
    let index = index.map_err(|_| refused())?;
    index.call_method1("__and__", (u32::MAX,))?.extract()
}

/// A finite current.
fn amps(current: Option<f64>) -> PyResult<Option<f64>> {
    match current {
        Some(current) if !current.is_finite() => Err(PyValueError::new_err(format!(
            "current={current}: must be finite (A)"
        ))),
        current => Ok(current),
    }
}

#[pymethods]
impl Estimator {
    #[new]
    #[pyo3(signature = (estimator="imm", rate=1000.0, *, counts_per_rev=None, parameters=None, presets=None,
        device=None, modulus=None, varying=false))]
    fn new(
        estimator: &str,
        rate: f64,
        counts_per_rev: Option<CountsPerRev>,
        parameters: Option<&Bound<'_, PyAny>>,
        presets: Option<PresetsFile>,
        device: Option<DeviceFile>,
        modulus: Option<Modulus>,
        varying: bool,
    ) -> PyResult<Self> {
        let device = self::device(device.as_ref(), counts_per_rev).map_err(value_error)?;
        let parameters = parameters.map_or(Ok(Named::new()), named)?;
        let built = Built::new(estimator, &device, rate, presets.as_ref(), &parameters);
        let built = built.map_err(value_error)?;
        let moduli = modulus.map_or(Ok(Moduli::default()), Modulus::checked)?;
        if varying && !built.kind.varying_period {
            let able = Kind::all().iter().filter(|kind| kind.varying_period);
            let able: Vec<_> = able.map(|kind| kind.name).collect();
            return Err(PyValueError::new_err(format!(
                "{estimator} needs a constant period: leave out varying=True, or name one of {}",
                able.join(", ")
            )));
        }
        Ok(Self {
            kind: built.kind,
            running: Mutex::new(Self::started(&built.estimator)),
            rate_hz: rate,
            counts_per_rev: device.stages.large.counts_per_rev,
            values: built.named(),
            notes: built.notes.iter().map(|note| in_python(note)).collect(),
            estimator: built.estimator,
            moduli,
            varying,
            runner: Mutex::new(None),
        })
    }

    /// Name of the estimator.
    #[getter]
    fn name(&self) -> &'static str {
        self.kind.name
    }

    /// Rate of the rows, Hz.
    #[getter]
    fn rate(&self) -> f64 {
        self.rate_hz
    }

    /// Counts per revolution of the encoder.
    #[getter]
    fn counts_per_rev(&self) -> u32 {
        self.counts_per_rev
    }

    /// Values of the parameters by name.
    #[getter]
    fn parameters(&self) -> BTreeMap<&'static str, f64> {
        self.values.clone()
    }

    /// A line if the parameters were tuned for another encoder or rate.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Standard deviation of the latest velocity, rad/s; None if the estimator reports none.
    #[getter]
    fn std_dev(&self, py: Python<'_>) -> PyResult<Option<f32>> {
        Ok(self.running(py)?.latest[0])
    }

    /// Acceleration at the latest row, rad/s^2; None if the estimator reports none.
    #[getter]
    fn acceleration(&self, py: Python<'_>) -> PyResult<Option<f32>> {
        Ok(self.running(py)?.latest[1])
    }

    /// Learned damping of the coupler over the assumed one; None if it is not learned.
    #[getter]
    fn damping_ratio(&self, py: Python<'_>) -> PyResult<Option<f32>> {
        Ok(self.running(py)?.latest[2])
    }

    /// Forgets all rows: the next row is the first one.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        *self.running(py)? = Self::started(&self.estimator);
        Ok(())
    }

    /// Takes the next row and returns the velocity there, rad/s.
    ///
    /// `current` is the current of the motor from this row to the next, A; `coupled` the count of the
    /// small encoder; `edge_age` and `edge_boundary` the latest edge, as of `Recording`; `dt`
    /// the time since the row before, s, for an estimator made with `varying=True`.
    #[pyo3(signature = (count, *, current=None, coupled=None, edge_age=None, edge_boundary=None, dt=None))]
    fn update(
        &self,
        py: Python<'_>,
        count: &Bound<'_, PyAny>,
        current: Option<f64>,
        coupled: Option<&Bound<'_, PyAny>>,
        edge_age: Option<f64>,
        edge_boundary: Option<&Bound<'_, PyAny>>,
        dt: Option<f64>,
    ) -> PyResult<f32> {
        let number = |object: Option<&Bound<'_, PyAny>>, name: &str| {
            object.map(|object| self::count(object, name)).transpose()
        };
        let edges = match (edge_age, number(edge_boundary, "edge_boundary")?) {
            (None, None) => None,
            (Some(age), Some(_)) if age < 0.0 || age.is_infinite() => {
                return Err(PyValueError::new_err(format!(
                    "edge_age={age}: must be finite and not negative (s), or NaN before the first edge"
                )));
            }
            (Some(age), Some(boundary)) => Some(vec![edge(age, boundary)]),
            _ => {
                return Err(PyValueError::new_err(
                    "edge_age and edge_boundary: give both or neither",
                ));
            }
        };
        let row = Trace {
            rate_hz: self.rate_hz,
            periods: self.period(dt)?.map(|period| vec![period]),
            counts_large: vec![self::count(count, "count")?],
            counts_small: number(coupled, "coupled")?.map(|count| vec![count]),
            current: amps(current)?.map(|current| vec![current]),
            edges,
            ..Trace::default()
        };
        let reports = self.run(&mut *self.running(py)?, row, || Ok(()))?;
        Ok(reports.velocity[0])
    }

    #[pyo3(signature = (counts, current, coupled, edge_age, edge_boundary, dt))]
    fn _process<'py>(
        &self,
        py: Python<'py>,
        counts: PyReadonlyArray1<'py, u32>,
        current: Option<PyReadonlyArray1<'py, f64>>,
        coupled: Option<PyReadonlyArray1<'py, u32>>,
        edge_age: Option<PyReadonlyArray1<'py, f64>>,
        edge_boundary: Option<PyReadonlyArray1<'py, u32>>,
        dt: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Arrays<'py>> {
        let periods = match copied(dt.as_ref())? {
            None => self.period(None)?.map(|_| Vec::new()),
            Some(dt) => {
                let periods = dt.iter().map(|dt| self.period(Some(*dt)));
                let periods: PyResult<Vec<_>> = periods.collect();
                Some(periods?.into_iter().flatten().collect())
            }
        };
        let rows = Trace {
            rate_hz: self.rate_hz,
            periods,
            counts_large: counts.as_slice()?.to_vec(),
            counts_small: copied(coupled.as_ref())?,
            current: copied(current.as_ref())?,
            edges: edges(edge_age.as_ref(), edge_boundary.as_ref())?,
            ..Trace::default()
        };
        self.refuse_own_handler()?;
        let reports = py.detach(|| {
            let mut running = locked(self.running.lock());
            let before = running.clone();
            let runner = Runner::enter(&self.runner);
            let look = || Python::attach(|py| py.check_signals());
            let reports = self.run(&mut running, rows, look);
            drop(runner);
            if reports.is_err() {
                // The rows can be given again.
                *running = before;
            }
            reports
        })?;
        Ok(arrays(py, reports))
    }

    fn __repr__(&self) -> String {
        let varying = if self.varying { ", varying=True" } else { "" };
        format!(
            "limpid.Estimator('{}', rate={}, counts_per_rev={}{}{varying})",
            self.kind.name, self.rate_hz, self.counts_per_rev, self.moduli
        )
    }
}

/// The thread that runs, until this is dropped.
struct Runner<'a>(&'a Mutex<Option<ThreadId>>);

impl<'a> Runner<'a> {
    fn enter(runner: &'a Mutex<Option<ThreadId>>) -> Self {
        *locked(runner.lock()) = Some(thread::current().id());
        Self(runner)
    }
}

impl Drop for Runner<'_> {
    fn drop(&mut self) {
        *locked(self.0.lock()) = None;
    }
}

/// The value of a mutex, also after a panic in another thread: no invariant spans two fields.
fn locked<G>(guard: Result<G, std::sync::PoisonError<G>>) -> G {
    guard.unwrap_or_else(std::sync::PoisonError::into_inner)
}
