//! Zero and gain of both current outputs, from measured currents.

use drivers::{DacScale, Setting, Settings};
use estimator_core::Amps;
use terminal::failure::Failure;

use crate::board::{Answer, Board};
use crate::channels::{CHANNELS, Channel, FEATURE, are_measured};
use crate::check::{Line, failed, show};
use crate::currents::{Fit, are_strokes_short, offset_at_rest};
use crate::settings::{self, Assignment};
use crate::strokes::{Seen, announce, observe, plan, strokes};

/// A board learns the zeros of its monitors in less, while its amplifiers are disabled, s.
const ZEROS_S: f64 = 0.1;
/// Steps to which a new setting is rounded: hundredths of a code, ten thousandths of a gain.
const ZERO_STEPS: f64 = 100.0;
const GAIN_STEPS: f64 = 10_000.0;

/// What the procedure sets.
pub(crate) const SETTINGS: [Setting; 4] = [
    CHANNELS[0].zero,
    CHANNELS[0].gain,
    CHANNELS[1].zero,
    CHANNELS[1].gain,
];

/// Measures how both currents follow their commands, prints a line for each, and sets zero and gain on the
/// board.
///
/// # Errors
/// [`Failure::Check`] if the image measures no currents, or a current does not follow its command;
/// otherwise those of the session and of [`settings::change`].
pub(crate) fn run(board: &mut Board, store: bool) -> Result<(), Failure> {
    let answer = board.compatible()?;
    if !are_measured(&answer.hello) {
        return Err(Failure::Check(format!(
            "calibrate: the image does not have the feature {FEATURE}; build it with this feature, or measure \
             the currents and set zero and gain by hand: cargo drive settings zero-large=2051.5 gain-large=1.01"
        )));
    }
    // A scene that another program has begun would move the motors, and the monitors learn their zeros while
    // the amplifiers are disabled.
    board.disarm()?;
    let before = settings::present(board)?;
    announce(board);
    let mut undo = Vec::new();
    if let Err(failure) = adjust(board, &answer, &before, &mut undo) {
        // Whatever has failed, an interrupt too: an order to store would keep settings of a calibration that has no end.
        let _ = settings::change(board, &undo);
        return Err(failure);
    }
    if store {
        return settings::store(board);
    }
    board.note("until the next reset; cargo drive settings --store keeps them");
    Ok(())
}

/// Measures both currents, with other zeros where those of `before` turn the handle out of its bounds, prints a line
/// for each, and sets zero and gain. Adds what undoes a change to `undo` ahead of it.
///
/// # Errors
/// As [`run`].
fn adjust(
    board: &mut Board,
    answer: &Answer,
    before: &Settings,
    undo: &mut Vec<Assignment>,
) -> Result<(), Failure> {
    let mut seen = measured(board, answer)?;
    let present = with_zeros(&seen, before);
    if present != *before {
        board.note(format_args!(
            "the offsets turned the handle out of its bounds: the strokes are repeated without most of them"
        ));
        undo.extend(zeros(before));
        settings::change(board, &zeros(&present))?;
        seen = measured(board, answer)?;
    }
    let mut assignments = Vec::new();
    let mut lines: Vec<Line> = Vec::new();
    for channel in &CHANNELS {
        let found =
            Fit::of(&seen, channel).and_then(|fit| calibrated(fit, channel, &present, before));
        let result = found.map(|(text, new)| {
            assignments.extend(new);
            text
        });
        let line = (channel.motor, result);
        show(board, &line)?;
        lines.push(line);
    }
    let wrong = failed(&lines);
    if wrong > 0 {
        return Err(Failure::Check(format!(
            "calibrate: {wrong} of {} motors failed; no setting was changed",
            lines.len()
        )));
    }
    undo.clear();
    undo.extend(assignments.iter().map(|it| Assignment {
        setting: it.setting,
        value: before.get(it.setting),
    }));
    settings::change(board, &assignments)
}

/// The strokes, after the monitors have learned their zeros.
fn measured(board: &mut Board, answer: &Answer) -> Result<Seen, Failure> {
    observe(board, answer, plan(None, false, ZEROS_S))?;
    observe(board, answer, strokes())
}

