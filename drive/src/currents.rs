//! Measured currents against their commands.

use drivers::{Setting, Settings};
use tuned::DEVICE;

use crate::channels::{CHANNELS, Channel, pairs};
use crate::check::Line;
use crate::strokes::Seen;

/// Least number of pairs in each direction of the current.
const LEAST_PAIRS: usize = 50;
/// Part of the largest current of the strokes that has to be commanded.
const REACHED: f64 = 0.9;
/// Part of the largest current of the strokes below which no motor turns: friction takes more.
const NO_CURRENT: f64 = 0.1;
/// Slope below which the measured current is not that of the command.
const LEAST_SLOPE: f64 = 0.5;
/// Largest RMS residual, over full scale: the mean of ten readings with noise of 0.5 % has 0.16 %. The
/// DAC and an ADC of twice the range round by less than 0.03 % each.
const LARGEST_RESIDUAL: f64 = 2e-3;
/// Largest offset in bring-up, over the current limit of the motor.
const LARGEST_OFFSET: f64 = 0.05;

/// Whether the settings of a board allow currents that turn the motors.
///
/// # Errors
/// Which settings allow none, and what would be right.
pub(crate) fn allowed(settings: &Settings) -> Result<(), String> {
    let scale = settings.current_scale();
    let [large, small] = [DEVICE.large, DEVICE.small].map(|motor| motor.current_limit as f32);
    for (channel, allowed, limit) in [
        (&CHANNELS[0], scale.large(large), Setting::LimitLarge),
        (&CHANNELS[1], scale.small(small), Setting::LimitSmall),
    ] {
        let (allowed, stroke) = (f64::from(allowed), f64::from(channel.stroke.get()));
        if allowed < NO_CURRENT * stroke {
            let [scale, limit] = [Setting::CurrentScale, limit].map(Setting::facts);
            return Err(format!(
                "they allow {:.0} mA of the {}, whose strokes have {:.0} mA: set {} to {} at least, and {} to \
                 {stroke:.2} A at least, by cargo drive settings",
                1e3 * allowed,
                channel.motor,
                1e3 * stroke,
                scale.name,
                scale.default,
                limit.name
            ));
        }
    }
    Ok(())
}

/// The lines of the bring-up on both currents, from the strokes.
pub(crate) fn lines(seen: &Seen) -> Vec<Line> {
    let line = |channel: &Channel| (channel.check, flowing(seen, channel));
    CHANNELS.iter().map(line).collect()
}

/// Whether the commanded currents flow.
fn flowing(seen: &Seen, channel: &Channel) -> Result<String, String> {
    judged(Fit::of(seen, channel)?, channel)
}

/// Whether a line is that of an amplifier which calibration can correct.
fn judged(fit: Fit, channel: &Channel) -> Result<String, String> {
    let found = fit.text();
    let gain = channel.gain.facts();
    let most = LARGEST_OFFSET * channel.limit;
    if fit.slope < f64::from(gain.least) || fit.slope > f64::from(gain.most) {
        Err(format!(
            "{found}; a slope from {} to {} is allowed: check the scales of amplifier and monitor, and the \
             motor's leads",
            gain.least, gain.most
        ))
    } else if fit.offset.abs() > most {
        Err(format!(
            "{found}; an offset of {:.0} mA is allowed: check the ground and the zero of the amplifier's \
             input, then run cargo drive calibrate",
            1e3 * most
        ))
    } else {
        Ok(found)
    }
}

/// Numbers of pairs with a positive and with a negative command.
fn directions(pairs: &[[f64; 2]]) -> [usize; 2] {
    let count = |is_meant: fn(f64) -> bool| {
        let meant = |[command, _]: &&[f64; 2]| is_meant(*command);
        pairs.iter().filter(meant).count()
    };
    [
        count(|command| command > 0.0),
        count(|command| command < 0.0),
    ]
}

/// Whether the strokes ended before they have enough pairs of a motor for a [`Fit`].
pub(crate) fn are_strokes_short(seen: &Seen, channel: &Channel) -> bool {
    let [up, down] = directions(&pairs(seen, channel));
    up.min(down) < LEAST_PAIRS
}

