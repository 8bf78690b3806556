//! Units at the end of a column's name.

use crate::{Folder, HOST_SIM};

/// Notes and status of replay on a log with a column called `name`, which is read as `ours`.
fn replay(name: &str, ours: &str) -> (Option<i32>, String) {
    let folder = Folder::new(HOST_SIM);
    let other = if ours == "counts_large" {
        "x"
    } else {
        "counts_large"
    };
    let rows: String = (0..50)
        .map(|k| format!("{},{k},{k}\n", f64::from(k) * 1e-3))
        .collect();
    folder.write("r.csv", format!("t,{other},{name}\n{rows}"));
    let column = format!("{ours}={name}");
    let output = folder.run(&["replay", "r.csv", "--estimator", "pll", "--column", &column]);
    let said = String::from_utf8(output.stderr).unwrap();
    let said: Vec<_> = said.split_whitespace().collect();
    (output.status.code(), said.join(" "))
}

#[test]
fn every_column_that_is_named_is_reported_with_its_unit() {
    for (ours, name, unit) in [
        ("counts_large", "angle_mrad", "mrad with 4096 counts/rev"),
        ("counts_large", "angle_mdeg", "mdeg with 4096 counts/rev"),
        ("counts_large", "theta/deg", "deg with 4096 counts/rev"),
        ("counts_large", "position", "counts"),
        ("counts_large", "encoder(steps)", "counts"),
        ("true_omega", "omega_deg_s", "deg/s"),
        ("true_omega", "gyro_dps", "deg/s"),
        ("true_omega", "speed/rpm", "rpm"),
        ("true_omega", "n [1/min]", "rpm"),
        ("true_omega", "speed", "rad/s"),
    ] {
        let (status, said) = replay(name, ours);
        assert_eq!(status, Some(0), "{name}: {said}");
        let note = format!("{ours} from '{name}' ({unit})");
        assert!(said.contains(&note), "{name}: {said}");
    }
}

#[test]
fn end_of_a_name_that_is_no_unit_is_refused_with_the_units() {
    for (ours, name, said) in [
        (
            "counts_large",
            "angle [grad]",
            "error: r.csv: line 1: 'grad' at the end of the name is no unit of counts_large; there are \
             counts, deg, rad, rev, mdeg, mrad, arcmin, arcsec; convert the numbers, or state the unit where it is one of \
             these, for example --column 'counts_large=angle [grad]:deg'",
        ),
        (
            "true_omega",
            "gyro_mdps",
            "'mdps' at the end of the name is no unit of true_omega; there are rad/s, deg/s, rev/s, rpm;",
        ),
    ] {
        let (status, line) = replay(name, ours);
        assert_eq!(status, Some(2), "{line}");
        assert!(line.contains(said), "{line}");
    }
}

#[test]
fn unit_that_is_stated_and_is_none_is_reported() {
    let folder = Folder::new(HOST_SIM);
    folder.write("r.csv", "t,counts_large\n0,1\n0.001,2\n");
    for (column, said) in [
        (
            "t=t:h",
            "error: r.csv: --column t=t:h: 'h' is no unit of t; there are s, ms, us, ns\n",
        ),
        (
            "t=t:s:s",
            "error: r.csv: --column t=t:s:s: the unit is stated twice; write --column t=t:s\n",
        ),
        (
            "counts_large=counts_large:ms",
            "'ms' is no unit of counts_large; there are counts, deg, rad, rev, mdeg, mrad, arcmin, arcsec\n",
        ),
        (
            "t=x:h",
            "no column 'x:h', which --column names for t; found: t; counts_large",
        ),
    ] {
        let line = folder.refused(&["replay", "r.csv", "--column", column]);
        assert!(line.contains(said), "{line}");
    }
    // A colon of the user's name.
    folder.write("c.csv", "t,joint:h\n0,1\n0.001,2\n");
    folder.good(&[
        "replay",
        "c.csv",
        "--estimator",
        "pll",
        "--column",
        "counts_large=joint:h",
    ]);
}
