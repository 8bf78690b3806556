//! The noise of the measurements, which the bank learns: innovations of an optimal filter are white (Mehra 1970).

use super::ModelBankState;
use crate::branch::unlikely;
use crate::design::const_math::limited;
use crate::interval::smaller;

/// Range of R of a boundary, counts². At the largest one the stamps are too noisy to be used.
pub(super) const LEAST_OF_BOUNDARY: f32 = 3e-4;
const LARGEST_OF_BOUNDARY: f32 = 0.1;

/// Range of R of a count, counts².
pub(in crate::bank) const LEAST_OF_COUNT: f32 = 1e-5;
const LARGEST_OF_COUNT: f32 = 1e4;

/// Change of R by an edge, in R.
const GAIN_OF_EDGE: f32 = 0.1;

/// Part of the innovation before the last one in the correlation of an edge: errors of the lines of an encoder with
/// two channels come again after four edges, and their innovations have the opposite sign after two.
const SECOND: f32 = 0.5;

/// Square of the innovation of an edge over its variance, and of a shift against it by the count, counts², above
/// which the stamp contradicts the count.
const LARGE: f32 = 2.0;
const CONTRADICTION: f32 = 0.5;

/// Change of R in the product of two innovations or shifts, and in a variance by the size of a shift.
const GAIN_OF_PRODUCT: f32 = 0.02;
const GAIN_OF_SIZE: f32 = 0.03;

/// Largest square of a shift over its variance that counts, and what is usual: a share of the part of the variance that
/// the interval removes, which is the mean of the whole square where R is right, and at most so much.
const LARGEST: f32 = 1.5;
const USUAL: f32 = 0.6;
const LARGEST_USUAL: f32 = 0.5;

/// Largest product of two shifts where the count turned back by one, counts².
const LARGEST_OF_TURN: f32 = 0.25;

/// Part of the variance beyond R that the size of a shift is learned from, counts²: that of a small noise behind an R that
/// is far too small.
const BEYOND: f32 = 0.01;

/// Part of a decrease of R that a count has which stays: what an end of its interval removes again and again says little
/// of the noise.
const STAYING: f32 = 0.2;

/// R after a new count in whose interval every member is far inside, in R: a noise that is never seen is forgotten.
const FORGETTING: f32 = 0.998;

/// Shifts or innovations of one sign in a row that white ones seldom are. Large shifts are then a motion that the
/// members lag, and R after each is `FALL` times R.
const ONE_SIDED: i8 = 8;
const FALL: f32 = 0.95;

impl<const K: usize> ModelBankState<K> {
    /// The variance R of the position of a boundary, counts², as estimated from the innovations of
    /// edges. Without stamps, or where they are not used, it is the variance of the noise of a count.
    #[must_use]
    pub const fn boundary_variance(&self) -> f32 {
        self.noise
    }

    /// Whether the boundaries are exact enough for their stamps to be used.
    #[inline(always)]
    pub(in crate::bank) const fn reads_stamps(&self) -> bool {
        self.noise < LARGEST_OF_BOUNDARY
    }

    /// The product of an innovation or a shift and the one before, and whether that one had alternated: three
    /// alternating innovations are noise, but a motion that the members cannot follow makes two alternate, and
    /// seldom three.
    #[inline(always)]
    fn product(&mut self, innovation: f32) -> (f32, bool) {
        let product = innovation * self.innovation;
        let alternated = self.signs < 0;
        self.innovation = innovation;
        self.signs = match product < 0.0 {
            true => -1,
            false if alternated => 1,
            false => self.signs.saturating_add(1),
        };
        (product, alternated)
    }

    /// Changes R by the innovation `error` of an edge, of variance `variance`: by its correlation with the two
    /// before in parts of R, which finds an R that is nearly right, and by a product below 0, which raises one that
    /// is far too small. Between edges that are ticks apart the motion has changed: their product says nothing.
    /// Where many innovations have one sign and this one is large, the stamps are off by the `shift` of the position by
    /// the count, if it is against them.
    #[inline(always)]
    pub(super) fn learn_noise_of_edges(
        &mut self,
        error: f32,
        variance: f32,
        shift: f32,
        moved: bool,
    ) {
        let before = self.innovation + SECOND * self.second_innovation;
        self.second_innovation = self.innovation;
        let correlation = limited(error * before / variance, 1.0);
        let (product, alternated) = self.product(error);
        let mut noise = self.noise * (1.0 - GAIN_OF_EDGE * correlation);
        if moved && alternated && product < 0.0 {
            noise -= GAIN_OF_PRODUCT * limited(product, variance);
        }
        // Both ends are constants: the panic of `clamp` is removed.
        self.noise = noise.clamp(LEAST_OF_BOUNDARY, LARGEST_OF_BOUNDARY);
        let square = shift * shift;
        let is_opposed = error * shift < 0.0 && error * error > LARGE * variance;
        let contradicts = is_opposed && square > CONTRADICTION;
        if contradicts && self.signs >= ONE_SIDED && square > self.noise {
            unlikely();
            self.noise = smaller(square, LARGEST_OF_COUNT);
        }
    }

    /// Changes R by the `shift` of a position whose variance with its noise is `variance`, and of which the interval
    /// has `removed` a part: by the product with the shift before, and by its size against what is usual. A position far
    /// inside its interval says little of the noise, however often. A noise of less than half a count seldom makes three
    /// shifts alternate, but it makes the count turn back: two shifts suffice if it `turns`.
    #[inline(always)]
    pub(super) fn learn_noise_of_counts(
        &mut self,
        shift: f32,
        variance: f32,
        removed: f32,
        turns: bool,
    ) {
        if shift == 0.0 {
            if self.still == 0 {
                self.noise = of_count(self.noise * FORGETTING);
            }
            return;
        }
        let (product, alternated) = self.product(shift);
        let size =
            smaller(shift * shift / variance, LARGEST) - smaller(USUAL * removed, LARGEST_USUAL);
        let noise = if size > 0.0 && self.signs >= ONE_SIDED {
            self.noise * FALL
        } else {
            let product = if product >= 0.0 || alternated {
                limited(product, variance)
            } else if turns {
                limited(product, LARGEST_OF_TURN)
            } else {
                0.0
            };
            let gain = match size < 0.0 && self.still != 0 {
                true => GAIN_OF_SIZE * STAYING,
                false => GAIN_OF_SIZE,
            };
            let share = smaller(variance, self.noise + BEYOND);
            self.noise + gain * size * share - GAIN_OF_PRODUCT * product
        };
        self.noise = of_count(noise);
    }
}

/// R of a count, within its range.
#[inline(always)]
const fn of_count(noise: f32) -> f32 {
    // Both ends are constants: the panic of `clamp` is removed.
    noise.clamp(LEAST_OF_COUNT, LARGEST_OF_COUNT)
}
