//! An image that captures the index pulses of both encoders.

use experiments::closed_loop::{Bench, FeedbackEncoder, Hand};
use haptic_control::{Mode, SceneKind, Stop};
use recordings::telemetry::IndexLine;
use virtual_board::fault::Fault;
use virtual_board::run::{ControlTick, Outcome, RATE_HZ, Setup};

use crate::image::{SETTLED_S, end, of_scene, run_image};

/// The image of this file, with all that watches the board, and the one without the feature.
const IMAGE: &str = "large-adaptive,current-monitor,supply-monitor,index-pulse";
const WITHOUT: &str = "large-adaptive,current-monitor,supply-monitor";

/// Any step of the plant, s.
const STEP_S: f64 = 1e-5;

/// When counts begin to be lost, s.
const FAULT_S: f64 = 0.5;

/// The lines of both encoders, each with the time of its tick, s.
fn lines(run: &Outcome) -> Vec<(f64, [IndexLine; 2])> {
    let lines = run.telemetry.frames.iter().filter_map(|frame| {
        let at_ns = run.tick(frame)?.at_ns;
        Some((at_ns as f64 * 1e-9, frame.side_lines.index?))
    });
    lines.collect()
}

/// Measured currents, supply and pulses agree. An index of one count that is aligned with A and B is captured at
/// the same count in both directions. In these hands the large motor slips by whole turns in two scenes, and no
/// other shaft passes its index.
#[test]
fn nothing_that_is_watched_stops_a_healthy_device_in_any_scene() {
    for scene in SceneKind::ALL {
        let run = run_image(IMAGE, &Setup::playing(scene, 1.0));
        let expected = match scene {
            SceneKind::Off => Mode::Armed,
            _ => Mode::Running,
        };
        assert_eq!(end(&run), (expected, Stop::None), "{scene:?}");
        let beside = run
            .telemetry
            .frames
            .iter()
            .skip(100)
            .map(|frame| &frame.side_lines);
        let watched = beside.filter(|lines| lines.measured.is_some() && lines.supply.is_some());
        assert!(watched.count() > 850, "{scene:?}");
        let lines = lines(&run);
        let exact = |(_, pair): &(f64, [IndexLine; 2])| pair.iter().all(|one| one.deviation == 0);
        assert!(lines.iter().all(exact), "{scene:?}: {lines:?}");
        let least = match scene {
            SceneKind::Wall => 1,
            SceneKind::SpringDamper => 2,
            _ => 0,
        };
        let (_, [large, _]) = lines.last().expect("a line in 128 frames");
        assert!(large.pulses >= least, "{scene:?}: {large:?}");
    }
}

/// Before it is an input, a channel is a comparison of the counter with 0, whose flag is no pulse.
#[test]
fn start_of_the_board_is_no_pulse() {
    let run = run_image(IMAGE, &of_scene(SceneKind::Off, Hand::Clamp, 0.4));
    let lines = lines(&run);
    assert!(!lines.is_empty());
    let nothing = [IndexLine::default(); 2];
    assert!(lines.iter().all(|(_, pair)| *pair == nothing), "{lines:?}");
}

/// For each shaft its count at the start, which is arbitrary, and that of the board at the same angle.
fn starts(setup: &Setup, tick: &ControlTick) -> [[u32; 2]; 2] {
    let Setup {
        device, hand, seed, ..
    } = setup;
    let mut bench = Bench::new(device, *hand, FeedbackEncoder::Own, RATE_HZ, *seed, STEP_S);
    let first = [bench.large.count(), bench.small.count()];
    let poses = [bench.plant.large(), bench.plant.small()];
    bench.large.follow(poses[0], tick.large, STEP_S, &mut ());
    bench.small.follow(poses[1], tick.handle, STEP_S, &mut ());
    let then = [bench.large.count(), bench.small.count()];
    [0, 1].map(|n| {
        let moved = then[n].wrapping_sub(first[n]);
        let board = u32::from(tick.counts[n].expect("a count"));
        [first[n], board.wrapping_sub(moved)]
    })
}

