//! Index pulses: whole turns, tolerance, lost counts, and the position after them.

use estimator_core::{Count, Counts};
use haptic_control::{DualStage, Index, IndexState, Motor, Stop};

const DEVICE: DualStage = DualStage::DEFAULT;
const MOTORS: [Motor; 2] = [DEVICE.large, DEVICE.small];
/// What docs and [`Index`] state, counts.
const TOLERANCE: i64 = 3;

/// A shaft with an index that is high for `width` counts, the counter of its encoder, and the check.
struct Shaft {
    index: Index,
    state: IndexState,
    /// Counts of a true turn.
    turn: i64,
    width: i64,
    /// True position, counts; the index rises at 0 in upward motion.
    at: i64,
    /// What the counter shows at position 0.
    zero: i64,
    /// Whether a capture comes before the count of the same edge, in upward and in downward motion.
    early: [bool; 2],
    pulses: u32,
    found: Option<Stop>,
}

impl Shaft {
    fn new(motor: &Motor, at: i64, zero: i64) -> Self {
        Self {
            index: Index::new(motor),
            state: IndexState::START,
            turn: motor.counts_per_rev.into(),
            width: 1,
            at,
            zero,
            early: [false; 2],
            pulses: 0,
            found: None,
        }
    }

    fn is_high(&self, at: i64) -> bool {
        at.rem_euclid(self.turn) < self.width
    }

    fn count(&self, at: i64) -> Count {
        Count((self.zero + at) as u32)
    }

    /// Turns to a position, a tick at each count.
    fn to(&mut self, target: i64) -> &mut Self {
        while self.at != target {
            let before = self.at;
            let direction = (target - before).signum();
            self.at += direction;
            let rises = self.is_high(self.at) && !self.is_high(before);
            let is_early = self.early[usize::from(direction < 0)];
            let captured = self.count(if is_early { before } else { self.at });
            self.pulses += u32::from(rises);
            self.found = self.index.check(&mut self.state, rises.then_some(captured));
        }
        self
    }

    fn turns(&mut self, turns: i64) -> &mut Self {
        self.to(self.at + turns * self.turn)
    }
}

/// From both sides of an index, and a counter about to go round.
const STARTS: [(i64, i64); 4] = [
    (0, 0),
    (-7, 1 << 16),
    (100, u32::MAX as i64 - 9000),
    (5, 1 << 31),
];

#[test]
fn each_turn_has_a_pulse_and_no_finding_in_both_directions() {
    for motor in &MOTORS {
        for (at, zero) in STARTS {
            let mut shaft = Shaft::new(motor, at, zero);
            shaft.turns(5).turns(-9).turns(5);
            assert_eq!(shaft.found, None);
            assert_eq!(shaft.state.deviation(), 0);
            assert_eq!((shaft.state.pulses(), shaft.pulses), (19, 19));
        }
    }
}

#[test]
fn reversals_over_the_index_are_no_finding() {
    for motor in &MOTORS {
        for width in [1, 2] {
            for early in [[false; 2], [true; 2], [true, false], [false, true]] {
                let mut shaft = Shaft::new(motor, -20, 77);
                (shaft.width, shaft.early) = (width, early);
                for k in 0..20 {
                    shaft.to(width).to(-1 - k);
                    assert_eq!(shaft.found, None, "{width} {early:?}");
                }
                shaft.turns(3).turns(-3).to(-20);
                assert_eq!(shaft.found, None, "{width} {early:?}");
            }
        }
    }
}

/// w + 1 counts: 4 with the captures that are furthest apart, 2 with those that are nearest.
#[test]
fn index_of_three_counts_is_admitted_by_exact_captures_alone() {
    let at_reversal = |early| {
        let mut shaft = Shaft::new(&DEVICE.large, -20, 77);
        (shaft.width, shaft.early) = (3, early);
        shaft.to(20).to(-20);
        (shaft.found, shaft.state.deviation())
    };
    assert_eq!(at_reversal([false; 2]), (None, 2));
    assert_eq!(at_reversal([true; 2]), (Some(Stop::LostCounts), 4));
}

#[test]
fn counts_that_go_round_are_no_finding() {
    for motor in &MOTORS {
        let turn = i64::from(motor.counts_per_rev);
        let index = Index::new(motor);
        let mut state = IndexState::START;
        // Two rounds of the count, which are no whole turns of 20 000 counts, and back.
        let turns = 2 * (1 << 32) / turn + 2;
        for k in (0..turns).chain((0..turns).rev()) {
            let pulse = Count((k * turn + 12_345) as u32);
            assert_eq!(index.check(&mut state, Some(pulse)), None, "{k}");
        }
        let Count(back) = state.latest();
        assert_eq!(back, 12_345);
        assert_eq!(state.position(Count(12_340), Counts(0)), Some(Counts(-5)));
    }
}

/// The capture has 16 bits. It is widened like the counter, by a count read up to 2^15 counts later.
#[test]
fn capture_is_widened_for_both_directions() {
    for pulse in [0_u32, 1, 0xFFFF, 0x1_0000, 0xFFFF_FFFF, 0x8000_7FFF] {
        for later in [0, 1, -1, 300, -300, 0x7FFF, -0x7FFF] {
            let now = Count(pulse.wrapping_add_signed(later));
            assert_eq!(now.extended(pulse as u16), Count(pulse), "{later}");
        }
    }
}