/// Mean current of a motor at the command of zero, A, which follows on the strokes; `None` of too few pairs.
pub(crate) fn offset_at_rest(seen: &Seen, channel: &Channel) -> Option<f64> {
    let pairs = pairs(seen, channel);
    let resting = pairs.iter().filter(|[command, _]| *command == 0.0);
    let number = resting.clone().count();
    (number >= LEAST_PAIRS)
        .then(|| resting.map(|[_, measured]| measured).sum::<f64>() / number as f64)
}

/// The line `measured = offset + slope command` through pairs of currents, by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    /// Current at the command of zero, A.
    pub(crate) offset: f64,
    /// Change of the current over that of the command.
    pub(crate) slope: f64,
    /// RMS distance of the measured currents from the line, A.
    residual: f64,
    pairs: usize,
}

impl Fit {
    /// The line of a motor.
    ///
    /// # Errors
    /// What was found and what to do, if the line does not state how the amplifier follows its command.
    pub(crate) fn of(seen: &Seen, channel: &Channel) -> Result<Self, String> {
        let pairs = pairs(seen, channel);
        let [up, down] = directions(&pairs);
        let largest = pairs.iter().fold(0.0_f64, |most, [i, _]| most.max(i.abs()));
        let stroke = f64::from(channel.stroke.get());
        if !pairs.is_empty() && largest < REACHED * stroke {
            return Err(format!(
                "the commands reach {:.0} mA of {:.0} mA: set current-scale to {} at least, and limit-large \
                 or limit-small to {stroke:.2} A",
                1e3 * largest,
                1e3 * stroke,
                Setting::CurrentScale.facts().default
            ));
        }
        if up.min(down) < LEAST_PAIRS {
            return Err(format!(
                "{up} measured currents beside a steady positive command and {down} beside a negative one, \
                 of {LEAST_PAIRS} that are needed: check the connection, and leave the handle free"
            ));
        }
        let fit = Self::through(&pairs);
        let found = fit.text();
        let most = LARGEST_RESIDUAL * f64::from(channel.full_scale.get());
        if fit.slope < -LEAST_SLOPE {
            Err(format!(
                "{found}: the current is measured against its command; exchange the wires of the monitor \
                 output, or those of the amplifier's input"
            ))
        } else if fit.slope.is_nan() || fit.slope < LEAST_SLOPE {
            Err(format!(
                "{found}: the commanded current does not flow, or is not measured; check the motor's \
                 leads, the wire of the monitor output, and the scales of amplifier and monitor"
            ))
        } else if fit.residual > most {
            Err(format!(
                "{found}; a residual of {:.1} mA is allowed: check the ground and the screen of the \
                 monitor output, and the limit and the tuning of the amplifier",
                1e3 * most
            ))
        } else {
            Ok(fit)
        }
    }

    /// The line through pairs of command and measured current, of which two commands differ.
    fn through(pairs: &[[f64; 2]]) -> Self {
        let number = pairs.len() as f64;
        let mean = |value: fn(&[f64; 2]) -> f64| pairs.iter().map(value).sum::<f64>() / number;
        let [command, measured] = [mean(|pair| pair[0]), mean(|pair| pair[1])];
        let sum = |product: &dyn Fn(f64, f64) -> f64| -> f64 {
            let products = pairs
                .iter()
                .map(|pair| product(pair[0] - command, pair[1] - measured));
            products.sum()
        };
        let slope = sum(&|x, y| x * y) / sum(&|x, _| x * x);
        let square = sum(&|x, y| (y - slope * x).powi(2)) / number;
        Self {
            offset: measured - slope * command,
            slope,
            residual: square.sqrt(),
            pairs: pairs.len(),
        }
    }

