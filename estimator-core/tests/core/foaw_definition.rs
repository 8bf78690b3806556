//! FOAW against its definition, tried window by window and sample by sample in exact fractions.
//!
//! Window i is the line of slope b_i through the newest sample. It is accepted if
//! `|y_k - j b_i - y_{k-j}| <= d` for every j in 1..=i; window 1 always is. Windows grow until
//! the first that is not accepted; the last accepted one gives the velocity.

use estimator_core::{BestFit, Count, EndFit, Fit, Foaw, FoawState, Sample, VelocityEstimator};

use crate::motion::Draws;

/// A slope as a fraction with a positive denominator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fraction {
    over: i128,
    under: i128,
}

/// The line of a window as a textbook draws it.
pub(crate) trait Definition: Fit + Copy {
    /// Slope of the line for the samples `y[0]` (newest) to `y[i]`, at times 0, -1 .. -i.
    fn line(y: &[i64]) -> Fraction;
}

impl Definition for EndFit {
    fn line(y: &[i64]) -> Fraction {
        let i = y.len() - 1;
        Fraction {
            over: i128::from(y[0] - y[i]),
            under: i as i128,
        }
    }
}

impl Definition for BestFit {
    /// Least squares: `(m Σ t y - Σ t Σ y) / (m Σ t² - (Σ t)²)` over m points.
    fn line(y: &[i64]) -> Fraction {
        let m = y.len() as i128;
        let (mut t1, mut t2, mut y1, mut ty) = (0i128, 0i128, 0i128, 0i128);
        for (age, y) in y.iter().enumerate() {
            // Positions relative to the newest, so that the sums are small.
            let (t, y) = (-(age as i128), i128::from(*y));
            t1 += t;
            t2 += t * t;
            y1 += y;
            ty += t * y;
        }
        Fraction {
            over: m * ty - t1 * y1,
            under: m * t2 - t1 * t1,
        }
    }
}

/// Velocity and window length by the definition. `y` is newest first, at most n + 1 long.
pub(crate) fn defined<D: Definition>(y: &[i64], d: i128) -> (Fraction, usize) {
    let mut accepted = (D::line(&y[..2]), 1);
    for i in 2..y.len() {
        let b = D::line(&y[..=i]);
        let in_band = |j: usize| {
            let behind = i128::from(y[0] - y[j]);
            (behind * b.under - j as i128 * b.over).abs() <= d * b.under
        };
        // The far end fails most often: it is tried first.
        if !(1..=i).rev().all(in_band) {
            break;
        }
        accepted = (b, i);
    }
    accepted
}

/// Whether `v` is the f32 closest to the fraction, or as close: an error of half a unit in the
/// last place at most, in exact integers.
fn error_in_half_ulps(v: f32, exact: Fraction) -> f64 {
    let ulp = if v == 0.0 {
        f64::from(f32::MIN_POSITIVE)
    } else {
        f64::from(f32::from_bits(v.abs().to_bits() + 1)) - f64::from(v.abs())
    };
    // v = mantissa * 2^-60 exactly, for every v that is a quotient of such integers.
    let scaled = f64::from(v) * 2f64.powi(60);
    assert!(scaled == scaled.trunc(), "{v} is finer than 2^-60");
    let difference = scaled as i128 * exact.under - (exact.over << 60);
    difference as f64 / exact.under as f64 / 2f64.powi(60) / (ulp / 2.0)
}

struct Tally {
    updates: usize,
    longest: usize,
}

/// Runs the core and the definition side by side over these positions, which a start begins.
fn compare<const N: usize, D: Definition>(positions: &[i64], n: usize, d: u16, tally: &mut Tally) {
    compare_after::<N, D>(None, positions, n, d, tally);
}

/// The same, with a step of this size to the first position, which restarts, if there is one.
fn compare_after<const N: usize, D: Definition>(
    restart: Option<i64>,
    positions: &[i64],
    n: usize,
    d: u16,
    tally: &mut Tally,
) {
    let foaw = Foaw::<N, D>::new(n, d).expect("valid");
    let at = |position: i64| Sample::new(Count((position as u32).wrapping_add(0xFFFF_FF00)));
    let mut state: FoawState<N, D> = foaw.start(&at(positions[0] - restart.unwrap_or(0)));
    if restart.is_some() {
        foaw.update(&mut state, &at(positions[0]));
    }
    let mut newest_first = Vec::with_capacity(n + 1);
    for k in 1..positions.len() {
        let velocity = foaw.update(&mut state, &at(positions[k])).0;
        newest_first.clear();
        let window = &positions[k.saturating_sub(n)..=k];
        newest_first.extend(window.iter().rev().map(|y| y - positions[k]));
        let (exact, length) = defined::<D>(&newest_first, i128::from(d));
        assert_eq!(state.window(), length, "n = {n}, d = {d}: {newest_first:?}");
        // One rounding of the quotient; where the dividend is above 2^24, of the parts of it.
        let error = error_in_half_ulps(velocity, exact).abs();
        let allowed = if exact.over == 0 { 0.0 } else { 1.05 };
        assert!(
            error <= allowed,
            "n = {n}, d = {d}: {velocity} is {error} half units off {exact:?}"
        );
        tally.updates += 1;
        tally.longest = tally.longest.max(length);
    }
}

/// Steps that stay equal for up to 40 ticks.
struct Stretch {
    step: i64,
    left: u64,
}

impl Stretch {
    fn step(&mut self, draws: &mut Draws) -> i64 {
        if self.left == 0 {
            self.left = 1 + draws.bits() % 40;
            self.step = draws.within(3);
        }
        self.left -= 1;
        self.step
    }
}

