//! Rows of a recording.

use std::f64::consts::TAU;

use experiments::transparency::Fingertip;
use recordings::recording::Recording;
use scoring::evaluation::Estimate;
use simulation::device::Device;
use simulation::trace::continued;

use crate::list::Values;

/// The rows of a recording of `device`: the channels, then the velocity of each of these estimates, rad/s. The
/// force is that of the torque wanted.
#[must_use]
pub fn rows(recording: &Recording, device: &Device, estimates: &[Estimate]) -> Vec<Vec<f64>> {
    let trace = &recording.trace;
    let (large, small) = (&device.stages.large, &device.stages.small);
    let handle = trace.counts_small.as_ref();
    let angles = [
        Some(angles(&trace.counts_large, large.counts_per_rev)),
        handle.map(|counts| angles(counts, small.counts_per_rev)),
    ];
    let row = |k: usize| {
        let mut row = values(recording, &angles, device, k).all().to_vec();
        row.extend(
            estimates
                .iter()
                .map(|estimate| f64::from(estimate.velocity[k])),
        );
        row
    };
    (0..recording.t.len()).map(row).collect()
}

/// Angles of an encoder, rad.
fn angles(counts: &[u32], per_rev: u32) -> Vec<f64> {
    let continued = continued(counts);
    let angle = |count: i64| count as f64 * TAU / f64::from(per_rev);
    continued.into_iter().map(angle).collect()
}

/// The values of row `k`, with the angles of the motor and of the handle.
fn values(
    recording: &Recording,
    [large_angle, handle_angle]: &[Option<Vec<f64>>; 2],
    device: &Device,
    k: usize,
) -> Values {
    let (trace, board) = (&recording.trace, &recording.board);
    let of = |name: &str| board.column(name).map_or(f64::NAN, |column| column[k]);
    let at = |column: &Option<Vec<f64>>| column.as_ref().map_or(f64::NAN, |column| column[k]);
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
        large_angle: at(large_angle),
        handle_angle: at(handle_angle),
        state: of("state"),
        cause: of("cause"),
        ..Values::default()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use recordings::recording::ReadOptions;

    use super::*;
    use crate::list::CHANNELS;

    const TEXT: &str = "t,counts_large,counts_small,current,current_small,true_omega,velocity_large,sigma_large,\
        velocity_small,torque,state,cause\n\
        0,-1024,500,0.5,-0.25,3,1.5,0.125,-2.5,0.01,4,6\n\
        0.001,-1020,0,0,0,0,0,0,0,0,0,0\n";

    fn read(text: &str) -> Recording {
        let options = ReadOptions::default();
        Recording::parse_with_board(text.as_bytes(), "r", &options).unwrap()
    }

    /// The values of a row that are known.
    fn known(row: &[f64]) -> BTreeMap<&'static str, f64> {
        let named = CHANNELS.iter().map(|channel| channel.name).zip(row);
        let known = named.filter(|(_, value)| !value.is_nan());
        known.map(|(name, value)| (name, *value)).collect()
    }

    #[test]
    fn row_has_the_values_of_the_recording_in_units_of_the_channels() {
        let mut device = Device::default();
        device.stages.large.counts_per_rev = 4096;
        device.stages.small.counts_per_rev = 2000;
        device.handle.diameter_m = 0.05;
        let recording = read(TEXT);
        let estimate = Estimate {
            estimator: "imm",
            velocity: vec![0.75, 7.0],
            deviation: None,
            damping_ratio: None,
        };
        let rows = rows(&recording, &device, &[estimate]);
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0][CHANNELS.len()..], [0.75]);
        assert_eq!(rows[1][CHANNELS.len()..], [7.0]);
        // A quarter of a turn each, and 0.01 N.m at 25 mm.
        let quarter = TAU / 4.0;
        let expected = [
            ("t", 0.0),
            ("true_omega", 3.0),
            ("velocity_large", 1.5),
            ("sigma_large", 0.125),
            ("velocity_small", -2.5),
            ("torque", 0.01),
            ("force", 400.0),
            ("current", 0.5),
            ("current_small", -0.25),
            ("large_angle", -quarter),
            ("handle_angle", quarter),
            ("state", 4.0),
            ("cause", 6.0),
        ];
        assert_eq!(known(&rows[0]), BTreeMap::from(expected));
        assert_eq!(known(&rows[1])["t"], 0.001);
    }

    #[test]
    fn what_a_recording_has_not_is_not_known() {
        let text = "t,counts_large\n0,1024\n0.001,1025\n";
        let recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let rows = rows(&recording, &Device::default(), &[]);
        let names: Vec<_> = known(&rows[0]).into_keys().collect();
        assert_eq!(names, ["large_angle", "t"]);
    }

    #[test]
    fn angles_go_on_where_the_counter_wraps() {
        let text = "t,counts_large,counts_small\n0,2147483649,4294967295\n0.001,2147483646,1\n0.002,2147483650,2\n";
        let rows = rows(&read(text), &Device::default(), &[]);
        let step = |name: &str, k: usize| known(&rows[k + 1])[name] - known(&rows[k])[name];
        let stages = Device::default().stages;
        let large = TAU / f64::from(stages.large.counts_per_rev);
        let small = TAU / f64::from(stages.small.counts_per_rev);
        // The angle is some 3e6 rad.
        assert!((step("large_angle", 0) + 3.0 * large).abs() < 1e-8);
        assert!((step("large_angle", 1) - 4.0 * large).abs() < 1e-8);
        assert!((step("handle_angle", 0) - 2.0 * small).abs() < 1e-12);
    }
}
