//! Measured currents of both motors: their zeros, and whether they are the commanded ones.

use estimator_core::{Amps, Hertz};

use crate::device::{DualStage, Motor};
use crate::limits::Currents;
use crate::stop::Stop;

/// Check of the readings r of both amplifiers' current monitors against the commanded currents.
///
/// The measured current is `i = r - z`. Its zero z is the mean of r while the amplifiers are
/// disabled, from 10 ms after they are, over 50 ms:
///
/// ```text
/// n += 1; z += (r - z) / min(n, N)
/// ```
///
/// A tick disagrees if a current differs from the command by more than 8 % of the motor's current
/// limit, if a zero is more than 8 % of the limit away from 0, or if the zeros are not known yet.
/// The ticks that disagree, less the ticks that agree, are counted from 0 on. A count of 50 ms is a
/// [`Stop::CurrentMismatch`]: a lead is open, an amplifier limits its current or has another scale,
/// or a monitor is not connected. Ticks that agree do not clear the count: the command of a motor
/// with an open lead agrees while it swings through zero.
///
/// Readings are taken at the begin of a tick. The current over the period before it is the mean of
/// the readings at both of its ends, which is exact for a straight line. A reading that disagrees is
/// replaced by the command: a monitor that breaks must not drive an observer.
///
/// 50 ms is the rule of the da Vinci Research Kit's controller, whose tolerance is 7 % of its range.
///
/// ```
/// use estimator_core::{Amps, Hertz};
/// use haptic_control::{Ammeters, AmmetersState, Currents, DualStage, Stop};
/// const AMMETERS: Ammeters = Ammeters::new(&DualStage::DEFAULT, Hertz(10e3));
/// let command = Currents { large: Amps::new(1.0), small: Amps::ZERO };
/// let mut state = AmmetersState::START;
/// for _ in 0..200 {
///     AMMETERS.update(&mut state, &Currents::default(), None);
/// }
/// state.restart();
/// // The large motor's lead is open.
/// for _ in 0..500 {
///     assert_eq!(AMMETERS.update(&mut state, &Currents::default(), Some(&command)).mismatch, None);
/// }
/// let flow = AMMETERS.update(&mut state, &Currents::default(), Some(&command));
/// assert_eq!(flow.mismatch, Some(Stop::CurrentMismatch));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ammeters {
    /// Largest differences, large and small motor, A.
    tolerances: [f32; 2],
    /// Ticks of disagreement that are accepted.
    patience: u32,
    /// Ticks from disabling the amplifiers until their currents are zero.
    wait: u32,
    /// Ticks of the mean of a zero.
    span: u32,
}

/// State of [`Ammeters`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmmetersState {
    /// Readings without current, large and small motor, A.
    zeros: [f32; 2],
    /// Largest differences that agree, A: none before the zeros are known, and while one is not near 0.
    tolerances: [f32; 2],
    /// Ticks since the amplifiers were disabled.
    disabled: u32,
    /// Ticks that disagree, less those that agree.
    disagreeing: u32,
    /// Measured currents at the latest tick, or the commands where they disagree, A.
    last: [f32; 2],
    /// Sums of the measured currents over `ticks`, A.
    sums: [f32; 2],
    ticks: u32,
}

/// Currents over the period before a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flow {
    /// Mean currents, measured if they agree with the commands.
    pub currents: Currents,
    /// Whether the currents disagree with the commands.
    pub mismatch: Option<Stop>,
}

/// Largest difference of a current from its command, as a part of the current limit.
const TOLERANCE: f64 = 0.08;
/// Tolerances with which nothing agrees.
const NOTHING: [f32; 2] = [-1.0; 2];
const PATIENCE_S: f64 = 0.05;
const WAIT_S: f64 = 0.01;
const SPAN_S: f64 = 0.05;

