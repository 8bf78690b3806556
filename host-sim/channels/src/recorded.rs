//! Rows of a recording.

use std::f64::consts::TAU;

use experiments::transparency::Fingertip;
use recordings::recording::{BoardColumns, Recording};
use scoring::evaluation::Estimate;
use simulation::device::Device;

use crate::list::Values;

/// The rows of a recording of `device`: the channels, then the velocity of each of these estimates, rad/s. The
/// force is that of the torque wanted.
#[must_use]
pub fn rows(
    recording: &Recording,
    board: &BoardColumns,
    device: &Device,
    estimates: &[Estimate],
) -> Vec<Vec<f64>> {
    let row = |k: usize| {
        let mut row = values(recording, board, device, k).all().to_vec();
        row.extend(
            estimates
                .iter()
                .map(|estimate| f64::from(estimate.velocity[k])),
        );
        row
    };
    (0..recording.t.len()).map(row).collect()
}

fn values(recording: &Recording, board: &BoardColumns, device: &Device, k: usize) -> Values {
    let trace = &recording.trace;
    let of = |name: &str| board.column(name).map_or(f64::NAN, |column| column[k]);
    let at = |column: &Option<Vec<f64>>| column.as_ref().map_or(f64::NAN, |column| column[k]);
    let angle = |counts: u32, turn: u32| f64::from(counts as i32) * TAU / f64::from(turn);
    let (large, small) = (&device.stages.large, &device.stages.small);
    let handle = trace.counts_small.as_ref();
    let torque = of("torque");
    Values {
        t: recording.t[k],
        true_omega: at(&trace.true_omega),
        velocity_large: of("velocity_large"),
        sigma_large: of("sigma_large"),
        velocity_small: of("velocity_small"),
        torque,
        force: torque * Fingertip::new(device).mn_per_nm,
        current: at(&trace.current),
        current_small: at(&recording.current_small),
        large_angle: angle(trace.counts_large[k], large.counts_per_rev),
        handle_angle: handle.map_or(f64::NAN, |counts| angle(counts[k], small.counts_per_rev)),
        state: of("state"),
        cause: of("cause"),
        ..Values::default()
    }
}
