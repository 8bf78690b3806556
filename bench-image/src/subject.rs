//! One estimator under measurement.

use core::fmt;

use estimator_core::{Sample, VelocityEstimator};

/// As much of an estimator as is measured: peers' states need be nothing but theirs.
pub trait Measured {
    /// State from tick to tick.
    type State;

    /// The state at rest at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// One tick: the velocity, counts a tick.
    fn update(&self, state: &mut Self::State, sample: &Sample) -> f32;
}

impl<E: VelocityEstimator> Measured for E {
    type State = <E as VelocityEstimator>::State;

    fn start(&self, first: &Sample) -> Self::State {
        VelocityEstimator::start(self, first)
    }

    // As firmware has it, where the parameters are constants: that is what is measured.
    #[inline(always)]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> f32 {
        VelocityEstimator::update(self, state, sample).0
    }
}

/// An estimator with its parameters fixed at compile time, as firmware has them.
#[derive(Clone, Copy)]
pub struct Subject {
    /// Its name without the length of its window.
    pub name: &'static str,
    /// Path of its `update` below the module `estimators`, by which its symbol is found.
    pub path: &'static [&'static str],
    /// Control rate that its parameters are for, Hz; 0 for every rate.
    pub rate_hz: u32,
    /// Length of its window, intervals; 0 without.
    pub window: usize,
    /// Bytes of its state.
    pub state: usize,
    /// Bytes of its parameters.
    pub parameters: usize,
    /// Runs it.
    pub run: Run,
}

/// Name in the table.
impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)?;
        match self.window {
            0 => Ok(()),
            n => write!(f, ", n = {n}"),
        }
    }
}

impl Subject {
    /// Whether it is no estimator of the catalogue: a filter of another library, or a comparator.
    #[must_use]
    pub fn is_peer(&self) -> bool {
        self.path[0].starts_with("peer_") || self.is_comparator()
    }

    /// Whether it is the velocity algorithm of another project, written anew.
    #[must_use]
    pub fn is_comparator(&self) -> bool {
        self.path[0].starts_with("comparator_")
    }
}

/// Starts with the first sample and gives the velocity, counts a tick, at every one after it.
pub type Run = fn(samples: &mut dyn Iterator<Item = Sample>, velocity: &mut dyn FnMut(f32));

/// The `SUBJECT` of a module that has the constant `ESTIMATOR`: name, path, rate in Hz, window, type.
macro_rules! subject {
    ($name:literal, $path:expr, $hertz:expr, $window:expr, $type:ty) => {
        type State = <$type as Measured>::State;

        #[inline(never)]
        fn update(state: &mut State, sample: &Sample) -> f32 {
            Measured::update(&ESTIMATOR, state, sample)
        }

        fn run(samples: &mut dyn Iterator<Item = Sample>, velocity: &mut dyn FnMut(f32)) {
            // Called through a pointer: the call's interface stays as it is written.
            let update = core::hint::black_box(update as fn(&mut State, &Sample) -> f32);
            let Some(first) = samples.next() else { return };
            let mut state = Measured::start(&ESTIMATOR, &first);
            for sample in samples {
                velocity(update(&mut state, &sample));
            }
        }

        pub(crate) const SUBJECT: Subject = Subject {
            name: $name,
            path: $path,
            rate_hz: $hertz as u32,
            window: $window,
            state: size_of::<State>(),
            parameters: size_of::<$type>(),
            run,
        };
    };
}
pub(crate) use subject;
