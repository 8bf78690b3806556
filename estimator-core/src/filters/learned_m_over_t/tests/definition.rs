//! The recurrence of docs/theory/m-over-t.md in f64, with absolute positions and times.

use super::*;

/// Boundaries of a period.
const P: usize = 12;

struct Definition {
    /// Offsets o of the boundaries.
    offsets: [f64; P],
    /// Position of the latest edge with its offset, and its time.
    edge: f64,
    time: f64,
    /// The prediction at the latest edge and its velocity.
    p: f64,
    w: f64,
    /// Mean error of the prediction.
    mean: f64,
    v: f64,
    /// Time between the latest two edges.
    between: f64,
}

impl Definition {
    /// At rest in the middle of the interval of count 0, at time 0.
    const START: Self = Self {
        offsets: [0.0; P],
        edge: 0.5,
        time: 0.0,
        p: 0.5,
        w: 0.0,
        mean: 0.0,
        v: 0.0,
        between: 1.0,
    };

    fn offset(&mut self, boundary: i32) -> &mut f64 {
        &mut self.offsets[boundary.rem_euclid(P as i32) as usize]
    }

    fn place(&mut self, boundary: i32) -> f64 {
        f64::from(boundary) + *self.offset(boundary)
    }

    /// The velocity at time `now`, with the edge of the tick: its boundary and its time.
    fn update(&mut self, now: f64, count: i32, edge: Option<(i32, f64)>) -> f64 {
        let Some((boundary, at)) = edge else {
            let next = self.place(if self.v > 0.0 { count + 1 } else { count });
            let distance = if self.v > 0.0 {
                next - self.edge
            } else {
                self.edge - next
            };
            let most = distance.max(0.0) / (now - self.time);
            self.v = self.v.clamp(-most, most);
            return self.v;
        };
        let place = self.place(boundary);
        let (d, dt) = (place - self.edge, at - self.time);
        if dt > 0.0 {
            self.v = d / dt;
            let expected = self.p + self.w * dt;
            let r = place - expected;
            if r.abs() > 2.0 {
                (self.p, self.w) = (place, self.v);
            } else {
                self.p = expected + 0.3 * r;
                self.w += 0.05 * r / dt;
                self.mean += (r - self.mean) / P as f64;
                if (0.4..=2.5).contains(&d.abs()) {
                    let step = 0.05 * (r - self.mean).clamp(-0.25, 0.25);
                    let offset = self.offset(boundary);
                    *offset = (*offset - step).clamp(-0.25, 0.25);
                }
            }
        }
        (self.edge, self.time, self.between) = (place, at, dt);
        self.v
    }
}

/// Velocity and offsets are those of the definition: in motion of up to 3 counts a tick in both
/// directions, so that edges are 0 to 3 counts apart, and on even and uneven boundaries.
#[test]
fn velocity_and_offsets_are_those_of_the_definition() {
    let swing = |t: f64| 40.0 + 300.0 * (t / 100.0).sin();
    let slow = |t: f64| 1.37 + 20.0 * (t / 70.0).sin();
    for (motion, uneven) in [
        (&swing as &dyn Fn(f64) -> f64, UNEVEN),
        (&slow, UNEVEN),
        (&slow, [0.0, 0.3, 0.0, -0.3, 0.1, 0.0]),
    ] {
        let filter = LearnedMOverT::<P>::new(CLOCK, RATE).unwrap();
        let mut state = filter.start(&Sample::new(Count(0)));
        let mut definition = Definition::START;
        let (mut worst, mut apart) = (0.0f64, 0.0f64);
        for (sample, now) in samples(motion, uneven, 6000).zip(1..) {
            let now = f64::from(now);
            let age = |edge: &Edge| f64::from(edge.age.0) * RATE.0 / CLOCK.0;
            let edge = sample.edge.filter(|edge| age(edge) < 1.0);
            let edge = edge.map(|edge| (edge.boundary.0 as i32, now - age(&edge)));
            let exact = definition.update(now, sample.count.0 as i32, edge);
            let found = f64::from(filter.update(&mut state, &sample).0);
            // Positions and times of f32 have seven digits, which a division by less is short of.
            if definition.between > 1e-3 {
                worst = worst.max((found - exact).abs());
            }
            for (found, exact) in state.offsets.iter().zip(definition.offsets) {
                apart = apart.max((f64::from(*found) - exact).abs());
            }
        }
        assert!(definition.offsets.iter().any(|o| o.abs() > 0.05));
        assert!(worst < 1e-3 && apart < 1e-5, "{worst:e}, {apart:e}");
    }
}
