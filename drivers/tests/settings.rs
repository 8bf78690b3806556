//! Settings as bytes, their ranges, and settings of other images.

use drivers::{REACHES, SETTINGS_BYTES, SaveError, Saved, Setting, Settings, SettingsError};
use estimator_core::{Amps, Counts};
use haptic_control::{CurrentScale, Currents};

/// Largest currents that the outputs command, A: 1798 of 2047 steps of 6 A and of 1.5 A.
const LARGE: f32 = 6.0 * (1798.0 / 2047.0);
const SMALL: f32 = 1.5 * (1798.0 / 2047.0);

/// Name, default and range at their numbers. They are in the flash of boards: no name or number ever changes.
const KNOWN: [(&str, f32, f32, f32); Setting::ALL.len()] = [
    ("zero-large", 2048.0, 1848.0, 2248.0),
    ("zero-small", 2048.0, 1848.0, 2248.0),
    ("gain-large", 1.0, 0.8, 1.25),
    ("gain-small", 1.0, 0.8, 1.25),
    ("current-scale", 0.1, 0.0, 1.0),
    ("signs-verified", 0.0, 0.0, 1.0),
    ("estimator", 0.0, 0.0, 254.0),
    ("serial", 0.0, 0.0, 16_777_215.0),
    ("limit-large", LARGE, 0.0, LARGE),
    ("limit-small", SMALL, 0.0, SMALL),
    // Whole numbers that f32 has.
    ("offset-large", 0.0, -8_388_608.0, 8_388_607.0),
    ("offset-small", 0.0, -8_388_608.0, 8_388_607.0),
];

#[test]
fn numbers_and_ranges_do_not_change() {
    for (number, known) in (0..).zip(KNOWN) {
        let setting = Setting::from_number(number).expect("a setting");
        let facts = setting.facts();
        assert_eq!(setting as u8, number);
        assert_eq!((facts.name, facts.default, facts.least, facts.most), known);
    }
    assert_eq!(Setting::from_number(Setting::ALL.len() as u8), None);
    assert_eq!(Setting::from_number(u8::MAX), None);
}

/// Bytes as boards hold them, at the places that the documentation of `Settings::encode` states.
#[test]
fn settings_that_a_board_holds_are_read() {
    let mut bytes = [0; 248];
    bytes[..4].copy_from_slice(&[1, 0, 5, 0]);
    let values: [f32; 5] = [2050.0, 2047.0, 1.1, 1.25, 0.5];
    for (place, value) in bytes[4..].chunks_mut(4).zip(values) {
        place.copy_from_slice(&value.to_le_bytes());
    }
    let mut held = Settings::DEFAULT;
    for (number, value) in (0..).zip(values) {
        assert!(held.set(Setting::from_number(number).unwrap(), value));
    }
    assert_eq!(Settings::decode(&bytes), Ok(held));
    bytes[0] = 2;
    assert_eq!(Settings::decode(&bytes), Err(SettingsError::Version(2)));
    assert_eq!(held.encode()[..2], [1, 0]);
}

#[test]
fn every_default_is_in_its_range_and_every_end_is_kept() {
    for &setting in Setting::ALL {
        let facts = setting.facts();
        assert!(facts.least < facts.most, "{}", facts.name);
        for value in [facts.default, facts.least, facts.most] {
            let mut settings = Settings::DEFAULT;
            assert!(settings.set(setting, value), "{}: {value}", facts.name);
            let read = Settings::decode(&settings.encode());
            assert_eq!(read, Ok(settings), "{}: {value}", facts.name);
        }
    }
}

#[test]
fn commissioned_board_has_the_whole_current_and_verified_signs() {
    let [blank, commissioned] = [Settings::DEFAULT, Settings::COMMISSIONED];
    assert!(!blank.are_signs_verified() && commissioned.are_signs_verified());
    // No limit of the bench: the outputs command no more than this.
    let [large, small] = REACHES;
    let unset = |part| CurrentScale::new(part).map(|it| it.bounded(Currents { large, small }));
    assert_eq!(unset(0.1), Some(blank.current_scale()));
    assert_eq!(unset(1.0), Some(commissioned.current_scale()));
    let differ = |setting: &&Setting| blank.get(**setting) != commissioned.get(**setting);
    assert_eq!(Setting::ALL.iter().filter(differ).count(), 2);
}

#[test]
fn limit_of_the_bench_bounds_its_motor_alone() {
    let mut settings = Settings::COMMISSIONED;
    assert!(settings.set(Setting::LimitLarge, 2.0));
    assert!(settings.set(Setting::CurrentScale, 0.5));
    let scale = settings.current_scale();
    // Half of 3 A is below the limit, half of 6 A is not.
    assert_eq!([scale.large(3.0), scale.large(6.0)], [1.5, 2.0]);
    assert_eq!(scale.small(1.5), 0.75);
    assert!(settings.set(Setting::LimitSmall, 0.25));
    assert_eq!(settings.current_scale().small(1.5), 0.25);
}

