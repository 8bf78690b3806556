//! Faults: what the hand feels until the image has made itself safe.

mod matrix;
mod scenes;

use std::fmt::Write as _;

use experiments::closed_loop::Hand;
use haptic_control::{Mode, SceneKind, Stop};
use measured::tables::FAULTS;
use rayon::prelude::*;
use simulation::device::Device;
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, Setup};

use crate::image::{free_air, of_scene, run};
use matrix::{Bound, End, FAULT_S, MATRIX, START_S};

/// Outcome of a fault.
struct Found {
    off_ms: Option<f64>,
    never_on: bool,
    reset_ms: Vec<f64>,
    force_mn: f64,
    state: Option<Mode>,
    cause: Option<Stop>,
    quiet: bool,
}

fn within(ms: f64, [least, most]: [f64; 2]) -> bool {
    ms >= least && ms <= most
}

impl Bound {
    fn run(&self) -> Found {
        let seconds = self.at_s + self.watched_s;
        let with = self.with.map(|fault| (0.0, fault));
        let fault = (self.at_s.min(seconds), self.fault);
        let run = run(&Setup {
            faults: with.into_iter().chain([fault]).collect(),
            ..of_scene(SceneKind::FreeAir, Hand::Moving, seconds)
        });
        let never_on = run.enables.len() == 1;
        let off_s = run.off_after(self.at_s).filter(|_| !never_on);
        let until = off_s.map_or(seconds, |off| self.at_s + off);
        let force_mn = if never_on {
            0.0
        } else {
            let diameter = Device::default().handle.diameter_m;
            // After a halt the outputs may return until the next control task.
            let mut offs = run.enables.iter().filter(|(_, on)| *on == [false; 2]);
            let first_off = offs.find_map(|(ns, _)| {
                let s = *ns as f64 * 1e-9;
                (s >= self.at_s).then_some(s)
            });
            let until = first_off.unwrap_or(until);
            run.spurious_mn(free_air(), self.at_s, until, diameter)
        };
        let from = if never_on {
            0
        } else {
            (until * 1e4) as usize + 2
        };
        let after = run.plant_states.iter().skip(from);
        let last = run.telemetry.frames.last();
        let resets = run.restarts.iter();
        Found {
            off_ms: off_s.map(|s| s * 1e3),
            never_on,
            reset_ms: resets.map(|reset| 1e3 * (reset.at_s - self.at_s)).collect(),
            force_mn,
            state: last.map(|frame| frame.state),
            cause: last.map(|frame| frame.cause),
            quiet: after.clone().count() > 100 && after.into_iter().all(|m| m.currents == [0.0; 2]),
        }
    }

    fn holds(&self, found: &Found) -> bool {
        let reset = match (self.reset_ms, &found.reset_ms[..]) {
            (Some(range), [ms]) => within(*ms, range),
            (None, []) => true,
            _ => false,
        };
        // Whatever came after, no amplifier was on again.
        let safe = found.quiet && found.state == Some(Mode::Safe);
        let ends = |end: End| match (end, found.off_ms) {
            (End::Off(range, cause), Some(ms)) => {
                safe && found.cause == Some(cause) && within(ms, range)
            }
            // The last frame is of the time before the halt.
            (End::Halted(range), Some(ms)) => {
                found.quiet && found.state == Some(Mode::Running) && within(ms, range)
            }
            (End::NeverOn(cause), None) => found.never_on && safe && found.cause == Some(cause),
            (End::On, None) => {
                found.state == Some(Mode::Running) && found.cause == Some(Stop::None)
            }
            _ => false,
        };
        let mut outcomes = [(self.end, self.force_mn)].into_iter().chain(self.or);
        reset
            && outcomes
                .any(|(end, [most, least])| ends(end) && within(found.force_mn, [least, most]))
    }

    /// The fault, or both of them.
    fn name(&self) -> String {
        let with = self.with.map(|fault| format!(" with {}", fault.as_str()));
        let start = if self.at_s == START_S {
            " at 0.5 ms"
        } else {
            ""
        };
        let name = self.fault.as_str();
        format!("{name}{start}{}", with.unwrap_or_default())
    }
}

#[test]
fn every_fault_has_its_documented_outcome() {
    for fault in Fault::all() {
        let rows = MATRIX.iter().filter(|bound| bound.fault == fault);
        assert!(rows.count() > 0, "{} has no bound", fault.as_str());
    }
    let found: Vec<Found> = MATRIX.par_iter().map(Bound::run).collect();
    let (mut failed, mut rows) = (String::new(), Vec::new());
    for (bound, found) in MATRIX.iter().zip(&found) {
        let off = match found.off_ms {
            Some(ms) => format!("{ms:.2}"),
            None if found.never_on => "never on".to_owned(),
            None => format!("on after {:.1} s", bound.watched_s),
        };
        let resets = found.reset_ms.iter().map(|ms| format!("{ms:.2}"));
        let row = vec![
            bound.name(),
            bound.fault.description().to_owned(),
            off,
            resets.collect::<Vec<_>>().join(" "),
            format!("{:.1}", found.force_mn),
            found
                .cause
                .map_or("none".to_owned(), |cause| (cause as u8).to_string()),
        ];
        if !bound.holds(found) {
            let Found { state, quiet, .. } = found;
            let more = format!("state {state:?}, quiet {quiet}");
            writeln!(failed, "{}; {more}", row.join(", ")).unwrap();
        }
        rows.push(row);
    }
    assert!(failed.is_empty(), "out of their bounds:\n{failed}");
    let same = |column: &str, then: f64, now: f64| {
        let slack = match column {
            // A tick.
            "off_ms" | "reset_ms" => 0.1_f64.max(0.1 * then),
            "force_mn" => 0.5_f64.max(0.1 * then),
            _ => 0.0,
        };
        (then - now).abs() <= slack
    };
    let checked = FAULTS.check(&[], &rows, same);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

/// Torque, counts and instants: a fault of the probe's side is not felt at all.
fn changes_nothing(run: &Outcome) {
    let healthy = free_air();
    assert!(run.ticks.len() > 9_900);
    for (mine, other) in run.ticks.iter().zip(&healthy.ticks) {
        assert_eq!(
            (mine.at_ns, mine.counts, mine.codes),
            (other.at_ns, other.counts, other.codes)
        );
    }
}

#[test]
fn full_telemetry_buffer_does_not_change_control() {
    let run = run(&Setup {
        seconds: 1.0,
        faults: vec![(FAULT_S, Fault::NobodyDrains)],
        ..Setup::default()
    });
    let frames = run.telemetry.frames.len();
    assert!((400..600).contains(&frames), "{frames} frames were drained");
    changes_nothing(&run);
}

#[test]
fn garbage_on_the_command_channel_does_not_change_control() {
    let run = run(&Setup {
        seconds: 1.0,
        faults: vec![(FAULT_S, Fault::CommandFlood)],
        ..Setup::default()
    });
    let counted = run
        .telemetry
        .log
        .iter()
        .any(|said| said.starts_with("garbage bytes="));
    assert!(counted, "{:?}", run.telemetry.log);
    changes_nothing(&run);
}
