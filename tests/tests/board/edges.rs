//! Time stamps of the large encoder's edges, captured by the image and known to the board.

use recordings::telemetry::Frame;
use virtual_board::run::{CoreAccess, Outcome, Setup};

use crate::image::run_image;

/// Clock that stamps edges, Hz.
const CLOCK_HZ: f64 = 84e6;

/// Until then the pins are being set up, which the timers see as edges, s.
const SET_UP_S: f64 = 5e-3;

/// A stamp that the image reported: when the tick began, boundary, age in s.
struct Stamp {
    tick_s: f64,
    boundary: i32,
    age_s: f64,
    /// From the tick's beginning until it read the clock, s.
    read_s: f64,
}

/// A run with a signal generator of this many edges a second on the large encoder's lines.
fn generated(hz: f64, seconds: f64) -> (Outcome, Vec<Stamp>) {
    generated_with(hz, seconds, Vec::new())
}

/// As [`generated`], with accesses of the core.
fn generated_with(
    hz: f64,
    seconds: f64,
    accesses: Vec<(f64, CoreAccess)>,
) -> (Outcome, Vec<Stamp>) {
    let setup = Setup {
        seconds,
        generator_hz: Some(hz),
        commands: Vec::new(),
        accesses,
        ..Setup::default()
    };
    let run = run_image("edge-capture", &setup);
    let stamps = run
        .telemetry
        .frames
        .iter()
        .filter_map(|frame| stamp(&run, frame))
        .filter(|stamp| stamp.tick_s > SET_UP_S)
        .collect();
    (run, stamps)
}

fn stamp(run: &Outcome, frame: &Frame) -> Option<Stamp> {
    let edge = frame.side_lines.edge?;
    let tick = run.tick(frame).expect("its tick");
    let read_ns = tick.stamp_clock_read_ns.expect("a reading") - tick.at_ns;
    Some(Stamp {
        read_s: read_ns as f64 * 1e-9,
        tick_s: tick.at_ns as f64 * 1e-9,
        boundary: edge.boundary as i32,
        age_s: f64::from(edge.age) / CLOCK_HZ,
    })
}

/// Edges made before the image counted: in the middle of what its frames say.
fn lost(run: &Outcome, hz: f64) -> i32 {
    let mut lost: Vec<i32> = run
        .telemetry
        .frames
        .iter()
        .map(|frame| {
            let tick = run.tick(frame).expect("its tick");
            let made = (tick.at_ns as f64 * 1e-9 * hz.abs()) as i32;
            made - (frame.counts_large as i32).abs()
        })
        .collect();
    lost.sort_unstable();
    lost[lost.len() / 2]
}

/// Edges at every phase to the reading, moved on by 4 ns a frame at one a microsecond: each stamp is
/// that of its boundary.
#[test]
fn every_stamp_is_the_time_of_its_edge() {
    for (hz, seconds) in [
        (1_000_003.7, 0.35),
        (-1_000_003.7, 0.35),
        (123_457.0, 0.4),
        (-3_001.0, 0.6),
    ] {
        let (run, stamps) = generated(hz, seconds);
        // Edges before the image had set up its pins are lost to it.
        let lost = lost(&run, hz);
        let frames = run.telemetry.frames.len();
        assert!(
            stamps.len() * 10 > frames * 9,
            "{hz}: {} of {frames}",
            stamps.len()
        );
        let late: Vec<f64> = stamps
            .iter()
            .map(|stamp| {
                // Boundary e lies below count e: the n-th edge upwards crosses e = n, downwards
                // e = 1 - n.
                let edge = if hz > 0.0 {
                    stamp.boundary
                } else {
                    1 - stamp.boundary
                };
                let at_s = f64::from(edge + lost) / hz.abs();
                stamp.age_s - (stamp.tick_s + stamp.read_s - at_s)
            })
            .collect();
        let (least, most) = late
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
        // The filter takes its first sample with the next count of the clock, which the read
        // divides too.
        // The instants of edge, tick and read are whole nanoseconds, and the read is known to an
        // instruction, 6 ns: half a count more.
        let limit = 1.5 / CLOCK_HZ;
        assert!(
            least > -limit && most < limit,
            "{hz}: {least:e} to {most:e} s"
        );
    }
}

/// Where no edge comes, the last one grows old, and before the first there is none.
#[test]
fn age_of_an_edge_increases_without_edges() {
    let (_, stamps) = generated(4.0, 0.9);
    assert!(stamps.iter().all(|stamp| stamp.tick_s > 0.25));
    let oldest = stamps.iter().map(|stamp| stamp.age_s).fold(0.0, f64::max);
    assert!((oldest - 0.25).abs() < 2e-3, "{oldest}");
}

/// Counter of TIM4.
const COUNTER: u32 = 0x4000_0824;

/// Edges at 0.25 s, 0.5 s and 0.75 s. The stamp of the edge before is that of another count.
#[test]
fn count_that_changes_without_an_edge_has_no_stamp_until_the_next_one() {
    let moved = vec![(0.6, CoreAccess::Store(COUNTER, 100))];
    let (_, stamps) = generated_with(4.0, 0.9, moved);
    let of = |from_s: f64, to_s: f64| {
        let times = stamps.iter().map(|stamp| stamp.tick_s);
        times.filter(|s| (from_s..to_s).contains(s)).count()
    };
    // A frame a millisecond.
    assert!(of(0.51, 0.59) >= 79);
    assert_eq!(of(0.602, 0.749), 0);
    assert!(of(0.76, 0.89) >= 125);
}
