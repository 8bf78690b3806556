//! The range of every parameter, on both sides of each end.

mod motor;

use estimator_core::{
    Count, DesignError, EndFit, FiniteDifference, Foaw, Handover, Hertz, LowPass, Pll, Sample,
    Scale, VelocityEstimator,
};

const RATE: Hertz = Hertz(1000.0);

/// Asserts that `design` refuses the value by this error, and no other way round.
#[track_caller]
fn assert_range<T>(
    what: &str,
    error: DesignError,
    accepted: &[f64],
    refused: &[f64],
    design: impl Fn(f64) -> Result<T, DesignError>,
) {
    for &value in accepted {
        assert_ne!(design(value).err(), Some(error), "{what} {value:e}");
    }
    for &value in refused
        .iter()
        .chain(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY])
    {
        assert_eq!(design(value).err(), Some(error), "{what} {value:e}");
    }
}

#[test]
fn cutoff_is_a_millionth_to_half_of_the_rate() {
    let low_pass = |cutoff: f64| LowPass::new(FiniteDifference, Hertz(cutoff), RATE);
    let pll = |cutoff: f64| Pll::new(Hertz(cutoff), RATE);
    let (inside, outside) = ([1.001e-3, 1.0, 500.0], [0.999e-3, 500.1, 0.0, -1.0]);
    assert_range("low-pass", DesignError::CUTOFF, &inside, &outside, low_pass);
    assert_range("PLL", DesignError::BANDWIDTH, &inside, &outside, pll);
    for rate in [0.0, -1000.0, f64::NAN, f64::INFINITY] {
        let refused = LowPass::new(FiniteDifference, Hertz(1.0), Hertz(rate));
        assert_eq!(refused.err(), Some(DesignError::RATE));
        assert_eq!(
            Pll::new(Hertz(1.0), Hertz(rate)).err(),
            Some(DesignError::RATE)
        );
        assert_eq!(Scale::new(4096, Hertz(rate)).err(), Some(DesignError::RATE));
    }
    let refused = Scale::new(0, RATE).err();
    assert_eq!(refused, Some(DesignError::COUNTS_PER_REV));
    // Factors that f32 does not hold.
    for (counts, rate) in [(1, 1e39), (u32::MAX, 1e-300)] {
        assert_eq!(
            Scale::new(counts, Hertz(rate)).err(),
            Some(DesignError::RATE)
        );
    }
}

/// The pole of a first-order low-pass is `exp(-2 π cutoff / rate)`: after a step of the velocity, n
/// ticks leave p^n of it.
#[test]
fn low_pass_has_its_pole() {
    let (cutoff, step) = (20.0, 100);
    let pole = (-std::f64::consts::TAU * cutoff / RATE.0).exp();
    let low_pass = LowPass::new(FiniteDifference, Hertz(cutoff), RATE).unwrap();
    let mut state = low_pass.start(&Sample::new(Count(0)));
    for n in 1..60 {
        let velocity = low_pass.update(&mut state, &Sample::new(Count(step * n))).0;
        let exact = f64::from(step) * (1.0 - pole.powi(n as i32));
        assert!(
            (f64::from(velocity) - exact).abs() < 1e-4,
            "{n}: {velocity} {exact}"
        );
    }
}

/// `e = y - (θ + v)`, `θ += v + (1 - p²) e`, `v += (1 - p)² e`, with positions that are absolute.
#[test]
fn pll_has_its_double_pole() {
    let pole = (-std::f64::consts::TAU * 35.0 / RATE.0).exp();
    let pll = Pll::new(Hertz(35.0), RATE).unwrap();
    let mut state = pll.start(&Sample::new(Count(0)));
    let (mut theta, mut v) = (0.0, 0.0);
    for n in 1..400u32 {
        // Steps of 0, 1, 3, 6, .. counts, and back.
        let y = n / 7 * (n % 20);
        let e = f64::from(y) - (theta + v);
        theta += v + (1.0 - pole * pole) * e;
        v += (1.0 - pole).powi(2) * e;
        let velocity = f64::from(pll.update(&mut state, &Sample::new(Count(y))).0);
        assert!(
            (velocity - v).abs() < 1e-4 * (1.0 + v.abs()),
            "{n}: {velocity} {v}"
        );
    }
}

