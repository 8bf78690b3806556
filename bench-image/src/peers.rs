//! Other libraries' filters with the same tuning, in the same frame: positions relative to the
//! newest count, so that f32 suffices, but for the integer loop, which wraps.

mod adskalman;
mod idsp_filters;
mod idsp_kalman;
mod minikalman;
mod nalgebra;

pub(crate) use adskalman::AdsKalman;
pub use idsp_filters::{IdspLowPass, IdspPll};
pub(crate) use idsp_kalman::IdspKalman;
pub(crate) use minikalman::MiniKalman;
pub(crate) use nalgebra::NalgebraKalman;

const fn to_f32(m: &[[f64; 3]; 3]) -> [[f32; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            out[i][j] = m[i][j] as f32;
            j += 1;
        }
        i += 1;
    }
    out
}

const fn diagonal(d: &[f64; 3]) -> [[f32; 3]; 3] {
    let [x, v, a] = *d;
    to_f32(&[[x, 0.0, 0.0], [0.0, v, 0.0], [0.0, 0.0, a]])
}

const fn transposed(m: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    let [[a, b, c], [d, e, f], [g, h, i]] = *m;
    [[a, d, g], [b, e, h], [c, f, i]]
}
