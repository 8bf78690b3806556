//! FOAW by its definition, in exact fractions.

use std::cmp::Ordering;

/// The fitted line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Through the newest and the oldest sample.
    EndFit,
    /// Least squares.
    BestFit,
}

/// The window's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Most intervals.
    pub n: usize,
    /// Noise bound, counts.
    pub d: i32,
    /// Fitted line.
    pub line: Line,
}

/// A fraction; its denominator is positive. With displacements below 2^22 over at most 128 ticks
/// every product below stays under 2^52.
#[derive(Clone, Copy, Debug)]
pub struct Fraction {
    /// Numerator.
    pub rise: i64,
    /// Denominator.
    pub run: i64,
}

impl Fraction {
    /// The nearest f64, then f32.
    #[must_use]
    pub fn rounded(self) -> f32 {
        (self.rise as f64 / self.run as f64) as f32
    }
}

impl Definition {
    /// Slope and length of the longest window over `z[j - 1] = y_k - y_{k-j}`: grown from one
    /// interval, until the line misses a sample by more than d.
    #[must_use]
    pub fn slope(&self, z: &[i32]) -> (Fraction, usize) {
        let mut accepted = (self.fit(&z[..1]), 1);
        for i in 2..=self.n.min(z.len()) {
            let slope = self.fit(&z[..i]);
            if !self.passes(slope, &z[..i]) {
                break;
            }
            accepted = (slope, i);
        }
        accepted
    }

    fn fit(&self, z: &[i32]) -> Fraction {
        let i = z.len() as i64;
        match self.line {
            Line::EndFit => Fraction {
                rise: i64::from(z[z.len() - 1]),
                run: i,
            },
            Line::BestFit => {
                let plain: i64 = z.iter().map(|&z| i64::from(z)).sum();
                let weighted: i64 = (1..).zip(z).map(|(j, &z)| j * i64::from(z)).sum();
                Fraction {
                    rise: 6 * (2 * weighted - i * plain),
                    run: i * (i + 1) * (i + 2),
                }
            }
        }
    }

    /// Whether `|z_j - j slope| <= d` for every j.
    fn passes(&self, slope: Fraction, z: &[i32]) -> bool {
        (1..).zip(z).all(|(j, &z)| {
            let miss = i64::from(z) * slope.run - j * slope.rise;
            miss.abs().cmp(&(i64::from(self.d) * slope.run)) != Ordering::Greater
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn change_of_velocity_ends_the_window() {
        let definition = Definition {
            n: 8,
            d: 1,
            line: Line::EndFit,
        };
        // One count a tick, before that rest: z grows to 3 and stays.
        let (slope, window) = definition.slope(&[1, 2, 3, 3, 3, 3, 3, 3]);
        assert_eq!((window, slope.rise, slope.run), (4, 3, 4));
    }

    #[test]
    fn least_squares_of_a_line_is_the_line() {
        let definition = Definition {
            n: 5,
            d: 0,
            line: Line::BestFit,
        };
        let (slope, window) = definition.slope(&[7, 14, 21, 28, 35]);
        assert_eq!((window, slope.rounded()), (5, 7.0));
    }
}