#[test]
fn lost_and_gained_counts_are_found_above_the_tolerance() {
    for motor in &MOTORS {
        for (at, zero) in STARTS {
            for direction in [1, -1] {
                for change in [-2000, -4, -3, -1, 1, 3, 4, 2000] {
                    let mut shaft = Shaft::new(motor, at, zero);
                    shaft.turns(direction).turns(direction);
                    shaft.zero += change;
                    let before = shaft.pulses;
                    shaft.turns(direction);
                    assert_eq!(shaft.pulses, before + 1);
                    let expected = (change.abs() > TOLERANCE).then_some(Stop::LostCounts);
                    assert_eq!(shaft.found, expected, "{direction} {change}");
                    assert_eq!(i64::from(shaft.state.deviation()), change);
                }
            }
        }
    }
}

#[test]
fn single_counts_that_are_lost_turn_after_turn_are_found_at_the_fourth() {
    let mut shaft = Shaft::new(&DEVICE.small, -5, 0);
    shaft.turns(1);
    for lost in 1..=4 {
        shaft.zero -= 1;
        shaft.turns(1);
        let expected = (lost > TOLERANCE).then_some(Stop::LostCounts);
        assert_eq!(shaft.found, expected, "{lost}");
    }
}

#[test]
fn wrong_counts_per_turn_are_found_at_the_first_whole_turn() {
    for (device, true_counts, expected) in [
        (4096, 4000, Some(Stop::LostCounts)),
        (4096, 4092, Some(Stop::LostCounts)),
        (4096, 4100, Some(Stop::LostCounts)),
        (4096, 2048, Some(Stop::LostCounts)),
        // A multiple looks like turns between which the index was missed.
        (4096, 8192, None),
    ] {
        let motor = Motor {
            counts_per_rev: device,
            ..DEVICE.large
        };
        for direction in [1, -1] {
            let mut shaft = Shaft::new(&motor, -direction, 9);
            shaft.turn = true_counts;
            shaft.to(0);
            assert_eq!((shaft.found, shaft.pulses), (None, 1));
            shaft.turns(direction);
            assert_eq!((shaft.found, shaft.pulses), (expected, 2), "{true_counts}");
        }
    }
}

/// A wire that is not connected.
#[test]
fn no_pulse_is_no_finding_and_no_position() {
    let mut shaft = Shaft::new(&DEVICE.large, 1, 0);
    shaft.width = 0;
    shaft.turns(10).turns(-20);
    assert_eq!((shaft.found, shaft.pulses), (None, 0));
    assert_eq!(shaft.state, IndexState::START);
    assert_eq!(shaft.state.position(Count(3), Counts(0)), None);
}

#[test]
fn pulse_in_the_middle_of_a_turn_is_found_and_stays() {
    for motor in &MOTORS {
        let mut shaft = Shaft::new(motor, -1, 50);
        let middle = 5 * shaft.turn / 2;
        shaft.turns(2).to(middle);
        let noise = shaft.count(shaft.at);
        let found = shaft.index.check(&mut shaft.state, Some(noise));
        assert_eq!(found, Some(Stop::LostCounts));
        assert_eq!(i64::from(shaft.state.deviation()), shaft.turn / 2);
        // A good one does not clear it.
        shaft.turns(1);
        assert_eq!(shaft.state.deviation(), 0);
        assert_eq!(shaft.found, Some(Stop::LostCounts));
    }
}

#[test]
fn restart_after_a_finding_takes_the_next_pulse_for_the_reference() {
    let mut shaft = Shaft::new(&DEVICE.large, -1, 0);
    shaft.turns(1);
    shaft.zero -= 40;
    shaft.turns(1);
    assert_eq!(shaft.found, Some(Stop::LostCounts));
    shaft.state.restart();
    assert_eq!(shaft.state.position(shaft.count(3), Counts(0)), None);
    assert_eq!((shaft.state.pulses(), shaft.state.deviation()), (0, -40));
    shaft.turns(2);
    assert_eq!((shaft.found, shaft.state.pulses()), (None, 2));
    assert_eq!(shaft.state.deviation(), 0);
}

/// Without one, a slow loss would be forgiven at each start.
#[test]
fn restart_without_a_finding_keeps_the_reference() {
    let mut shaft = Shaft::new(&DEVICE.large, -1, 0);
    shaft.turns(1);
    for _ in 0..3 {
        shaft.zero -= 1;
        shaft.turns(1);
        shaft.state.restart();
    }
    shaft.zero -= 1;
    shaft.turns(1);
    assert_eq!(shaft.found, Some(Stop::LostCounts));
}

/// The zero is known from the first pulse on, without a whole turn.
#[test]
fn first_pulse_gives_the_position() {
    for motor in &MOTORS {
        let mut shaft = Shaft::new(motor, -10, 1 << 20);
        let position = |shaft: &Shaft| shaft.state.position(shaft.count(shaft.at), Counts(7));
        assert_eq!(position(shaft.to(-1)), None);
        assert_eq!(position(shaft.to(25)), Some(Counts(25 - 7)));
    }
}

#[test]
fn position_counts_from_the_first_pulse_and_its_offset() {
    for zero in [0, 1 << 31, u32::MAX.into()] {
        let mut shaft = Shaft::new(&DEVICE.large, -10, zero);
        shaft.to(2 * 4096 + 30);
        let position = |at, offset| {
            let count = shaft.count(at);
            shaft.state.position(count, Counts(offset)).map(|it| it.0)
        };
        assert_eq!(position(0, 0), Some(0));
        assert_eq!(position(8222, 0), Some(8222));
        assert_eq!(position(-100, 0), Some(-100));
        assert_eq!(position(100, 40), Some(60));
        assert_eq!(position(100, -40), Some(140));
    }
}
