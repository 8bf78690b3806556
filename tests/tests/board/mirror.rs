//! The same control on the host, fed with what the image read: the same bits.

use estimator_core::{Amps, Count, Sample};
use haptic_control::{Currents, Request, Stop};
use virtual_board::run::{Outcome, Tick};

use crate::firmware::control::{Control, Inputs};
use crate::image::free_air;
use crate::telemetry::Record;

/// Runs the firmware's control over the counts of every tick of `run`: what it orders, what it
/// reports.
fn mirrored(run: &Outcome) -> Vec<(Option<Currents>, Record)> {
    let mut counts = [Count(0); 2];
    let mut sample = |read: [Option<u16>; 2], current: Amps| {
        for n in [0, 1] {
            counts[n] = counts[n].extended(read[n].expect("each tick reads both encoders"));
        }
        Sample::new(counts[0])
            .with_small(counts[1])
            .with_current(current)
    };
    // The image widens its counters from what they show at first.
    let start = run.first_counts.map(|read| Count(u32::from(read.unwrap())));
    let first = Sample::new(start[0]).with_small(start[1]);
    sample(run.first_counts, Amps::ZERO);
    let mut control = Control::new(&first, Stop::None);
    let mut before = false;
    let step = |(k, tick): (usize, &Tick)| {
        let sample = sample(tick.counts, control.applied().large);
        let armed = tick.enabled == [true; 2];
        // The scene was chosen at some tick before arming, which makes no difference.
        let request = match (k, armed && !before) {
            (0, _) => Request::Select(1),
            (_, true) => Request::Arm,
            (_, false) => Request::KeepAlive,
        };
        before = armed;
        let inputs = Inputs {
            amplifier_fault: false,
            clock_failure: false,
            missed: 0,
            request: Some(request),
        };
        control.step(&sample, &inputs)
    };
    run.ticks.iter().enumerate().map(step).collect()
}

#[test]
fn what_the_image_reports_is_what_the_host_computes_bit_for_bit() {
    let run = free_air();
    let host = mirrored(run);
    let mut moving = 0;
    for frame in &run.telemetry.frames {
        let k = run.tick_index(frame).expect("a frame tells of a tick");
        let Record {
            tick,
            sample,
            action,
            state,
            cause,
            ..
        } = host[k].1;
        assert_eq!(
            (frame.tick, frame.large, frame.small),
            (tick, sample.large.0, sample.small.0)
        );
        assert_eq!(
            (&frame.state, &frame.cause),
            (&state.to_string(), &cause.to_string())
        );
        let image = [frame.wl, frame.ws, frame.torque, frame.il, frame.is];
        let currents = [action.currents.large.get(), action.currents.small.get()];
        let wanted = [
            action.large.0,
            action.handle.0,
            action.torque.0,
            currents[0],
            currents[1],
        ];
        assert_eq!(
            image.map(f32::to_bits),
            wanted.map(f32::to_bits),
            "{frame:?} {wanted:?}"
        );
        moving += usize::from(action.large.0 != 0.0 && action.handle.0 != 0.0);
    }
    assert!(moving > 3000, "{moving} frames of a moving device");
}

#[test]
fn every_dac_code_is_the_hosts_current() {
    let run = free_air();
    let mut moved = 0;
    for (tick, (order, _)) in run.ticks.iter().zip(mirrored(run)) {
        assert_eq!(tick.enabled, [order.is_some(); 2]);
        let currents = order.unwrap_or_default();
        let currents = [currents.large, currents.small];
        for n in [0, 1] {
            let exact = 2048.0 + f64::from(currents[n].get()) / [6.0, 1.5][n] * 2047.0;
            let code = f64::from(tick.codes[n].expect("the channel is on"));
            let miss = (code - exact.clamp(1.0, 4095.0)).abs();
            assert!(miss < 0.501, "{code} {exact} {tick:?}");
            moved += usize::from(code != 2048.0);
        }
    }
    assert!(moved > 30_000, "{moved}");
}
