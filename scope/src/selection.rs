//! The scene that is selected, by the orders of pages and the frames of the board.

use haptic_control::{Mode, SceneKind};

/// Time of the board from an order until its frames show what became of it, s.
const PENDING_S: f64 = 0.5;

/// The selected scene.
pub(crate) struct Selection {
    scene: u8,
    /// The scene before the latest order.
    before: u8,
    /// Time of the latest order, s.
    at: f64,
}

impl Selection {
    /// No scene.
    pub(crate) const NONE: Self = Self {
        scene: SceneKind::Off.number(),
        before: SceneKind::Off.number(),
        at: f64::NEG_INFINITY,
    };

    /// Number of the scene.
    pub(crate) const fn scene(&self) -> u8 {
        self.scene
    }

    /// A page has ordered a scene.
    pub(crate) fn order(&mut self, scene: u8, now: f64) {
        *self = Self {
            scene,
            before: self.scene,
            at: now,
        };
    }

    /// The board has refused a selection.
    pub(crate) fn refused(&mut self, now: f64) {
        if self.is_pending(now) {
            *self = Self {
                scene: self.before,
                ..Self::NONE
            };
        }
    }

    /// Takes the state of the board before a frame and in it. A board that has stopped, or was disarmed otherwise
    /// than by a page, has no scene. A board that is disarmed keeps a selection until it is armed.
    pub(crate) fn frame(&mut self, before: Option<Mode>, mode: Option<Mode>, now: f64) {
        let is_off = match mode {
            Some(Mode::Armed | Mode::Safe) => true,
            Some(Mode::Boot) => before.is_some_and(Mode::is_enabled),
            _ => false,
        };
        if is_off && !self.is_pending(now) {
            *self = Self::NONE;
        }
    }

    fn is_pending(&self, now: f64) -> bool {
        now < self.at + PENDING_S
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WALL: u8 = 2;
    const OFF: u8 = 0;

    /// A wall that was ordered at 0 s and runs.
    fn running() -> Selection {
        let mut selection = Selection::NONE;
        selection.order(WALL, 0.0);
        for (before, mode, t) in [
            (Mode::Armed, Mode::Armed, 0.001),
            (Mode::Armed, Mode::Running, 0.002),
            (Mode::Running, Mode::Running, 1.0),
        ] {
            selection.frame(Some(before), Some(mode), t);
        }
        assert_eq!(selection.scene(), WALL);
        selection
    }

    #[test]
    fn board_that_leaves_running_by_itself_has_no_scene() {
        for mode in [Mode::Armed, Mode::Safe, Mode::Boot] {
            let mut selection = running();
            selection.frame(Some(Mode::Running), Some(mode), 2.0);
            assert_eq!(selection.scene(), OFF, "{mode:?}");
        }
    }

    #[test]
    fn selection_of_a_disarmed_board_waits_for_the_order_to_arm() {
        let mut selection = Selection::NONE;
        selection.order(WALL, 0.0);
        for mode in [Mode::Boot, Mode::Settling, Mode::Running] {
            selection.frame(Some(mode), Some(mode), 9.0);
            assert_eq!(selection.scene(), WALL, "{mode:?}");
        }
    }

    #[test]
    fn refused_or_lost_selection_is_taken_back() {
        const DETENTS: u8 = 5;
        let mut selection = running();
        selection.order(DETENTS, 3.0);
        selection.refused(3.1);
        assert_eq!(selection.scene(), WALL);
        // A refusal of another command.
        selection.refused(3.2);
        assert_eq!(selection.scene(), WALL);
        let mut selection = Selection::NONE;
        selection.order(WALL, 0.0);
        selection.frame(Some(Mode::Safe), Some(Mode::Safe), 0.1);
        assert_eq!(selection.scene(), WALL);
        selection.frame(Some(Mode::Safe), Some(Mode::Safe), 0.6);
        assert_eq!(selection.scene(), OFF);
    }
}
