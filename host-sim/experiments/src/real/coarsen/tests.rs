//! The coarse encoder against a second computation: exact fractions, edges by bisection over ticks of
//! the edge clock.

use simulation::trace::EDGE_CLOCK_HZ;

use super::*;

/// Ticks of the edge clock in a microsecond.
const TICKS_PER_US: i128 = 84;

/// Phase as a fraction, so that the second computation is exact.
const PHASES: [(i128, i128); 4] = [(0, 1), (37, 100), (71, 100), (-137, 1000)];

/// A path with rows at whole microseconds.
struct Path {
    us: Vec<i128>,
    counts: Vec<i128>,
}

impl Path {
    /// A walk in which the speed changes its size and direction, with stretches of rest; `most` fine
    /// counts a row, and rows `steps` apart in turn.
    fn new(rows: usize, most: i128, steps: [i128; 2]) -> Self {
        let (mut us, mut counts, mut speed, mut state) = (vec![0], vec![-977], 0, 12_345_u64);
        for k in 1..rows {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            if k % 23 == 0 {
                let random = i128::from(state >> 33);
                speed = if random % 5 == 0 {
                    0
                } else {
                    random % (2 * most + 1) - most
                };
            }
            us.push(us[k - 1] + steps[k % 2]);
            counts.push(counts[k - 1] + speed);
        }
        Self { us, counts }
    }

    fn fine(&self) -> Fine {
        Fine {
            t: self.us.iter().map(|us| 2.5 + 1e-6 * *us as f64).collect(),
            counts: self.counts.iter().map(|count| *count as i64).collect(),
            ..Fine::default()
        }
    }
}

/// The coarse encoder in exact arithmetic.
struct Exact<'a> {
    path: &'a Path,
    fine: i128,
    coarse: i128,
    phase: (i128, i128),
}

impl Exact<'_> {
    /// Count at `tick` of the edge clock, in the segment that begins at row `row`.
    fn count(&self, row: usize, tick: i128) -> i128 {
        let start = TICKS_PER_US * self.path.us[row];
        let span = TICKS_PER_US * self.path.us[row + 1] - start;
        let [n0, n1] = [self.path.counts[row], self.path.counts[row + 1]];
        let position = n0 * span + (n1 - n0) * (tick - start);
        let (p, q) = self.phase;
        let sum = position * self.coarse * q + p * self.fine * span;
        sum.div_euclid(self.fine * q * span)
    }

    /// Count at `tick`, and the latest edge at or before it: the first tick with the new count, and
    /// the boundary.
    fn seen(&self, tick: i128) -> (i128, Option<(i128, i128)>) {
        let last = self.path.us.len() - 2;
        let from = |row: usize| TICKS_PER_US * self.path.us[row];
        let row = (0..=last).rev().find(|&row| from(row) <= tick).unwrap();
        let count = self.count(row, tick);
        for row in (0..=row).rev() {
            let (mut before, mut after) = (from(row), tick.min(from(row + 1)));
            let (old, new) = (self.count(row, before), self.count(row, after));
            if old == new {
                continue;
            }
            while after - before > 1 {
                let middle = before.midpoint(after);
                match self.count(row, middle) == new {
                    true => after = middle,
                    false => before = middle,
                }
            }
            let boundary = if new > old { new } else { new + 1 };
            return (count, Some((after, boundary)));
        }
        (count, None)
    }
}

