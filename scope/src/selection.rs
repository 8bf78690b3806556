//! The scene that is selected, by the orders of pages and the frames of the board.

use haptic_control::{Mode, SceneKind};

/// Time of the board from an order until its frames show what became of it, s.
const PENDING_S: f64 = 0.5;

/// The selected scene.
pub(crate) struct Selection {
    /// The scene without the latest orders.
    settled: u8,
    /// Latest orders, each with its time, s: the board may refuse them still.
    pending: Vec<(u8, f64)>,
}

impl Selection {
    /// No scene.
    pub(crate) const NONE: Self = Self {
        settled: SceneKind::Off.number(),
        pending: Vec::new(),
    };

    /// Number of the scene.
    pub(crate) fn scene(&self) -> u8 {
        self.pending
            .last()
            .map_or(self.settled, |(scene, _)| *scene)
    }

    /// A page has ordered a scene.
    pub(crate) fn order(&mut self, scene: u8, now: f64) {
        self.settle(now);
        self.pending.push((scene, now));
    }

    /// The board has refused a selection: it admits no scene in closed loop. One in open loop that was ordered since
    /// stays.
    pub(crate) fn refused(&mut self, now: f64) {
        self.settle(now);
        self.pending.retain(|(scene, _)| {
            let kind = SceneKind::ALL.get(usize::from(*scene));
            !kind.is_some_and(|kind| kind.is_closed_loop())
        });
    }

    /// Keeps the orders that the board may refuse still.
    fn settle(&mut self, now: f64) {
        let is_late = |(_, at): &(u8, f64)| now >= at + PENDING_S;
        let number = self.pending.iter().take_while(|it| is_late(it)).count();
        if let Some((scene, _)) = self.pending.drain(..number).next_back() {
            self.settled = scene;
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
        self.settle(now);
        if is_off && self.pending.is_empty() {
            *self = Self::NONE;
        }
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
        // The refusal of a scene comes after the next order.
        let open = SceneKind::Excite.number();
        for (next, shown) in [(open, open), (WALL, OFF)] {
            let mut selection = Selection::NONE;
            selection.order(DETENTS, 0.0);
            selection.order(next, 0.1);
            selection.refused(0.2);
            assert_eq!(selection.scene(), shown);
            selection.frame(Some(Mode::Armed), Some(Mode::Running), 1.0);
            assert_eq!(selection.scene(), shown);
        }
        let mut selection = Selection::NONE;
        selection.order(WALL, 0.0);
        selection.frame(Some(Mode::Safe), Some(Mode::Safe), 0.1);
        assert_eq!(selection.scene(), WALL);
        selection.frame(Some(Mode::Safe), Some(Mode::Safe), 0.6);
        assert_eq!(selection.scene(), OFF);
    }
}