/// At the ends of the ranges of zero and gain, with the whole current of a device that asks for the full scale.
#[test]
fn calibrated_outputs_bound_the_currents_to_those_that_they_reach() {
    let ends = |setting: Setting| [setting.facts().least, setting.facts().most];
    for channel in 0..2 {
        let (zero, gain, full) = [
            (Setting::ZeroLarge, Setting::GainLarge, 6.0),
            (Setting::ZeroSmall, Setting::GainSmall, 1.5),
        ][channel];
        for (zero_codes, part) in ends(zero)
            .into_iter()
            .flat_map(|zero_codes| ends(gain).map(|part| (zero_codes, part)))
        {
            let mut settings = Settings::COMMISSIONED;
            assert!(settings.set(zero, zero_codes) && settings.set(gain, part));
            let scale = settings.current_scale();
            let largest = [scale.large(6.0), scale.small(1.5)][channel];
            // The output ends 0.2 V from both rails of 3.3 V, which is 1798 codes from the middle one.
            let worse = (1798.0 - 200.0) / 2047.0 * full * part;
            let wanted = worse.min(REACHES[channel].get());
            assert!(
                (largest - wanted).abs() < 1e-5,
                "{zero_codes} {part}: {largest} A"
            );
            // The other channel is as it was.
            let other = [scale.large(6.0), scale.small(1.5)][1 - channel];
            assert_eq!(other, REACHES[1 - channel].get());
            let code = settings.dac_scales()[channel].exact_code(Amps::new(largest));
            assert!((2048.0 - code).abs() < 1798.1, "{code}");
        }
    }
}

#[test]
fn offsets_are_whole_counts_of_each_encoder() {
    let mut settings = Settings::DEFAULT;
    assert_eq!(settings.offsets(), [Counts(0); 2]);
    assert!(settings.set(Setting::OffsetLarge, -1234.0));
    assert!(settings.set(Setting::OffsetSmall, 8_388_607.0));
    assert!(!settings.set(Setting::OffsetSmall, 0.5));
    assert_eq!(settings.offsets(), [Counts(-1234), Counts(8_388_607)]);
}

/// Settings of an image that did not have the limits leave them at the largest currents of the outputs.
#[test]
fn settings_of_before_the_limits_have_none() {
    let mut older = Settings::COMMISSIONED.encode();
    older[2..4].copy_from_slice(&(Setting::LimitLarge as u16).to_le_bytes());
    older[4 + 4 * 8..].fill(0);
    assert_eq!(Settings::decode(&older), Ok(Settings::COMMISSIONED));
}

#[test]
fn outcomes_are_read_back_by_their_numbers() {
    let codes: Vec<_> = (0..=u8::MAX).filter_map(Saved::from_code).collect();
    let results: [Result<(), SaveError<()>>; 4] = [
        Ok(()),
        Err(SaveError::Full),
        Err(SaveError::Flash(())),
        Err(SaveError::Mismatch),
    ];
    let [stored, others @ ..] = results.map(Saved::from);
    assert_eq!(codes[..2], [stored, Saved::Enabled]);
    assert_eq!(codes[2..], others);
    assert!((0..).zip(codes).all(|(code, saved)| saved as u8 == code));
}

#[test]
fn values_out_of_range_change_nothing() {
    for &setting in Setting::ALL {
        let facts = setting.facts();
        let mut settings = Settings::DEFAULT;
        let half = facts.least + 0.5;
        let outside = [
            f32::NAN,
            f32::INFINITY,
            facts.least - 1.0,
            facts.most * 1.001 + 0.01,
        ];
        for value in outside.into_iter().chain(facts.is_whole.then_some(half)) {
            assert!(!settings.set(setting, value), "{}: {value}", facts.name);
        }
        assert_eq!(settings, Settings::DEFAULT);
    }
}

#[test]
fn settings_of_another_image_are_read_as_far_as_they_are_known() {
    let mut settings = Settings::DEFAULT;
    assert!(settings.set(Setting::ZeroSmall, 2050.0));
    assert!(settings.set(Setting::Serial, 77.0));
    let whole = settings.encode();
    // An image that had the first two settings alone.
    let mut older = whole;
    older[2..4].copy_from_slice(&2u16.to_le_bytes());
    older[12..].fill(0);
    let read = Settings::decode(&older).expect("readable");
    assert_eq!(read.get(Setting::ZeroSmall), 2050.0);
    assert_eq!(read.get(Setting::Serial), 0.0);
    assert_eq!(read.get(Setting::GainLarge), 1.0);
    // One with more of them, and one with more than there is room for.
    for count in [Setting::ALL.len() as u16 + 3, u16::MAX] {
        let mut newer = whole;
        newer[2..4].copy_from_slice(&count.to_le_bytes());
        newer[SETTINGS_BYTES - 8..].fill(0xEE);
        assert_eq!(Settings::decode(&newer), Ok(settings));
    }
}

#[test]
fn settings_of_another_version_or_out_of_range_are_refused() {
    let mut bytes = Settings::DEFAULT.encode();
    bytes[0] = 9;
    assert_eq!(Settings::decode(&bytes), Err(SettingsError::Version(9)));
    let mut bytes = Settings::DEFAULT.encode();
    bytes[4 + 4 * 4..][..4].copy_from_slice(&1.5f32.to_le_bytes());
    let refused = Err(SettingsError::Value(Setting::CurrentScale));
    assert_eq!(Settings::decode(&bytes), refused);
    assert_eq!(
        Settings::decode(&[0xFF; SETTINGS_BYTES]),
        Err(SettingsError::Version(0xFFFF))
    );
}
