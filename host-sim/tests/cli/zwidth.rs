//! Z-width as somebody asks for it, and whether its bounds are bounds.

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use estimator_core::Hertz;
use experiments::zwidth::{
    Boundary, LoopSetup, STIFFNESS, Settings, bound, boundaries, contact_test,
};
use simulation::device::Device;

use crate::{Folder, HOST_SIM};

fn case(name: &str, rate_hz: f64, lines: u32) -> LoopSetup {
    let kind = Kind::named(name).unwrap();
    LoopSetup {
        large: kind,
        handle: kind,
        rate_hz,
        lines,
        exact: false,
    }
}

fn settings(seed: u64) -> Settings {
    Settings {
        device: Device::default(),
        parameters: Parameters::default(),
        seed,
    }
}

fn found(cases: &[LoopSetup]) -> Vec<Boundary> {
    boundaries(cases, &settings(1), &|| ()).unwrap()
}

#[test]
fn z_width_is_smaller_at_a_slow_rate_and_with_a_coarse_encoder() {
    let [fine, slow, coarse] = [
        case("pll", 10e3, 1024),
        case("pll", 1e3, 1024),
        case("pll", 1e3, 256),
    ];
    // Sums over seeds, which draw the phases of the encoders.
    let mut plain = [0.0; 3];
    for seed in 1..=4 {
        let found = boundaries(&[fine, slow, coarse], &settings(seed), &|| ()).unwrap();
        for (sum, boundary) in plain.iter_mut().zip(found) {
            *sum += boundary.walls[0].1.value;
        }
    }
    // Twice as stiff at ten times the rate; half of what a count is worth counts, in any wall.
    assert!(plain[0] > 2.0 * plain[1], "{plain:?}");
    assert!(plain[1] > 0.6 && plain[2] < 0.8 * plain[1], "{plain:?}");
}

#[test]
fn largest_stiffness_rises_and_falls_with_damping() {
    let boundary = &found(&[case("foaw-best-fit", 1e3, 1024)])[0];
    let plain = boundary.walls[0].1.value;
    let (damping, best) = boundary.stiffest().unwrap();
    assert!(damping > 0.0 && best.value > 1.1 * plain, "{boundary:?}");
    assert!(boundary.viscous.value > damping, "{boundary:?}");
}

/// With the true velocity the undamped wall is limited by its delay of half a tick and the lag of the
/// amplifier: as a damping of `-K (T / 2 + τa)`, against that of the coupler, which is not compensated right after a
/// reversal. The coupler's is smaller below 60 Hz, where the large motor follows in part, and is compensated on the way
/// into the wall, so that the bound is below the condition.
#[test]
fn undamped_wall_with_the_true_velocity_is_limited_by_its_delay() {
    for (rate_hz, amplifier_hz) in [(1e3, 2000.0), (1e3, 500.0), (2e3, 2000.0)] {
        let mut settings = settings(0);
        settings.device.stages.amplifier_bandwidth = Hertz(amplifier_hz);
        let stages = settings.device.stages;
        let wanted = stages.damping / (0.5 / rate_hz + stages.amplifier_lag());
        let case = LoopSetup {
            exact: true,
            ..case("kalman-triple", rate_hz, 1024)
        };
        let found = [1, 2, 3, 4, 5, 6].map(|seed| {
            settings.seed = seed;
            let contact_test = contact_test(&case, &settings).unwrap();
            let found = bound(STIFFNESS, |k| contact_test.violation(k, 0.0));
            found.unwrap().value
        });
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        println!("{rate_hz} Hz, amplifier {amplifier_hz} Hz: {mean}, derived {wanted}");
        assert!(
            (0.7..1.1).contains(&(mean / wanted)),
            "{rate_hz} Hz, amplifier {amplifier_hz} Hz: {found:?}, derived {wanted}"
        );
    }
}

/// Bisection takes for granted that everything below a bound is good and nothing beyond it. Close
/// to the bound that is not quite so: chance decides what the encoders' phases make of it. Far
/// beyond and far below it is.
#[test]
fn values_below_a_bound_pass_and_values_beyond_fail() {
    let (mut tried, mut strange) = (0, Vec::new());
    for (name, rate_hz) in [("kalman-triple", 1e3), ("pll", 10e3)] {
        let case = case(name, rate_hz, 1024);
        let boundary = &found(&[case])[0];
        let contact_test = contact_test(&case, &settings(1)).unwrap();
        for &(damping, wall) in &boundary.walls {
            assert!(wall.value > 0.0, "{boundary:?}");
            for part in [0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.7, 2.5, 4.0, 8.0] {
                let is_good = contact_test
                    .violation(part * wall.value, damping)
                    .unwrap()
                    .is_none();
                tried += 1;
                if is_good != (part < 1.0) {
                    assert!((0.6..2.0).contains(&part), "{name}: {part} of {wall:?}");
                    strange.push((name, part, damping, wall.value));
                }
            }
        }
    }
    assert!(strange.len() * 10 <= tried, "of {tried}: {strange:?}");
}

