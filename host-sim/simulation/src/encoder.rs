//! A quadrature encoder: integer counts of an angle, and optionally the times of its edges.

mod disc;

pub use disc::DiscErrors;

use crate::plant::Pose;
use std::f64::consts::TAU;

/// Receiver of edges. With `()` no times of edges are computed.
pub trait EdgeObserver {
    /// Boundary `boundary` (modulo 2^32; boundary `e` lies between counts `e - 1` and `e`) was
    /// crossed; `part` computes the time as a fraction of the step, 0 to 1.
    fn edge(&mut self, boundary: u32, part: impl FnOnce() -> f64);
}

impl EdgeObserver for () {
    #[inline]
    fn edge(&mut self, _: u32, _: impl FnOnce() -> f64) {}
}

/// An encoder on a shaft: `count = floor(angle / (2 pi) * counts_per_rev)`, generalised to a disc
/// whose boundary `e` lies at `e + error[e mod counts_per_rev]` counts.
///
/// It stores the angles of the two boundaries around the shaft, so that a step without an edge needs
/// two comparisons. Angles are in counts relative to the first count, which keeps the precision for
/// counts near 2^32. Two crossings of a boundary within one step (10 us) are not detected.
#[derive(Clone, Debug)]
pub struct Encoder {
    rad_per_count: f64,
    /// Angle of the ideal boundary `first`, rad.
    origin: f64,
    first: i64,
    count: i64,
    lower: f64,
    upper: f64,
    disc: DiscErrors,
}

impl Encoder {
    /// An encoder with the count `first` at `angle` (rad). `phase` (0 to 1) is the position between
    /// the lower and the upper boundary of this count on an ideal disc.
    #[must_use]
    pub fn new(counts_per_rev: u32, first: u32, phase: f64, angle: f64, disc: DiscErrors) -> Self {
        let rad_per_count = TAU / f64::from(counts_per_rev);
        let mut encoder = Self {
            rad_per_count,
            origin: angle - phase * rad_per_count,
            first: i64::from(first),
            count: i64::from(first),
            lower: 0.0,
            upper: 0.0,
            disc,
        };
        encoder.place();
        // A disc error can have moved a boundary beyond the shaft.
        if angle < encoder.lower {
            encoder.count -= 1;
        } else if angle >= encoder.upper {
            encoder.count += 1;
        }
        encoder.place();
        encoder
    }

    /// Counter, modulo 2^32.
    #[inline]
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count as u32
    }

    /// Offset of boundary `e` of the disc, counts.
    #[cfg(test)]
    pub(crate) fn disc_error(&self, e: i64) -> f64 {
        self.disc.error(e)
    }

    fn boundary(&self, e: i64) -> f64 {
        self.origin + ((e - self.first) as f64 + self.disc.error(e)) * self.rad_per_count
    }

    fn place(&mut self) {
        self.lower = self.boundary(self.count);
        self.upper = self.boundary(self.count + 1);
    }

    /// Updates the count over a step of `step_s` that ended at `to`.
    #[inline]
    pub fn follow(&mut self, from: Pose, to: Pose, step_s: f64, observer: &mut impl EdgeObserver) {
        if to.angle >= self.lower && to.angle < self.upper {
            return;
        }
        self.cross(from, to, step_s, observer);
    }

    #[cold]
    fn cross(&mut self, from: Pose, to: Pose, step_s: f64, observer: &mut impl EdgeObserver) {
        while to.angle >= self.upper {
            self.count += 1;
            observer.edge(self.count as u32, || part(from, to, step_s, self.upper));
            self.lower = self.upper;
            self.upper = self.boundary(self.count + 1);
        }
        while to.angle < self.lower {
            observer.edge(self.count as u32, || part(from, to, step_s, self.lower));
            self.count -= 1;
            self.upper = self.lower;
            self.lower = self.boundary(self.count);
        }
    }
}

