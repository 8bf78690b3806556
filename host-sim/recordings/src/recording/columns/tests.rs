use crate::recording::read_log as read;

/// A number that is cut is another one, and only the last field of the last line can be.
#[test]
fn number_that_may_be_cut_is_left_out() {
    let row = |k: usize, f: &dyn Fn(String, usize) -> String| f(format!("0.{k}"), 70 + k);
    let rows =
        |f: &dyn Fn(String, usize) -> String| -> String { (0..9).map(|k| row(k, f)).collect() };
    let plain = rows(&|t, n| format!("{t},{n}\n"));
    let swapped = rows(&|t, n| format!("{n},x,{t}\n"));
    let other = rows(&|t, n| format!("{t},{n},1.5\n"));
    let named = rows(&|t, n| format!("t:{t},counts_large:{n}\n"));
    let long = rows(&|t, n| format!("{t},a,1\n{t},counts_large,{n}\n"));
    for (text, columns, line) in [
        (format!("t,counts_large\n{plain}"), "", Some(10)),
        (format!("counts_large,x,t\n{swapped}"), "", Some(10)),
        (format!("t,counts_large,x\n{other}"), "", None),
        (named, "", Some(9)),
        (format!("t,name,value\n{long}"), "", Some(19)),
    ] {
        let whole = read(&text, columns).unwrap();
        assert_eq!(whole.t.len(), 9, "{text}");
        assert!(!whole.notes.iter().any(|note| note.contains("has no end")));
        let cut = read(&text[..text.len() - 2], columns).unwrap();
        let said = line.map(|line| {
            format!(
                "line {line}, the last one, has no end and is left out: its last number may be cut"
            )
        });
        let found = cut.notes.iter().find(|note| note.contains("has no end"));
        assert_eq!(found, said.as_ref(), "{text}");
        assert_eq!(cut.t.len(), 9 - usize::from(line.is_some()), "{text}");
    }
}

#[test]
fn rows_of_other_signals_are_left_out() {
    let rows = |none: &str| {
        let row = |k: usize| format!("0.{k},{},\n0.{k}5,{none},9.81\n", 8 * k);
        (0..9).map(row).collect::<String>()
    };
    for none in ["", "NaN", "-nan", "null", "None", "N/A"] {
        for (header, columns) in [
            ("s,encoder,imu", "t=s,counts_large=encoder:counts"),
            ("t,counts_large,imu", ""),
        ] {
            let recording = read(&format!("{header}\n{}", rows(none)), columns).unwrap();
            assert_eq!(recording.trace.counts_large[..3], [0, 8, 16]);
            assert_eq!(recording.t.len(), 9);
            let said = "9 rows without a position are left out, the first in line 3";
            assert!(recording.notes.iter().any(|note| note == said));
        }
    }
    // A number that is not finite is a value.
    let error = read(&format!("t,counts_large,imu\n{}", rows("inf")), "").unwrap_err();
    assert!(
        error.contains("line 3: column counts_large: 'inf' is not a number"),
        "{error}"
    );
    let rows = rows("");
    // All other signals of the log are in other files, or did not change.
    for row in ["9,,", "9,, ", "9,,NaN"] {
        let recording = read(&format!("t,counts_large,imu\n{rows}{row}\n"), "").unwrap();
        let said = "10 rows without a position are left out, the first in line 3";
        assert!(recording.notes.iter().any(|note| note == said));
    }
    // Without a time a row is of no instant, and a log of the position alone has no other signals.
    for (header, row, said) in [
        (
            "t,counts_large,imu",
            ",,1",
            "line 20: column t: '' is not a number; remove the row",
        ),
        (
            "t,counts_large",
            "9,",
            "line 20: column counts_large: '' is not a number; remove the row",
        ),
    ] {
        let rows = match header.matches(',').count() {
            2 => rows.clone(),
            _ => (0..18).map(|k| format!("0.{k:02},{k}\n")).collect(),
        };
        let error = read(&format!("{header}\n{rows}{row}\n"), "").unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn rows_with_another_time_and_no_position_are_left_out() {
    let row = |k: usize| format!("0.{k}1,,0.{k},{}\n0.{k}5,9.81,,\n", 8 * k);
    let rows: String = (0..9).map(row).collect();
    let text = format!("received,imu,stamp,encoder\n{rows}");
    let recording = read(&text, "t=stamp:s,counts_large=encoder:counts").unwrap();
    assert_eq!(recording.trace.counts_large[..3], [0, 8, 16]);
    assert_eq!(recording.t.len(), 9);
    let said = "9 rows without a position are left out, the first in line 3";
    assert!(recording.notes.iter().any(|note| note == said));
}

#[test]
fn lines_without_the_names_of_the_rows_are_left_out() {
    let row = |k: usize| format!("time_ms: {k} counts: {}\n", 3 * k);
    let [above, below] = [0..9, 9..30].map(|rows| rows.map(row).collect::<String>());
    let notes = |between: &str| {
        let recording = read(&format!("{above}{between}{below}"), "").unwrap();
        assert_eq!(recording.trace.counts_large[8..10], [24, 27], "{between}");
        assert_eq!(recording.t.len(), 30);
        let lines = recording.notes.into_iter();
        lines
            .filter(|note| note.contains("names and"))
            .collect::<Vec<_>>()
    };
    let one = "line 10 has none of the names and is left out";
    for line in [
        "DONE",
        "speed: 100, step: 0.5",
        "runtime_ms: 5",
        "next counts",
        "0.5 0.7",
    ] {
        assert_eq!(notes(&format!("{line}\n")), [one], "{line}");
    }
    let two = "2 lines have none of the names and are left out, the first is line 11";
    assert_eq!(notes("\nspeed: 100 step: 0.5\nDONE\n"), [two]);
    // An object of another kind.
    let object = |k: usize| format!("{{\"time_ms\":{k},\"counts\":{}}}\n", 3 * k);
    let objects: String = (0..9).map(object).collect();
    let recording = read(&format!("{objects}{{\"event\":5}}\n"), "").unwrap();
    assert_eq!(recording.t.len(), 9);
    assert!(recording.notes.iter().any(|note| note == one));
    // A row that is broken.
    for line in ["time_ms: 9", "9 counts: ", "time_ms = 9 counts 27"] {
        let error = read(&format!("{above}{line}\n{below}"), "").unwrap_err();
        assert!(error.starts_with("r.csv: line 10: "), "{line}: {error}");
    }
}
