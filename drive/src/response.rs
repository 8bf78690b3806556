//! The response of a motor to its current, estimated from counts.

/// Milliseconds of half a second difference: long against the step of a count, short against the strokes of
/// the excitation.
const HALF: usize = 4;

/// Speed below which the direction of friction is unknown, rad/s.
const SLOW: f64 = 0.5;

/// Counts, angles and currents of a motor at every millisecond.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a> {
    /// Angle, rad.
    pub(crate) angle: &'a [f64],
    /// Angle of the other side of the coupler, rad.
    pub(crate) coupled: &'a [f64],
    /// Current from each millisecond to the next one, A.
    pub(crate) current: &'a [f64],
}

/// Estimated response: `α = gain i + coupling (ω' - ω) - friction sign ω`, by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Response {
    /// Acceleration per current, rad/s² per A.
    pub(crate) gain: f64,
    /// Acceleration per slip of the coupler, 1/s.
    pub(crate) coupling: f64,
    /// Part of the acceleration's variance that the model explains.
    pub(crate) explained: f64,
}

impl Response {
    /// The response in a motion; `None` if it is too short, or if current or slip do not vary.
    pub(crate) fn of(motion: Motion<'_>) -> Option<Self> {
        const DT: f64 = 1e-3;
        const M: f64 = HALF as f64;
        let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        let (mut power, mut rows) = (0.0, 0_u32);
        let angles = motion.angle.windows(2 * HALF + 1);
        let others = motion.coupled.windows(2 * HALF + 1);
        for ((own, other), current) in angles.zip(others).zip(motion.current.windows(2 * HALF)) {
            let [first, middle, last] = [own[0], own[HALF], own[2 * HALF]];
            let acceleration = (last - 2.0 * middle + first) / (M * DT).powi(2);
            // A second difference of angles is the acceleration, weighted by a triangle.
            let weighted = (0..).zip(current).map(|(j, current)| {
                let j = f64::from(j) + 0.5;
                j.min(2.0 * M - j) / (M * M) * current
            });
            let omega = (last - first) / (2.0 * M * DT);
            let slip = (other[2 * HALF] - other[0]) / (2.0 * M * DT) - omega;
            let direction = if omega.abs() < SLOW {
                0.0
            } else {
                omega.signum()
            };
            let row = [weighted.sum::<f64>(), slip, -direction];
            for (i, x) in row.iter().enumerate() {
                for (j, y) in row.iter().enumerate() {
                    normal[i][j] += x * y;
                }
                right[i] += x * acceleration;
            }
            power += acceleration * acceleration;
            rows += 1;
        }
        let solved = solve(normal, right).filter(|_| rows > 100)?;
        let told: f64 = solved.iter().zip(right).map(|(x, y)| x * y).sum();
        let [gain, coupling, _] = solved;
        let response = Self {
            gain,
            coupling,
            explained: told / power,
        };
        (power > 0.0).then_some(response)
    }
}

/// The solution of three equations, symmetric and positive definite; `None` if they are not.
fn solve(mut a: [[f64; 3]; 3], mut b: [f64; 3]) -> Option<[f64; 3]> {
    let scale = [0, 1, 2].map(|i| a[i][i]);
    for k in 0..3 {
        let pivot = a[k];
        if pivot[k].is_nan() || pivot[k] <= 1e-9 * scale[k] || pivot[k] <= 0.0 {
            return None;
        }
        for i in k + 1..3 {
            let factor = a[i][k] / pivot[k];
            for (x, y) in a[i].iter_mut().zip(pivot) {
                *x -= factor * y;
            }
            b[i] -= factor * b[k];
        }
    }
    let mut x = [0.0; 3];
    for k in (0..3).rev() {
        let rest: f64 = (k + 1..3).map(|j| a[k][j] * x[j]).sum();
        x[k] = (b[k] - rest) / a[k][k];
    }
    Some(x)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A motor with gain 800, coupling 60 and friction 90, against another side that turns by itself,
    /// integrated exactly within each millisecond's steps of 10 us.
    pub(crate) fn motion(gain: f64, coupling: f64) -> [Vec<f64>; 3] {
        let (mut angle, mut omega, mut coupled) = (0.0, 0.0, 0.0);
        let mut all = [Vec::new(), Vec::new(), Vec::new()];
        for k in 0..3000 {
            let current = [0.15, 0.0, -0.15, 0.1, -0.1, 0.0][k / 13 % 6];
            for (list, value) in all.iter_mut().zip([angle, coupled, current]) {
                list.push(value);
            }
            for j in 0..100 {
                let t = k as f64 * 1e-3 + f64::from(j) * 1e-5;
                let other = 6.0 * (20.0 * t).sin() + 3.0 * (53.0 * t).cos();
                let friction = 90.0 * f64::tanh(omega / 0.05);
                omega += 1e-5 * (gain * current + coupling * (other - omega) - friction);
                angle += 1e-5 * omega;
                coupled += 1e-5 * other;
            }
        }
        all
    }

    fn response([angle, coupled, current]: &[Vec<f64>; 3]) -> Option<Response> {
        Response::of(Motion {
            angle,
            coupled,
            current,
        })
    }

    #[test]
    fn gain_and_coupling_are_found_with_their_signs() {
        for (gain, coupling) in [(800.0, 60.0), (-800.0, 60.0), (800.0, 190.0)] {
            let found = response(&motion(gain, coupling)).expect("a response");
            assert!((found.gain / gain - 1.0).abs() < 0.1, "{found:?}");
            assert!((found.coupling / coupling - 1.0).abs() < 0.2, "{found:?}");
            assert!(found.explained > 0.9, "{found:?}");
        }
        // The lines of the other encoder are exchanged.
        let [angle, coupled, current] = motion(800.0, 60.0);
        let reversed = [angle, coupled.iter().map(|x| -x).collect(), current];
        let found = response(&reversed).expect("a response");
        assert!(found.gain > 0.0 && found.coupling < 30.0, "{found:?}");
    }

    #[test]
    fn rest_and_short_motions_have_no_response() {
        let still = [vec![0.0; 3000], vec![0.0; 3000], vec![0.1; 3000]];
        assert_eq!(response(&still), None);
        // A constant current and friction of one direction are not told apart.
        let omega = |k: usize| 3.0 + (0.02 * k as f64).sin();
        let turned = (0..3000).scan(0.0, |angle, k| {
            *angle += 1e-3 * omega(k);
            Some(*angle)
        });
        let other = (0..3000).map(|k| (0.05 * f64::from(k)).cos());
        let steady = [turned.collect(), other.collect(), vec![0.1; 3000]];
        assert_eq!(response(&steady), None);
        let short = motion(800.0, 60.0).map(|list| list[..100].to_vec());
        assert_eq!(response(&short), None);
    }
}
