//! One run of a case: the loop, what was seen of it, its scores.

use std::time::{Duration, Instant};

use haptic_control::{DualStage, LoopPoles, Stop};

use super::compare::{Case, Run, Settings, Signals, USUAL, device};
use super::{FeltRow, Fingertip, Parasitic, REFERENCE};
use crate::closed_loop::{Eye, Loop, Moment, usual};
use crate::compare::{Cost, interval};
use catalogue::estimators::Setup;
use catalogue::estimators::{Estimator, Kind};
use catalogue::parameters::PlantKind;
use scoring::contest::{Contest, Estimate, Heading, Row};
use scoring::score::Score;
use simulation::device::Device;
use simulation::simulate::{plant_steps, ticks};
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Who closes a loop.
#[derive(Clone, Copy)]
pub(super) enum By {
    /// The estimator of this number.
    Contestant(usize),
    Reference,
    /// No estimator: the scene has no loop around the large motor.
    Nobody,
}

/// A case with everything built that its runs share.
pub(super) struct Prepared<'a> {
    pub(super) case: &'a Case,
    settings: &'a Settings,
    device: Device,
    believed: DualStage,
    contest: Contest,
    handle: Estimator,
    reference: Estimator,
    ticks: usize,
}

/// The estimator `kind` with its parameters, on an encoder with so many counts.
pub(super) fn estimator(
    kind: &Kind,
    settings: &Settings,
    counts_per_rev: u32,
    rate_hz: f64,
    plant: PlantKind,
) -> Result<Estimator, Failure> {
    let mut setup = Setup::of(&settings.device, rate_hz);
    setup.stages.large.counts_per_rev = counts_per_rev;
    kind.build(&setup, &settings.parameters.values(kind, &setup, plant))
}

impl<'a> Prepared<'a> {
    pub(super) fn new(case: &'a Case, settings: &'a Settings) -> Result<Self, Failure> {
        let device = device(settings, case.plant);
        let on = |kind: &Kind, counts_per_rev| {
            estimator(kind, settings, counts_per_rev, case.rate_hz, case.plant)
        };
        Ok(Self {
            case,
            settings,
            believed: device.stages,
            contest: Contest::new(
                &settings.estimators,
                &settings.parameters,
                &Setup::of(&device, case.rate_hz),
                case.plant,
            )?,
            handle: on(settings.handle, device.stages.small.counts_per_rev)?,
            reference: on(Kind::named(USUAL)?, device.reference.counts_per_rev)?,
            ticks: ticks(case.rate_hz, case.seconds)?,
            device,
        })
    }

    pub(super) fn closers(&self) -> Vec<By> {
        if !self.case.scene.facts().needs.continuous {
            return vec![By::Nobody];
        }
        let contestants = (0..self.settings.estimators.len()).map(By::Contestant);
        contestants.chain([By::Reference]).collect()
    }

    pub(super) fn run(&self, by: By) -> Result<(Run, Vec<FeltRow>, Cost), Failure> {
        let begin = Instant::now();
        let (large, eye) = match by {
            By::Contestant(i) => (self.contest.contestants()[i].estimator(), Eye::Large),
            By::Reference => (&self.reference, Eye::Reference),
            By::Nobody => (&self.handle, Eye::Large),
        };
        let case = self.case;
        let run = Loop {
            device: self.device.clone(),
            believed: self.believed,
            scene: usual(case.scene, &self.believed, case.rate_hz)?,
            hand: case.scene.facts().hand.into(),
            rate_hz: case.rate_hz,
            seed: case.seed,
            large: large.clone(),
            handle: self.handle.clone(),
            eye,
            poles: LoopPoles::DEFAULT,
            late_ticks: 0,
        };
        let mut seen = Seen::new(self);
        run.run(self.ticks, |moment| seen.push(moment))?;
        let simulated = Instant::now();

        let parasitic = Parasitic::of(&seen.parasitic_mn, case.rate_hz, &seen.fingertip);
        let (rows, velocity) = self.rows(by, &mut seen, parasitic)?;
        let run = Run {
            controlled_by: match by {
                By::Contestant(i) => self.settings.estimators[i].name,
                By::Reference => REFERENCE,
                By::Nobody => "any",
            },
            parasitic,
            velocity,
            stopped: seen.stopped,
            signals: seen.signals,
        };
        let cost = Cost {
            plant_steps: plant_steps(case.rate_hz, case.seconds)?,
            simulation: simulated - begin,
            estimation: Duration::ZERO,
            scoring: simulated.elapsed(),
        };
        Ok((run, rows, cost))
    }

