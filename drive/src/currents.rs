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
mod tests;
