//! Logs whose header, first row or last row is not where it belongs.

use crate::recording::{Recording, read_log as read, read_log_at as read_at};

const ROWS: &str = "0,0\n1,3\n2,6\n3,9\n";

fn counts(recording: &Recording) -> &[u32] {
    &recording.trace.counts_large
}

#[test]
fn number_of_a_column_is_no_name_in_a_row() {
    let options = "t=1:ms,counts_large=2:counts";
    // Rows with the numbers of the columns.
    let text = "0,0\n1,0\n2,1\n3,2\n";
    let recording = read(text, options).unwrap();
    assert_eq!(counts(&recording), [0, 0, 1, 2]);
    assert_eq!(recording.t, [0.0, 0.001, 0.002, 0.003]);
    let recording = read_at(Some(1000.0), "5,1\n5,2\n1,3\n", "counts_large=2:counts").unwrap();
    assert_eq!(counts(&recording), [1, 2, 3]);
    // A header is still found by the name of the other column.
    let text = format!("a title, of a log\nms,x\n{ROWS}");
    let recording = read(&text, "t=ms:ms,counts_large=2:counts").unwrap();
    assert_eq!(counts(&recording), [0, 3, 6, 9]);
}

#[test]
fn numbers_of_the_columns_above_the_rows_are_no_row() {
    for (text, options) in [
        (
            "0,1,2\n0.0,0,5\n0.001,3,5\n0.002,6,5\n",
            "t=1:s,counts_large=2:counts",
        ),
        (
            ",0,1\n0,0.0,0\n1,0.001,3\n2,0.002,6\n",
            "t=2:s,counts_large=3:counts",
        ),
    ] {
        let recording = read(text, options).unwrap();
        assert_eq!(counts(&recording), [0, 3, 6], "{text}");
        assert_eq!(recording.repeated_rows, 0);
    }
    // A first row that looks so.
    let recording = read("0,1,2\n1,4,2\n2,7,2\n", "t=1:ms,counts_large=2:counts").unwrap();
    assert_eq!(counts(&recording), [1, 4, 7]);
    let error = read(",0,1\n0,0.0,5\n1,0.001,3\n2,0.002,6\n", "").unwrap_err();
    assert!(error.contains("--column t=2:s,counts_large=3"), "{error}");
}

#[test]
fn single_column_has_all_rows() {
    for text in ["0\n3\n6\n", "counts\n0\n3\n6\n", "# started\n0\n3\n6\n"] {
        let recording = read_at(Some(100.0), text, "counts_large=1:counts").unwrap();
        assert_eq!(counts(&recording), [0, 3, 6], "{text}");
    }
    let recording = read_at(Some(100.0), "counts\n0\n3\n6\n", "").unwrap();
    assert_eq!(counts(&recording), [0, 3, 6]);
}

#[test]
fn header_below_other_rows_is_found() {
    for above in ["34,5\n", "7,1\n8,2\n# reset\n", "boot,5\n34,5\n"] {
        let recording = read(&format!("{above}time_ms,counts\n{ROWS}"), "").unwrap();
        assert_eq!(counts(&recording), [0, 3, 6, 9], "{above}");
        let number = above.lines().count();
        let first = 1 + usize::from(above.starts_with("boot"));
        let said = format!(
            "the rows from line {first} to the header in line {} are not read: remove them, or cut the log there",
            number + 1
        );
        assert!(recording.notes.contains(&said), "{:?}", recording.notes);
    }
    // Other names in the middle are no header.
    let error = read(&format!("{ROWS}a,b\n{ROWS}"), "").unwrap_err();
    assert!(
        error.contains("there are no names but 2 columns"),
        "{error}"
    );
}

#[test]
fn lines_between_header_and_rows_are_passed_over() {
    for between in ["Starting...\n", "---,---\n", "\"\"\n\"\"\n", "# on\n===\n"] {
        let recording = read(&format!("time_ms,counts\n{between}{ROWS}"), "").unwrap();
        assert_eq!(counts(&recording), [0, 3, 6, 9], "{between}");
    }
}