/// Compares every tick with the second computation. Returns the number of ticks before the first
/// edge, ticks with a new edge in each direction, and the most edges between two ticks.
fn compare(path: &Path, fine: u32, coarse: u32, phase: (i128, i128), rate_hz: f64) -> [u32; 4] {
    let made = Coarse {
        fine_counts_per_rev: fine,
        counts_per_rev: coarse,
        rate_hz,
        phase: phase.0 as f64 / phase.1 as f64,
    };
    let recording = made.recording(&path.fine(), "path").unwrap();
    let exact = Exact {
        path,
        fine: fine.into(),
        coarse: coarse.into(),
        phase,
    };
    let period = (EDGE_CLOCK_HZ / rate_hz) as i128;
    let [mut none, mut forwards, mut backwards, mut most] = [0; 4];
    let mut earlier = None;
    for (k, &count) in recording.trace.counts_large.iter().enumerate() {
        let at = format!("{fine}/{coarse} counts, phase {phase:?}, {rate_hz} Hz, tick {k}");
        let now = period * k as i128;
        let (expected, edge) = exact.seen(now);
        assert_eq!(count, expected as u32, "count, {at}");
        let stamp = recording.trace.edges.as_ref().unwrap()[k];
        let Some((instant, boundary)) = edge else {
            assert_eq!(stamp, None, "{at}");
            none += 1;
            continue;
        };
        let stamp = stamp.expect(&at);
        assert_eq!(stamp.boundary, boundary as u32, "boundary, {at}");
        // The edge lies in the tick of the edge clock before the first one with the new count. The
        // time is computed in f64 from rows at 2.5 s, which adds far less than a hundredth of a tick.
        let late = (now - instant) as f64;
        let age = stamp.age_s * EDGE_CLOCK_HZ;
        assert!(
            (late - 0.01..=late + 1.01).contains(&age),
            "age {age}, {late}, {at}"
        );
        if instant > now - period {
            match boundary == expected {
                true => forwards += 1,
                false => backwards += 1,
            }
        }
        let moved = earlier.map_or(0, |count: i128| (expected - count).unsigned_abs() as u32);
        most = most.max(moved);
        earlier = Some(expected);
    }
    [none, forwards, backwards, most]
}

#[test]
fn counts_and_edges_equal_a_second_computation() {
    let mut sums = [0; 4];
    for (fine, coarse) in [
        (300_000, 4096),
        (40_000, 16_384),
        (30_000, 64),
        (8192, 4096),
    ] {
        for phase in PHASES {
            for (rate_hz, most) in [(1000.0, 3), (500.0, 200), (2000.0, 4000)] {
                let path = Path::new(3000, most, [500, 500]);
                let seen = compare(&path, fine, coarse, phase, rate_hz);
                sums = std::array::from_fn(|i| sums[i] + seen[i]);
            }
        }
    }
    // Every case occurs: no edge yet, edges in both directions, many edges between two ticks.
    assert!(
        sums[0] > 100 && sums[1] > 1000 && sums[2] > 1000 && sums[3] > 1000,
        "{sums:?}"
    );
}

#[test]
fn uneven_rows_and_other_rates_equal_a_second_computation() {
    // Without phase 0 and with an odd ratio, no boundary lies exactly at a tick between two rows.
    for phase in &PHASES[1..] {
        for (rate_hz, steps) in [
            (1000.0, [700, 1050]),
            (800.0, [500, 500]),
            (1250.0, [100, 100]),
        ] {
            let path = Path::new(3000, 40, steps);
            let seen = compare(&path, 30_011, 4096, *phase, rate_hz);
            assert!(seen[1] > 50 && seen[2] > 50, "{seen:?}");
        }
    }
}

#[test]
fn truth_is_interpolated_and_current_is_that_of_the_row_before() {
    let fine = Fine {
        t: vec![0.0, 0.000_7, 0.001_75, 0.002_45],
        counts: vec![0, 7, 14, 14],
        current: Some(vec![2.0, -1.0, 4.0, 8.0]),
        omega: Some(vec![0.0, 7.0, 17.5, 10.5]),
        ..Fine::default()
    };
    let coarse = Coarse {
        fine_counts_per_rev: 1000,
        counts_per_rev: 500,
        rate_hz: 1000.0,
        phase: 0.0,
    };
    let recording = coarse.recording(&fine, "f").unwrap();
    assert_eq!(recording.t, [0.0, 0.001, 0.002]);
    assert_eq!(recording.trace.current, Some(vec![2.0, -1.0, 4.0]));
    // A truth of 10 000 rad/s^2 up, then 10 000 down.
    let omega = recording.trace.true_omega.unwrap();
    for (omega, expected) in omega.iter().zip([0.0, 10.0, 15.0]) {
        assert!((omega - expected).abs() < 1e-9, "{omega}");
    }
}

#[test]
fn too_fine_a_resolution_or_too_fast_a_rate_is_refused() {
    let fine = Path::new(100, 3, [500, 500]).fine();
    for (counts_per_rev, rate_hz, said) in [
        (501, 1000.0, "ask for at most 500 counts/rev"),
        (500, 2100.0, "ask for at most --rate 2000"),
    ] {
        let coarse = Coarse {
            fine_counts_per_rev: 1000,
            counts_per_rev,
            rate_hz,
            phase: 0.0,
        };
        let error = coarse.recording(&fine, "f").unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}
