//! The constants of a flash image's build, and its errors: each is one line that names the variable,
//! the file and the key, and says what would be right.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use device_files::constants::{constants, named_file};

/// A file of this test's own.
fn file(name: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("constants");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}

/// The shipped presets.
const SHIPPED: &str = include_str!("../../presets.toml");

fn assert_line(error: &str, parts: &[&str]) {
    assert!(!error.contains('\n'), "one line: {error}");
    for part in parts {
        assert!(error.contains(part), "{error:?} lacks {part:?}");
    }
}

#[test]
fn missing_files_are_reported_with_their_variable() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let named = |value: &str| named_file("DEVICE", OsStr::new(value), root);
    assert_eq!(named("Cargo.toml"), Ok(root.join("Cargo.toml")));
    assert_line(
        &named("nowhere.toml").unwrap_err(),
        &[
            "DEVICE: no file ",
            "device-files/nowhere.toml",
            "a relative path starts at the top of the repository",
        ],
    );
    assert_line(
        &named("").unwrap_err(),
        &["DEVICE is empty: name a TOML file, or unset it"],
    );
    for (device, presets, variable) in [
        (Some(root), None, "DEVICE: "),
        (None, Some(root), "PRESETS: "),
    ] {
        let error = constants(device, presets).unwrap_err();
        assert_line(
            &error,
            &[
                variable,
                "device-files: not a regular file; give a TOML file",
            ],
        );
    }
}

#[test]
fn errors_of_a_device_file_name_line_or_key_and_remedy() {
    for (text, parts) in [
        (
            "[large]\ninertia = 1e-5\n",
            &[
                "line 2, inertia: unknown field `inertia`; did you mean `inertia_kg_m2`? expected one of",
                "`inertia_kg_m2`",
            ][..],
        ),
        (
            "[large]\ninertia_kgm2 = 1e-5\n",
            &[
                "line 2, inertia_kgm2: unknown field `inertia_kgm2`; did you mean `inertia_kg_m2`? expected",
            ],
        ),
        (
            "[larg]\ninertia_kg_m2 = 1e-5\n",
            &["line 1, [larg]: unknown field `larg`; did you mean `large`? expected one of"],
        ),
        (
            "x = 1\n",
            &["line 1, x: unknown field `x`, expected one of"],
        ),
        (
            "[large]\n\ninertia_kg_m2 = \"heavy\"\n",
            &["line 3, inertia_kg_m2: ", "expected a number"],
        ),
        (
            "[large]\ninertia_kg_m2 = 111\n",
            &[
                "line 2, large.inertia_kg_m2 = 111: must be at most 0.1 kg.m2; did you mean 111e-7, which is 111 g.cm2?",
            ],
        ),
        (
            "[small]\ntorque_constant_nm_per_a = 46.2\n",
            &[
                "line 2, small.torque_constant_nm_per_a = 46.2: must be at most 10 N.m/A; did you mean 46.2e-3",
            ],
        ),
        (
            "[coupler]\ndamping_nms_per_rad = -1\n",
            &["line 2, coupler.damping_nms_per_rad = -1: must be above 0"],
        ),
        (
            "[large]\ncounts_per_rev = 3\n",
            &["line 2, large.counts_per_rev = 3: must be from 16 to 4000000"],
        ),
        (
            "[large]\ninertia_kg_m2 = 140 g.cm2 # rotor\n",
            &[
                "line 2, inertia_kg_m2: '140 g.cm2' is no number; write it as 0.015 or 1.5e-2, with a point and \
                 without a unit",
            ],
        ),
        (
            "large.inertia_kg_m2 = 1,5e-5\n",
            &["line 1, large.inertia_kg_m2: '1,5e-5' is no number; write"],
        ),
        (
            "[large]\ncoulomb_nm = .004\n",
            &["line 2, coulomb_nm: '.004' is no number; write it as 0.015"],
        ),
        (
            "[large]\ncoulomb_nm = 4.e-3\n",
            &["line 2, coulomb_nm: '4.e-3' is no number"],
        ),
        (
            "[large]\ncoulomb_nm = 4e\n",
            &["line 2, coulomb_nm: '4e' is no number"],
        ),
        (
            "[large]\ncounts_per_rev = 04096\n",
            &["line 2, counts_per_rev: '04096' is no number"],
        ),
        (
            "[large]\ncoulomb_nm = heavy\n",
            &["line 2, coulomb_nm: string values must be quoted"],
        ),
        ("[amplifier\n", &["line 1, [amplifier: "]),
        (
            "[small]\ncoulomb_nm = 0\n[[large]]\ncoulomb_nm = 0\n",
            &["line 3, [[large]]: not a list of sections; write its name between single brackets"],
        ),
        (
            "[large]\ncoulomb_nm = # guess\ninertia_kg_m2 = 1e-5\n",
            &["line 2, coulomb_nm: no value; write one after '=', or remove the line"],
        ),
    ] {
        let path = file("device.toml", text);
        let error = constants(Some(&path), None).unwrap_err();
        let start = format!("DEVICE: {}: ", path.display());
        assert_line(&error, &[&[start.as_str()], parts].concat());
    }
}

