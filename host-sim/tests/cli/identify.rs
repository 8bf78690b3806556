//! `host-sim identify`.

use simulation::device::Device;

use crate::{Folder, HOST_SIM};

fn words(arguments: &str) -> Vec<&str> {
    arguments.split_whitespace().collect()
}

#[test]
fn identify_replaces_only_the_identified_values_of_the_device_file() {
    let folder = Folder::new(HOST_SIM);
    let good = |arguments: &str| folder.good(&words(arguments));
    let truth = "[large]\ninertia_kg_m2 = 1.3e-5\n[coupler]\ndamping_nms_per_rad = 0.8e-3\n";
    folder.write("truth.toml", truth);
    let mine = "# mine\n[hand]\nstiffness_nm_per_rad = 0.4 # soft\n";
    folder.write("mine.toml", mine);
    good("simulate --device truth.toml --every 10 --out excite.csv");
    let command = "identify excite.csv --device mine.toml --out mine.toml --report page";
    let table = good(command);
    assert!(
        table.lines().all(|line| line.chars().count() <= 80),
        "{table}"
    );
    let line = |text: &str, start: &str| {
        let line = text.lines().find(|line| line.starts_with(start)).unwrap();
        line.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let inertia = line(&table, "large.inertia_kg_m2");
    // Both units: the key's and the table's.
    let [shown, file] = [1, 3].map(|field: usize| inertia[field].parse::<f64>().unwrap());
    assert_eq!(inertia[2], "g.cm2");
    assert!((file / (1e-7 * shown) - 1.0).abs() < 1e-4, "{inertia:?}");
    let table: Vec<_> = table.split_whitespace().collect();
    let table = table.join(" ");
    let page = folder.text("page/index.html");
    assert_eq!(page.matches("<figure>").count(), 2);
    for said in [
        "excite.csv: velocity of the large motor",
        "health: coupler",
        "95 % intervals",
    ] {
        assert!(page.contains(said), "{said}");
    }
    for said in [
        "health: coupler.damping_nms_per_rad: 0.833 of the file's 0.9600 mN.m.s/rad, -16.7 %, outside \
         its interval: the coupler is hot",
        "assumed: large.torque_constant_nm_per_a = 0.0468 is exact",
        "amplifier.bandwidth_hz - Hz",
        "not identified: amplifier.bandwidth_hz: rows 1 ms apart",
    ] {
        assert!(table.contains(said), "{said}\n{table}");
    }
    let text = folder.text("mine.toml");
    assert!(text.starts_with(mine), "{text}");
    assert!(
        !text.contains("bandwidth") && !text.contains("\ntorque_constant"),
        "{text}"
    );
    let device = Device::from_toml_str(&text).unwrap();
    assert!((device.stages.large.inertia / 1.3e-5 - 1.0).abs() < 0.01);
    assert!((device.stages.damping / 0.8e-3 - 1.0).abs() < 0.01);

    // The same recording again finds its own file right, and JSON is alone on standard output.
    let json = good("identify excite.csv --device mine.toml --json -");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let rows = json["quantities"].as_array().unwrap();
    let row = rows.iter().find(|row| row["key"] == "large.inertia_kg_m2");
    assert_eq!(row.unwrap()["file_inside"], true);

    assert_eq!(row.unwrap()["unit"], "kg.m2");
    let assumed = |json: &serde_json::Value| json["assumed"].to_string();
    assert!(!assumed(&json).contains("counts_per_rev"), "{json}");
    // Without a device file its encoders are assumed, and that is said.
    let said = "large.counts_per_rev = 4096 and small.counts_per_rev = 20000";
    let default = good("identify excite.csv --json -");
    assert!(
        assumed(&serde_json::from_str(&default).unwrap()).contains(said),
        "{default}"
    );
    let default = good("identify excite.csv");
    assert!(
        default.contains("assumed: large.counts_per_rev = 4096 and"),
        "{default}"
    );

    let default = words(&default).join(" ");
    assert!(
        default.contains("of the default device's 0.9600 mN.m.s/rad")
            && default.contains("the device differs")
            && !default.contains("the file"),
        "{default}"
    );
    // The option gives the counts of one encoder.
    let default = good("identify excite.csv --counts-per-rev 4096");
    let default = words(&default).join(" ");
    assert!(
        default.contains("assumed: small.counts_per_rev = 20000 of the default device")
            && !default.contains("large.counts_per_rev"),
        "{default}"
    );

    // An uneven clock is what is wrong, not the motion.
    let recorded = folder.text("excite.csv");
    let mut uneven = String::new();
    for (k, line) in recorded.lines().enumerate() {
        let Some((t, rest)) = line.split_once(',').filter(|_| k > 0) else {
            uneven += &format!("{line}\n");
            continue;
        };
        let late = if k % 4 == 0 { 120e-6 } else { 0.0 };
        uneven += &format!("{},{rest}\n", t.parse::<f64>().unwrap() + late);
    }
    folder.write("uneven.csv", uneven);
    let errors = folder.refused(&words("identify uneven.csv --device mine.toml"));
    assert!(errors.contains("uneven.csv: t is uneven in 5"), "{errors}");
    assert!(
        errors.contains("by up to 120 us") && errors.contains("--row-rate HZ, else --resample HZ"),
        "{errors}"
    );

    // The rows are evenly spaced, whatever column t says.
    let second = |k: usize| recorded.lines().nth(k).unwrap().split_once(',').unwrap().0;
    let step: f64 = second(2).parse::<f64>().unwrap() - second(1).parse::<f64>().unwrap();
    let even = good(&format!(
        "identify uneven.csv --device mine.toml --row-rate {:.0}",
        1.0 / step
    ));
    assert_eq!(
        even.lines().take(4).collect::<Vec<_>>(),
        good("identify excite.csv --device mine.toml")
            .lines()
            .take(4)
            .collect::<Vec<_>>()
    );

    // What is refused writes nothing and says why in a line.
    for (arguments, said) in [
        (
            "identify excite.csv --known kt=1 --out new.toml",
            "no key kt; must be",
        ),
        (
            "identify excite.csv --known large.inertia_kg_m2=-1 --out new.toml",
            "above 0",
        ),
        (
            "identify excite.csv --known large.inertia_kg_m2=30",
            "--known large.inertia_kg_m2 = 30: must be at most 0.1 kg.m2",
        ),
        (
            "identify nothing.csv --out new.toml",
            "nothing.csv: cannot read",
        ),
        ("simulate --scene none --out new.toml", "no scene"),
        (
            "identify excite.csv ./excite.csv",
            "./excite.csv: is already given by excite.csv; give each recording once",
        ),
        (
            "identify - -",
            "RECORDING -: standard input can be read once",
        ),
    ] {
        let errors = folder.refused(&words(arguments));
        assert!(errors.contains(said), "{errors}");
    }
    let errors = folder.refused("identify ../data/back-and-forth.csv --clamped");
    assert!(errors.contains("no column current"), "{errors}");
}

/// Constants that a coarse encoder of the handle leaves open; the intervals of the jackknife alone are below 2 %.
#[test]
fn coarse_handle_encoder_is_named_as_the_cause_of_wide_intervals() {
    let folder = Folder::new(HOST_SIM);
    folder.write("coarse.toml", "[small]\ncounts_per_rev = 300\n");
    folder.good("simulate --device coarse.toml --every 10 --out excite.csv");
    let table = folder.good("identify excite.csv --device coarse.toml");
    let table: Vec<_> = table.split_whitespace().collect();
    let said =
        "the encoders are too coarse for it: clamp the handle, or give its encoder more counts";
    assert!(table.join(" ").contains(said), "{table:?}");
}

#[test]
fn excitation_that_ends_early_or_moves_nothing_is_told() {
    let folder = Folder::new(HOST_SIM);
    let notes = |text: &str, options: &str| {
        folder.write("mine.toml", text);
        let arguments = "simulate --device mine.toml --every 10 --out excite.csv";
        folder.ends(0, &format!("{arguments} {options}")).1
    };
    assert_eq!(notes("", ""), "");
    assert_eq!(notes("", "--hand nobody"), "");
    let coarse = "small.counts_per_rev = 200";
    let said = notes(coarse, "");
    assert!(
        said.starts_with("note: scene excite ended after 0.0")
            && said.contains(
                "a count of small.counts_per_rev = 200 is more than that: give --hand clamp"
            )
            && said.contains("an encoder of 252 counts or more"),
        "{said}"
    );
    assert_eq!(notes("small.counts_per_rev = 252", ""), "");
    assert_eq!(notes(coarse, "--hand clamp"), "");
    let said = notes("coupler.damping_nms_per_rad = 5e-5", "");
    let rest = "note: the large motor does not move: scene excite has 0.064 A at most, 3.00e-3 N.m, and \
                large.coulomb_nm is 4.00e-3";
    assert!(said.starts_with(rest), "{said}");
    let refused = folder.refused("identify excite.csv --device mine.toml");
    assert!(
        refused.contains("the large motor does not move; check"),
        "{refused}"
    );
}
