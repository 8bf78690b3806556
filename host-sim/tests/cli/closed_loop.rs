//! `host-sim compare --closed-loop`.

use haptic_control::SceneKind;
use serde_json::Value;

use crate::{Folder, HOST_SIM};

fn good(arguments: &[&str]) -> String {
    Folder::new(HOST_SIM).good(arguments)
}

fn rows(arguments: &[&str]) -> Vec<Value> {
    let mut all = vec!["compare", "--closed-loop", "--json", "-"];
    all.extend(arguments);
    serde_json::from_str(&good(&all)).unwrap()
}

fn number(row: &Value, field: &str) -> f64 {
    let value = row[field].as_f64();
    value.unwrap_or_else(|| panic!("{field} of {row}"))
}

fn page_of(folder: &Folder, arguments: &[&str]) -> String {
    let mut all = vec!["compare", "--out", "page"];
    all.extend(arguments);
    folder.good(&all);
    folder.text("page/index.html")
}

const TWO: [&str; 8] = [
    "--estimator",
    "finite-difference",
    "--estimator",
    "kalman-triple-steady",
    "--rate",
    "1000",
    "--seconds",
    "1",
];

#[test]
fn json_has_the_contracts_fields_and_the_reference_loop_differs() {
    let mut arguments = TWO.to_vec();
    arguments.extend(["--scene", "free-air"]);
    let rows = rows(&arguments);
    let who: Vec<_> = rows
        .iter()
        .map(|row| [&row["estimator"], &row["controlled_by"]].map(|v| v.as_str().unwrap()))
        .collect();
    let (difference, kalman) = ("finite-difference", "kalman-triple-steady");
    assert_eq!(
        who,
        [
            [difference, difference],
            [kalman, kalman],
            [difference, "reference"],
            [kalman, "reference"],
        ]
    );
    for row in &rows {
        assert_eq!(row["scenario"], "free-air");
        assert_eq!(row["rate_hz"], 1000.0);
        assert_eq!(row["plant"], "friction");
        assert_eq!(row["seed"], 1);
        assert_eq!(row["handle_estimator"], kalman);
        assert!(row.get("stopped").is_some_and(Value::is_null));
        for field in [
            "parasitic_mn_rms",
            "parasitic_mn_p99",
            "parasitic_mn_tactile",
            "rms_rad_s",
            "max_rad_s",
            "distance_rad_s",
            "distance_pct",
            "rms_pct",
            "outside",
            "noise_rad_s",
            "chatter_rad_s",
            "force_mn",
        ] {
            let value = number(row, field);
            assert!(value >= 0.0 && value.is_finite(), "{field}: {value}");
        }
        assert!((0.0..=1.0).contains(&number(row, "below_threshold")));
        assert!(number(row, "parasitic_mn_p99") > number(row, "parasitic_mn_rms"));
    }
    let rms = |i: usize| number(&rows[i], "parasitic_mn_rms");
    assert_eq!(rms(2), rms(3), "who watches changes nothing");
    assert!(rms(2) != rms(0) && rms(2) != rms(1));
    for i in [0, 2] {
        assert_eq!(number(&rows[i], "rms_pct"), 100.0);
    }
    assert!(number(&rows[1], "rms_pct") < 60.0);
}

#[test]
fn output_is_reproducible_and_depends_on_seed_handle_and_friction() {
    let mut arguments = vec!["compare", "--closed-loop", "--json", "-"];
    arguments.extend(TWO);
    arguments.extend(["--scenario", "wall"]);
    let one = good(&arguments);
    assert_eq!(one, good(&arguments));
    for more in [
        &["--seed", "2"][..],
        &["--handle-estimator", "finite-difference"],
        &["--frictionless"],
        &["--set", "kalman-triple-steady.jerk=100"],
    ] {
        let mut other = arguments.clone();
        other.extend(more);
        assert_ne!(one, good(&other), "{more:?}");
    }
}

#[test]
fn every_scene_runs_and_scenes_without_the_large_motor_do_not_depend_on_the_estimator() {
    let rows = rows(&TWO);
    for scene in SceneKind::environments() {
        let of_scene = rows.iter().filter(|row| row["scenario"] == scene.name());
        let rms: Vec<f64> = of_scene
            .map(|row| number(row, "parasitic_mn_rms"))
            .collect();
        assert_eq!(rms.len(), 4, "{scene}");
        let alike = rms.iter().all(|value| *value == rms[0]);
        assert_eq!(alike, !scene.facts().needs.continuous, "{scene}: {rms:?}");
    }
}

