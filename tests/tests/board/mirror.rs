//! The same core on the host, fed with what the image read: the same bits.

use estimator_core::{Amps, Count, Sample};
use haptic_control::Action;
use virtual_board::run::{Outcome, Tick};

use crate::image::free_air;
use crate::scene::Core;

/// Runs the core over the counts of every tick of `run`.
fn mirrored(run: &Outcome) -> Vec<Action> {
    let mut counts = [Count(0); 2];
    let mut sample = |read: [Option<u16>; 2], current: Amps| {
        for n in [0, 1] {
            counts[n] = counts[n].extended(read[n].expect("each tick reads both encoders"));
        }
        Sample::new(counts[0])
            .with_small(counts[1])
            .with_current(current)
    };
    let first = sample(run.first_counts, Amps::ZERO);
    let mut core = Core::start(&first);
    let mut before = false;
    let mut applied = Amps::ZERO;
    let step = |tick: &Tick| {
        let sample = sample(tick.counts, applied);
        let armed = tick.enabled == [true; 2];
        if armed && !before {
            core.select(1, &sample);
        }
        before = armed;
        let action = core.step(&sample);
        applied = action.currents.large;
        action
    };
    run.ticks.iter().map(step).collect()
}

#[test]
fn what_the_image_reports_is_what_the_host_computes_bit_for_bit() {
    let run = free_air();
    let host = mirrored(run);
    let mut moving = 0;
    for frame in &run.telemetry.frames {
        let k = run.tick_index(frame).expect("a frame tells of a tick");
        let Action {
            currents,
            torque,
            large,
            handle,
        } = host[k];
        let image = [frame.wl, frame.ws, frame.torque, frame.il, frame.is];
        let wanted = [
            large.0,
            handle.0,
            torque.0,
            currents.large.get(),
            currents.small.get(),
        ];
        assert_eq!(
            image.map(f32::to_bits),
            wanted.map(f32::to_bits),
            "{frame:?} {wanted:?}"
        );
        moving += usize::from(large.0 != 0.0 && handle.0 != 0.0);
    }
    assert!(moving > 3000, "{moving} frames of a moving device");
}

#[test]
fn every_dac_code_is_the_hosts_current() {
    let run = free_air();
    let mut moved = 0;
    for (tick, action) in run.ticks.iter().zip(mirrored(run)) {
        let currents = [action.currents.large, action.currents.small];
        for n in [0, 1] {
            let exact = 2048.0 + f64::from(currents[n].get()) / [6.0, 1.5][n] * 2047.0;
            let code = f64::from(tick.codes[n].expect("the channel is on"));
            assert!(
                (code - exact.clamp(1.0, 4095.0)).abs() < 0.501,
                "{code} {exact} {tick:?}"
            );
            moved += usize::from(code != 2048.0);
        }
    }
    assert!(moved > 30_000, "{moved}");
}