/// The settings with the zeros of channels whose strokes ended early, as far as these zeros are admitted. An
/// offset of both outputs in one direction turns a free handle out of the bounds of the strokes.
fn with_zeros(seen: &Seen, present: &Settings) -> Settings {
    let mut settings = *present;
    let ended = CHANNELS
        .iter()
        .any(|channel| are_strokes_short(seen, channel));
    for channel in CHANNELS.iter().filter(|_| ended) {
        let zero = offset_at_rest(seen, channel).and_then(|offset| {
            let code = scale(channel, present)?.exact_code(Amps::new(-offset as f32));
            // The DAC rounds the command of zero too, which most pairs have: a whole code is exact.
            Some(code.round())
        });
        if let Some(zero) = zero {
            // A zero that is not admitted stays as it is, and the fit fails again.
            settings.set(channel.zero, zero);
        }
    }
    settings
}

/// The zeros in these settings.
fn zeros(settings: &Settings) -> [Assignment; 2] {
    [0, 1].map(|n| Assignment {
        setting: CHANNELS[n].zero,
        value: settings.get(CHANNELS[n].zero),
    })
}

/// The DAC of a channel with these settings; `None` if they are no calibration.
fn scale(channel: &Channel, settings: &Settings) -> Option<DacScale> {
    let [zero, gain] = [channel.zero, channel.gain].map(|setting| settings.get(setting));
    DacScale::new(channel.full_scale)?.calibrated(zero, gain)
}

/// New zero and gain of a channel, from a line that was measured with the `present` settings, and a text on
/// what changes against the settings `before`.
///
/// # Errors
/// What was found and what to do, if a new value is out of the bounds of its setting.
fn calibrated(
    fit: Fit,
    channel: &Channel,
    present: &Settings,
    before: &Settings,
) -> Result<(String, [Assignment; 2]), String> {
    let [zero, gain] = [channel.zero, channel.gain].map(|setting| present.get(setting));
    let Some(scale) = scale(channel, present) else {
        return Err(format!(
            "zero {zero} and gain {gain} of the board are no calibration"
        ));
    };
    // The command whose current is zero.
    let command = Amps::new((-fit.offset / fit.slope) as f32);
    let rounded = |value: f64, steps: f64| ((value * steps).round() / steps) as f32;
    let new = [
        (
            channel.zero,
            before.get(channel.zero),
            rounded(f64::from(scale.exact_code(command)), ZERO_STEPS),
        ),
        (
            channel.gain,
            gain,
            rounded(f64::from(gain) * fit.slope, GAIN_STEPS),
        ),
    ];
    let change = |(setting, before, after): (Setting, f32, f32)| {
        format!("{} {before} to {after}", setting.facts().name)
    };
    let text = format!("{}; {}", fit.text(), new.map(change).join(", "));
    let refused = new
        .iter()
        .find(|(setting, _, after)| !setting.admits(*after));
    if let Some((setting, ..)) = refused {
        let facts = setting.facts();
        return Err(format!(
            "{text}: {} is at least {} and at most {}; adjust zero and scale of the amplifier",
            facts.name, facts.least, facts.most
        ));
    }
    Ok((
        text,
        new.map(|(setting, _, value)| Assignment { setting, value }),
    ))
}

#[cfg(test)]
mod tests {
    use drivers::AdcScale;

    use super::*;
    use crate::channels::tests::seen;

    const FULL_SCALES: [f32; 2] = [6.0, 1.5];

    /// New settings of both motors, whose DACs really have this zero and gain, of a board with the
    /// `present` settings. The currents are those of whole DAC codes, read as whole codes of an ADC.
    fn found(
        real: [(f32, f32); 2],
        present: &Settings,
    ) -> [Result<Vec<(Setting, f32)>, String>; 2] {
        let flows = |motor: usize, command: f32| {
            let (zero, gain) = real[motor];
            let channel = &CHANNELS[motor];
            let full_scale = FULL_SCALES[motor];
            let scale = DacScale::new(Amps::new(full_scale)).unwrap();
            let [z, g] = [channel.zero, channel.gain].map(|setting| present.get(setting));
            let code = scale
                .calibrated(z, g)
                .unwrap()
                .code(Amps::new(command))
                .get();
            let flows = (f32::from(code) - zero) * full_scale / 2047.0 * gain;
            let range = 4.0 / 3.0 * full_scale;
            let read = AdcScale::new(Amps::new(range)).unwrap();
            let code = (flows / range * 2048.0).round() + 2048.0;
            read.current(code as u16).get()
        };
        let seen = seen(flows);
        [0, 1].map(|motor| {
            let channel = &CHANNELS[motor];
            let fit = Fit::of(&seen, channel)?;
            let (_, new) = calibrated(fit, channel, present, present)?;
            Ok(new.map(|it| (it.setting, it.value)).into())
        })
    }

