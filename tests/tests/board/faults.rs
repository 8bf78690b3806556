//! Faults: what the hand feels until the image has made itself safe.

use std::fmt::Write as _;

use host_sim::closed_loop::{Hand, SceneName};
use host_sim::device::Device;
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, Setup};

use crate::golden::Golden;
use crate::image::{free_air, of_scene, run};

const FAULT_S: f64 = 0.5;

/// How a fault has to end.
#[derive(Clone, Copy)]
enum End {
    /// Amplifiers off at most so many ms later, for this cause, after so many restarts.
    Off {
        ms: f64,
        cause: &'static str,
        restarts: usize,
    },
    /// Amplifiers on, no cause: nothing dangerous, or nothing that is noticed yet.
    On,
}

/// What a fault may cost.
struct Bound {
    fault: Fault,
    /// How long to watch after the fault, s.
    watched_s: f64,
    end: End,
    /// Largest and smallest difference from the healthy run's torque until the end, mN at the
    /// fingertip. The smaller one says that the fault did happen.
    force_mn: [f64; 2],
}

const fn off(ms: f64, cause: &'static str, restarts: usize) -> End {
    End::Off {
        ms,
        cause,
        restarts,
    }
}

const fn bound(fault: Fault, watched_s: f64, end: End, force_mn: [f64; 2]) -> Bound {
    Bound {
        fault,
        watched_s,
        end,
        force_mn,
    }
}

/// The image feeds its watchdog from frames, so it dies at most 50 ms and a frame after the last,
/// by an oscillator that is exact here and good to 50 % on silicon.
const MATRIX: [Bound; 15] = [
    // One phase alone counts to and fro, which looks like motion against the push.
    bound(Fault::StuckA, 0.3, off(10.0, "14", 0), [60.0, 10.0]),
    bound(Fault::StuckB, 0.3, off(10.0, "14", 0), [60.0, 10.0]),
    // The loop pushes ever harder until the monitor misses the motion.
    bound(Fault::StuckBoth, 0.5, off(200.0, "4", 0), [300.0, 10.0]),
    // The loop drives the motor the wrong way until the monitor has seen enough of it.
    bound(Fault::Swapped, 0.3, off(6.0, "14", 0), [90.0, 10.0]),
    bound(Fault::LostCounts, 2.0, End::On, [100.0, 10.0]),
    bound(Fault::AmplifierFault, 0.2, off(0.2, "5", 0), [1.0, 0.0]),
    bound(Fault::HungCore, 0.2, off(60.0, "8", 1), [40.0, 1.0]),
    bound(Fault::HungControl, 0.2, off(60.0, "8", 1), [40.0, 1.0]),
    bound(Fault::HungIdle, 0.2, off(60.0, "8", 1), [1.0, 0.0]),
    bound(Fault::BusError, 0.2, off(0.2, "12", 1), [1.0, 0.0]),
    // Never on: there is nothing to compare with.
    bound(Fault::DeadCrystal, -0.3, off(0.0, "10", 0), [0.0, 0.0]),
    // The emulator raises no NMI: the control task finds the lost crystal, on a clock of 16 MHz.
    bound(Fault::CrystalFails, 0.2, off(1.5, "10", 0), [5.0, 0.0]),
    // Control is not touched; but an interrupt that comes an instruction later may take a current
    // over to the next step of the plant, and a count with it. Half of what a fingertip notices.
    bound(Fault::NobodyDrains, 1.0, End::On, [5.0, 0.0]),
    bound(Fault::CommandFlood, 1.0, End::On, [5.0, 0.0]),
    bound(Fault::BrownOut, 0.2, off(0.05, "9", 1), [1.0, 0.0]),
];

/// What a fault did.
struct Found {
    off_ms: Option<f64>,
    force_mn: f64,
    state: String,
    cause: String,
    quiet: bool,
    restarts: usize,
}

