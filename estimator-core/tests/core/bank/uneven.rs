//! Intervals between samples that differ from the control period: the bank against its definition, and
//! the other estimators that take such intervals.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use estimator_core::{
    Confidence, Count, CountsPerTick, FiniteDifference, Hertz, Imm, ImmEdge, ImmPair,
    LearnedMOverT, LowPass, MOverT, Sample, VaryingPeriod, VelocityEstimator,
};

use super::definition::Definition;
use super::{Apart, BANKS, CLOCK, Random, Seen, hand};

const RATE: f64 = 1000.0;

/// Cut-off of the low-pass, Hz.
const CUTOFF: f64 = 80.0;

/// Seeds of the intervals.
const SEEDS: RangeInclusive<u64> = 1..=9;

/// Motion seen at uneven times, and the intervals between them, periods; that of the first sample is 1.
struct Uneven {
    seen: Seen,
    intervals: Vec<f64>,
}

impl Uneven {
    fn new(intervals: Vec<f64>, place: &dyn Fn(f64) -> f64) -> Self {
        let mut now = 0.0;
        let mut times = vec![0.0];
        for interval in &intervals[1..] {
            now += interval / RATE;
            times.push(now);
        }
        let seen = Seen::at(&times, RATE, 0.0, place);
        Self { seen, intervals }
    }

    /// A hand on an encoder of `counts` counts per revolution, over random intervals.
    fn hand(counts: f64, [least, most]: [f64; 2], seed: u64) -> Self {
        let mut random = Random(seed);
        let mut intervals = vec![1.0];
        while intervals.iter().sum::<f64>() < 3.0 * RATE {
            let share = 0.5 + 0.5 * random.next();
            intervals.push(least + share * (most - least));
        }
        Self::new(intervals, &|t| counts * hand(t))
    }

    /// The estimates with the true intervals, counts per tick.
    fn run<E: VaryingPeriod>(&self, estimator: &E) -> Vec<f64> {
        let mut state = estimator.start(&self.seen.samples[0]);
        let mut velocities = vec![0.0];
        for (sample, interval) in self.seen.samples.iter().zip(&self.intervals).skip(1) {
            let CountsPerTick(v) = estimator.update_over(&mut state, sample, *interval as f32);
            velocities.push(f64::from(v));
        }
        velocities
    }
}

fn imm() -> Imm {
    Imm::new(Hertz(RATE)).expect("valid")
}

fn imm_edge() -> ImmEdge {
    ImmEdge::with_edges(CLOCK, Hertz(RATE)).expect("valid")
}

fn imm_pair() -> ImmPair {
    ImmPair::new(Hertz(RATE)).expect("valid")
}

fn low_pass() -> LowPass<FiniteDifference> {
    LowPass::new(FiniteDifference, Hertz(CUTOFF), Hertz(RATE)).expect("valid")
}

fn m_over_t() -> MOverT {
    MOverT::new(CLOCK, Hertz(RATE)).expect("valid")
}

fn learned() -> LearnedMOverT<12> {
    LearnedMOverT::new(CLOCK, Hertz(RATE)).expect("valid")
}

/// Calls a function with each estimator that takes intervals.
macro_rules! for_each {
    ($($function:tt)+) => {
        $($function)+("finite-difference", &FiniteDifference);
        $($function)+("low-pass", &low_pass());
        $($function)+("m-over-t", &m_over_t());
        $($function)+("m-over-t-learned", &learned());
        $($function)+("imm", &imm());
        $($function)+("imm-edge", &imm_edge());
        $($function)+("imm-pair", &imm_pair());
    };
}