#[test]
fn file_of_another_encoding_is_refused_with_the_remedy() {
    let toml = "[hand] # n\u{e4}h\n";
    let utf16: Vec<u8> = (toml.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let latin1: Vec<u8> = toml.chars().map(|c| c as u8).collect();
    for (bytes, said) in [
        (
            [&[0xFF, 0xFE], &utf16[..]].concat(),
            ": is UTF-16, as > of Windows PowerShell writes it; save the file as UTF-8",
        ),
        ([b"\n", &latin1[..]].concat(), ": line 2: is not UTF-8 text"),
    ] {
        let path = file("encoding.toml", "");
        fs::write(&path, bytes).unwrap();
        assert_line(&constants(Some(&path), None).unwrap_err(), &[said]);
        assert_line(&constants(None, Some(&path)).unwrap_err(), &[said]);
    }
    // The mark at the start of UTF-8 is no error.
    assert!(constants(Some(&file("encoding.toml", "\u{feff}[hand]\n")), None).is_ok());
}

#[test]
fn long_keys_and_values_are_shortened_in_errors() {
    let long = "x".repeat(10_000);
    for text in [
        format!("{long} = 1\n"),
        format!("[hand]\n{long} = 1\n"),
        format!("[hand]\nstiffness_nm_per_rad = \"{long}\"\n"),
        format!("[{long}\n"),
        long.clone(),
    ] {
        let error = constants(Some(&file("long.toml", &text)), None).unwrap_err();
        assert_line(&error, &["line "]);
        let repeated = error.split(|c| c != 'x').map(str::len).max();
        assert!(error.len() < 600 && repeated <= Some(40), "{error}");
    }
}

#[test]
fn errors_of_a_presets_file_name_line_or_key_and_remedy() {
    let preset = |more: &str| format!("[[preset]]\nrate_hz = 1e3\nplant = \"friction\"\n{more}\n");
    for (text, parts) in [
        (
            preset("rate = 1"),
            &["line 4, rate: unknown field `rate`; did you mean `rate_hz`? expected one of"][..],
        ),
        (
            "[[presets]]\nrate_hz = 1e3\n".into(),
            &["line 1, [[presets]]: unknown field `presets`; did you mean `preset`? expected `preset` or `image`"],
        ),
        (
            preset("estimators = {}").replace("friction", "frict"),
            &["line 3, plant: unknown variant `frict`; did you mean `friction`? expected `friction` or"],
        ),
        (
            preset("estimators = {}").replace("plant", "#"),
            &["line 1, [[preset]]: missing field `plant`; add plant = \"friction\" or plant = \"frictionless\""],
        ),
        (
            preset(""),
            &["line 1, [[preset]]: missing field `estimators`; add [preset.estimators.NAME] with the values"],
        ),
        (
            preset("estimators = {}").replace("rate_hz", "#"),
            &["line 1, [[preset]]: missing field `rate_hz`; add rate_hz = 1000, the control rate in Hz"],
        ),
        (
            preset("counts_per_rev = -1"),
            &["line 4, counts_per_rev: ", "expected a whole number from 16 to 4000000"],
        ),
        (
            preset("counts_per_rev = 99999999999"),
            &["line 4, counts_per_rev: ", "expected a whole number from 16 to 4000000"],
        ),
        (
            preset("[preset.estimators.pll]\nbandwidth_hz = \"1\""),
            &["line 5, bandwidth_hz: ", "expected a number"],
        ),
        (
            "[[preset]]\nrate_hz = 0\nplant = \"friction\"\nestimators = {}\n".into(),
            &["line 2, rate_hz = 0: must be from 5 to 10000000 Hz"],
        ),
        (
            "[[preset]]\nrate_hz = inf\nplant = \"friction\"\nestimators = {}\n".into(),
            &["line 2, rate_hz = inf: must be from 5 to 10000000 Hz"],
        ),
        (
            "[[preset]]\nrate_hz = 1e-300\nplant = \"friction\"\nestimators = {}\n".into(),
            &["line 2, rate_hz = 1e-300: must be from 5 to"],
        ),
        (
            preset("counts_per_rev = 3\nestimators = {}"),
            &["line 4, counts_per_rev = 3 at rate_hz = 1000: must be from 16 to 4000000 counts per revolution"],
        ),
        (
            "[[preset]]\nrate_hz = 1e3\nplant = \"friction\"\ncounts_per_rev = 0\nestimators = {}\n".into(),
            &["line 4, counts_per_rev = 0 at rate_hz = 1000: must be from 16"],
        ),
        (
            preset("[preset.estimators.pl]\nbandwidth_hz = 1"),
            &["line 4, no estimator 'pl'; host-sim estimators lists them"],
        ),
        (
            preset("[preset.estimators.pll]\nbandwidth = 1"),
            &["line 5, pll has no parameter 'bandwidth'; there are bandwidth_hz"],
        ),
        (
            preset("[preset.estimators.pll]\nbandwidth_hz = -1"),
            &["line 5, pll.bandwidth_hz = -1: must be a number from 0.001 to 1000000"],
        ),
        (
            preset("[preset.estimators.foaw-end-fit]\nn = 2.5"),
            &["line 5, foaw-end-fit.n = 2.5: must be a whole number from 1 to 128"],
        ),
        (
            preset("[preset.estimators.pll]\nbandwidth_hz = 1\n[[preset]]\nplant = \"friction\"\nrate_hz = 1000.0\n\
                    estimators = { pll = { bandwidth_hz = 2 }, low-pass = {} }"),
            &["line 8, [[preset]]: pll at rate_hz = 1000 on the plant with friction is in an earlier [[preset]] too"],
        ),
        (
            "[image.middle.foaw-end-fit]\nn = 2\n".into(),
            &["line 1, image.middle: no such motor; there are large and handle"],
        ),
        (
            "[image.handle.pll]\nbandwidth_hz = 10\n".into(),
            &["line 1, image.handle.pll: no image reads it; there are kalman-triple-steady"],
        ),
        (
            "[image.handle.kalman-triple-steady]\njerk = nan\n".into(),
            &["line 2, kalman-triple-steady.jerk = NaN: must be a number from "],
        ),
    ] {
        let path = file("presets.toml", &text);
        let error = constants(None, Some(&path)).unwrap_err();
        let start = format!("PRESETS: {}: ", path.display());
        assert_line(&error, &[&[start.as_str()], parts].concat());
    }
}

/// A file that repeats the shipped presets changes no constant of the device and no fingerprint.
#[test]
fn files_reach_the_constants() {
    let text = |device: Option<&Path>, presets: Option<&Path>| constants(device, presets).unwrap();
    let line = |text: &str, start: &str| {
        let line = text.lines().find(|line| line.starts_with(start));
        line.unwrap_or_else(|| panic!("no {start} in {text}"))
            .to_owned()
    };
    let shipped = text(None, None);
    assert_eq!(shipped.warning, None);
    let repeated = text(None, Some(&file("shipped.toml", SHIPPED)));
    for start in ["pub const DEVICE", "const PRESETS"] {
        assert_eq!(line(&repeated.text, start), line(&shipped.text, start));
    }
    let jerk = "[image.handle.kalman-triple-steady]\njerk = 4321.5\n";
    let other = text(None, Some(&file("other.toml", jerk)));
    assert_ne!(
        line(&other.text, "const PRESETS"),
        line(&shipped.text, "const PRESETS")
    );
    assert!(other.text.contains("4321.5") && !shipped.text.contains("4321.5"));
    // An encoder far from that of the presets.
    let device = file(
        "fine.toml",
        "[large]\ncounts_per_rev = 20000\ninertia_kg_m2 = 1.25e-5\n",
    );
    let fine = text(Some(&device), None);
    assert!(
        line(&fine.text, "pub const DEVICE").contains("inertia: 1.25e-5"),
        "{}",
        fine.text
    );
    let warning = fine.warning.expect("a warning");
    assert_line(
        &warning,
        &[
            "tuned for 4096 counts/rev are scaled to 20000",
            "host-sim tune --device",
        ],
    );
    // One preset for such an encoder is enough.
    let presets = [("1e3", "4096"), ("2e3", "20000")].map(|(rate, counts)| {
        format!(
            "[[preset]]\nrate_hz = {rate}\nplant = \"friction\"\ncounts_per_rev = {counts}\n\
             [preset.estimators.pll]\nbandwidth_hz = 100\n"
        )
    });
    let presets = file("both.toml", &presets.concat());
    assert_eq!(text(Some(&device), Some(&presets)).warning, None);
}

/// The plant without friction is one of the simulation only.
#[test]
fn images_have_the_presets_for_the_plant_with_friction() {
    let of = |plant: &str| {
        let preset = format!(
            "[[preset]]\nrate_hz = 1e3\nplant = \"{plant}\"\ncounts_per_rev = 4096\n\
             [preset.estimators.pll]\nbandwidth_hz = 123.25\n"
        );
        constants(None, Some(&file(&format!("{plant}.toml"), &preset))).unwrap()
    };
    assert!(of("friction").text.contains("123.25"));
    assert!(!of("frictionless").text.contains("123.25"));
}

/// Tuned values are scaled without a warning to an encoder with up to 1.5 times as many counts, or as few.
#[test]
fn an_encoder_far_from_the_tuned_one_is_reported() {
    for (counts_per_rev, far) in [(2700, true), (2800, false), (6100, false), (6200, true)] {
        let device = format!("[large]\ncounts_per_rev = {counts_per_rev}\n");
        let device = file(&format!("encoder-{counts_per_rev}.toml"), &device);
        let warning = constants(Some(&device), None).unwrap().warning;
        assert_eq!(warning.is_some(), far, "{counts_per_rev}: {warning:?}");
    }
}
