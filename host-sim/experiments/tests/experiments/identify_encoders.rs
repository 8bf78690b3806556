//! Identification from encoders that are coarse or counted the wrong way.

use experiments::closed_loop::Hand;
use simulation::device::Device;

use super::identify::{device, found_against, record, torque_constant, truth};

/// Quantisation of the slip biases every value. It is the same in every block, so the jackknife does not see it.
#[test]
fn intervals_contain_the_quantisation_of_the_handle() {
    for counts_per_rev in [300, 512, 1024] {
        let (mut inside, mut number) = (0, 0);
        for seed in 1..=8 {
            let mut device = device(seed);
            device.stages.small.counts_per_rev = counts_per_rev;
            let mut file = Device::default();
            file.stages.small.counts_per_rev = counts_per_rev;
            let recording = record(&device, Hand::Still, seed, 10);
            let found = found_against(&file, vec![recording], torque_constant(&device)).unwrap();
            for quantity in &found.quantities[..3] {
                let error = quantity.estimate.value - truth(&device, quantity.key);
                inside += usize::from(error.abs() <= quantity.estimate.half);
                number += 1;
            }
        }
        // At 95 % each, fewer than 20 of 24 have a probability below 1 %.
        assert!(
            number == 24 && inside >= 20,
            "{counts_per_rev}: {inside} of {number}"
        );
    }
}

#[test]
fn handle_encoder_that_counts_against_the_large_one_is_named() {
    for (hand, counts_per_rev) in [
        (Hand::Still, 20_000),
        (Hand::Still, 300),
        (Hand::Gone(0.0), 20_000),
    ] {
        let mut device = Device::default();
        device.stages.small.counts_per_rev = counts_per_rev;
        let mut recording = record(&device, hand, 1, 1);
        let small = recording.trace.counts_small.as_mut().unwrap();
        small
            .iter_mut()
            .for_each(|count| *count = count.wrapping_neg());
        let error = found_against(&device, vec![recording], torque_constant(&device)).unwrap_err();
        assert!(
            error.contains("column counts_small counts against column counts_large"),
            "{hand:?} {counts_per_rev}: {error}"
        );
    }
}