#[test]
fn the_bank_follows_its_definition_over_uneven_intervals() {
    for counts in [64.0, 1024.0, 16_384.0] {
        let mut near = [0; 3];
        let mut squares = [[0.0; 2]; 3];
        for seed in SEEDS {
            let uneven = Uneven::hand(counts, [0.2, 3.0], seed);
            let Uneven { seen, intervals } = &uneven;
            let defined = |members, edges| {
                Definition::run_over(members, RATE, &seen.counts, edges, intervals)
            };
            let pairs = [
                (uneven.run(&imm()), defined(3, None)),
                (uneven.run(&imm_edge()), defined(3, Some(&*seen.edges))),
                (uneven.run(&imm_pair()), defined(2, None)),
            ];
            for (i, (found, defined)) in pairs.iter().enumerate() {
                let apart = Apart::new(seen, found, defined);
                println!("{counts} {} seed {seed}: {apart:?}", BANKS[i]);
                squares[i][0] += apart.error * apart.error;
                squares[i][1] += apart.least * apart.least;
                near[i] += usize::from(apart.is_near());
            }
        }
        // Once on its way, rounding decides whether a bank moves to another rung: the errors are those of
        // the definition over all seeds.
        for (bank, [found, least]) in BANKS.iter().zip(squares) {
            assert!(
                found < 1.1 * 1.1 * least,
                "{counts} {bank}: {found} {least}"
            );
        }
        let [all, most] = [SEEDS.count(), SEEDS.count() - 2];
        assert!(
            near[0] == all && near[1..].iter().all(|near| *near >= most),
            "{counts}: {near:?}"
        );
    }
}

#[test]
fn differences_and_low_pass_are_those_of_the_definition() {
    let uneven = Uneven::hand(4096.0, [0.2, 3.0], 3);
    let counts = &uneven.seen.counts;
    let (difference, filtered) = (uneven.run(&FiniteDifference), uneven.run(&low_pass()));
    let mut slow = 0.0;
    for k in 1..counts.len() {
        let h = uneven.intervals[k];
        let velocity = (counts[k] - counts[k - 1]) / h;
        slow += (1.0 - (-2.0 * PI * CUTOFF * h / RATE).exp()) * (velocity - slow);
        let close =
            |found: f64, expected: f64| (found - expected).abs() < 1e-5 * expected.abs().max(1.0);
        assert!(
            close(difference[k], velocity),
            "{k}: {} {velocity}",
            difference[k]
        );
        assert!(close(filtered[k], slow), "{k}: {} {slow}", filtered[k]);
    }
    let mut state = FiniteDifference.start(&Sample::new(Count(0)));
    FiniteDifference.update_over(&mut state, &Sample::new(Count(3)), 2.5);
    // One count in 2.5 periods.
    let variance = FiniteDifference.variance_over(&state, 2.5).0;
    assert!((variance - 0.16).abs() < 1e-7, "{variance}");
    assert_eq!(
        imm().variance_over(&imm().start(&Sample::new(Count(0))), 2.5),
        {
            let bank = imm();
            bank.variance(&bank.start(&Sample::new(Count(0))))
        }
    );
}

#[test]
fn m_over_t_is_exact_on_a_ramp_over_uneven_intervals() {
    for velocity in [0.113, -0.3137, 0.9073, -3.7071, 9.3031] {
        let intervals = Uneven::hand(1.0, [0.2, 3.0], 3).intervals;
        let uneven = Uneven::new(intervals, &|t| velocity * RATE * t + 0.5);
        let found = uneven.run(&m_over_t());
        for k in 200..found.len() {
            // A tick of the clock is 1.2e-5 periods, over which two edges are 0.2 periods apart at least.
            assert!(
                (found[k] / velocity - 1.0).abs() < 3e-4,
                "{velocity} {k}: {}",
                found[k]
            );
        }
    }
}

fn is_ordinary_update<E: VaryingPeriod>(name: &str, estimator: &E) {
    let seen = Seen::new(RATE, 3000, 0.0, &|t| 1024.0 * hand(t));
    let mut ordinary = estimator.start(&seen.samples[0]);
    let mut over = ordinary.clone();
    for (tick, sample) in seen.samples.iter().enumerate().skip(1) {
        let a = estimator.update(&mut ordinary, sample).0;
        let b = estimator.update_over(&mut over, sample, 1.0).0;
        assert_eq!(a.to_bits(), b.to_bits(), "{name} {tick}");
        assert!(ordinary == over, "{name} {tick}");
    }
}

#[test]
fn a_period_of_one_is_the_ordinary_update_bit_for_bit() {
    for_each!(is_ordinary_update);
}

