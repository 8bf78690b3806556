//! The settings that a board keeps in flash.

use estimator_core::{Amps, Counts};
use haptic_control::{CurrentScale, Currents};

use crate::{DacScale, FULL_SCALES, REACHES, SaveError};

/// Version of the meaning of the settings. A new setting at the end of the list keeps the version.
const VERSION: u16 = 1;

/// Bytes of encoded settings, in every version: version, number of the settings, and place for 61 of them.
pub const SETTINGS_BYTES: usize = 248;

/// Bytes of version and number of the settings, and of a value.
const HEAD: usize = 4;
const VALUE: usize = 4;

/// What is known of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettingFacts {
    /// Name.
    pub name: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// Unit; "1" for a ratio, a number and a yes or no.
    pub unit: &'static str,
    /// Value of a board without settings.
    pub default: f32,
    /// Smallest value.
    pub least: f32,
    /// Largest value.
    pub most: f32,
    /// Whether the value is a whole number.
    pub is_whole: bool,
}

macro_rules! settings {
    ($($(#[doc = $meaning:literal])+ $setting:ident: $name:literal, $unit:literal, $default:tt in $least:tt, $most:tt $($whole:ident)?;)+) => {
        /// A setting. Its number is its place in this list. A number never changes its meaning, and a new
        /// setting is added at the end.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Setting {
            $($(#[doc = $meaning])+ $setting,)+
        }

        impl Setting {
            /// All settings, each at its number.
            pub const ALL: &[Self] = &[$(Self::$setting),+];

            /// What is known of the setting.
            #[must_use]
            pub const fn facts(self) -> SettingFacts {
                match self {
                    $(Self::$setting => SettingFacts {
                        name: $name,
                        meaning: concat!($($meaning),+).trim_ascii(),
                        unit: $unit,
                        default: $default,
                        least: $least,
                        most: $most,
                        is_whole: false $(|| stringify!($whole).len() > 0)?,
                    },)+
                }
            }
        }
    };
}

/// Largest currents that outputs with a nominal zero and gain can command, A.
const MOST_LARGE: f32 = REACHES[0].get();
const MOST_SMALL: f32 = REACHES[1].get();

/// Offsets of encoders, counts: whole numbers that f32 has.
const LEAST_COUNTS: f32 = -8_388_608.0;
const MOST_COUNTS: f32 = 8_388_607.0;

settings! {
    /// DAC code at which the current of the large motor is zero.
    ZeroLarge: "zero-large", "codes", 2048.0 in 1848.0, 2248.0;
    /// DAC code at which the current of the small motor is zero.
    ZeroSmall: "zero-small", "codes", 2048.0 in 1848.0, 2248.0;
    /// Change of the current of the large motor per code, over the nominal one.
    GainLarge: "gain-large", "1", 1.0 in 0.8, 1.25;
    /// Change of the current of the small motor per code, over the nominal one.
    GainSmall: "gain-small", "1", 1.0 in 0.8, 1.25;
    /// Part of the current limits of the device that the board uses.
    CurrentScale: "current-scale", "1", 0.1 in 0.0, 1.0;
    /// Whether the signs of encoders and currents have been verified: 1 is yes. Scenes in closed loop are
    /// refused before.
    SignsVerified: "signs-verified", "1", 0.0 in 0.0, 1.0 whole;
    /// Number of the estimator of the large motor after a start.
    Estimator: "estimator", "1", 0.0 in 0.0, 254.0 whole;
    /// Serial number of the device.
    Serial: "serial", "1", 0.0 in 0.0, 16_777_215.0 whole;
    /// Largest current of the large motor at this bench. The loops use the smaller one of this and of the
    /// scaled limit of the device.
    LimitLarge: "limit-large", "A", MOST_LARGE in 0.0, MOST_LARGE;
    /// Largest current of the small motor at this bench. The loops use the smaller one of this and of the
    /// scaled limit of the device.
    LimitSmall: "limit-small", "A", MOST_SMALL in 0.0, MOST_SMALL;
    /// Counts from the index of the large encoder to the mechanical zero. Positions are reported from there.
    OffsetLarge: "offset-large", "counts", 0.0 in LEAST_COUNTS, MOST_COUNTS whole;
    /// Counts from the index of the small encoder to the mechanical zero. Positions are reported from there.
    OffsetSmall: "offset-small", "counts", 0.0 in LEAST_COUNTS, MOST_COUNTS whole;
}

const COUNT: usize = Setting::ALL.len();
const _: () = assert!(HEAD + VALUE * COUNT <= SETTINGS_BYTES, "no room");

impl Setting {
    /// The setting of a number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Number of the setting.
    #[must_use]
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Whether a value is in the range of the setting.
    #[must_use]
    pub fn admits(self, value: f32) -> bool {
        let SettingFacts {
            least,
            most,
            is_whole,
            ..
        } = self.facts();
        let is_whole_value = value as i32 as f32 == value;
        least <= value && value <= most && (is_whole_value || !is_whole)
    }
}

/// Reason for encoded settings not to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingsError {
    /// They are of this other version.
    Version(u16),
    /// The value of this setting is outside its range.
    Value(Setting),
}

/// Outcome of the command [`Store`](crate::Command::Store).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Saved {
    /// The settings are in flash.
    Stored = 0,
    /// The amplifiers are enabled, or were a moment ago.
    Enabled = 1,
    /// The flash is full until the next reset.
    Full = 2,
    /// The flash refuses the access.
    Refused = 3,
    /// The flash does not hold what was written.
    Mismatch = 4,
}

impl Saved {
    /// The outcome with this number in a message.
    #[must_use]
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            0 => Self::Stored,
            1 => Self::Enabled,
            2 => Self::Full,
            3 => Self::Refused,
            4 => Self::Mismatch,
            _ => return None,
        })
    }
}

