//! Faults: what the hand feels until the image has made itself safe.

use virtual_board::fault::Fault;
use virtual_board::run::Setup;

use crate::image::{free_air, run};

const FAULT_S: f64 = 0.5;

fn with(fault: Fault, seconds: f64) -> Setup {
    Setup {
        seconds,
        faults: vec![(FAULT_S, fault)],
        ..Setup::default()
    }
}

#[test]
fn telemetry_that_nobody_drains_changes_nothing_in_control() {
    let setup = with(Fault::NobodyDrains, 2.0);
    let run = run(&setup);
    let healthy = free_air();
    let frames = run.telemetry.frames.len();
    assert!((400..600).contains(&frames), "{frames} frames were drained");
    assert!(run.ticks.len() > 19_900);
    for (mine, other) in run.ticks.iter().zip(&healthy.ticks) {
        assert_eq!(
            (mine.at_ns, mine.counts, mine.codes),
            (other.at_ns, other.counts, other.codes)
        );
    }
}