    /// The rows of a run, and the RMS error of the velocity that its loop used.
    fn rows(
        &self,
        by: By,
        seen: &mut Seen,
        parasitic: Parasitic,
    ) -> Result<(Vec<FeltRow>, Option<Score>), Failure> {
        let case = self.case;
        let heading = Heading {
            scenario: case.scene.name().to_owned(),
            rate_hz: case.rate_hz,
            plant: case.plant,
            seed: case.seed,
        };
        let used = Estimate {
            estimator: match by {
                By::Contestant(i) => self.settings.estimators[i].name,
                By::Reference | By::Nobody => REFERENCE,
            },
            velocity: std::mem::take(&mut seen.used),
            deviation: None,
        };
        let score = |estimates: &[Estimate]| {
            let (interval, wanted) = (interval(&self.device), self.settings.wanted);
            self.contest
                .rows(&heading, &seen.trace, estimates, interval, wanted)
        };
        let felt = |row: Row, controlled_by| FeltRow {
            row,
            controlled_by,
            handle_estimator: self.settings.handle.name,
            parasitic,
            stopped: seen.stopped,
        };
        let itself = |row: Row| {
            let name = row.estimator;
            felt(row, name)
        };
        let watched = || score(&self.contest.estimates(&seen.trace));
        let closed = |rows: &[Row]| rows.first().map(|row| row.score);
        Ok(match by {
            By::Contestant(_) => {
                let rows = score(&[used])?;
                let velocity = closed(&rows);
                (rows.into_iter().map(itself).collect(), velocity)
            }
            By::Reference => {
                let velocity = closed(&score(&[used])?);
                let rows = watched()?.into_iter().map(|row| felt(row, REFERENCE));
                (rows.collect(), velocity)
            }
            By::Nobody => {
                let rows = watched()?;
                let reference = rows.iter().map(|row| felt(row.clone(), REFERENCE));
                let reference: Vec<_> = reference.collect();
                (
                    rows.into_iter().map(itself).chain(reference).collect(),
                    None,
                )
            }
        })
    }
}

/// What was seen of a run.
struct Seen {
    fingertip: Fingertip,
    /// What an estimator on the device's own encoder could know, and the truth.
    trace: Trace,
    /// Velocity of the large motor that the controller used, rad/s.
    used: Vec<f32>,
    parasitic_mn: Vec<f64>,
    signals: Option<Signals>,
    stopped: Option<&'static str>,
}

impl Seen {
    fn new(prepared: &Prepared) -> Self {
        Self {
            fingertip: Fingertip::new(&prepared.device),
            trace: Trace {
                rate_hz: prepared.case.rate_hz,
                counts_large: Vec::with_capacity(prepared.ticks),
                counts_small: Some(Vec::with_capacity(prepared.ticks)),
                current: Some(Vec::with_capacity(prepared.ticks)),
                edges: None,
                true_omega: Some(Vec::with_capacity(prepared.ticks)),
                true_damping: None,
            },
            used: Vec::with_capacity(prepared.ticks),
            parasitic_mn: Vec::with_capacity(prepared.ticks),
            signals: prepared.case.keep.then(Signals::default),
            stopped: None,
        }
    }

    fn push(&mut self, moment: &Moment) {
        let mn = self.fingertip.mn_per_nm;
        let wanted = f64::from(moment.action.torque.0);
        self.parasitic_mn.push(mn * (moment.felt - wanted));
        self.used.push(moment.action.large_velocity.0);
        self.trace.counts_large.push(moment.own_count.0);
        if let Some(counts) = &mut self.trace.counts_small {
            counts.push(moment.sample.coupled.0);
        }
        if let Some(current) = &mut self.trace.current {
            let wanted = f64::from(moment.action.currents.large.get());
            current.push(if moment.stopped.is_none() {
                wanted
            } else {
                0.0
            });
        }
        if let Some(omega) = &mut self.trace.true_omega {
            omega.push(moment.large.omega);
        }
        if let Some(signals) = &mut self.signals {
            signals.wanted_mn.push((mn * wanted) as f32);
            signals.felt_mn.push((mn * moment.felt) as f32);
            signals.handle_rad_s.push(moment.handle.omega as f32);
        }
        self.stopped = self.stopped.or(moment.stopped.map(Stop::as_str));
    }
}
