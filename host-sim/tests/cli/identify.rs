//! `host-sim identify`.

use std::fs;

use host_sim::device::Device;

use crate::Folder;

fn words(arguments: &str) -> Vec<&str> {
    arguments.split_whitespace().collect()
}

#[test]
fn the_command_writes_a_device_file_with_only_what_it_knows_replaced() {
    let folder = Folder::new("identify");
    let good = |arguments: &str| folder.good(&words(arguments));
    let truth = "[large]\ninertia_kg_m2 = 1.3e-5\n[coupler]\ndamping_nms_per_rad = 0.8e-3\n";
    folder.write("truth.toml", truth);
    let mine = "# mine\n[hand]\nstiffness_nm_per_rad = 0.4 # soft\n";
    folder.write("mine.toml", mine);
    good("simulate --device truth.toml --every 10 --out excite.csv");
    let command = "identify excite.csv --device mine.toml --out mine.toml --report page";
    let table = good(command);
    let page = fs::read_to_string(folder.0.join("page/index.html")).unwrap();
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
         its interval: coupler hot",
        "assumed: large.torque_constant_nm_per_a = 0.0468 taken as exact",
        "amplifier.bandwidth_hz                   -  Hz          rows 1 ms apart",
    ] {
        assert!(table.contains(said), "{said}\n{table}");
    }
    let text = fs::read_to_string(folder.0.join("mine.toml")).unwrap();
    assert!(text.starts_with(mine), "{text}");
    assert!(
        !text.contains("bandwidth") && !text.contains("\ntorque_constant"),
        "{text}"
    );
    let device = Device::from_toml_str(&text).unwrap();
    assert!((device.large.inertia_kg_m2 / 1.3e-5 - 1.0).abs() < 0.01);
    assert!((device.coupler.damping_nms_per_rad / 0.8e-3 - 1.0).abs() < 0.01);

    // The same recording again finds its own file right, and JSON is alone on standard output.
    let json = good("identify excite.csv --device mine.toml --json -");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let rows = json["quantities"].as_array().unwrap();
    let row = rows.iter().find(|row| row["key"] == "large.inertia_kg_m2");
    assert_eq!(row.unwrap()["file_inside"], true);

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
            "identify nothing.csv --out new.toml",
            "nothing.csv: cannot read",
        ),
        ("simulate --scene none --out new.toml", "no scene"),
    ] {
        let errors = folder.refused(&words(arguments));
        assert!(errors.contains(said), "{errors}");
    }
    let motor = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../tests/data/back-and-forth.csv"
    );
    let errors = folder.refused(&words(&format!("identify {motor} --clamped")));
    assert!(errors.contains("no column current"), "{errors}");
}
