//! One run of a closed-loop case: the loop, its recorded signals, its scores.

use std::time::{Duration, Instant};

use haptic_control::{DualStage, LoopPoles, Stop};

use super::attribution::CAUSES;
use super::compare::{DEFAULT_ESTIMATOR, LoopCase, LoopSettings, Run, Signals, device};
use super::{Attribution, ClosedLoopRow, Fingertip, Ledger, Parasitic, REFERENCE};
use crate::closed_loop::{Conditions, Dac, FeedbackEncoder, Hand, Loop, TickState, usual};
use crate::compare::{Cost, interval};
use catalogue::estimators::Setup;
use catalogue::estimators::{Estimator, Kind};
use catalogue::parameters::PlantKind;
use scoring::evaluation::{Estimate, Evaluation, Heading, Row};
use scoring::score::Score;
use simulation::device::Device;
use simulation::plant::Grip;
use simulation::simulate::{plant_steps, ticks};
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Source of the large motor's velocity in the loop.
#[derive(Clone, Copy)]
pub(super) enum Feedback {
    /// The estimator with this index.
    Candidate(usize),
    /// The reference encoder.
    Reference,
    /// None: the scene has no velocity loop around the large motor.
    Unused,
}

/// A case with the parts that all its runs share.
pub(super) struct Prepared<'a> {
    pub(super) case: &'a LoopCase,
    settings: &'a LoopSettings,
    device: Device,
    assumed: DualStage,
    evaluation: Evaluation,
    handle: Estimator,
    reference: Estimator,
    ticks: usize,
    /// The hand's grip in each tick.
    grips: Vec<Grip>,
}

/// The estimator `kind` with its parameters, for an encoder of `counts_per_rev`.
pub(super) fn estimator(
    kind: &Kind,
    settings: &LoopSettings,
    counts_per_rev: u32,
    rate_hz: f64,
    plant: PlantKind,
) -> Result<Estimator, Failure> {
    let mut setup = Setup::of(&settings.common.device, rate_hz);
    setup.stages.large.counts_per_rev = counts_per_rev;
    kind.build(
        &setup,
        &settings.common.parameters.values(kind, &setup, plant),
    )
}

impl<'a> Prepared<'a> {
    pub(super) fn new(case: &'a LoopCase, settings: &'a LoopSettings) -> Result<Self, Failure> {
        let device = device(settings, case.plant);
        let ticks = ticks(case.rate_hz, case.seconds)?;
        let hand = Hand::from(case.scene.facts().hand);
        let on = |kind: &Kind, counts_per_rev| {
            estimator(kind, settings, counts_per_rev, case.rate_hz, case.plant)
        };
        Ok(Self {
            case,
            settings,
            assumed: device.stages,
            evaluation: Evaluation::new(
                &settings.common.estimators,
                &settings.common.parameters,
                &Setup::of(&device, case.rate_hz),
                case.plant,
            )?,
            handle: on(settings.handle, device.stages.small.counts_per_rev)?,
            reference: on(
                Kind::named(DEFAULT_ESTIMATOR)?,
                device.reference.counts_per_rev,
            )?,
            ticks,
            grips: hand.grips(1.0 / case.rate_hz, case.seed, ticks),
            device,
        })
    }

    /// Velocity sources of the case's runs, in the order of the runs.
    pub(super) fn loops(&self) -> Vec<Feedback> {
        if !self.case.scene.facts().needs.continuous {
            return vec![Feedback::Unused];
        }
        let candidates = (0..self.settings.common.estimators.len()).map(Feedback::Candidate);
        candidates.chain([Feedback::Reference]).collect()
    }

    pub(super) fn run(
        &self,
        feedback: Feedback,
    ) -> Result<(Run, Vec<ClosedLoopRow>, Cost), Failure> {
        let begin = Instant::now();
        let (large, encoder) = match feedback {
            Feedback::Candidate(i) => (
                self.evaluation.candidates()[i].estimator(),
                FeedbackEncoder::Own,
            ),
            Feedback::Reference => (&self.reference, FeedbackEncoder::Reference),
            Feedback::Unused => (&self.handle, FeedbackEncoder::Own),
        };
        let case = self.case;
        let run = Loop {
            device: self.device.clone(),
            assumed: self.assumed,
            scene: usual(case.scene, &self.assumed, case.rate_hz)?,
            hand: case.scene.facts().hand.into(),
            rate_hz: case.rate_hz,
            seed: case.seed,
            large: large.clone(),
            handle: self.handle.clone(),
            encoder,
            poles: LoopPoles::DEFAULT,
            late_ticks: 0,
            offsets_a: [0.0; 2],
        };
        let mut recorder = Recorder::new(self, &run)?;
        let conditions = Conditions {
            dac: Some(Dac::board()?),
            grips: Some(&self.grips),
            ..Conditions::default()
        };
        run.run_under(self.ticks, conditions, |moment| recorder.push(moment))?;
        let simulated = Instant::now();

        let parasitic = Parasitic::of(&recorder.parasitic_mn, case.rate_hz, &recorder.fingertip);
        let (rows, velocity) = self.rows(feedback, &mut recorder, parasitic)?;
        let run = Run {
            controlled_by: match feedback {
                Feedback::Candidate(i) => self.settings.common.estimators[i].name,
                Feedback::Reference => REFERENCE,
                Feedback::Unused => "any",
            },
            parasitic,
            velocity,
            stopped: recorder.stopped,
            attribution: recorder.attribution(case.rate_hz),
            signals: recorder.signals,
        };
        let cost = Cost {
            plant_steps: plant_steps(case.rate_hz, case.seconds)?,
            simulation: simulated - begin,
            estimation: Duration::ZERO,
            scoring: simulated.elapsed(),
        };
        Ok((run, rows, cost))
    }

