//! Numbers of causes and modes in telemetry.

use haptic_control::{Mode, Stop};

/// Numbers and names are part of telemetry and tables: they never change.
#[test]
fn every_stop_keeps_its_number_and_name() {
    let names = [
        "none",
        "handle-overspeed",
        "large-overspeed",
        "jump",
        "not-moving",
        "amplifier-fault",
        "tick-overrun",
        "non-finite",
        "watchdog",
        "brown-out",
        "clock-failure",
        "panic",
        "hard-fault",
        "command-timeout",
        "against",
        "debugger",
        "exception",
        "interlock",
        "overload",
        "current-mismatch",
        "lost-counts",
        "torque-balance",
        "supply",
    ];
    assert_eq!(Stop::ALL.map(Stop::as_str), names);
    for code in 0..=u8::MAX {
        match Stop::from_code(code) {
            Some(stop) => assert_eq!((stop as u8, stop), (code, Stop::ALL[usize::from(code)])),
            None => assert!(usize::from(code) >= names.len(), "{code}"),
        }
    }
    assert_eq!(Stop::from_code(22), Some(Stop::Supply));
}

#[test]
fn codes_of_modes_are_unique_and_reversible() {
    for code in 0..=4 {
        assert_eq!(Mode::from_code(code).map(|mode| mode as u8), Some(code));
    }
    assert_eq!(Mode::from_code(5), None);
}
