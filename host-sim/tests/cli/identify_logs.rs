//! `host-sim identify` on logs of ordinary motion.

use crate::{Folder, HOST_SIM};

const CLAMPED: [&str; 3] = ["identify", "log.csv", "--clamped"];

/// Constants of a motor without a handle, SI.
const INERTIA: f64 = 2.0e-5;
const TORQUE_CONSTANT: f64 = 0.0468;
const DAMPING: f64 = 4e-4;
const FRICTION: f64 = 5e-3;
const LOAD: f64 = 2e-3;

/// Twenty seconds of a motor at 1 kHz with 4096 counts/rev, with `current` (A) and a torque that is not
/// in the log (N.m) over time.
fn log(current: impl Fn(f64) -> f64, unknown: impl Fn(f64) -> f64) -> String {
    let mut text = String::from("t,counts_large,current\n");
    let (mut angle, mut omega) = (0.0_f64, 0.0_f64);
    const FINE: u32 = 50;
    let step = 1e-3 / f64::from(FINE);
    for k in 0..20_000 {
        let t = f64::from(k) * 1e-3;
        let held = current(t);
        let count = (angle * 4096.0 / std::f64::consts::TAU).floor();
        text += &format!("{t},{count},{held}\n");
        for j in 0..FINE {
            let now = t + f64::from(j) * step;
            let drive = TORQUE_CONSTANT * held + LOAD + unknown(now) - DAMPING * omega;
            let friction = if omega == 0.0 {
                drive.clamp(-FRICTION, FRICTION)
            } else {
                FRICTION.copysign(omega)
            };
            let next = omega + (drive - friction) / INERTIA * step;
            omega = if next * omega < 0.0 { 0.0 } else { next };
            angle += omega * step;
        }
    }
    text
}

fn back_and_forth(t: f64) -> f64 {
    0.5 * (3.0 * t).sin() + 0.3 * (8.3 * t).sin() + 0.2 * (21.0 * t).sin()
}

fn ratio(json: &str, name: &str) -> [f64; 2] {
    let json: serde_json::Value = serde_json::from_str(json).unwrap();
    let ratios = json["ratios"].as_array().unwrap();
    let row = ratios.iter().find(|row| row["name"] == name).unwrap();
    ["value", "half_width_95"].map(|key| row[key].as_f64().unwrap())
}

/// The value is within two half-widths of the truth, and its half-width below `widest` of it.
fn assert_near(json: &str, name: &str, truth: f64, widest: f64) {
    let [value, half] = ratio(json, name);
    let away = (value - truth).abs();
    assert!(
        away < 2.0 * half + 2e-3 * truth.abs(),
        "{name}: {value} +-{half}, {truth}"
    );
    assert!(
        half < widest * truth.abs(),
        "{name}: {value} +-{half}, {truth}"
    );
}

#[test]
fn ratios_of_ordinary_motion_are_those_of_the_motor() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log(back_and_forth, |_| 0.0));
    let json = folder.good(&[&CLAMPED[..], &["--json", "-"]].concat());
    let per_a = TORQUE_CONSTANT / INERTIA;
    assert_near(&json, "torque constant / inertia", per_a, 0.02);
    assert_near(&json, "damping / inertia", DAMPING / INERTIA, 0.1);
    assert_near(&json, "friction / inertia", FRICTION / INERTIA, 0.1);
    assert_near(&json, "constant torque / inertia", LOAD / INERTIA, 0.1);

    // The device's own simulated motion.
    for simulated in [
        "simulate --scenario track --rate 1000 --seconds 5 --out log.csv",
        "simulate --scene free-air --hand moving --every 10 --seconds 8 --out log.csv",
    ] {
        folder.good(simulated);
        let json = folder.good(&["identify", "log.csv", "--json", "-"]);
        assert_near(&json, "torque constant / inertia", 46.8e-3 / 115e-7, 0.02);
    }
}

#[test]
fn motion_one_way_determines_friction_only_with_a_constant_torque() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log(|t| 0.7 + 0.5 * back_and_forth(t), |_| 0.0));
    let table = folder.good(&CLAMPED);
    assert!(
        table.contains("large.coulomb_nm                         -  mN.m"),
        "{table}"
    );
    let table: Vec<_> = table.split_whitespace().collect();
    let said = "friction and a constant torque cannot be told apart; record both directions";
    assert!(table.join(" ").contains(said), "{table:?}");
    let json = folder.good(&[&CLAMPED[..], &["--json", "-"]].concat());
    let both = (FRICTION - LOAD) / INERTIA;
    assert_near(&json, "friction less constant torque, / inertia", both, 0.3);
    assert_near(
        &json,
        "torque constant / inertia",
        TORQUE_CONSTANT / INERTIA,
        0.05,
    );
}

#[test]
fn unknown_torque_is_reported_and_no_value_is_written() {
    let folder = Folder::new(HOST_SIM);
    // A fifth of the motor's torque comes from elsewhere.
    let unknown = |t: f64| 4.5e-3 * (31.0 * t + 2.0 * (5.0 * t).sin()).sin();
    folder.write("log.csv", log(back_and_forth, unknown));
    let table = folder.good(&CLAMPED);
    let said = "not identified: large.inertia_kg_m2: 1";
    assert!(
        table.contains(said) && table.contains("torque is unexplained"),
        "{table}"
    );
    let line = folder.refused(&[&CLAMPED[..], &["--out", "new.toml"]].concat());
    assert!(
        line.contains("--out new.toml: no constant is identified: "),
        "{line}"
    );
    // Most of it.
    folder.write("log.csv", log(back_and_forth, |t| 8.0 * unknown(t)));
    let line = folder.refused(&CLAMPED);
    assert!(
        line.contains("no hand or contact touched the shaft") && line.contains("(limit 30 %)"),
        "{line}"
    );
}