/// Time at which the cubic through both poses passes `angle`, as a fraction of the step, 0 to 1.
fn part(from: Pose, to: Pose, step_s: f64, angle: f64) -> f64 {
    let span = to.angle - from.angle;
    if span == 0.0 {
        return 1.0;
    }
    // In units of the span: s from 0 to 1, p(0) = 0, p(1) = 1, slopes at both ends.
    let wanted = (angle - from.angle) / span;
    let (first, last) = (from.omega * step_s / span, to.omega * step_s / span);
    let (second, third) = (3.0 - 2.0 * first - last, first + last - 2.0);
    let (mut low, mut high) = (0.0, 1.0);
    let mut s = wanted.clamp(0.0, 1.0);
    for _ in 0..50 {
        let miss = s * (first + s * (second + s * third)) - wanted;
        if miss > 0.0 {
            high = s;
        } else {
            low = s;
        }
        let newton = s - miss / (first + s * (2.0 * second + s * 3.0 * third));
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - s).abs() < 1e-9 {
            return next;
        }
        s = next;
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Disc;

    /// Times of edges, s, and their boundaries.
    struct Log {
        start: f64,
        step: f64,
        edges: Vec<(f64, u32)>,
    }

    impl EdgeObserver for Log {
        fn edge(&mut self, boundary: u32, part: impl FnOnce() -> f64) {
            self.edges.push((self.start + part() * self.step, boundary));
        }
    }

    fn run(
        encoder: &mut Encoder,
        step: f64,
        steps: u32,
        pose: impl Fn(f64) -> Pose,
        mut each: impl FnMut(&Encoder, Pose),
    ) -> Vec<(f64, u32)> {
        let mut log = Log {
            start: 0.0,
            step,
            edges: Vec::new(),
        };
        for k in 0..steps {
            log.start = f64::from(k) * step;
            let to = pose(f64::from(k + 1) * step);
            encoder.follow(pose(log.start), to, step, &mut log);
            each(encoder, to);
        }
        log.edges
    }

    fn swing(t: f64) -> Pose {
        let w = TAU * 7.0;
        Pose {
            angle: 0.4 * (w * t).sin(),
            omega: 0.4 * w * (w * t).cos(),
        }
    }

    #[test]
    fn counts_are_the_floor_of_the_angle() {
        let mut encoder = Encoder::new(4096, 5, 0.25, 0.0, DiscErrors::none());
        run(&mut encoder, 10e-6, 50_000, swing, |encoder, pose| {
            let exact = (pose.angle / TAU * 4096.0 + 5.25).floor();
            assert_eq!(i64::from(encoder.count() as i32), exact as i64);
        });
    }

    #[test]
    fn counts_wrap_without_a_jump() {
        let (mut near, mut far) = (
            Encoder::new(4096, 1000, 0.5, 0.0, DiscErrors::none()),
            Encoder::new(4096, u32::MAX - 3, 0.5, 0.0, DiscErrors::none()),
        );
        let mut wrapped = false;
        for k in 0..20_000 {
            let (from, to) = (swing(f64::from(k) * 1e-5), swing(f64::from(k + 1) * 1e-5));
            near.follow(from, to, 1e-5, &mut ());
            far.follow(from, to, 1e-5, &mut ());
            assert_eq!(
                near.count().wrapping_sub(1000),
                far.count().wrapping_sub(u32::MAX - 3)
            );
            wrapped |= far.count() < 1000;
        }
        assert!(wrapped);
    }

    #[test]
    fn edge_times_are_those_of_the_motion() {
        // A step a hundred times longer checks the cubic interpolation.
        for (step, bound) in [(10e-6, 1e-10), (1e-3, 1e-8)] {
            let mut encoder = Encoder::new(4096, 0, 0.5, 0.0, DiscErrors::none());
            let edges = run(&mut encoder, step, (1.0 / step) as u32, swing, |_, _| {});
            assert!(edges.len() > 5000);
            for (t, boundary) in edges {
                let pose = swing(t);
                if pose.omega.abs() < 1.0 {
                    continue;
                }
                let exact = (f64::from(boundary as i32) - 0.5) * TAU / 4096.0;
                let miss_s = (pose.angle - exact) / pose.omega;
                assert!(miss_s.abs() < bound, "{miss_s:e} s");
            }
        }
    }

    #[test]
    fn several_edges_of_one_step_are_reported_in_order() {
        let mut encoder = Encoder::new(4_000_000, 100, 0.5, 0.0, DiscErrors::none());
        let mut counts = vec![encoder.count()];
        let mut most = 0;
        let edges = run(&mut encoder, 10e-6, 40_000, swing, |encoder, _| {
            most = most.max(encoder.count().abs_diff(*counts.last().unwrap()));
            counts.push(encoder.count());
        });
        assert!(most > 20, "{most}");
        let mut count = 100_u32;
        for pair in edges.windows(2) {
            assert!(pair[0].0 <= pair[1].0, "{pair:?}");
        }
        for (_, boundary) in edges {
            // Boundary e separates counts e - 1 and e.
            count = if boundary == count {
                count.wrapping_sub(1)
            } else {
                count.wrapping_add(1)
            };
            assert!(boundary == count || boundary == count.wrapping_add(1));
        }
        assert_eq!(count, encoder.count());
    }

    #[test]
    fn shaft_is_within_its_count_from_the_start_and_makes_no_edge_at_rest() {
        let errors = Disc {
            phase_counts: 0.3,
            random_counts: 0.1,
            ..Disc::default()
        };
        let mut moved = [0; 3];
        for seed in 0..20 {
            for phase in [0.02, 0.5, 0.98] {
                let disc = DiscErrors::new(&errors, 4096, seed);
                let mut encoder = Encoder::new(4096, 100, phase, 0.7, disc);
                assert!(
                    encoder.lower <= 0.7 && 0.7 < encoder.upper,
                    "{seed} {phase}"
                );
                moved[(encoder.count() - 99) as usize] += 1;
                let rest = |_| Pose {
                    angle: 0.7,
                    omega: 0.0,
                };
                assert_eq!(run(&mut encoder, 10e-6, 1, rest, |_, _| {}), []);
            }
        }
        // The disc moves boundaries beyond the shaft in both directions.
        assert!(moved.iter().all(|count| *count > 3), "{moved:?}");
    }

    #[test]
    fn disc_error_moves_each_boundary_and_repeats_every_turn() {
        let errors = Disc {
            phase_counts: 0.2,
            line_counts: 0.1,
            random_counts: 0.1,
        };
        let disc = DiscErrors::new(&errors, 64, 9);
        let mut encoder = Encoder::new(64, 0, 0.5, 0.0, disc.clone());
        let steady = |t: f64| Pose {
            angle: 10.0 * t,
            omega: 10.0,
        };
        let edges = run(&mut encoder, 10e-6, 130_000, steady, |_, _| {});
        assert!(edges.len() >= 128);
        for (t, boundary) in edges {
            let counts = 10.0 * t / TAU * 64.0 + 0.5;
            let error = counts - f64::from(boundary);
            assert!((error - disc.error(i64::from(boundary) % 64)).abs() < 1e-6);
        }
    }
}