impl AmmetersState {
    /// No current, zeros unknown.
    pub const START: Self = Self {
        zeros: [0.0; 2],
        tolerances: NOTHING,
        disabled: 0,
        disagreeing: 0,
        last: [0.0; 2],
        sums: [0.0; 2],
        ticks: 0,
    };

    /// Means of the measured currents since the last call, or since the start.
    pub fn take_means(&mut self) -> Currents {
        let per_tick = 1.0 / self.ticks.max(1) as f32;
        let [large, small] = self.sums.map(|sum| Amps::new(sum * per_tick));
        (self.sums, self.ticks) = ([0.0; 2], 0);
        Currents { large, small }
    }

    /// Forgets the disagreement of currents, when the device is armed. Zeros stay, and their disagreement.
    pub fn restart(&mut self) {
        if self.tolerances != NOTHING {
            self.disagreeing = 0;
        }
    }
}

impl Ammeters {
    /// The ammeters of a device, at a control rate.
    #[must_use]
    pub const fn new(device: &DualStage, rate: Hertz) -> Self {
        const fn tolerance(motor: &Motor) -> f32 {
            (TOLERANCE * motor.current_limit) as f32
        }
        const fn ticks(seconds: f64, rate: Hertz) -> u32 {
            let rounded = (seconds * rate.0 + 0.5) as u32;
            if rounded == 0 { 1 } else { rounded }
        }
        Self {
            tolerances: [tolerance(&device.large), tolerance(&device.small)],
            patience: ticks(PATIENCE_S, rate),
            wait: ticks(WAIT_S, rate),
            span: ticks(SPAN_S, rate),
        }
    }

    /// One tick, with the readings at its begin and the commands that were in force until then;
    /// `None` while the amplifiers are disabled.
    pub fn update(
        &self,
        state: &mut AmmetersState,
        readings: &Currents,
        commands: Option<&Currents>,
    ) -> Flow {
        let readings = [readings.large.get(), readings.small.get()];
        let commands = match commands {
            Some(commands) => {
                state.disabled = 0;
                [commands.large.get(), commands.small.get()]
            }
            None => {
                self.disabled(state, readings);
                [0.0; 2]
            }
        };
        let (mut means, mut agrees) = ([0.0; 2], true);
        for i in 0..2 {
            let measured = readings[i] - state.zeros[i];
            state.sums[i] += measured;
            let mut taken = measured;
            if !((measured - commands[i]).abs() <= state.tolerances[i]) {
                (taken, agrees) = (commands[i], false);
            }
            means[i] = 0.5 * (state.last[i] + taken);
            state.last[i] = taken;
        }
        state.ticks = state.ticks.wrapping_add(1);
        if !agrees {
            state.disagreeing = (state.disagreeing + 1).min(self.patience + 1);
        } else if state.disagreeing > 0 {
            state.disagreeing -= 1;
        }
        Flow {
            currents: Currents {
                large: Amps::new(means[0]),
                small: Amps::new(means[1]),
            },
            mismatch: self.mismatch(state),
        }
    }

    /// Whether the currents disagree with the commands, as in the [`Flow`] of the latest tick.
    #[must_use]
    #[inline]
    pub fn mismatch(&self, state: &AmmetersState) -> Option<Stop> {
        (state.disagreeing > self.patience).then_some(Stop::CurrentMismatch)
    }

    /// One tick with disabled amplifiers.
    fn disabled(&self, state: &mut AmmetersState, readings: [f32; 2]) {
        state.disabled = state.disabled.saturating_add(1);
        let ticks = state.disabled.saturating_sub(self.wait).min(self.span);
        if ticks > 0 {
            let gain = 1.0 / ticks as f32;
            let mut near = true;
            for (i, zero) in state.zeros.iter_mut().enumerate() {
                *zero += (readings[i] - *zero) * gain;
                near &= zero.abs() <= self.tolerances[i];
            }
            state.tolerances = if near { self.tolerances } else { NOTHING };
        }
    }
}