impl Bound {
    fn run(&self) -> Found {
        let seconds = FAULT_S + self.watched_s;
        let run = run(&Setup {
            faults: vec![(FAULT_S.min(seconds), self.fault)],
            ..of_scene(SceneName::FreeAir, Hand::Moving, seconds)
        });
        let off_s = run.off_after(FAULT_S);
        let until = off_s.map_or(seconds, |off| FAULT_S + off);
        let never_on = run.enables.len() == 1;
        let force_mn = if never_on {
            0.0
        } else {
            let diameter = Device::default().handle.diameter_m;
            run.spurious_mn(free_air(), FAULT_S, until, diameter)
        };
        let from = if never_on {
            0
        } else {
            (until * 1e4) as usize + 2
        };
        let after = run.moments.iter().skip(from);
        let last = run.telemetry.frames.last().expect("frames");
        Found {
            off_ms: off_s.map(|s| s * 1e3),
            force_mn,
            state: last.state.clone(),
            cause: last.cause.clone(),
            quiet: after.clone().count() > 100 && after.into_iter().all(|m| m.currents == [0.0; 2]),
            restarts: run.restarts.len(),
        }
    }

    fn holds(&self, found: &Found) -> bool {
        let [most, least] = self.force_mn;
        let felt = found.force_mn <= most && found.force_mn >= least;
        felt && match (self.end, found.off_ms) {
            (
                End::Off {
                    ms,
                    cause,
                    restarts,
                },
                Some(off_ms),
            ) => {
                // Whatever came after, no amplifier was on again.
                let safe = found.quiet && found.state == "3" && found.cause == cause;
                safe && off_ms <= ms && found.restarts == restarts
            }
            (End::On, None) => found.state == "2" && found.cause == "0" && found.restarts == 0,
            _ => false,
        }
    }
}

const TABLE: Golden = Golden {
    file: "faults.md",
    name: "faults",
};

#[test]
fn every_fault_ends_as_it_has_to() {
    assert!(Fault::all().eq(MATRIX.iter().map(|bound| bound.fault)));
    // Two at a time: a run takes one thread.
    let found: Vec<Found> = std::thread::scope(|scope| {
        let halves = MATRIX.chunks(MATRIX.len().div_ceil(2));
        let run = |half: &'static [Bound]| half.iter().map(Bound::run).collect::<Vec<_>>();
        let threads: Vec<_> = halves.map(|half| scope.spawn(move || run(half))).collect();
        let results = threads.into_iter().map(|thread| thread.join().unwrap());
        results.flatten().collect()
    });
    let (mut failed, mut rows) = (String::new(), Vec::new());
    for (bound, found) in MATRIX.iter().zip(&found) {
        let off = match found.off_ms {
            Some(ms) => format!("{ms:.2}"),
            None => format!("on after {:.1} s", bound.watched_s),
        };
        let row = vec![
            format!("`{}`", bound.fault.as_str()),
            bound.fault.description().to_owned(),
            off,
            format!("{:.1}", found.force_mn),
            found.cause.clone(),
        ];
        if !bound.holds(found) {
            let Found {
                state,
                restarts,
                quiet,
                ..
            } = found;
            let more = format!("state {state}, {restarts} restarts, quiet {quiet}");
            writeln!(failed, "{}; {more}", row.join(", ")).unwrap();
        }
        rows.push(row);
    }
    assert!(failed.is_empty(), "out of their bounds:\n{failed}");
    let head = [
        "fault",
        "what happens",
        "off after, ms",
        "force, mN",
        "cause",
    ];
    TABLE.check(&head, &rows, |column, golden| match column {
        2 => 0.05_f64.max(0.1 * golden),
        // Where nothing stops it the trajectories part, and the largest force is where they met it.
        3 => 0.5_f64.max(0.5 * golden),
        _ => 0.0,
    });
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
fn telemetry_that_nobody_drains_changes_nothing_in_control() {
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
fn a_flood_of_garbage_changes_nothing_in_control() {
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