#[test]
fn row_of_another_length_is_named() {
    let options = "t=1:ms,counts_large=2:counts";
    for (text, said) in [
        (
            "8,34\n0,0,1\n1,6,1\n",
            "line 2: 3 fields where the first row, in line 1, has 2; one of these lines is cut, or is two rows \
             run together: remove it; numbers with a decimal comma need another separator than a comma",
        ),
        (
            "9,17,3\n0,0\n1,1\n",
            "line 2: 2 fields where the first row, in line 1, has 3; one of these lines is cut",
        ),
    ] {
        let error = read(text, options).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    for end in ["velocity,1/s\n", "[next]\n"] {
        let error = read(&format!("t,counts_large,x\n{}{end}", "0,1,2\n1,2,3\n"), "").unwrap_err();
        let said = "where the first line has 3; it has no number: if another table begins there, cut the log there, else \
                    remove the line";
        assert!(error.contains(said), "{error}");
    }
    let error = read(&format!("t,counts_large\n{ROWS}4,12,5,15\n"), "").unwrap_err();
    let said = "line 6: 4 fields where the first line has 2; remove the line if two rows run together there; numbers \
                with a decimal comma";
    assert!(error.contains(said), "{error}");
}

#[test]
fn last_row_may_be_cut_anywhere() {
    for (end, note) in [
        ("0.4", true),
        ("0.4,1", true),
        ("0.4,12,", false),
        ("0.4,12,7", false),
    ] {
        let text = format!("t,counts_large,x\n0,0,7\n0.1,3,7\n0.2,6,7\n0.3,9,7\n{end}");
        let recording = read(&text, "").unwrap();
        let said = "line 6, the last one, has no end and is left out: its last number may be cut"
            .to_owned();
        assert_eq!(recording.notes.contains(&said), note, "{end}");
        assert_eq!(counts(&recording)[..4], [0, 3, 6, 9]);
        assert_eq!(counts(&recording).len(), 5 - usize::from(note), "{end}");
    }
    let error = read("t,counts_large\n0,0\n0.1,3\n0.2\n", "").unwrap_err();
    assert!(
        error.contains("line 4: 1 field where the first line has 2"),
        "{error}"
    );
}

#[test]
fn column_with_the_name_of_a_time_is_compared_with_the_rate() {
    let text = "time_ms,counts\n0,0\n1,3\n2,6\n3,9\n";
    let error = read_at(Some(500.0), text, "").unwrap_err();
    let said = "--row-rate 500: column 'time_ms' has 1000 rows a second; give --row-rate 1000";
    assert!(error.contains(said), "{error}");
    let recording = read_at(Some(1000.0), text, "").unwrap();
    assert!(
        recording.notes.iter().any(|note| note.contains("time_ms")),
        "{:?}",
        recording.notes
    );
}

#[test]
fn rate_of_no_control_loop_is_noted() {
    for (unit, notes) in [("us", 1), ("ms", 0)] {
        let text = format!("time_{unit},counts\n{ROWS}");
        let recording = read(&text, "").unwrap();
        let said = "1000000 rows a second are more than 100000: check the unit of t, which";
        let found = recording.notes.iter().filter(|note| note.starts_with(said));
        assert_eq!(found.count(), notes, "{unit}");
    }
}

#[test]
fn header_above_numbers_with_separators_of_thousands_is_found() {
    // The first line of numbers is the third row.
    let rows = "0.000;1'200\n0.001;1'000\n0.002;800\n0.003;-1'000\n";
    for time in ["t", "time"] {
        let error = read(&format!("{time};counts\n{rows}"), "").unwrap_err();
        assert!(!error.contains("no names"), "{error}");
    }
    let error = read(&format!("t;counts\n{rows}"), "").unwrap_err();
    assert!(
        error.contains("line 5: column counts_large: '-1\\'000' is not a number; write it without separators of thousands"),
        "{error}"
    );
}

#[test]
fn quotes_around_nothing_are_a_blank_line() {
    for text in [
        "time_ms,counts\n\"\"\n\"\"\n0,0\n1,3\n\"\"\n2,6\n3,9\n",
        "time_ms;counts\n\" \"\n0;0\n1;3\n2;6\n3;9\n",
    ] {
        assert_eq!(counts(&read(text, "").unwrap()), [0, 3, 6, 9], "{text}");
    }
}

#[test]
fn names_with_blanks_between_them_are_above_rows_with_commas() {
    for names in [
        "# time_ms counts",
        "time_ms\tcounts",
        "% time_ms; counts",
        "# time[ms] pos[counts]",
    ] {
        let recording = read(&format!("{names}\n{ROWS}"), "").unwrap();
        assert_eq!(counts(&recording), [0, 3, 6, 9], "{names}");
        let recording = read(&format!("{names}\n{ROWS}"), "t=1:ms,counts_large=2:counts").unwrap();
        assert_eq!(counts(&recording), [0, 3, 6, 9], "{names}");
    }
    // Words that are no names of a time and a position, or of more columns.
    for words in [
        "# motor two",
        "# time_ms of counts",
        "time (ms),position,gain=1",
    ] {
        let error = read(&format!("{words}\n{ROWS}"), "").unwrap_err();
        assert!(error.contains("2 columns, separated by ','; "), "{error}");
    }
}

#[test]
fn words_of_a_comment_with_a_number_or_a_value_are_no_names() {
    for comment in ["% 7 9 gain", "% gain =0.5 rad/s,", "# motor 2 begins"] {
        let text = format!("{comment}\n0 0 1\n1 3 1\n2 6 1\n3 9 1\n");
        let error = read(&text, "").unwrap_err();
        let said = "r.csv: line 1: no column t; there are no names but 3 columns, separated by spaces; give";
        assert!(error.starts_with(said), "{error}");
        let recording = read(&text, "t=1:ms,counts_large=2:counts").unwrap();
        assert_eq!(counts(&recording), [0, 3, 6, 9]);
    }
    // A time and a position are named, beside a number.
    let text = "# time_ms, counts, 3\n0,0,1\n1,3,1\n2,6,1\n3,9,1\n";
    assert_eq!(counts(&read(text, "").unwrap()), [0, 3, 6, 9]);
    // Names of columns above it are found.
    let text = format!("% time_ms, counts\n% gain = 5, 7\n{ROWS}");
    assert_eq!(counts(&read(&text, "").unwrap()), [0, 3, 6, 9]);
}

#[test]
fn rows_with_other_fields_than_the_first_line_are_named_as_such() {
    let rows: String = (0..40).map(|k| format!("{k},{},1\n", 3 * k)).collect();
    let error = |above: &str| {
        let options = "t=1:ms,counts_large=2:counts";
        read(&format!("{above}\n{rows}"), options).unwrap_err()
    };
    let settings = error("angle,rate,seconds,gain\n90,1000,5,2");
    let said = "r.csv: line 3: 3 fields, as in the lines below, where the first line has 4; write one name for each \
                field, or remove the lines above that are no rows";
    assert_eq!(settings, said);
    let said = "r.csv: line 2: 3 fields, as in the lines below, where the first row, in line 1, has 2; remove that line";
    assert_eq!(error("1,2"), said);
    // One row among others is the odd one.
    let odd = rows.replacen("7,21,1", "7,21", 1);
    let error = read(&format!("t_ms,counts,on\n{odd}"), "").unwrap_err();
    let said = "r.csv: line 9: 2 fields where the first line has 3; remove the line if the log was cut there";
    assert_eq!(error, said);
}