impl<E> From<Result<(), SaveError<E>>> for Saved {
    fn from(result: Result<(), SaveError<E>>) -> Self {
        match result {
            Ok(()) => Self::Stored,
            Err(SaveError::Full) => Self::Full,
            Err(SaveError::Flash(_)) => Self::Refused,
            Err(SaveError::Mismatch) => Self::Mismatch,
        }
    }
}

/// The settings of a board.
///
/// ```
/// use drivers::{Setting, Settings};
/// let mut settings = Settings::DEFAULT;
/// assert!(settings.set(Setting::ZeroLarge, 2051.5));
/// assert!(!settings.set(Setting::CurrentScale, 2.0));
/// let read = Settings::decode(&settings.encode()).unwrap();
/// assert_eq!(read.get(Setting::ZeroLarge), 2051.5);
/// assert_eq!(read.get(Setting::CurrentScale), 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings([f32; COUNT]);

impl Default for Settings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Settings {
    /// Those of a board without settings.
    pub const DEFAULT: Self = {
        let mut values = [0.0; COUNT];
        let mut i = 0;
        while i < COUNT {
            values[i] = Setting::ALL[i].facts().default;
            i += 1;
        }
        Self(values)
    };

    /// Those of a board after its bring-up, with ideal current outputs and the whole current.
    pub const COMMISSIONED: Self = {
        let Self(mut values) = Self::DEFAULT;
        values[Setting::CurrentScale as usize] = 1.0;
        values[Setting::SignsVerified as usize] = 1.0;
        Self(values)
    };

    /// The value of a setting.
    #[must_use]
    pub const fn get(&self, setting: Setting) -> f32 {
        self.0[setting as usize]
    }

    /// Changes a setting, if its range has the value; returns whether it has.
    pub fn set(&mut self, setting: Setting, value: f32) -> bool {
        let is_admitted = setting.admits(value);
        if is_admitted {
            self.0[setting as usize] = value;
        }
        is_admitted
    }

    /// The scale of the current limits, with the largest currents at this bench and of its calibrated outputs.
    #[must_use]
    pub fn current_scale(&self) -> CurrentScale {
        let [large, small] = self.dac_scales();
        let within = |limit, scale: DacScale| {
            let (limit, reach) = (self.get(limit), scale.reach().get());
            Amps::new(if limit < reach { limit } else { reach })
        };
        let scale = CurrentScale::new(self.get(Setting::CurrentScale));
        scale.unwrap_or(CurrentScale::NONE).bounded(Currents {
            large: within(Setting::LimitLarge, large),
            small: within(Setting::LimitSmall, small),
        })
    }

    /// The calibrated scales of the outputs: large, small.
    // Rare, and no part of the control task's own code.
    #[inline(never)]
    #[must_use]
    pub fn dac_scales(&self) -> [DacScale; 2] {
        const NOMINAL: [DacScale; 2] = {
            let [large, small] = FULL_SCALES;
            match (DacScale::new(large), DacScale::new(small)) {
                (Some(large), Some(small)) => [large, small],
                _ => panic!("a full scale is above 0"),
            }
        };
        let [large, small] = NOMINAL;
        // The ranges of the settings are within what a scale admits.
        let calibrated = |scale: DacScale, zero, gain| {
            scale
                .calibrated(self.get(zero), self.get(gain))
                .unwrap_or(scale)
        };
        [
            calibrated(large, Setting::ZeroLarge, Setting::GainLarge),
            calibrated(small, Setting::ZeroSmall, Setting::GainSmall),
        ]
    }

    /// Whether the signs of encoders and currents have been verified.
    #[must_use]
    pub fn are_signs_verified(&self) -> bool {
        self.get(Setting::SignsVerified) != 0.0
    }

    /// Counts from the index of each encoder to the mechanical zero: large, small.
    #[must_use]
    pub const fn offsets(&self) -> [Counts; 2] {
        [
            Counts(self.get(Setting::OffsetLarge) as i32),
            Counts(self.get(Setting::OffsetSmall) as i32),
        ]
    }

    /// Number of the estimator of the large motor after a start.
    #[must_use]
    pub const fn estimator(&self) -> u8 {
        self.get(Setting::Estimator) as u8
    }

    /// The settings as bytes: version and number of the settings, u16, then each value, f32; little endian,
    /// with zeros behind.
    #[must_use]
    pub fn encode(&self) -> [u8; SETTINGS_BYTES] {
        let mut bytes = [0; SETTINGS_BYTES];
        let head = [VERSION.to_le_bytes(), (COUNT as u16).to_le_bytes()];
        let values = self.0.iter().flat_map(|value| value.to_le_bytes());
        let all = head.into_iter().flatten().chain(values);
        for (byte, value) in bytes.iter_mut().zip(all) {
            *byte = value;
        }
        bytes
    }

    /// The settings of encoded bytes. A setting that an older image did not have has its default.
    ///
    /// # Errors
    /// [`SettingsError`].
    pub fn decode(bytes: &[u8; SETTINGS_BYTES]) -> Result<Self, SettingsError> {
        let [a, b, c, d, values @ ..] = bytes;
        let version = u16::from_le_bytes([*a, *b]);
        if version != VERSION {
            return Err(SettingsError::Version(version));
        }
        let count = usize::from(u16::from_le_bytes([*c, *d]));
        let (values, _) = values.as_chunks::<VALUE>();
        let mut settings = Self::DEFAULT;
        for (setting, value) in Setting::ALL.iter().zip(values).take(count) {
            if !settings.set(*setting, f32::from_le_bytes(*value)) {
                return Err(SettingsError::Value(*setting));
            }
        }
        Ok(settings)
    }
}