const SHORT: [&str; 7] = [
    "zwidth",
    "--estimator",
    "kalman-motor",
    "--rate",
    "1000",
    "--lines",
    "1024",
];

#[test]
fn json_is_alone_on_standard_output_and_reproducible() {
    let folder = Folder::new(HOST_SIM);
    let mut arguments = SHORT.to_vec();
    arguments.extend(["--json", "-"]);
    let output = folder.run(&arguments);
    assert_eq!(output.status.code(), Some(0));
    assert!(folder.names().is_empty(), "no page unless it is asked for");
    let rows: Vec<serde_json::Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows.len(), 6);
    for row in &rows {
        assert_eq!(row["estimator"], "kalman-motor");
        // It reads the large motor's current: on the handle another one stands in.
        assert_eq!(row["handle_estimator"], "kalman-triple");
        assert_eq!(
            (&row["rate_hz"], &row["lines"]),
            (&1000.0.into(), &1024.into())
        );
        assert_eq!((&row["seed"], &row["at_cap"]), (&1.into(), &false.into()));
        for field in ["stiffness_nm_per_rad", "damping_nms_per_rad"] {
            assert!(row[field].as_f64().is_some_and(|x| x >= 0.0), "{row}");
        }
        let fault = row["fault"].as_str().unwrap();
        assert!(
            ["limit cycle", "energy", "stopped"].contains(&fault),
            "{row}"
        );
        assert!(["hand", "light grip", "throw"].contains(&row["touch"].as_str().unwrap()));
    }
    let bounds: Vec<_> = rows
        .iter()
        .map(|row| row["bound"].as_str().unwrap())
        .collect();
    assert_eq!(bounds[..5], ["stiffness"; 5]);
    assert_eq!(
        (bounds[5], &rows[5]["stiffness_nm_per_rad"]),
        ("damping", &0.0.into())
    );
    assert_eq!(folder.run(&arguments).stdout, output.stdout);
}

#[test]
fn encoder_of_a_device_file_is_the_default() {
    let folder = Folder::new(HOST_SIM);
    folder.write("mine.toml", "[large]\ncounts_per_rev = 1026\n");
    let command = "zwidth --device mine.toml --estimator low-pass --rate 1000 --shard 1/1 --out";
    let lines = |more: &str| {
        let (_, errors) = folder.ends(0, &format!("{command} {} {more}", "parts"));
        let heading = folder.text("parts/shard-1-of-1.jsonl");
        let heading = heading.lines().next().unwrap();
        let heading: serde_json::Value = serde_json::from_str(heading).unwrap();
        (heading["settings"]["lines"].to_string(), errors)
    };
    let (own, errors) = lines("");
    assert_eq!(own, "[256]");
    assert!(
        errors.contains(
            "large.counts_per_rev = 1026 is no whole number of lines; 256 lines, 1024 counts"
        ),
        "{errors}"
    );
    let (given, errors) = lines("--lines 512");
    assert_eq!((given.as_str(), errors.as_str()), ("[512]", ""));
}

#[test]
fn page_has_figures_and_table() {
    let folder = Folder::new(HOST_SIM);
    let mut arguments = SHORT.to_vec();
    arguments.extend(["--out", "z"]);
    let output = folder.run(&arguments);
    assert_eq!(output.status.code(), Some(0));
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table.contains("1000 Hz, large encoder of 1024 lines"),
        "{table}"
    );
    assert!(table.contains("  kalman-motor "), "{table}");
    let read = |name| std::fs::read_to_string(folder.path().join("z").join(name)).unwrap();
    assert!(read("index.html").contains(read("figures/01.svg").as_str()));
    let csv = read("zwidth.csv");
    assert!(
        csv.starts_with("estimator,handle_estimator,rate_hz,lines,"),
        "{csv}"
    );
    assert_eq!(csv.lines().count(), 7);
    assert!(read("zwidth.json").starts_with('['));
}

#[test]
fn invalid_arguments_are_refused_in_one_line_and_write_nothing() {
    let folder = Folder::new(HOST_SIM);
    for (arguments, said) in [
        (&["--estimator", "kalmann"][..], "no estimator 'kalmann'"),
        (&["--handle", "pl"], "no estimator 'pl'"),
        (
            &["--handle-estimator", "m-over-t"],
            "m-over-t: needs edge time stamps, which the closed loop does not have",
        ),
        (
            &["--handle-estimator", "adaptive"],
            "--handle-estimator adaptive: it models the large motor, not the handle",
        ),
        (&["--rate", "50"], "--rate 50: a closed loop needs a"),
        (
            &["--rate", "599", "--lines", "1024"],
            "--rate 599: a closed loop needs a control rate of 600 to 100000 Hz",
        ),
        (
            &["--lines", "3"],
            "'--lines <N>': must be from 4 to 1000000",
        ),
        (&["--lines", "many"], "--lines"),
        (&["--set", "pll.bandwidth=1"], "no parameter 'bandwidth'"),
        (&["--device", "none.toml"], "none.toml: cannot read"),
        (&["--seconds", "1"], "--seconds"),
    ] {
        let error = folder.refused(&[&["zwidth"], arguments].concat());
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
}