#[test]
fn foaw_has_a_range() {
    for (window, bound, error) in [
        (0, 1, Some(DesignError::WINDOW)),
        (1, 1, None),
        (15, 1, None),
        (16, 1, Some(DesignError::WINDOW)),
        (15, 0, None),
        (15, 1 << 14, None),
        (15, (1 << 14) + 1, Some(DesignError::BOUND)),
    ] {
        let refused = Foaw::<15, EndFit>::new(window, bound).err();
        assert_eq!(refused, error, "{window} {bound}");
    }
}

#[test]
fn handover_has_a_range() {
    let new = |settle, fade| Handover::new(FiniteDifference, FiniteDifference, settle, fade);
    let longest = 1u16 << 15;
    for (settle, fade) in [(0, 1), (0, longest), (longest - 1, longest)] {
        assert!(new(settle, fade).is_ok(), "{settle} {fade}");
    }
    for (settle, fade, error) in [
        (0, 0, DesignError::FADE),
        (0, longest + 1, DesignError::FADE),
        (longest, 1, DesignError::SETTLE),
        (u16::MAX, 1, DesignError::SETTLE),
    ] {
        assert_eq!(new(settle, fade).err(), Some(error), "{settle} {fade}");
    }
}

/// A message begins with the parameter, states the requirement and ends with the unit, and no two
/// messages are the same.
#[test]
fn message_has_parameter_requirement_and_unit() {
    for error in DesignError::ALL {
        let (parameter, unit) = (error.parameter(), error.unit());
        let message = error.to_string();
        let rest = message.strip_prefix(parameter).expect("the parameter");
        let words = rest.strip_suffix(&format!(" ({unit})")).unwrap_or(rest);
        assert_eq!(
            words.strip_prefix(' '),
            Some(error.requirement()),
            "{error}"
        );
        assert_eq!(words == rest, unit.is_empty(), "{error}");
        assert!(!parameter.is_empty() && !message.contains("  "), "{error}");
        let same = DesignError::ALL.iter();
        let same = same.filter(|other| other.message() == error.message());
        assert_eq!(same.count(), 1, "{error}");
    }
}

/// Names the API has: constructors and fields. A unit is left out where the parameter is a number.
#[test]
fn errors_name_parameters_of_the_api() {
    for (error, parameter, unit) in [
        (DesignError::RATE, "rate", "Hz"),
        (DesignError::CUTOFF, "cutoff", "Hz"),
        (DesignError::INERTIA, "inertia", "kg m^2"),
        (DesignError::TORQUE_NOISE, "torque_noise", "N m/sqrt(Hz)"),
        (DesignError::FRICTION_SHARE, "friction_share", ""),
        (DesignError::TABLE, "N", "ticks"),
    ] {
        assert_eq!((error.parameter(), error.unit()), (parameter, unit));
    }
}

/// The text of every source file below a folder, but that of the errors.
fn sources(folder: &std::path::Path) -> String {
    let entries = std::fs::read_dir(folder).expect("readable");
    let text = |path: std::path::PathBuf| match path.is_dir() {
        true => sources(&path),
        false if path.ends_with("design/error.rs") => String::new(),
        false => std::fs::read_to_string(path).expect("readable"),
    };
    entries
        .map(|entry| text(entry.expect("readable").path()))
        .collect()
}

/// Every parameter that an error names is an argument, a field, a method or a constant of a type.
#[test]
fn parameters_of_errors_exist_in_the_sources() {
    let sources = sources(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    for error in DesignError::ALL {
        let name = error.parameter();
        let declared = [
            format!("({name}: "),
            format!(" {name}: "),
            format!("fn {name}("),
            format!("const {name}: usize"),
        ];
        let is_declared = declared.iter().any(|text| sources.contains(text));
        assert!(is_declared, "{name}: {}", error.message());
    }
}