    /// The line in words.
    pub(crate) fn text(&self) -> String {
        format!(
            "offset {:.1} mA, slope {:.3}, residual {:.1} mA of {} pairs",
            1e3 * self.offset,
            self.slope,
            1e3 * self.residual,
            self.pairs
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::tests::seen;

    fn fits(seen: &Seen) -> [Result<Fit, String>; 2] {
        [0, 1].map(|motor| Fit::of(seen, &CHANNELS[motor]))
    }

    fn refused(flows: impl Fn(usize, f32) -> f32) -> [String; 2] {
        let seen = seen(flows);
        fits(&seen).map(|fit| fit.unwrap_err())
    }

    #[test]
    fn offset_and_slope_of_steady_commands_are_found() {
        let seen = seen(|motor, command| [0.02, -0.004][motor] + [0.9, 1.1][motor] * command);
        let [large, small] = fits(&seen).map(Result::unwrap);
        for (fit, offset, slope) in [(large, 0.02, 0.9), (small, -0.004, 1.1)] {
            assert!((fit.offset - offset).abs() < 1e-6, "{fit:?}");
            assert!((fit.slope - slope).abs() < 1e-6, "{fit:?}");
            assert!(fit.residual < 1e-6, "{fit:?}");
            // Frames 4 to 11 of each block end five frames of one command.
            assert_eq!(fit.pairs, 800);
        }
        assert_eq!(
            large.text(),
            "offset 20.0 mA, slope 0.900, residual 0.0 mA of 800 pairs"
        );
    }

    #[test]
    fn residual_is_the_rms_distance_from_the_line() {
        let fit = Fit::through(&[[1.0, 2.0], [1.0, 3.0], [3.0, 6.0], [3.0, 7.0]]);
        let expected = Fit {
            offset: 0.5,
            slope: 2.0,
            residual: 0.5,
            pairs: 4,
        };
        assert_eq!(fit, expected);
    }

    #[test]
    fn reversed_and_missing_currents_are_told_apart() {
        for said in refused(|_, command| -command) {
            assert!(
                said.contains("slope -1.000") && said.contains("exchange"),
                "{said}"
            );
        }
        for slope in [0.0, 0.49, -0.49] {
            for said in refused(|_, command| 0.001 + slope * command) {
                assert!(said.contains("check the motor's leads"), "{said}");
            }
        }
        for said in refused(|_, _| f32::NAN) {
            assert!(said.contains("check the motor's leads"), "{said}");
        }
    }

    #[test]
    fn half_of_the_current_is_measured_at_least() {
        for fit in fits(&seen(|_, command| 0.51 * command)) {
            assert!(fit.is_ok(), "{fit:?}");
        }
        for said in refused(|_, command| -0.51 * command) {
            assert!(said.contains("exchange"), "{said}");
        }
    }

    #[test]
    fn currents_that_scatter_are_refused() {
        // The bounds are 12 and 3 mA. Deviations whose sign alternates leave the line as it is.
        let scattered = |part: f32| {
            let mut seen = seen(|_, command| command);
            for measured in &mut seen.measured {
                let sign = if measured.seq % 2 == 0 { 1.0 } else { -1.0 };
                measured.large += sign * part * 0.012;
                measured.small += sign * part * 0.003;
            }
            fits(&seen)
        };
        for fit in scattered(0.98) {
            assert!(fit.is_ok(), "{fit:?}");
        }
        let [large, small] = scattered(1.02).map(Result::unwrap_err);
        assert!(
            large.contains("a residual of 12.0 mA is allowed"),
            "{large}"
        );
        assert!(small.contains("a residual of 3.0 mA is allowed"), "{small}");
    }

    #[test]
    fn few_pairs_and_small_commands_are_refused() {
        let whole = seen(|_, command| command);
        let mut short = whole.clone();
        short.frames.truncate(150);
        let error = Fit::of(&short, &CHANNELS[0]).unwrap_err();
        assert!(error.contains("of 50 that are needed"), "{error}");
        let silent = Seen {
            measured: Vec::new(),
            ..whole.clone()
        };
        let error = Fit::of(&silent, &CHANNELS[0]).unwrap_err();
        assert!(error.starts_with("0 measured currents"), "{error}");
        let mut weak = whole.clone();
        for frame in &mut weak.frames {
            frame.current *= 0.5;
        }
        let error = Fit::of(&weak, &CHANNELS[0]).unwrap_err();
        assert!(
            error.starts_with("the commands reach 150 mA of 300 mA"),
            "{error}"
        );
        assert!(Fit::of(&weak, &CHANNELS[1]).is_ok());
    }

    #[test]
    fn commands_reach_nine_tenths_of_the_strokes() {
        for (part, is_enough) in [(0.91, true), (0.89, false)] {
            let mut part_of = seen(|_, command| command);
            for frame in &mut part_of.frames {
                frame.current *= part;
                frame.current_small *= part;
            }
            for fit in fits(&part_of) {
                assert_eq!(fit.is_ok(), is_enough, "{part}: {fit:?}");
            }
        }
    }

    /// Commands in one direction alone do not tell an offset from a slope.
    #[test]
    fn each_direction_has_fifty_pairs() {
        for (number, is_enough) in [(50, true), (49, false)] {
            let mut lacking = seen(|_, command| command);
            let mut left = number;
            lacking.measured.retain(|it| {
                let frame = &lacking.frames[it.seq as usize];
                // The first four frames of each block end no pair.
                let is_pair = frame.current < 0.0 && it.seq % 12 >= 4;
                let stays = !is_pair || left > 0;
                left -= usize::from(is_pair && stays);
                stays
            });
            // The command of the small motor has the other sign.
            for channel in &CHANNELS {
                let fit = Fit::of(&lacking, channel);
                assert_eq!(fit.is_ok(), is_enough, "{fit:?}");
                assert_eq!(are_strokes_short(&lacking, channel), !is_enough);
            }
        }
    }

    #[test]
    fn offset_at_rest_is_the_mean_of_fifty_pairs_at_least() {
        let mut seen = seen(|_, command| 0.02 + 0.9 * command);
        let offset = offset_at_rest(&seen, &CHANNELS[0]).expect("an offset");
        assert!((offset - 0.02).abs() < 1e-6);
        // Four blocks at rest have 32 pairs.
        seen.frames.truncate(300);
        assert_eq!(offset_at_rest(&seen, &CHANNELS[0]), None);
    }

    #[test]
    fn directions_are_those_of_commands_that_are_not_zero() {
        let commands = [0.3, 0.0, -0.1, 0.2, 0.0, 0.0, 1e-9];
        let pairs = commands.map(|command| [command, -command]);
        assert_eq!(directions(&pairs), [3, 1]);
        assert_eq!(directions(&[]), [0, 0]);
    }

    /// The bounds themselves are allowed.
    #[test]
    fn slope_and_offset_at_a_bound_are_allowed() {
        let channel = &CHANNELS[0];
        let gain = channel.gain.facts();
        let fit = |offset, slope| Fit {
            offset,
            slope,
            residual: 0.0,
            pairs: 100,
        };
        let [least, most] = [gain.least, gain.most].map(f64::from);
        let offset = LARGEST_OFFSET * channel.limit;
        for (at, beyond) in [
            (fit(0.0, least), fit(0.0, least.next_down())),
            (fit(0.0, most), fit(0.0, most.next_up())),
            (fit(offset, 1.0), fit(offset.next_up(), 1.0)),
            (fit(-offset, 1.0), fit((-offset).next_down(), 1.0)),
        ] {
            assert!(judged(at, channel).is_ok(), "{at:?}");
            assert!(judged(beyond, channel).is_err(), "{beyond:?}");
        }
    }

    #[test]
    fn bring_up_allows_what_calibration_can_correct() {
        let results = |offset: f32, slope: f32| {
            let flows = |motor: usize, command| [1.0, 0.25][motor] * offset + slope * command;
            lines(&seen(flows)).into_iter().map(|(_, result)| result)
        };
        // 5 % of 6 A and of 1.5 A.
        for (offset, slope) in [(0.29, 1.0), (-0.29, 1.0), (0.0, 0.81), (0.0, 1.24)] {
            assert!(
                results(offset, slope).all(|it| it.is_ok()),
                "{offset} {slope}"
            );
        }
        for (offset, slope, told) in [
            (0.31, 1.0, "calibrate"),
            (-0.31, 1.0, "calibrate"),
            (0.0, 0.79, "from 0.8 to 1.25"),
            (0.0, 1.26, "from 0.8 to 1.25"),
            (0.0, 0.3, "leads"),
        ] {
            for result in results(offset, slope) {
                let error = result.unwrap_err();
                assert!(error.contains(told), "{offset} {slope}: {error}");
            }
        }
    }

    /// Below a tenth of the strokes' current no motor turns.
    #[test]
    fn settings_have_to_allow_a_tenth_of_the_strokes() {
        for (setting, channel) in [Setting::LimitLarge, Setting::LimitSmall]
            .into_iter()
            .zip(&CHANNELS)
        {
            let stroke = channel.stroke.get();
            for (part, is_allowed) in [(0.11, true), (0.09, false)] {
                let mut settings = Settings::COMMISSIONED;
                assert!(settings.set(setting, part * stroke));
                assert_eq!(
                    allowed(&settings).is_ok(),
                    is_allowed,
                    "{setting:?}: {part}"
                );
            }
        }
    }
}
