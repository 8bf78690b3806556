//! A telemetry frame, by the list of fields that the firmware logs.

use std::str::FromStr;

use drivers::link;
use haptic_control::{Mode, Stop};

use super::side_lines::SideLines;

/// Begin of a frame's line.
pub(super) const START: &str = "frame seq=";

/// A column of recordings: its name, and the value of a frame as text, if the frame has one.
pub(crate) type Column = (&'static str, fn(&Frame) -> Option<String>);

macro_rules! frame {
    ($format:literal; $($(#[$doc:meta])* $name:ident: $type:ty, $old:literal, $csv:ident, $value:expr;)+) => {
        /// A telemetry frame: what the firmware logs of one control tick.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Frame {
            $($(#[$doc])* pub $name: $type,)+
            /// Lines that the firmware logs beside the frame.
            pub side_lines: SideLines,
        }

        impl FromStr for Frame {
            type Err = String;

            /// Reads the fields by name, in any order. Unknown names and text that a log appends are
            /// skipped.
            fn from_str(line: &str) -> Result<Self, String> {
                let fields = Fields(line);
                Ok(Self {
                    $($name: Field::read(&fields, stringify!($name), $old)?,)+
                    side_lines: SideLines::default(),
                })
            }
        }

        impl TryFrom<link::Frame> for Frame {
            type Error = String;

            /// The message of the link as the frame of a log.
            fn try_from(frame: link::Frame) -> Result<Self, String> {
                Ok(Self {
                    $($name: Field::of(stringify!($name), frame.$name)?,)+
                    side_lines: SideLines::default(),
                })
            }
        }

        /// The columns of a recording, in their order.
        pub(crate) const COLUMNS: &[Column] = {
            const ALL: &[(bool, Column)] = &[
                $((is_csv(stringify!($csv)), (stringify!($name), |frame| frame.$name.text()))),+
            ];
            const COUNT: usize = {
                let (mut count, mut rest) = (0, ALL);
                while let [(csv, _), others @ ..] = rest {
                    (count, rest) = (count + *csv as usize, others);
                }
                count
            };
            const CHOSEN: [Column; COUNT] = {
                let (mut chosen, mut count, mut rest) = ([ALL[0].1; COUNT], 0, ALL);
                while let [(csv, column), others @ ..] = rest {
                    if *csv {
                        chosen[count] = *column;
                        count += 1;
                    }
                    rest = others;
                }
                chosen
            };
            &CHOSEN
        };
    };
}

drivers::frame_fields!(frame, frame, lost);

/// Whether the field of a row is a column of recordings, by the word in the row.
const fn is_csv(word: &str) -> bool {
    matches!(word.as_bytes(), b"csv")
}

/// A value of a frame's line and of a recording.
trait Field: Sized {
    /// The type on the link.
    type Wire;

    /// The value of the link; an error names the field.
    fn of(name: &str, value: Self::Wire) -> Result<Self, String>;

    /// The value under either name.
    fn read(fields: &Fields<'_>, name: &str, old: &str) -> Result<Self, String>;

    /// The value in a recording, if there is one; an empty text stands for one that is not finite.
    fn text(&self) -> Option<String>;
}

macro_rules! numbers {
    ($($type:ty, $text:expr;)+) => {$(
        impl Field for $type {
            type Wire = Self;

            fn of(_: &str, value: Self) -> Result<Self, String> {
                Ok(value)
            }

            fn read(fields: &Fields<'_>, name: &str, old: &str) -> Result<Self, String> {
                fields.number(fields.name_of(name, old))
            }

            fn text(&self) -> Option<String> {
                let text: fn(&Self) -> String = $text;
                Some(text(self))
            }
        }
    )+};
}

numbers! {
    u8, Self::to_string;
    u16, Self::to_string;
    u32, Self::to_string;
    f32, finite;
}

/// A value as text, which is empty if it is not finite.
fn finite(value: &f32) -> String {
    match value.is_finite() {
        true => value.to_string(),
        false => String::new(),
    }
}

/// A field that older images do not have.
impl<T: Field> Field for Option<T> {
    type Wire = T::Wire;

    fn of(name: &str, value: T::Wire) -> Result<Self, String> {
        T::of(name, value).map(Some)
    }

    fn read(fields: &Fields<'_>, name: &str, old: &str) -> Result<Self, String> {
        match fields.text(fields.name_of(name, old)) {
            Ok(_) => T::read(fields, name, old).map(Some),
            Err(_) => Ok(None),
        }
    }

    fn text(&self) -> Option<String> {
        self.as_ref()?.text()
    }
}

macro_rules! codes {
    ($($type:ty)+) => {$(
        impl Field for $type {
            type Wire = u8;

            fn of(name: &str, code: u8) -> Result<Self, String> {
                Self::from_code(code).ok_or_else(|| format!("{name}={code} has no meaning"))
            }

            fn read(fields: &Fields<'_>, name: &str, old: &str) -> Result<Self, String> {
                let code = u8::read(fields, name, old)?;
                Self::of(name, code).map_err(|error| format!("{error} in '{}'", fields.0))
            }

            fn text(&self) -> Option<String> {
                (*self as u8).text()
            }
        }
    )+};
}

codes!(Mode Stop);

/// Words `name=value` of a line.
pub(super) struct Fields<'a>(pub(super) &'a str);

impl<'a> Fields<'a> {
    fn text(&self, name: &str) -> Result<&'a str, String> {
        let value = |word: &'a str| word.strip_prefix(name)?.strip_prefix('=');
        let found = self.0.split_whitespace().find_map(value);
        found.ok_or_else(|| format!("no {name} in '{}'", self.0))
    }

    /// The name of a field that the line has, the present or the old one; the present one if it has
    /// neither.
    fn name_of<'n>(&self, name: &'n str, old: &'n str) -> &'n str {
        match self.text(name) {
            Err(_) if self.text(old).is_ok() => old,
            _ => name,
        }
    }

    pub(super) fn number<T: FromStr>(&self, name: &str) -> Result<T, String> {
        let value = self.text(name)?;
        let number = value.parse();
        number.map_err(|_| format!("'{name}={value}' is not a valid number in '{}'", self.0))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) const LINE: &str = "frame seq=3 tick=30 large=65535 small=7 wl=-1.5 \
        ws=0.25 torque=0.0 il=0.1 is=-0.2 state=2 cause=0 overruns=0 drops=1 cycles=900";

    #[test]
    fn frame_is_read_by_field_names() {
        let frame: Frame = LINE.parse().unwrap();
        assert_eq!(
            (frame.tick, frame.counts_large, frame.drops),
            (30, 65535, 1)
        );
        assert_eq!((frame.velocity_large, frame.state), (-1.5, Mode::Running));
        assert_eq!((frame.current_small, frame.cause), (-0.2, Stop::None));
        assert_eq!((frame.sigma_large, frame.estimator), (None, None));
        let said = LINE.replace("torque", "sl=0.5 estimator=255 torque");
        let said: Frame = said.parse().unwrap();
        assert_eq!(
            (said.sigma_large, said.estimator),
            (Some(0.5), Some(drivers::NO_ESTIMATOR))
        );
        assert!(
            LINE.replace("torque", "sl=x torque")
                .parse::<Frame>()
                .is_err()
        );
        let longer = LINE.replace(" ws", " new=1 ws") + " (firmware src/telemetry.rs:93)";
        assert_eq!(longer.parse(), Ok(frame));
    }

    #[test]
    fn old_and_present_field_names_give_the_same_frame() {
        let today = [
            (" large=", " counts_large="),
            (" small=", " counts_small="),
            (" wl=", " velocity_large="),
            (" ws=", " velocity_small="),
            (" il=", " current="),
            (" is=", " current_small="),
        ];
        let mut line = LINE.to_owned();
        for (old, new) in today {
            assert!(line.contains(old), "{old}");
            line = line.replace(old, new);
        }
        assert_eq!(line.parse::<Frame>(), LINE.parse());
    }

    #[test]
    fn unknown_state_or_cause_is_refused() {
        let wrong = LINE.replace("state=2", "state=9");
        assert!(
            wrong
                .parse::<Frame>()
                .unwrap_err()
                .contains("state=9 has no meaning")
        );
        let wrong = LINE.replace("cause=0", "cause=200");
        assert!(
            wrong
                .parse::<Frame>()
                .unwrap_err()
                .contains("cause=200 has no meaning")
        );
    }

    #[test]
    fn columns_of_a_recording_are_these_fields_of_a_frame() {
        let names: Vec<_> = COLUMNS.iter().map(|(name, _)| *name).collect();
        assert_eq!(
            names,
            [
                "counts_large",
                "counts_small",
                "current",
                "current_small",
                "torque",
                "velocity_large",
                "velocity_small",
                "state",
                "cause",
                "sigma_large"
            ]
        );
    }

    #[test]
    fn frame_with_a_missing_or_invalid_field_is_refused_with_a_reason() {
        let without = LINE.replace("drops=1 ", "");
        assert!(without.parse::<Frame>().unwrap_err().contains("no drops"));
        let wrong = LINE.replace("wl=-1.5", "wl=x");
        assert!(wrong.parse::<Frame>().unwrap_err().contains("'wl=x'"));
        for cut in 0..LINE.len() - 11 {
            assert!(LINE[..cut].parse::<Frame>().is_err(), "{}", &LINE[..cut]);
        }
    }
}
