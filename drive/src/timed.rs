//! Changes of a session at a time: `stiffness=0.2@1.5`.

use drivers::Command;
use haptic_control::SceneKind;
use terminal::failure::Failure;

use crate::named::{self, Tuning};

/// Text with the time of the session at which it applies, s.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timed {
    /// Time from the begin of the scene, s.
    pub(crate) at_s: f64,
    text: String,
}

/// Reads `TEXT` or `TEXT@S`. Without a time it applies at once.
///
/// # Errors
/// One line if the time is not a number from 0.
pub(crate) fn timed(text: &str) -> Result<Timed, String> {
    let (text, at_s) = match text.rsplit_once('@') {
        None => (text, 0.0),
        Some((text, at)) => {
            let at: Option<f64> = at.parse().ok();
            let at = at.filter(|at| at.is_finite() && *at >= 0.0);
            (
                text,
                at.ok_or("the time after @ must be seconds, 0 or more")?,
            )
        }
    };
    Ok(Timed {
        at_s,
        text: text.to_owned(),
    })
}

/// The name, as messages about a single command have it.
impl std::fmt::Display for Change {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Tuning(tuning) => tuning.fmt(f),
            Self::Estimator(number) => write!(f, "{}", named::called(*number)),
        }
    }
}

/// A change of a running session.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Change {
    /// A parameter.
    Tuning(Tuning),
    /// The estimator of the large motor.
    Estimator(u8),
}

impl Change {
    /// The command.
    pub(crate) fn command(&self) -> Command {
        match self {
            Self::Tuning(tuning) => tuning.command(),
            Self::Estimator(number) => Command::Estimator(*number),
        }
    }
}

impl Timed {
    /// The tuning `NAME=VALUE` of a scene.
    ///
    /// # Errors
    /// [`Failure::Input`] if it is none.
    pub(crate) fn tuning(&self, scene: SceneKind) -> Result<Change, Failure> {
        let text = &self.text;
        let parts = text.split_once('=').and_then(|(name, value)| {
            let value: f32 = value.parse().ok()?;
            Some((name, value))
        });
        let (name, value) = parts.ok_or_else(|| {
            Failure::Input(format!(
                "--tune {text}: must be NAME=VALUE or NAME=VALUE@S, for example stiffness=0.2@1.5"
            ))
        })?;
        Tuning::new(scene, name, value).map(Change::Tuning)
    }

    /// The estimator `NAME`.
    ///
    /// # Errors
    /// [`Failure::Input`] if there is none of this name.
    pub(crate) fn estimator(&self) -> Result<Change, Failure> {
        Ok(Change::Estimator(named::estimator(&self.text)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_what_follows_the_last_at() {
        let at = |text| timed(text).map(|timed| (timed.at_s, timed.text));
        assert_eq!(
            at("stiffness=0.2@1.5"),
            Ok((1.5, "stiffness=0.2".to_owned()))
        );
        for at_once in ["stiffness=0.2", "stiffness=0.2@0"] {
            assert_eq!(at(at_once), Ok((0.0, "stiffness=0.2".to_owned())));
        }
        assert_eq!(at("a@b=1@2"), Ok((2.0, "a@b=1".to_owned())));
        for wrong in ["a=1@", "a=1@x", "a=1@-1", "a=1@nan", "a=1@inf"] {
            assert!(at(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn tuning_that_is_no_assignment_of_a_parameter_is_refused() {
        let wall = |text| timed(text).unwrap().tuning(SceneKind::Wall);
        assert!(wall("stiffness=0.2").is_ok());
        for (wrong, said) in [
            ("stiffness", "--tune stiffness: must be NAME=VALUE"),
            ("stiffness=x", "--tune stiffness=x: must be"),
            (
                "stifness=1",
                "no parameter of wall 'stifness'; did you mean stiffness?",
            ),
        ] {
            let error = wall(wrong).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let off = timed("a=1").unwrap().tuning(SceneKind::Off).unwrap_err();
        assert_eq!(off.to_string(), "scene off has no parameter");
    }
}
