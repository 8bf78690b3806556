//! The parameters of the scenes that pages have set, as the board has them.

use std::collections::BTreeMap;

use drive::named::Known;
use drivers::link::Hello;
use haptic_control::SceneKind;
use serde_json::Value;

use crate::order::tuning;

/// The values since the start of the board.
pub(crate) struct Tuned {
    known: Known,
    /// Values by the numbers of scene and parameter.
    values: BTreeMap<(u8, u8), f32>,
}

impl Tuned {
    /// The values of a board that has just started.
    pub(crate) fn new() -> Self {
        Self {
            known: Known::usual(),
            values: BTreeMap::new(),
        }
    }

    /// A value goes to the board. One that its image refuses changes nothing.
    pub(crate) fn set(&mut self, scene: u8, parameter: u8, value: f32, hello: &Hello) {
        let tuning = tuning(scene, parameter, value);
        if tuning.is_ok_and(|tuning| self.known.set(&tuning, hello).is_ok()) {
            self.values.insert((scene, parameter), value);
        }
    }

    /// A scene is selected: the set-point of the torque starts at zero.
    pub(crate) fn select(&mut self, scene: u8) {
        if scene == SceneKind::Torque.number() {
            self.values.retain(|(of, _), _| *of != scene);
        }
    }

    /// The values for the page, by `scene.parameter`.
    pub(crate) fn json(&self) -> Value {
        let named = self.values.iter();
        named
            .map(|((scene, parameter), value)| (format!("{scene}.{parameter}"), (*value).into()))
            .collect::<serde_json::Map<_, Value>>()
            .into()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::order::tests::hello;

    #[test]
    fn values_that_the_image_takes_are_kept() {
        let hello = hello();
        let [wall, detents, torque] =
            [SceneKind::Wall, SceneKind::Detents, SceneKind::Torque].map(SceneKind::number);
        let mut tuned = Tuned::new();
        assert_eq!(tuned.json(), json!({}));
        tuned.set(wall, 1, 0.25, &hello);
        tuned.set(wall, 1, 100.0, &hello);
        tuned.set(wall, 9, 0.25, &hello);
        // With 24 detents the amplitude is bounded.
        tuned.set(detents, 0, 0.04, &hello);
        tuned.set(torque, 0, 0.0078125, &hello);
        let kept = json!({ format!("{wall}.1"): 0.25, format!("{torque}.0"): 0.0078125 });
        assert_eq!(tuned.json(), kept);
        tuned.select(wall);
        assert_eq!(tuned.json(), kept);
        tuned.select(torque);
        assert_eq!(tuned.json(), json!({ format!("{wall}.1"): 0.25 }));
    }
}
