//! Plant and encoders without a controller.

use std::f64::consts::TAU;

use estimator_core::{Amps, Count, Sample};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::{FeedbackEncoder, Hand};
use simulation::device::Device;
use simulation::encoder::{DiscErrors, EdgeObserver, Encoder};
use simulation::plant::{Grip, Plant, Pose};
use simulation::scenario::draw;

/// The simulated device: plant and encoders.
pub struct Bench {
    /// Shafts, coupler and amplifiers.
    pub plant: Plant,
    /// The encoder of the large motor that the controller reads.
    pub large: Encoder,
    /// The device's own encoder of the large motor, if the controller reads the reference encoder.
    pub own: Option<Encoder>,
    /// The handle's encoder.
    pub small: Encoder,
}

impl Bench {
    /// The device at rest, held by `hand`. `seed` draws the large motor's angle and the encoders'
    /// phases, `rate_hz` is the sample rate of the hand's motion, and `step` is the plant's step, s.
    #[must_use]
    pub fn new(
        device: &Device,
        hand: Hand,
        feedback: FeedbackEncoder,
        rate_hz: f64,
        seed: u64,
        step: f64,
    ) -> Self {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(17) ^ 0xC105_ED00);
        let mut plant = Plant::new(device, step);
        let start = Pose {
            angle: draw(&mut random, 0.0, TAU),
            omega: 0.0,
        };
        plant.place(start, hand.start(1.0 / rate_hz, seed));
        let mut encoder = |counts_per_rev: u32, angle: f64, disc: DiscErrors| {
            let first = random.next_u64() as u32;
            let phase = draw(&mut random, 0.0, 1.0);
            Encoder::new(counts_per_rev, first, phase, angle, disc)
        };
        let disc = DiscErrors::new(&device.disc, device.stages.large.counts_per_rev, seed);
        // The reference encoder is drawn last, so that the other draws do not depend on it.
        let own = encoder(device.stages.large.counts_per_rev, start.angle, disc);
        let angle = plant.small().angle;
        let small = encoder(
            device.stages.small.counts_per_rev,
            angle,
            DiscErrors::none(),
        );
        let (large, own) = match feedback {
            FeedbackEncoder::Own => (own, None),
            FeedbackEncoder::Reference => {
                let counts_per_rev = device.reference.counts_per_rev;
                let reference = encoder(counts_per_rev, start.angle, DiscErrors::none());
                (reference, Some(own))
            }
        };
        Self {
            plant,
            large,
            own,
            small,
        }
    }

    /// One step of the plant, `since` s after the tick; the encoders report edges to the observers.
    pub fn step(
        &mut self,
        grip: &Grip,
        since: f64,
        step: f64,
        large: &mut impl EdgeObserver,
        small: &mut impl EdgeObserver,
    ) {
        let (old_large, old_small) = (self.plant.large(), self.plant.small());
        self.plant.step(grip, since, 0.0);
        self.large
            .follow(old_large, self.plant.large(), step, large);
        if let Some(own) = &mut self.own {
            own.follow(old_large, self.plant.large(), step, &mut ());
        }
        self.small
            .follow(old_small, self.plant.small(), step, small);
    }

    /// The controller's input: the present counts and the large motor's `current`.
    #[must_use]
    pub fn sample(&self, current: Amps) -> Sample {
        Sample::new(Count(self.large.count()))
            .with_coupled(Count(self.small.count()))
            .with_current(current)
    }
}
