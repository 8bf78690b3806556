//! The instants at which control ticks are due, and missed ticks.

/// The grid of control ticks, `PERIOD` counts apart, on a 32-bit counter that wraps.
///
/// ```
/// use haptic_control::Grid;
/// let mut grid = Grid::<100>::new(0);
/// assert_eq!((grid.due(), grid.begin(103)), (100, 0));
/// // The tick of 200 begins at 452: the ticks of 300 and 400 are missed.
/// assert_eq!((grid.begin(452), grid.due()), (2, 500));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid<const PERIOD: u32> {
    /// The count at which the present tick was due.
    begun: u32,
    /// The count at which the next tick is due.
    due: u32,
    /// The first lateness of a tick that [`Self::begin`] has to look at: a period, or 0 if the latest tick
    /// ended after the next one was due.
    late: u32,
    /// The longest time of a tick that ended before the next one was due, and of one that did not.
    longest: u32,
    overrun: u32,
}

impl<const PERIOD: u32> Grid<PERIOD> {
    /// A grid whose first tick is due one period after `now`.
    #[must_use]
    pub const fn new(now: u32) -> Self {
        const { assert!(PERIOD > 0) };
        Self {
            begun: now,
            due: now.wrapping_add(PERIOD),
            late: PERIOD,
            longest: 0,
            overrun: 0,
        }
    }

    /// The count at which the next tick is due.
    #[must_use]
    pub const fn due(&self) -> u32 {
        self.due
    }

    /// Begins a tick at the count `now`, at which the tick is due or later. Returns the number of
    /// ticks missed since the last tick, or 1 if the last tick overran.
    #[inline]
    pub fn begin(&mut self, now: u32) -> u32 {
        let late = now.wrapping_sub(self.due);
        if late < self.late {
            self.advance(PERIOD);
            return 0;
        }
        self.begin_late(late)
    }

    #[cold]
    #[inline(never)]
    fn begin_late(&mut self, late: u32) -> u32 {
        let missed = late / PERIOD;
        let periods = missed.wrapping_add(1);
        self.advance(PERIOD.wrapping_mul(periods));
        let overran = self.late == 0;
        self.late = PERIOD;
        missed.max(u32::from(overran))
    }

    /// Begins the last tick that is due within this number of counts after the latest one.
    fn advance(&mut self, counts: u32) {
        let due = self.due.wrapping_add(counts);
        (self.begun, self.due) = (due.wrapping_sub(PERIOD), due);
    }

    /// Ends the present tick at the count `now`. Returns whether the next tick is due by now.
    #[inline]
    pub fn end(&mut self, now: u32) -> bool {
        let spent = now.wrapping_sub(self.begun);
        // An overrun is longer than all ticks that are none.
        if spent <= self.longest {
            return false;
        }
        if spent < PERIOD {
            self.longest = spent;
            return false;
        }
        self.overrun = self.overrun.max(spent);
        self.late = 0;
        true
    }

    /// The longest time in counts from the instant at which a tick was due to its end, over the
    /// ticks since the last call.
    pub fn take_longest(&mut self) -> u32 {
        let longest = core::mem::take(&mut self.longest);
        longest.max(core::mem::take(&mut self.overrun))
    }
}