    #[test]
    fn real_zero_and_gain_are_found_from_any_present_ones() {
        let real = [(2051.5, 0.96), (2035.25, 1.04)];
        let mut calibrated = Settings::DEFAULT;
        calibrated.set(Setting::ZeroLarge, 2060.0);
        calibrated.set(Setting::GainLarge, 1.1);
        calibrated.set(Setting::ZeroSmall, 2020.0);
        calibrated.set(Setting::GainSmall, 0.9);
        for present in [Settings::DEFAULT, calibrated] {
            let found = found(real, &present).map(Result::unwrap);
            for (motor, new) in found.into_iter().enumerate() {
                let channel = &CHANNELS[motor];
                let [(first, zero), (second, gain)] = new[..] else {
                    panic!("two settings: {new:?}");
                };
                assert_eq!([first, second], [channel.zero, channel.gain]);
                // The DAC rounds by half a code, the ADC by two thirds of one. The mean square of the
                // commands is 80 and 160 codes times their mean magnitude.
                let most = 0.5 + 2.0 / 3.0;
                assert!((zero - real[motor].0).abs() < most, "{new:?}");
                let most = most / [80.0, 160.0][motor];
                assert!((gain - real[motor].1).abs() < most, "{new:?}");
                // Hundredths of a code, and ten thousandths of a gain.
                for steps in [zero * 100.0, gain * 10_000.0] {
                    assert!((steps - steps.round()).abs() < 0.05, "{new:?}");
                }
            }
        }
    }

    /// One shaft out of its bounds ends the strokes of both motors.
    #[test]
    fn strokes_that_are_short_for_one_motor_give_both_other_zeros() {
        let mut seen = seen(|_, command| 0.02 + command);
        assert_eq!(with_zeros(&seen, &Settings::DEFAULT), Settings::DEFAULT);
        for (frame, measured) in seen.frames.iter_mut().zip(&mut seen.measured).skip(100) {
            (frame.current_small, measured.small) = (0.0, 0.02);
        }
        let zeros = zeros(&with_zeros(&seen, &Settings::DEFAULT));
        // 0.02 A over a full scale of 6 A and of 1.5 A has 7 and 27 of 2047 codes.
        assert_eq!(zeros.map(|it| it.value), [2048.0 - 7.0, 2048.0 - 27.0]);
    }

    /// A zero of the repeated strokes is no zero of before.
    #[test]
    fn line_tells_the_settings_of_before_the_procedure() {
        let fit = Fit::of(&seen(|_, command| command), &CHANNELS[0]).unwrap();
        let mut present = Settings::DEFAULT;
        assert!(present.set(Setting::ZeroLarge, 2036.0) && present.set(Setting::GainLarge, 1.1));
        let mut before = present;
        assert!(before.set(Setting::ZeroLarge, 2040.0));
        let (text, _) = calibrated(fit, &CHANNELS[0], &present, &before).unwrap();
        let end = "; zero-large 2040 to 2036, gain-large 1.1 to 1.1";
        assert!(text.ends_with(end), "{text}");
    }

    #[test]
    fn settings_out_of_bounds_are_refused() {
        let [large, small] = found([(1840.0, 1.0), (2048.0, 1.3)], &Settings::DEFAULT);
        let large = large.unwrap_err();
        assert!(
            large.contains("zero-large is at least 1848 and at most 2248"),
            "{large}"
        );
        let small = small.unwrap_err();
        assert!(
            small.contains("gain-small is at least 0.8 and at most 1.25"),
            "{small}"
        );
        let [large, small] = found([(1850.0, 1.22), (2246.0, 0.83)], &Settings::DEFAULT);
        assert!(large.is_ok() && small.is_ok(), "{large:?} {small:?}");
    }
}
