//! Which ticks do what is not due in every tick.
//!
//! The longest tick decides the deadline of the control task. A telemetry frame, the end of a slot of the
//! monitor, the balance of the torques, a message, and the end of a slot of the windings therefore come
//! in different ticks, at 10 kHz and more. A phase is the number of a tick from 0 to [`DECIMATION`] - 1,
//! since the latest frame. Slots, windows and settling are whole numbers of these periods, so that each
//! stays at its phase.

use crate::config::DECIMATION;

/// Number of a tick since the latest frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Phase(u32);

/// What a tick does that others do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// Nothing.
    Nothing,
    /// A frame.
    Frame,
    /// The balance, for this number of ticks.
    Balance(u32),
    /// The end of a slot of the monitor.
    Slot,
    /// A message, if one waits.
    Message,
    /// The windings, for this number of ticks.
    Windings(u32),
    /// The balance and the windings, for one tick, and a message, if one waits.
    All {
        /// Whether a frame is made, too.
        frame: bool,
        /// Whether a slot of the monitor ends, too.
        slot: bool,
    },
}

impl Phase {
    /// Makes a frame.
    pub const FRAME: Self = Self(0);
    /// Begins and ends windows of the balance, which takes this tick and the next three.
    pub const BALANCE: Self = Self::tenth(1);
    /// Ends a slot of the monitor.
    pub const SLOT: Self = Self::tenth(5);
    /// Takes the first message; ticks before the last one of a period take one each. The last one ends a
    /// slot of the windings, which begin with the first tick.
    const FIRST_MESSAGE: Self = Self::tenth(6);
    /// The tick before the first one.
    pub const START: Self = Self(DECIMATION - 1);

    const fn tenth(n: u32) -> Self {
        Self(n * DECIMATION / 10)
    }

    /// The phase of the next tick.
    #[must_use]
    pub const fn next(self) -> Self {
        if self.0 + 1 >= DECIMATION {
            Self(0)
        } else {
            Self(self.0 + 1)
        }
    }

    /// What a tick of this phase does.
    #[must_use]
    #[allow(
        unreachable_patterns,
        clippy::match_overlapping_arm,
        reason = "below 10 kHz, where it is not executed"
    )]
    pub const fn due(self) -> Due {
        const FRAME: u32 = Phase::FRAME.0;
        const BALANCE: [u32; 4] = {
            let first = Phase::BALANCE.0;
            [first, first + 1, first + 2, first + 3]
        };
        const SLOT: u32 = Phase::SLOT.0;
        const MESSAGE: u32 = Phase::FIRST_MESSAGE.0;
        const LAST: u32 = Phase::START.0;
        if DECIMATION < 10 {
            return Due::All {
                frame: self.0 == FRAME,
                slot: self.0 == SLOT,
            };
        }
        match self.0 {
            FRAME => Due::Frame,
            b if b == BALANCE[0] => Due::Balance(DECIMATION - 3),
            b if b == BALANCE[1] || b == BALANCE[2] || b == BALANCE[3] => Due::Balance(1),
            SLOT => Due::Slot,
            LAST => Due::Windings(DECIMATION),
            MESSAGE.. => Due::Message,
            _ => Due::Nothing,
        }
    }

    /// The number of the tick, of this period of frames.
    #[must_use]
    pub const fn tick(self, period: u32) -> u32 {
        period.wrapping_mul(DECIMATION).wrapping_add(self.0)
    }

    /// Number of ticks from this one to the next one of the phase `to`, 1 to [`DECIMATION`].
    #[must_use]
    pub const fn until(self, to: Self) -> u32 {
        if to.0 > self.0 {
            to.0 - self.0
        } else {
            to.0 + DECIMATION - self.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_comes_in_different_ticks() {
        const { assert!(DECIMATION >= 10) };
        let phases = core::iter::successors(Some(Phase::FRAME), |phase| Some(phase.next()));
        let mut due = [0; DECIMATION as usize];
        for (phase, due) in phases.clone().zip(&mut due) {
            *due += u32::from(phase == Phase::FRAME)
                + u32::from(phase == Phase::SLOT)
                + u32::from(phase == Phase::START)
                + u32::from(phase.due() == Due::Message);
        }
        let (balance, _) = phases
            .enumerate()
            .find(|(_, phase)| *phase == Phase::BALANCE)
            .unwrap();
        for due in &mut due[balance..balance + 4] {
            *due += 1;
        }
        assert!(due.iter().all(|due| *due <= 1), "{due:?}");
        assert!(due.iter().sum::<u32>() >= 10);
    }

    #[test]
    fn time_until_a_phase_is_the_number_of_steps_to_it() {
        for from in 0..DECIMATION {
            for to in [Phase::FRAME, Phase::BALANCE, Phase::SLOT] {
                let steps =
                    core::iter::successors(Some(Phase(from).next()), |phase| Some(phase.next()))
                        .position(|phase| phase == to);
                assert_eq!(steps.map(|n| n as u32 + 1), Some(Phase(from).until(to)));
            }
        }
    }
}
