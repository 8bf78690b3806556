//! Tests of units and columns that the numbers tell.

use crate::recording::read_log as read;

/// 40 rows of the columns that `row` gives, with a line of names if there is one.
fn rows(header: &str, row: impl Fn(u32) -> String) -> String {
    let rows = (0..40).map(|k| format!("{}\n", row(k)));
    format!("{header}{}", rows.collect::<String>())
}

#[test]
fn units_that_are_guessed_fit_the_numbers() {
    let time = |step: f64| move |k: u32| format!("{},{}", step * f64::from(k), 3 * k);
    for (step, unit) in [
        (0.02, "s"),
        (0.05, "s"),
        (1.0, "ms"),
        (50.0, "ms"),
        (25_005.0, "us"),
        (5e5, "ns"),
    ] {
        let error = read(&rows("time,counts\n", time(step)), "").unwrap_err();
        let said =
            format!("--column 't=time:{unit},counts_large=counts', where the unit {unit} is a");
        assert!(error.contains(&said), "{step}: {error}");
    }
    for (name, numbers, unit) in [
        ("angle", [0.25, 0.5, 3.0], "rad"),
        ("angle", [0.25, 45.5, 170.0], "deg"),
        ("angle", [1.0, 45.0, 170.0], "deg"),
        ("angle", [1.0, 450.0, 4095.0], "counts"),
        ("encoder", [1.0, 45.0, 170.0], "counts"),
        ("motor turns pos", [0.25, 45.5, 170.0], "rev"),
    ] {
        let row = |k: u32| format!("{k},{}", numbers[k as usize % 3]);
        let error = read(&rows(&format!("t_ms,{name}\n"), row), "").unwrap_err();
        let said = format!("counts_large={name}:{unit}', where the unit {unit} is a guess");
        assert!(error.contains(&said), "{error}");
    }
}

#[test]
fn time_without_a_name_is_the_column_that_rises_most_evenly() {
    for (row, said) in [
        (
            &(|k: u32| format!("{},{},{}", k * k, 0.5 * f64::from(k % 3), 10 * k))
                as &dyn Fn(u32) -> String,
            "--column t=3:ms,counts_large=1:counts, where",
        ),
        (
            &|k: u32| format!("motor,{},{}", 10 * k, 0.5 * f64::from(k % 3)),
            "--column t=2:ms,counts_large=3:rad, where",
        ),
        (
            &|k: u32| format!("{}\t{}\t{}\t{}", 20_000 * k, 3, k % 5, k % 7),
            "--column t=1:us,counts_large=3:counts, where",
        ),
    ] {
        let error = read(&rows("", row), "").unwrap_err();
        assert!(error.contains(said), "{error}");
        assert!(!error.contains("monitor of SimpleFOC"), "{error}");
    }
}

#[test]
fn units_of_rows_with_names_fit_the_numbers_too() {
    for (first, step, unit) in [(0.0, 1.0, "ms"), (1.7e9, 0.5, "s"), (5e6, 2000.0, "us")] {
        for (position, angle) in [(1.5, "rad"), (80.5, "deg")] {
            let labelled = |k: u32| {
                let t = first + step * f64::from(k);
                format!("time: {t} pos: {}", position + f64::from(k % 3))
            };
            let object = |k: u32| {
                let t = first + step * f64::from(k);
                format!(
                    "{{\"time\": {t}, \"pos\": {}}}",
                    position + f64::from(k % 3)
                )
            };
            for text in [rows("", labelled), rows("", object)] {
                let error = read(&text, "").unwrap_err();
                let said = format!("--column 't=time:{unit},counts_large=pos:{angle}'");
                assert!(error.contains(&said), "{text:.60}: {error}");
            }
        }
    }
}

/// SerialPlot calls its channels as a logic analyser does.
#[test]
fn channels_beyond_levels_are_no_lines_of_a_logic_analyser() {
    let read_at = |scale: u32| {
        let row = |k: u32| format!("{},{}", scale * (k % 2), scale * (k / 2 % 2));
        read(&rows("Channel 1,Channel 2\n", row), "").unwrap_err()
    };
    assert!(read_at(1).contains("lines of a logic analyser"));
    let said = read_at(45);
    assert!(
        !said.contains("logic analyser") && said.contains("name the columns"),
        "{said}"
    );
}

#[test]
fn table_whose_lines_are_signals_is_to_be_turned() {
    let line = |columns: u32, scale: u32| {
        let fields: Vec<_> = (0..columns).map(|k| (scale * k).to_string()).collect();
        fields.join(",") + "\n"
    };
    let said = |columns| read(&(line(columns, 1) + &line(columns, 3)), "").unwrap_err();
    let turned = "columns: if each line is a signal, exchange lines and columns, ";
    assert!(said(101).contains(turned), "{}", said(101));
    // It may be one all the same.
    assert!(said(101).contains("else give the numbers of the columns, for example --column t="));
    assert!(!said(100).contains(turned), "{}", said(100));
}
