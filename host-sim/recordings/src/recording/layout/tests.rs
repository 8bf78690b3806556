//! Headers and separators of whole logs.

use crate::recording::read_log as read;

#[test]
fn header_that_is_not_found_is_reported_with_what_is_searched() {
    let rows = "t,counts_large\n0,1\n0.001,2\n";
    let lines = "# a comment\n".repeat(500);
    let long = format!("# {}\n", "x".repeat(997)).repeat(66);
    for (preamble, limit) in [(&lines, "500 lines"), (&long, "64 KiB")] {
        for column in ["", "t=t"] {
            let error = read(&format!("{preamble}{rows}"), column).unwrap_err();
            let said = format!("; no header within the first {limit}; ");
            assert!(error.contains(&said), "{error}");
        }
    }
    read(&format!("{}{rows}", &lines[12..]), "").unwrap();
    let error = read(&format!("{}{rows}", "a, b\n".repeat(500)), "").unwrap_err();
    let said = "found: a; b, separated by ','; no other header within the first 500 lines; ";
    assert!(error.contains(said), "{error}");
    let error = read(&"0,".repeat(40_000), "t=1,counts_large=2").unwrap_err();
    let said = "r.csv: line 1: no end of the line within 64 KiB; write one row a line";
    assert!(error.starts_with(said), "{error}");
}

#[test]
fn first_row_of_a_log_without_a_header_is_reported() {
    let rows = (0..20).map(|k| format!("{k}e-3,{k}\n"));
    let text = format!("# pandas\n0,1\n{}", rows.collect::<String>());
    let recording = read(&text, "t=1:s,counts_large=2:counts").unwrap();
    let said = "; without a header, line 3 is the first row: '0e-3,0'";
    assert!(recording.notes[0].ends_with(said), "{:?}", recording.notes);
    let recording = read(&text.replace("0,1", "t,counts_large"), "t=t").unwrap();
    assert!(!recording.notes[0].contains("header"));
}

#[test]
fn separator_at_the_end_of_all_rows_begins_no_column() {
    for end in ["\t", "\t\r", "\t "] {
        let monitor = format!("2\t0.1\t0.5\t0.25{end}\n").repeat(3);
        let error = read(&monitor, "").unwrap_err();
        assert!(error.contains("the monitor of SimpleFOC"), "{error}");
    }
    let columns = "t=1,counts_large=2";
    assert!(read("0\t1\t\n0.001\t2\t\n", columns).is_ok());
    // The last field of the first row is empty.
    for text in ["0\t1\t\n0.001\t2\t5\n", "0,1,\n0.001,2,5\n"] {
        assert_eq!(read(text, columns).unwrap().trace.counts_large, [1, 2]);
    }
    let text = "a;b\n0;1;\n0.001;2;\n";
    assert!(read(text, "t=a,counts_large=b").is_ok());
}

#[test]
fn rows_may_have_another_separator_than_the_header() {
    for text in [
        "t;counts_large\n0,1\n0.001,2\n",
        "t,counts_large\n# a\n0;1\n0,001;2\n",
        "# t\tcounts_large\n0   1\n1e-3   2\n",
        "# t counts_large\n0,1\n1e-3,2\n",
        "t counts_large\n0\t1\n0.001\t2\n",
    ] {
        let recording = read(text, "").unwrap();
        assert_eq!(recording.trace.counts_large, [1, 2], "{text}");
        assert_eq!(recording.t, [0.0, 0.001], "{text}");
    }
    // The rows have the separator of the header, and a decimal comma.
    let recording = read("t counts_large\n0,25 1\n0,26 2\n", "").unwrap();
    assert_eq!(recording.t, [0.25, 0.26]);
    // Other columns than the names.
    let error = read("t counts_large x\n0,1\n0.001,2\n", "").unwrap_err();
    assert!(error.contains("line 2"), "{error}");
}

#[test]
fn row_with_more_fields_than_the_header_has_names_is_refused() {
    for row in ["a\tb\tc\t06:00:00", "a\tb\tc\t1700000000"] {
        let error = read(&format!("Measurement\t\n{row}\n"), "").unwrap_err();
        let said = "r.csv: line 1: no column t; found: 'Measurement'; ";
        assert!(error.starts_with(said), "{error}");
    }
}
