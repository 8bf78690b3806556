//! Tests of measured currents.

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
    // The seventh block at rest begins at frame 540, and the fifth frame of a block ends its first pair: six blocks
    // have 48 pairs.
    for (frames, is_enough) in [(546, true), (545, false)] {
        seen.frames.truncate(frames);
        let offset = offset_at_rest(&seen, &CHANNELS[0]);
        assert_eq!(offset.is_some(), is_enough, "{frames}");
    }
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