#[test]
fn logs_that_tell_nothing_are_refused_for_their_reason() {
    let folder = Folder::new(HOST_SIM);
    let milliamps = |t| (1e3 * back_and_forth(t)).round();
    folder.write("log.csv", log(back_and_forth, |_| 0.0));
    let recorded = folder.text("log.csv");
    let rows = recorded.lines().skip(1).enumerate();
    let rows = rows.map(|(k, line)| {
        let (before, _) = line.rsplit_once(',').unwrap();
        format!("{before},{}\n", milliamps(k as f64 * 1e-3))
    });
    let rows: String = rows.collect();
    folder.write("log.csv", format!("t,counts_large,current\n{rows}"));
    let line = folder.refused(&CLAMPED);
    assert!(
        line.contains("give --column 'current=current:mA'"),
        "{line}"
    );
    folder.good(&[&CLAMPED[..], &["--column", "current=current:mA"]].concat());

    // The option names the column of the log.
    let named = |name: &str| format!("t,counts_large,{name}\n{rows}");
    folder.write("log.csv", named("current_mA"));
    let line = folder.refused(&CLAMPED);
    let said = "no column current; torques cannot be identified from counts alone: name it, for example \
                --column 'current=current_mA'";
    assert!(line.contains(said), "{line}");
    // Also where the handle is not known.
    let line = folder.refused("identify log.csv");
    assert!(line.contains(said), "{line}");
    folder.good(&[&CLAMPED[..], &["--column", "current=current_mA"]].concat());
    let line = folder.refused(&[&CLAMPED[..], &["--column", "current=current_mA:A"]].concat());
    assert!(
        line.contains("give --column 'current=current_mA:mA'"),
        "{line}"
    );

    let steady = |k: u32| format!("{},{},0.5\n", f64::from(k) * 1e-3, 7 * k);
    let rows: String = (0..8000).map(steady).collect();
    folder.write("log.csv", format!("t,counts_large,current\n{rows}"));
    let line = folder.refused(&CLAMPED);
    assert!(line.contains("the velocity is constant"), "{line}");
}

/// A current that changes its sign in every row, one that is hardly there, and that of a moment.
#[test]
fn current_that_does_not_drive_the_motion_is_told() {
    let folder = Folder::new(HOST_SIM);
    let swing = |k: u32| (3e3 * (2e-3 * f64::from(k)).sin()).floor();
    let alternating = |k: u32| if k.is_multiple_of(2) { 0.5 } else { -0.5 };
    for current in [alternating, |_| 1e-300, |k| if k < 10 { 0.5 } else { 0.0 }] {
        let row = |k: u32| format!("{}e-3,{},{}\n", k, swing(k), current(k));
        let rows: String = (0..8000).map(row).collect();
        folder.write("log.csv", format!("t,counts_large,current\n{rows}"));
        let line = folder.refused(&CLAMPED);
        let said = "log.csv: the motion does not follow column current: ";
        assert!(line.contains(said), "{line}");
    }
}

#[test]
fn handle_is_doubted_with_the_motor_whose_torque_is_unexplained() {
    let folder = Folder::new(HOST_SIM);
    folder.good("simulate --hand nobody --every 10 --out free.csv");
    // The log lacks a part of the large motor's current, 20 mA, and has that of the small motor.
    let text = folder.text("free.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    assert!(header.starts_with("t,counts_large,counts_small,current,"));
    let mut log = format!("{header}\n");
    for row in rows.lines() {
        let mut fields: Vec<_> = row.split(',').map(str::to_owned).collect();
        let [t, current] = [0, 3].map(|k: usize| fields[k].parse::<f64>().unwrap());
        fields[3] = (current + 0.02 * (31.0 * t + 2.0 * (5.0 * t).sin()).sin()).to_string();
        log += &(fields.join(",") + "\n");
    }
    folder.write("log.csv", log);
    // With a known damping the intervals of the handle do not depend on the large motor.
    let known = "identify log.csv --known coupler.damping_nms_per_rad=9.6e-4";
    let table = folder.good(known);
    for key in ["small.torque_constant_nm_per_a", "small.inertia_kg_m2"] {
        let lines = table.split(&format!("not identified: {key}: ")).nth(1);
        let said = lines.and_then(|lines| lines.split("not identified").next());
        let said: Vec<_> = said.unwrap_or_default().split_whitespace().collect();
        let said = said.join(" ");
        assert!(
            said.contains("of the motor's torque is unexplained"),
            "{key}: {table}"
        );
    }
    let line = folder.refused(&format!("{known} --out new.toml"));
    assert!(line.contains("no constant is identified: "), "{line}");
    assert!(!folder.path().join("new.toml").exists());
}

#[test]
fn device_file_is_kept_where_another_output_fails() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log(back_and_forth, |_| 0.0));
    let mine = "large.counts_per_rev = 4096\n";
    folder.write("mine.toml", mine);
    let command = "identify log.csv --clamped --device mine.toml --out mine.toml --json /dev/full";
    let output = folder.run(command);
    assert!(!output.status.success(), "{output:?}");
    assert_eq!(folder.text("mine.toml"), mine);
}
