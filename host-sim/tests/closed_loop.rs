//! The closed loop as somebody asks for it on the command line, and what its scores promise.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use haptic_control::LoopPoles;
use host_sim::closed_loop::{Eye, Hand, Loop, SceneName, believed, estimator};
use host_sim::device::Device;
use host_sim::estimators::Kind;
use host_sim::felt::{Case, Fingertip, Parasitic, Settings, bandwidth_hz, compare, sweep};
use host_sim::parameters::{Parameters, PlantKind};
use host_sim::score::Wanted;
use serde_json::Value;

fn host_sim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(arguments)
        .current_dir(std::env::temp_dir())
        .output()
        .unwrap()
}

fn good(arguments: &[&str]) -> String {
    let output = host_sim(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).unwrap()
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

/// A folder of its own for each test, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        Self(std::env::temp_dir().join(format!("limpid-loop-{test}-{}", std::process::id())))
    }

    fn page(&self, arguments: &[&str]) -> String {
        let mut all = vec!["compare", "--out", self.0.to_str().unwrap()];
        all.extend(arguments);
        good(&all);
        fs::read_to_string(self.0.join("index.html")).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
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
fn json_is_the_contract_and_the_reference_closes_another_loop() {
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
fn the_same_command_gives_the_same_bytes_and_seed_handle_and_friction_count() {
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
fn every_scene_runs_and_those_of_the_small_motor_alone_are_the_same_for_all() {
    let rows = rows(&TWO);
    for scene in SceneName::ALL {
        let of_scene = rows.iter().filter(|row| row["scenario"] == scene.as_str());
        let rms: Vec<f64> = of_scene
            .map(|row| number(row, "parasitic_mn_rms"))
            .collect();
        assert_eq!(rms.len(), 4, "{scene}");
        let alike = rms.iter().all(|value| *value == rms[0]);
        assert_eq!(alike, !scene.asks_for_velocity(), "{scene}: {rms:?}");
    }
}

#[test]
fn better_velocity_is_less_force_at_a_high_rate() {
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
fn bad_words_are_refused_with_one_line() {
    for (arguments, said) in [
        (
            &["--closed-loop", "--scenario", "step"][..],
            "'step' cannot close a loop",
        ),
        (
            &["--closed-loop", "--scene", "wal"],
            "no scene 'wal'; there are off",
        ),
        (&["--closed-loop", "--estimator", "kalman"], "kalman-triple"),
        (&["--closed-loop", "--rate", "100"], "control at 100 Hz"),
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
            "gives no acceleration",
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
        let output = host_sim(&all);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{arguments:?}: {errors}");
        assert!(errors.contains(said), "{arguments:?}: {errors}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}

const FIGURES: [&str; 12] = [
    "Time in which the parasitic force is below",
    "What is felt of the device in free air",
    "Spectrum of the parasitic force in free air",
    "Force wanted and felt at the fingertip, scene wall",
    "Force wanted and felt at the fingertip, scene texture",
    "Torque felt over torque wanted",
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
fn the_report_has_the_figures_and_no_broken_number() {
    let folder = Folder::new("report");
    let mut arguments = TWO.to_vec();
    arguments.push("--closed-loop");
    let page = folder.page(&arguments);
    for text in FIGURES {
        assert!(page.contains(text), "{text}");
    }
    assert_sound(&page);
    let csv = fs::read_to_string(folder.0.join("closed-loop.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 4 * SceneName::ALL.len());
    assert!(csv.starts_with("scenario,rate_hz,plant,seed,estimator,controlled_by,"));
    // Too short for most figures, and still a page.
    let short = folder.page(&[
        "--closed-loop",
        "--seconds",
        "0.15",
        "--rate",
        "1000",
        "--estimator",
        "pll",
    ]);
    assert!(short.contains("Closed-loop scores"));
    assert_sound(&short);
}

#[test]
fn a_whole_comparison_closes_the_loop_beside_and_a_named_scenario_does_not() {
    let folder = Folder::new("beside");
    let page = folder.page(&TWO);
    assert!(page.contains("Figure 8.") && page.contains(FIGURES[1]));
    let mut named = TWO.to_vec();
    named.extend(["--scenario", "step"]);
    assert!(!folder.page(&named).contains(FIGURES[0]));
    // At 200 Hz no loop can be designed: compared all the same, and said.
    let slow = folder.page(&["--rate", "200", "--seconds", "1", "--estimator", "pll"]);
    assert!(slow.contains("The loop was not closed: control at 200 Hz"));
    assert!(slow.contains("Figure 8.") && !slow.contains(FIGURES[0]));
}

fn settings(names: &[&str]) -> Settings {
    Settings {
        device: Device::default(),
        estimators: names
            .iter()
            .map(|name| Kind::named(name).unwrap())
            .collect(),
        handle: Kind::named("kalman-triple-steady").unwrap(),
        parameters: Parameters::default(),
        wanted: Wanted::ALL,
    }
}

#[test]
fn parasitic_is_felt_less_wanted_at_the_fingertip() {
    let case = Case {
        scene: SceneName::Wall(0.30, 0.0),
        rate_hz: 1000.0,
        plant: PlantKind::Friction,
        seed: 3,
        seconds: 1.5,
        keep: true,
    };
    let outcomes = compare(&[case], &settings(&["pll"]), || ()).unwrap();
    let fingertip = Fingertip::new(&Device::default());
    for run in &outcomes[0].runs {
        let signals = run.signals.as_ref().unwrap();
        let pushed = signals.wanted_mn.iter().copied().fold(0.0, f32::min);
        assert!(pushed < -300.0, "the hand is in the wall: {pushed} mN");
        let forces = signals.felt_mn.iter().zip(&signals.wanted_mn);
        let parasitic: Vec<f64> = forces
            .map(|(felt, wanted)| f64::from(felt - wanted))
            .collect();
        let again = Parasitic::of(&parasitic, 1000.0, &fingertip);
        let rms = |score: &Parasitic| score.parasitic_mn_rms.unwrap();
        assert!((rms(&again) / rms(&run.parasitic) - 1.0).abs() < 1e-3);
        assert!(rms(&again) < 30.0, "felt is what was wanted, nearly");
    }
}

#[test]
fn off_has_no_current_and_only_scenes_with_a_loop_know_the_large_motor_s_velocity() {
    let (device, parameters, rate_hz) = (Device::default(), Parameters::default(), 1000.0);
    let kind = Kind::named("kalman-triple-steady").unwrap();
    let on = |counts| estimator(kind, &device, counts, rate_hz, &parameters).unwrap();
    for scene in SceneName::ALL {
        let run = Loop {
            device: device.clone(),
            believed: believed(&device),
            scene,
            hand: Hand::Moving,
            rate_hz,
            seed: 1,
            large: on(device.large.counts_per_rev),
            handle: on(device.small.counts_per_rev),
            eye: Eye::Large,
            poles: LoopPoles::DEFAULT,
            late_ticks: 0,
        };
        let (mut driven, mut known, mut counted) = (false, false, false);
        run.run(500, |moment| {
            let currents = moment.action.currents;
            driven |= currents.large.get() != 0.0 || currents.small.get() != 0.0;
            known |= moment.action.large.0 != 0.0;
            counted |= moment.own_count != moment.sample.large;
        })
        .unwrap();
        assert_eq!(driven, scene != SceneName::Off, "{scene}");
        assert_eq!(known, scene.asks_for_velocity(), "{scene}");
        assert!(!counted, "the loop sees the device's own encoder");
    }
}

#[test]
fn torque_is_rendered_flat_up_to_the_amplifiers() {
    let swept = sweep(
        &settings(&["finite-difference"]),
        10e3,
        PlantKind::Frictionless,
    )
    .unwrap();
    let (name, responses) = &swept.runs[1];
    assert_eq!((*name, responses[0].hz), ("reference", 2.0));
    for response in responses {
        assert!(
            (0.0..=1.0 + 1e-9).contains(&response.coherence),
            "{response:?}"
        );
        if response.hz < 10.0 {
            assert!((response.gain - 1.0).abs() < 0.03, "{response:?}");
            assert!(response.phase_deg.abs() < 3.0, "{response:?}");
        }
    }
    // An amplifier of 2 kHz, a tick of delay in the large motor's part, half a tick of holding.
    let bandwidth = bandwidth_hz(responses).unwrap();
    assert!((1400.0..2100.0).contains(&bandwidth), "{bandwidth}");
    let (_, difference) = &swept.runs[0];
    let least =
        |of: &[host_sim::felt::Response]| of.iter().map(|r| r.coherence).fold(1.0, f64::min);
    assert!(least(difference) < least(responses));
}

/// The inertia that a hand feels: felt torque against the handle's acceleration, least squares.
fn felt_inertia(scene: SceneName) -> f64 {
    let (device, parameters, rate_hz) = (Device::default(), Parameters::default(), 10e3);
    let kind = Kind::named("kalman-triple-steady").unwrap();
    let on = |counts| estimator(kind, &device, counts, rate_hz, &parameters).unwrap();
    let run = Loop {
        believed: believed(&device),
        scene,
        hand: Hand::Moving,
        rate_hz,
        seed: 1,
        large: on(device.large.counts_per_rev),
        handle: on(device.small.counts_per_rev),
        eye: Eye::Large,
        poles: LoopPoles::DEFAULT,
        late_ticks: 0,
        device,
    };
    let (mut products, mut squares) = (0.0, 0.0);
    run.run(30_000, |now| {
        products -= now.felt * now.handle_acceleration;
        squares += now.handle_acceleration * now.handle_acceleration;
    })
    .unwrap();
    products / squares
}

#[test]
fn a_virtual_inertia_is_felt_and_a_negative_one_lightens_the_handle() {
    let own = Device::default().small.inertia_kg_m2;
    let [lighter, plain, heavier] =
        [-0.4, 0.0, 0.4].map(|part| felt_inertia(SceneName::Inertia(part)) / own);
    // The estimate is late, so that an added inertia arrives in part only.
    assert!((plain - 1.0).abs() < 0.1, "{plain}");
    assert!(
        (0.3..0.6).contains(&(plain - lighter)),
        "{lighter}, {plain}"
    );
    assert!(
        (0.1..0.5).contains(&(heavier - plain)),
        "{plain}, {heavier}"
    );
}
