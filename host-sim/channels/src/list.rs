//! The channels: the one list of what a row of the stream has.

use serde::Serialize;

macro_rules! channels {
    ($($name:ident: $topic:literal, $unit:literal, $label:literal;)+) => {
        /// A row: the values at one telemetry frame. A value that the source does not have is NaN.
        #[derive(Clone, Copy, Debug)]
        pub struct Values {
            $(#[doc = concat!($label, ", unit: ", $unit)] pub $name: f64,)+
        }

        impl Default for Values {
            fn default() -> Self {
                Self { $($name: f64::NAN,)+ }
            }
        }

        impl Values {
            /// The values in the order of [`CHANNELS`].
            #[must_use]
            pub fn all(&self) -> [f64; CHANNELS.len()] {
                [$(self.$name),+]
            }
        }

        /// The channels, before those of the estimators.
        pub const CHANNELS: [Channel; [$($label),+].len()] = [$(Channel {
            name: stringify!($name),
            topic: $topic,
            unit: $unit,
            label: $label,
        }),+];
    };
}

/// A channel of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Channel {
    /// Name in files and in programs.
    pub name: &'static str,
    /// Topic of an exported file that has the channel.
    pub topic: &'static str,
    /// Unit; empty for a number.
    pub unit: &'static str,
    /// Words for a person.
    pub label: &'static str,
}

channels! {
    t: "time", "s", "time of the board";
    true_omega: "velocity", "rad/s", "true velocity";
    velocity_large: "velocity", "rad/s", "estimate in charge";
    sigma_large: "velocity", "rad/s", "its standard deviation";
    true_handle: "velocity", "rad/s", "true velocity of the handle";
    velocity_small: "velocity", "rad/s", "estimate of the handle";
    torque: "torque", "N·m", "torque wanted";
    felt: "torque", "N·m", "torque felt";
    force: "force", "mN", "force at the fingertip";
    parasitic: "force", "mN", "parasitic force";
    tactile: "force", "mN", "its RMS from 50 to 500 Hz";
    current: "current", "A", "large motor, commanded";
    current_large_true: "current", "A", "large motor, true";
    current_small: "current", "A", "small motor, commanded";
    current_small_true: "current", "A", "small motor, true";
    instructions: "cost", "", "instructions per tick, most";
    cycles: "cost", "", "cycles of the longest tick";
    large_angle: "device", "rad", "angle of the large motor";
    handle_angle: "device", "rad", "angle of the handle";
    hand_angle: "device", "rad", "target of the hand";
    state: "device", "", "state of the safety machine";
    cause: "device", "", "cause of the latest stop";
    estimator: "device", "", "number of the estimator in charge";
    overruns: "cost", "", "control ticks missed or late";
    drops: "cost", "", "frames that the board lost";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_stands_at_the_place_of_its_channel() {
        let values = Values {
            t: 1.0,
            drops: 2.0,
            ..Values::default()
        };
        let all = values.all();
        assert_eq!((all[0], all[CHANNELS.len() - 1]), (1.0, 2.0));
        assert!(all[1].is_nan());
    }
}