/// The index of a shaft is where its own count is a multiple of a turn.
#[test]
fn both_encoders_report_pulses_and_the_position_after_them() {
    let setup = of_scene(SceneKind::FreeAir, Hand::Tracking, 1.2);
    let run = run_image(IMAGE, &setup);
    assert_eq!(end(&run), (Mode::Running, Stop::None));
    // The inputs of the counters have settled, and the shafts rest.
    let starts = starts(&setup, &run.ticks[10]);
    let stages = [&setup.device.stages.large, &setup.device.stages.small];
    let mut first: [Option<u32>; 2] = [None; 2];
    for frame in &run.telemetry.frames {
        let Some(pair) = frame.side_lines.index else {
            continue;
        };
        let counts = [frame.counts_large, frame.counts_small];
        for (n, one) in pair.iter().enumerate().filter(|(_, one)| one.pulses > 0) {
            let [shaft, board] = starts[n];
            let moved = one.count.wrapping_sub(board).cast_signed();
            // Counts go round after 2^32, which are no whole turns.
            let place = i64::from(shaft) + i64::from(moved);
            let turn = i64::from(stages[n].counts_per_rev);
            assert_eq!(place % turn, 0, "encoder {n}: {one:?}");
        }
        for ((one, first), count) in pair.iter().zip(&mut first).zip(counts) {
            if one.pulses > 0 {
                let reference = *first.get_or_insert(one.count);
                assert_eq!(one.position, count.wrapping_sub(reference).cast_signed());
            }
        }
    }
    assert!(first.iter().all(Option::is_some), "{first:?}");
}

/// A frame is at most 1 ms after the pulse that it reports. The tick after a pulse disables the
/// amplifiers, which the lockstep sees a step or two late.
#[test]
fn lost_counts_stop_the_device_at_the_next_pulse() {
    for (scene, hand) in [
        (SceneKind::FreeAir, Hand::Tracking),
        (SceneKind::Wall, Hand::Pushing),
    ] {
        let run = run_image(
            IMAGE,
            &Setup {
                faults: vec![(FAULT_S, Fault::LostCounts)],
                ..of_scene(scene, hand, 1.5)
            },
        );
        assert_eq!(end(&run), (Mode::Safe, Stop::LostCounts), "{scene:?}");
        let off_s = FAULT_S + run.off_after(FAULT_S).expect("off");
        let lines = lines(&run);
        let found = lines.iter().find(|(_, pair)| pair[0].deviation != 0);
        let (at_s, [large, small]) = found.expect("a deviation");
        println!(
            "{scene:?}: {large:?}, off {:.2} ms after its line",
            1e3 * (off_s - at_s)
        );
        assert!(large.deviation.abs() > 3, "{large:?}");
        assert_eq!(small.deviation, 0, "the other encoder loses nothing");
        assert!(
            (-1.0e-3..0.2e-3).contains(&(off_s - at_s)),
            "{off_s} {at_s}"
        );
    }
}

/// The table of faults has this fault in an image without the feature, which goes on.
#[test]
fn image_without_the_feature_does_not_find_lost_counts() {
    let setup = Setup {
        faults: vec![(FAULT_S, Fault::LostCounts)],
        ..of_scene(SceneKind::FreeAir, Hand::Tracking, 1.0)
    };
    let run = run_image(WITHOUT, &setup);
    assert_eq!(end(&run), (Mode::Running, Stop::None));
    assert!(lines(&run).is_empty());
}

/// What docs/benchmarks.md says of the cost.
#[test]
fn indices_take_45_instructions_a_tick() {
    let mean = |image| {
        let run = run_image(image, &of_scene(SceneKind::FreeAir, Hand::Moving, 0.8));
        let settled = run.ticks.iter().filter(|tick| {
            let at_s = tick.at_ns as f64 * 1e-9;
            (SETTLED_S..0.8).contains(&at_s)
        });
        let instructions: Vec<_> = settled.map(|tick| f64::from(tick.instructions)).collect();
        instructions.iter().sum::<f64>() / instructions.len() as f64
    };
    let cost = mean(IMAGE) - mean(WITHOUT);
    println!("{cost:.1} instructions");
    assert!((cost - 45.0).abs() < 10.0, "{cost}");
}
