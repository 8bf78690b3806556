//! High-pass filter.

use std::f64::consts::{SQRT_2, TAU};

/// Butterworth high-pass of second order.
#[derive(Clone, Debug)]
pub(super) struct HighPass {
    gain: f64,
    a1: f64,
    a2: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl HighPass {
    pub(super) fn new(cutoff_hz: f64, rate_hz: f64) -> Self {
        let k = (0.5 * TAU * cutoff_hz / rate_hz).tan();
        let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
        Self {
            gain: norm,
            a1: 2.0 * (k * k - 1.0) * norm,
            a2: (1.0 - SQRT_2 * k + k * k) * norm,
            x: [0.0; 2],
            y: [0.0; 2],
        }
    }

    pub(super) fn update(&mut self, x: f64) -> f64 {
        let [x1, x2] = self.x;
        let [y1, y2] = self.y;
        let y = self.gain * (x - 2.0 * x1 + x2) - self.a1 * y1 - self.a2 * y2;
        self.x = [x, x1];
        self.y = [y, y1];
        y
    }
}
