//! First-order adaptive windowing (FOAW), exact in integers.

mod best_fit;
mod cone;
mod fit;
mod recent;

use core::marker::PhantomData;

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::CountsPerTick;

pub use fit::{BestFit, EndFit, Fit};
use recent::Recent;

/// First-order adaptive windowing (FOAW): the slope of a straight line over the longest window in
/// which the line passes every sample within a noise bound (Janabi-Sharifi, Hayward, Chen 2000; eqs.
/// 6 to 8).
///
/// With `z_j = y_k - y_{k-j}`, window i has the slope b_i of its fit `F`: [`EndFit`],
/// `z_i / i`, or [`BestFit`], least squares. It is accepted if the line of that slope through the
/// newest sample passes within the noise bound d of every sample, `|z_j - j b_i| <= d` for all
/// `j` in `1..=i`, inclusive. Windows grow from `i = 1`, which is always accepted, and the last
/// one accepted before the first failure, or before n, gives the velocity.
///
/// Window i passes if its slope lies in the cone of slopes that pass every sample,
/// `[max (z_j - d) / j, min (z_j + d) / j]`. The cone is narrowed sample by sample and compared by
/// cross multiplication, so the window is that of the O(n²) definition, without rounding, in one
/// pass. The velocity is rounded once, at the end.
///
/// `d = 1` count bounds the quantisation error of an ideal disc, so at constant speed the end-fit
/// window is always full. The best-fit line may miss a sample by more than 1 count: from n = 9 on it
/// needs `d = 2` for a full window, and with d = 1 the velocity of slow motion is too low by up to
/// 15 % at n = 128. At rest the window is full and the velocity zero after n ticks. N is the largest
/// window, 1 to 128 intervals; n may be less at run time. Steps of 2^15 counts/tick or more restart
/// the window.
///
/// The ring of samples is stored twice, so that a window is contiguous: 8 N bytes, and with the end-fit
/// 2 N more. The newest steps that are equal form one straight line, which needs no test: at rest and at
/// a whole number of counts/tick an update takes few instructions. Every other sample of the window is
/// tested once; with N above 16 the end-fit tests only those at which the step changes, which decide.
/// With n and d = 1 known at compile time an update takes at most 76 + 19 n instructions of a Cortex-M4F
/// for the end-fit, 112 + 20 n with N above 16, and 136 + 38 n for the best-fit, 181 + 66 n where its
/// products need 64 bits, with steps above 3 · 2^31 / (n + 2)^4 - d.
///
/// ```
/// use estimator_core::{BestFit, Count, Foaw, Sample, VelocityEstimator, preset};
/// const FOAW: Foaw<8, BestFit> = preset!(Foaw::new(8, 1));
/// let mut state = FOAW.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for tick in 1..=20 {
///     v = FOAW.update(&mut state, &Sample::new(Count(tick / 4))).0; // a quarter count a tick
/// }
/// assert_eq!((v, state.window()), (0.233_333_33, 8));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Foaw<const N: usize, F> {
    window: u8,
    bound: i32,
    /// Longest step for which 32 bits hold the products of a best-fit window; -1 for none.
    longest_i32: i32,
    fit: PhantomData<F>,
}

memory!([const N: usize, F] Foaw<N, F> { window, bound, longest_i32, fit });

impl<const N: usize, F: Fit> Foaw<N, F> {
    /// FOAW over at most `window` intervals, n, with a noise bound d of `bound` counts.
    ///
    /// # Errors
    /// [`DesignError::WINDOW`] unless `1 <= window <= N`, [`DesignError::BOUND`] if `bound`
    /// is above 2^14. `N` outside 1 to 128 does not compile.
    pub const fn new(window: usize, bound: u16) -> Result<Self, DesignError> {
        const { assert!(1 <= N && N <= 128, "window of 1 to 128 intervals") };
        if window == 0 || window > N {
            return Err(DesignError::WINDOW);
        }
        if bound > 1 << 14 {
            return Err(DesignError::BOUND);
        }
        Ok(Self {
            window: window as u8,
            bound: bound as i32,
            longest_i32: best_fit::longest_i32(window as u32, bound),
            fit: PhantomData,
        })
    }
}

/// State of a [`Foaw`]: the newest counts and the window length last used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoawState<const N: usize, F: Fit> {
    recent: Recent<N, F::Steps<N>>,
    window: u8,
}

impl<const N: usize, F: Fit> FoawState<N, F> {
    /// Window length of the last update in intervals; 0 before the first.
    #[must_use]
    pub const fn window(&self) -> usize {
        self.window as usize
    }
}

/// The body of an update. It is not a function: calls of one from two functions would be optimised before
/// the parameters are known, which takes up to six instructions more where they are constants.
macro_rules! update {
    ($self:ident, $state:ident, $sample:ident, $memory:literal) => {{
        let recent = &mut $state.recent;
        let step = $sample.count - recent.newest;
        if step.0 == 0 && recent.at_rest($self.window) {
            $state.window = $self.window;
            return CountsPerTick(0.0);
        }
        // The products of longer steps overflow i32.
        if !step.is_motion() {
            recent.restart($sample.count);
            $state.window = 1;
            return CountsPerTick(step.to_f32());
        }
        recent.push($sample.count, $self.window);
        let fits_i32 = step.0.abs() <= $self.longest_i32;
        let n = usize::from($self.window);
        let window = F::longest::<N, $memory>(recent, n, fits_i32, $self.bound);
        $state.window = window.intervals;
        CountsPerTick(window.slope)
    }};
}

impl<const N: usize, F: Fit> VelocityEstimator for Foaw<N, F> {
    type State = FoawState<N, F>;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> FoawState<N, F> {
        FoawState {
            recent: Recent::new(first.count),
            window: 0,
        }
    }

    // An image that uses one type twice contains one copy of this function, which takes the parameters
    // at run time. `inline(always)` here and a call to the search that both uses share would be faster there,
    // but a single use, the usual one, would take more instructions, with the best-fit up to 28 in the mean.
    #[inline]
    fn update(&self, state: &mut FoawState<N, F>, sample: &Sample) -> CountsPerTick {
        update!(self, state, sample, false)
    }

    #[inline]
    fn update_of_memory(&self, state: &mut FoawState<N, F>, sample: &Sample) -> CountsPerTick {
        update!(self, state, sample, true)
    }
}