/// Positions of one kind, `ticks` long.
fn positions(kind: usize, ticks: usize, draws: &mut Draws) -> Vec<i64> {
    let mut y = vec![0i64];
    let speed = draws.unit() * 32_700.0;
    let slow = draws.unit() * 3.0;
    let (amplitude, period) = (draws.unit() * 3000.0, 30.0 + 400.0 * draws.unit().abs());
    let interval = 2 + draws.bits() % 60;
    let draw = draws.unit().abs();
    let step = draws.within(40);
    let mut stretch = Stretch { step: 0, left: 0 };
    for tick in 1..=ticks {
        let t = tick as f64;
        let last = y[tick - 1];
        y.push(match kind {
            // Walks, narrow and wide.
            0 => last + draws.within(1),
            1 => last + draws.within(9),
            // Smooth motion, quantised: slow, sinusoidal, and near the fastest allowed.
            2 => (slow * t).floor() as i64,
            3 => (amplitude * (t / period).sin()).floor() as i64,
            4 => (speed * t).floor() as i64,
            // Ties: whole steps, with a sample exactly at the band's edge now and then.
            5 => step * tick as i64 + i64::from(draws.bits() % 4 == 0) * draws.within(2),
            // Rest with a flicker, and creep.
            6 => i64::from(draws.bits() % 16 == 0),
            7 => (tick as u64 / interval) as i64,
            // Reversal at the fastest allowed.
            8 => last + if tick / 20 % 2 == 0 { 32_767 } else { -32_767 },
            // Speeds of every size, for products on both sides of 32 bits.
            9 => (speed.signum() * 2f64.powf(14.9 * draw) * t).floor() as i64 + draws.within(1),
            // Stretches of equal steps, of any length.
            10 => last + stretch.step(draws),
            // Fast with noise.
            _ => (speed * 0.9 * t).floor() as i64 + draws.within(3),
        });
    }
    y
}

const KINDS: usize = 12;

/// All kinds of motion at this window and band, both fits.
fn all_kinds<const N: usize>(n: usize, bands: &[u16], ticks: usize, seed: u64) -> Tally {
    let mut draws = Draws(seed);
    let mut tally = Tally {
        updates: 0,
        longest: 0,
    };
    for kind in 0..KINDS {
        for &d in bands {
            let y = positions(kind, ticks, &mut draws);
            compare::<N, EndFit>(&y, n, d, &mut tally);
            compare::<N, BestFit>(&y, n, d, &mut tally);
        }
    }
    tally
}

#[test]
fn windows_and_velocities_are_those_of_the_definition() {
    let (short, long) = std::thread::scope(|scope| {
        let short = scope.spawn(|| {
            let mut updates = 0;
            for n in 1..=15 {
                updates += all_kinds::<15>(n, &[0, 1, 2, 3, 7], 200, n as u64).updates;
            }
            // The smallest ring whose search goes by stretches.
            for n in 1..=17 {
                updates += all_kinds::<17>(n, &[0, 1, 3], 200, n as u64).updates;
            }
            updates + all_kinds::<16>(16, &[1, 16_384], 800, 99).updates
        });
        let long = scope.spawn(|| {
            let mut updates = all_kinds::<32>(32, &[0, 1, 4], 300, 5).updates;
            updates += all_kinds::<64>(63, &[1, 2], 250, 6).updates;
            let widest = all_kinds::<128>(128, &[0, 1, 3], 300, 7);
            // The widest window is reached, so the bounds of the integers are tried.
            assert_eq!(widest.longest, 128);
            updates + widest.updates
        });
        (short.join().unwrap(), long.join().unwrap())
    });
    assert!(short + long >= 400_000, "{short} + {long} updates");
}

/// Whatever the slopes, at the ends of what is allowed.
#[test]
fn no_window_reaches_beyond_the_first_sample() {
    fn at_the_limits<const N: usize>(tally: &mut Tally) {
        let mut draws = Draws(N as u64);
        for kind in 0..KINDS {
            for d in [0, 1, 1 << 14] {
                let y = positions(kind, N + 3, &mut draws);
                for restart in [None, Some(1 << 15), Some(-1 << 30)] {
                    compare_after::<N, EndFit>(restart, &y, N, d, tally);
                    compare_after::<N, BestFit>(restart, &y, N, d, tally);
                }
            }
        }
    }
    let mut tally = Tally {
        updates: 0,
        longest: 0,
    };
    at_the_limits::<1>(&mut tally);
    at_the_limits::<2>(&mut tally);
    at_the_limits::<3>(&mut tally);
    at_the_limits::<128>(&mut tally);
    assert_eq!(tally.longest, 128);
}

/// The definition above, on windows small enough to check by hand.
#[test]
fn definition_agrees_with_hand_calculation() {
    // End-fit over 0, 1, 1, newest last: b_2 = 1/2 misses the middle sample by 1/2.
    assert_eq!(defined::<EndFit>(&[0, 0, -1], 0).1, 1);
    assert_eq!(defined::<EndFit>(&[0, 0, -1], 1).1, 2);
    // A tie is inside: the line of slope 1 misses the middle sample of 0, 2, 2 by exactly 1.
    assert_eq!(defined::<EndFit>(&[0, 0, -2], 1).1, 2);
    // Least squares over 0, 1, 1 has the slope 1/2, over 0, 0, 3 the slope 3/2: misses by 3/2.
    let (b, i) = defined::<BestFit>(&[0, 0, -1], 1);
    assert_eq!((b.over * 2, i), (b.under, 2));
    assert_eq!(defined::<BestFit>(&[0, -3, -3], 1).1, 1);
    assert_eq!(defined::<BestFit>(&[0, -3, -3], 2).1, 2);
}