    /// The rows of a run, and the scores of the velocity that its loop used.
    fn rows(
        &self,
        feedback: Feedback,
        recorder: &mut Recorder,
        parasitic: Parasitic,
    ) -> Result<(Vec<ClosedLoopRow>, Option<Score>), Failure> {
        let case = self.case;
        let heading = Heading {
            scenario: case.scene.name().to_owned(),
            rate_hz: case.rate_hz,
            plant: case.plant,
            seed: case.seed,
        };
        let used = Estimate {
            estimator: match feedback {
                Feedback::Candidate(i) => self.settings.common.estimators[i].name,
                Feedback::Reference | Feedback::Unused => REFERENCE,
            },
            velocity: std::mem::take(&mut recorder.used),
            deviation: None,
            damping_ratio: None,
        };
        let score = |estimates: &[Estimate]| {
            let (interval, wanted) = (interval(&self.device), self.settings.common.wanted);
            self.evaluation
                .rows(&heading, &recorder.trace, estimates, interval, wanted)
        };
        let felt = |row: Row, controlled_by| ClosedLoopRow {
            row,
            controlled_by,
            handle_estimator: self.settings.handle.name,
            parasitic,
            stopped: recorder.stopped,
        };
        let itself = |row: Row| {
            let name = row.estimator;
            felt(row, name)
        };
        let watched = || score(&self.evaluation.estimates(&recorder.trace));
        let closed = |rows: &[Row]| rows.first().map(|row| row.score);
        Ok(match feedback {
            Feedback::Candidate(_) => {
                let rows = score(&[used])?;
                let velocity = closed(&rows);
                (rows.into_iter().map(itself).collect(), velocity)
            }
            Feedback::Reference => {
                let velocity = closed(&score(&[used])?);
                let rows = watched()?.into_iter().map(|row| felt(row, REFERENCE));
                (rows.collect(), velocity)
            }
            Feedback::Unused => {
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

/// Signals recorded in a run.
struct Recorder {
    fingertip: Fingertip,
    /// Signals of the device's own encoders and the true velocity.
    trace: Trace,
    /// Velocity of the large motor that the controller used, rad/s.
    used: Vec<f32>,
    parasitic_mn: Vec<f64>,
    /// The bookkeeping and the force of each cause, mN.
    causes: Option<(Ledger, [Vec<f64>; CAUSES])>,
    signals: Option<Signals>,
    stopped: Option<&'static str>,
}

impl Recorder {
    fn new(prepared: &Prepared, run: &Loop) -> Result<Self, Failure> {
        let scene = run.scene.kind();
        let ledger = || Ledger::new(&run.device, &run.assumed, scene, run.rate_hz, run.poles);
        Ok(Self {
            fingertip: Fingertip::new(&prepared.device),
            trace: Trace {
                rate_hz: prepared.case.rate_hz,
                counts_large: Vec::with_capacity(prepared.ticks),
                counts_small: Some(Vec::with_capacity(prepared.ticks)),
                current: Some(Vec::with_capacity(prepared.ticks)),
                edges: None,
                true_omega: Some(Vec::with_capacity(prepared.ticks)),
                known: None,
                true_damping: None,
                periods: None,
            },
            used: Vec::with_capacity(prepared.ticks),
            parasitic_mn: Vec::with_capacity(prepared.ticks),
            causes: match prepared.case.attribute {
                true => Some((ledger()?, Default::default())),
                false => None,
            },
            signals: prepared.case.keep.then(Signals::default),
            stopped: None,
        })
    }

    fn attribution(&self, rate_hz: f64) -> Option<Attribution> {
        let (_, terms_mn) = self.causes.as_ref()?;
        Attribution::of(terms_mn, rate_hz)
    }

    fn push(&mut self, moment: &TickState) {
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
        if let Some((ledger, terms_mn)) = &mut self.causes {
            for (term, torque) in terms_mn.iter_mut().zip(ledger.terms(moment)) {
                term.push(mn * torque);
            }
        }
        if let Some(signals) = &mut self.signals {
            signals.wanted_mn.push((mn * wanted) as f32);
            signals.felt_mn.push((mn * moment.felt) as f32);
            signals.handle_rad_s.push(moment.handle.omega as f32);
        }
        self.stopped = self.stopped.or(moment.stopped.map(Stop::as_str));
    }
}