/// RMS errors over all seeds with the true intervals and with a constant period, counts per period.
fn gains_by_true_intervals<E: VaryingPeriod>(name: &str, estimator: &E) {
    // Some counts in a period: the interval matters more than the quantisation.
    let errors = SEEDS.map(|seed| {
        let uneven = Uneven::hand(16_384.0, [0.4, 1.6], seed);
        let seen = &uneven.seen;
        [uneven.run(estimator), seen.run(estimator)].map(|found| seen.rms(&found))
    });
    let errors: Vec<_> = errors.collect();
    let [true_intervals, constant] = [0, 1].map(|i| {
        let squares = errors.iter().map(|both| both[i] * both[i]);
        (squares.sum::<f64>() / errors.len() as f64).sqrt()
    });
    println!("{name}: {true_intervals:.4}, constant period {constant:.4}");
    let share = match name {
        "finite-difference" | "low-pass" => 1.0 / 3.0,
        // With a constant period they take the uneven steps for noise of the counts.
        "imm" | "imm-pair" => 1.0 / 7.0,
        _ => 0.1,
    };
    assert!(
        true_intervals < share * constant,
        "{name}: {true_intervals}, constant period {constant}"
    );
}

#[test]
fn true_intervals_have_a_smaller_error_than_a_constant_period() {
    for_each!(gains_by_true_intervals);
}

fn survives_a_gap<E: VaryingPeriod>(name: &str, estimator: &E) {
    // Steady motion, a gap, and steady motion of another velocity.
    let mut intervals = vec![1.0; 1000];
    intervals[500] = 1000.0;
    for (before, after) in [(2.3, 2.3), (2.3, -7.1), (0.4, 30.0)] {
        let place = |t: f64| {
            let (t, turn) = (RATE * t, 800.0);
            before * t.min(turn) + after * (t - turn).max(0.0) + 0.5
        };
        let uneven = Uneven::new(intervals.clone(), &place);
        let found = uneven.run(estimator);
        assert!(found.iter().all(|v| v.is_finite()), "{name}");
        let largest = found.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        assert!(largest < 70.0, "{name}: {largest}");
        // Less than a count a tick off, 0.1 s after the gap.
        for k in 600..1000 {
            assert!(
                (found[k] - after).abs() < 1.0,
                "{name} {k}: {} {after}",
                found[k]
            );
        }
    }
}

#[test]
fn estimates_stay_finite_over_a_gap_of_a_thousand_periods() {
    for_each!(survives_a_gap);
}

fn rests_after_0_3_s<E: VaryingPeriod>(name: &str, estimator: &E) {
    for interval in [0.3, 2.5, 400.0] {
        let intervals = vec![interval; 2000.min((600.0 / interval) as usize + 60)];
        let stop = 50.0 * interval / RATE;
        let uneven = Uneven::new(intervals, &|t| 3000.0 * t.min(stop) + 0.5);
        let counts = &uneven.seen.counts;
        let last = (1..counts.len())
            .rfind(|&k| counts[k] != counts[k - 1])
            .expect("it moves");
        for (k, velocity) in uneven.run(estimator).into_iter().enumerate() {
            let still = (k as f64 - last as f64) * interval / RATE;
            // The time at rest is a sum of multiples of 1/1024 periods.
            if k > last && still > 0.301 + interval / RATE {
                assert_eq!(velocity, 0.0, "{name} {interval} {k}");
            } else if k > last && still < 0.299 {
                assert!(velocity != 0.0, "{name} {interval} {k}");
            }
        }
    }
}

#[test]
fn a_bank_is_at_rest_after_0_3_s_of_true_time() {
    rests_after_0_3_s("imm", &imm());
    rests_after_0_3_s("imm-edge", &imm_edge());
    rests_after_0_3_s("imm-pair", &imm_pair());
}

fn limits_periods<E: VaryingPeriod>(name: &str, estimator: &E) {
    let run = |period: f32| {
        let mut state = estimator.start(&Sample::new(Count(0)));
        let mut last = 0.0;
        for k in 1..50u32 {
            last = estimator
                .update_over(&mut state, &Sample::new(Count(k * 7)), period)
                .0;
            assert!(last.is_finite(), "{name} {period}: {last}");
        }
        last
    };
    let (least, most) = (1.0 / 1024.0, 1_048_576.0);
    for (period, limit) in [
        (0.0, least),
        (-1.0, least),
        (f32::NAN, least),
        (1e-30, least),
        (1e9, most),
        (f32::INFINITY, most),
    ] {
        assert_eq!(
            run(period).to_bits(),
            run(limit).to_bits(),
            "{name} {period}"
        );
    }
}

#[test]
fn periods_out_of_range_are_limited() {
    for_each!(limits_periods);
}