#[test]
fn better_velocity_gives_less_parasitic_force_at_a_high_rate() {
    let mut arguments = TWO[..4].to_vec();
    arguments.extend(["--rate", "11600", "--seconds", "2"]);
    arguments.extend(["--scene", "free-air", "--scene", "wall"]);
    let rows = rows(&arguments);
    assert_eq!(rows.len(), 8);
    // Half of the estimate's error reaches the fingertip at once, beside friction and inertia.
    for scene in rows.chunks(4) {
        let rms = |i: usize| number(&scene[i], "parasitic_mn_rms");
        let below = |i: usize| number(&scene[i], "below_threshold");
        assert!(
            rms(1) < 0.6 * rms(0),
            "{}: {}, {}",
            scene[0]["scenario"],
            rms(1),
            rms(0)
        );
        assert!(below(1) > below(0) + 0.3, "{}", scene[0]["scenario"]);
        // The reference is the best there can be, give or take the run.
        assert!(rms(2) < 1.05 * rms(1), "{}", scene[0]["scenario"]);
    }
}

#[test]
fn invalid_arguments_are_refused_with_one_line() {
    let folder = Folder::new(HOST_SIM);
    for (arguments, said) in [
        (
            &["--closed-loop", "--scenario", "step"][..],
            "'step' cannot close a loop",
        ),
        (
            &["--closed-loop", "--scene", "wal"],
            "no scene 'wal'; did you mean wall? there are off",
        ),
        (&["--closed-loop", "--estimator", "kalman"], "kalman-triple"),
        (
            &["--closed-loop", "--rate", "100"],
            "--rate 100: a closed loop needs a control rate of 600 to 100000 Hz",
        ),
        (&["--closed-loop", "--rate", "0"], "rate"),
        (&["--closed-loop", "--seconds", "0"], "duration 0 s"),
        (
            &["--closed-loop", "--seconds", "0.1"],
            "scores begin after 0.1 s",
        ),
        (
            &[
                "--closed-loop",
                "--scene",
                "inertia",
                "--handle-estimator",
                "pll",
            ],
            "provides no acceleration",
        ),
        (
            &["--closed-loop", "--handle-estimator", "kalman-motor"],
            "not the handle",
        ),
        (
            &["--closed-loop", "--handle-estimator", "eye"],
            "no estimator 'eye'",
        ),
        (&["--handle-estimator", "pll"], "--closed-loop"),
        (&["--scenario", "viscous"], "viscous"),
    ] {
        let mut all = vec!["compare"];
        all.extend(arguments);
        let line = folder.refused(&all);
        assert!(line.contains(said), "{arguments:?}: {line}");
    }
}

const FIGURES: [&str; 12] = [
    "Time in which the parasitic force is below",
    "Parasitic force in free air by motion of the handle",
    "Spectrum of the parasitic force in free air",
    "Commanded and felt force at the fingertip, scene wall",
    "Commanded and felt force at the fingertip, scene texture",
    "Frequency response of the rendered torque",
    "Open loop of the large motor",
    "RMS parasitic force in closed loop, scene free-air",
    "Margins of the velocity loop",
    "Torque rendered into a clamped handle",
    "1 kHz, plant with friction, loop closed",
    "Velocity estimators compared",
];

fn assert_sound(page: &str) {
    let outside_script = page.split("<script>").next().unwrap();
    for bad in ["NaN", "inf ", "inf,", "\"inf", "not a number"] {
        assert!(!outside_script.contains(bad), "{bad}");
    }
}

#[test]
fn report_has_all_figures_and_only_finite_numbers() {
    let folder = Folder::new(HOST_SIM);
    let mut arguments = TWO.to_vec();
    arguments.push("--closed-loop");
    let page = page_of(&folder, &arguments);
    for text in FIGURES {
        assert!(page.contains(text), "{text}");
    }
    assert_sound(&page);
    let csv = folder.text("page/closed-loop.csv");
    assert_eq!(
        csv.lines().count(),
        1 + 4 * SceneKind::environments().count()
    );
    assert!(csv.starts_with("scenario,rate_hz,plant,seed,estimator,rms_rad_s,"));
    // Too short for most figures, and still a page.
    let short = page_of(
        &folder,
        &[
            "--closed-loop",
            "--seconds",
            "0.15",
            "--rate",
            "1000",
            "--estimator",
            "pll",
        ],
    );
    assert!(short.contains("Closed-loop scores"));
    assert_sound(&short);
}

#[test]
fn full_comparison_includes_the_closed_loop_and_one_of_a_scenario_does_not() {
    let folder = Folder::new(HOST_SIM);
    let page = page_of(&folder, &TWO);
    assert!(page.contains("figure 8)") && page.contains(FIGURES[1]));
    let mut named = TWO.to_vec();
    named.extend(["--scenario", "step"]);
    assert!(!page_of(&folder, &named).contains(FIGURES[0]));
    // At 200 Hz no loop can be designed: compared all the same, and said.
    let slow = page_of(
        &folder,
        &["--rate", "200", "--seconds", "1", "--estimator", "pll"],
    );
    assert!(slow.contains("The closed loop was not simulated: --rate 200: a closed loop"));
    assert!(slow.contains("figure 8)") && !slow.contains(FIGURES[0]));
}
