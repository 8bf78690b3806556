//! Every layout of JSON has the rows of the same log with one object a line.

use super::Other;
use crate::recording::{Recording, read_log};

fn read(text: &str) -> Result<Recording, String> {
    Recording::parse(text.as_bytes(), "r.json").map_err(|error| error.to_string())
}

fn counts(text: &str) -> Vec<u32> {
    let recording = read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert_eq!(recording.t, [0.0, 0.001, 0.002], "{text}");
    recording.trace.counts_large
}

/// The layouts of a log of three rows; each object has a field beside them that no row needs.
const LAYOUTS: [&str; 20] = [
    r#"[{"t": 0, "counts_large": 5, "x": "a, [b"}, {"t": 0.001, "counts_large": 6}, {"t": 0.002, "counts_large": 8}]"#,
    "# a \"log\n# of [x], {\n[\n{\"t\": 0, \"counts_large\": 5},\n{\"t\": 0.001, \"counts_large\": 6}\n,{\"t\": 0.002, \"counts_large\": 8}\n]\n",
    "[\n  {\n    \"t\": 0,\n    \"counts_large\": 5,\n    \"x\": {\"y\": [1, \"}\\\"\"]}\n  },\n  {\n    \"t\": 0.001,\n    \
     \"counts_large\": 6\n  },\n  {\n    \"t\": 0.002,\n    \"counts_large\": 8\n  }\n]\n",
    "{\n  \"t\": 0,\n  \"counts_large\": 5\n}\n{\n  \"t\": 0.001,\n  \"counts_large\": 6\n}\n{\n  \"t\": 0.002,\n  \
     \"counts_large\": 8\n}\n",
    "{\"t\": 0, \"counts_large\": 5},\n{\"t\": 0.001, \"counts_large\": 6},\n{\"t\": 0.002, \"counts_large\": 8}\n",
    r#"{"t": 0, "counts_large": 5}{"t": 0.001, "counts_large": 6} {"t": 0.002, "counts_large": 8}"#,
    r#"[["t", "counts_large"], [0, 5], [0.001, 6], [0.002, 8]]"#,
    "[\n  [\n    \"t\",\n    \"counts_large\"\n  ],\n  [0, 5], [\n    0.001,\n    6\n  ],\n  [0.002, 8]\n]\n",
    "[\"t\", \"counts_large\"]\n[0, 5]\n[0.001, 6]\n[0.002, 8]\n",
    r#"{"t": [0, 0.001, 0.002], "name": "a run", "counts_large": [5, 6, 8], "gains": [1.5]}"#,
    "// a log\n{\n  \"t\": [\n    0,\n    0.001,\n    0.002\n  ],\n  \"counts_large\": [5, 6, 8],\n  \"x\": [NaN, null, \"b\\n\"]\n}\n",
    r#"{"t": {"0": 0, "1": 0.001, "2": 0.002}, "counts_large": {"0": 5, "1": 6, "2": 8}}"#,
    r#"{"0": {"t": 0, "counts_large": 5}, "1": {"t": 0.001, "counts_large": 6}, "2": {"t": 0.002, "counts_large": 8}}"#,
    "{'t': 0, 'counts_large': 5}\n{'t': 0.001, 'counts_large': 6, 'x': None}\n{'t': 0.002, 'counts_large': 8}\n",
    "{'t': [0, 0.001, 0.002], 'x': True, 'counts_large': [5, 6, 8]}",
    r#"{"columns": ["t", "counts_large"], "index": [0, 1, 2], "data": [[0, 5], [0.001, 6], [0.002, 8]]}"#,
    r#"{"schema": {"fields": []}, "data": [{"t": 0, "counts_large": 5}, {"t": 0.001, "counts_large": 6}, {"t": 0.002, "counts_large": 8}]}"#,
    "{\"device\": {\"poles\": [1]},\n\"data\": [\n{\"t\": 0, \"counts_large\": 5},\n{\"t\": 0.001, \"counts_large\": 6},\n{\"t\": 0.002, \"counts_large\": 8}\n]}",
    r#"{"data": {"t": [0, 0.001, 0.002], "counts_large": [5, 6, 8]}}"#,
    "{\"t\":\r [0, 0.001, 0.002],\r\"counts_large\": [5, 6,\r8]}\r",
];

#[test]
fn layouts_have_the_same_rows() {
    for text in LAYOUTS {
        assert_eq!(counts(text), [5, 6, 8], "{text}");
        assert_eq!(counts(&text.replace('\n', "\r\n")), [5, 6, 8], "{text}");
        assert_eq!(counts(&format!("\u{feff}{text}")), [5, 6, 8], "{text}");
    }
}

/// A text longer than its begin and than any buffer.
#[test]
fn long_texts_are_read_whole() {
    let rows = 0..20_000;
    let object = |k: i32| format!("{{\"t\": {k}e-3, \"counts_large\": {}}}", k / 7);
    let join = |text: &dyn Fn(i32) -> String| rows.clone().map(text).collect::<Vec<_>>().join(", ");
    let expected: Vec<_> = rows.clone().map(|k| (k / 7) as u32).collect();
    let list = |text: &dyn Fn(i32) -> String| format!("[{}]", join(text));
    for text in [
        list(&object),
        join(&object),
        list(&|k| format!("[{k}e-3, {}]", k / 7)).replacen('[', "[[\"t\", \"counts_large\"], ", 1),
        format!(
            "{{\"t\": {}, \"counts_large\": {}}}",
            list(&|k| format!("{k}e-3")),
            list(&|k| (k / 7).to_string())
        ),
    ] {
        assert_eq!(read(&text).unwrap().trace.counts_large, expected);
    }
}

#[test]
fn lists_in_a_list_are_columns() {
    for (text, columns) in [
        (
            r#"{"t": [0, 0.001, 0.002], "q": [[1, 5], [2, 6], [3, 8]]}"#,
            "counts_large=q.1",
        ),
        (
            r#"{"t": [0, 0.001, 0.002], "motors": {"1": {"at": [5, 6, 8]}, "2": {"at": [1, 1, 1]}}}"#,
            "counts_large=motors.1.at",
        ),
        // A list of one run.
        (
            r#"{"limits": [1], "data": [{"name": "a", "t": [0, 0.001, 0.002], "at": [5, 6, 8]}]}"#,
            "counts_large=at",
        ),
        (
            r#"{"runs": [{"t": [0, 0.001, 0.002], "at": [5, 6, 8]}]}"#,
            "t=runs.t,counts_large=runs.at",
        ),
        // As Python prints tuples.
        (
            "(0.0, 5)\n(0.001, 6)\n(0.002, 8)\n",
            "t=1:s,counts_large=2:counts",
        ),
        (
            "[(0.0, 5), (0.001, 6), (0.002, 8)]",
            "t=1:s,counts_large=2:counts",
        ),
        // As numpy prints it.
        (
            "[[0.    5.   ]\n [0.001 6.   ]\n [0.002 8.   ]]\n",
            "t=1:s,counts_large=2:counts",
        ),
    ] {
        let recording = read_log(text, columns).unwrap();
        assert_eq!(recording.trace.counts_large, [5, 6, 8], "{text}");
    }
}

/// A short list, as of settings or events, is no column; one that is nearly as long as the others is a damaged one.
#[test]
fn a_list_of_half_the_rows_is_left_out() {
    let text = |list: &str| {
        format!(
            r#"{{"t": [0, 0.1, 0.2, 0.3, 0.4, 0.5], "counts_large": [5, 6, 7, 8, 9, 9], "gains": [{list}]}}"#
        )
    };
    let read_counts = read(&text("1, 2, 3")).unwrap().trace.counts_large;
    assert_eq!(read_counts, [5, 6, 7, 8, 9, 9]);
    let error = read(&text("1, 2, 3, 4")).unwrap_err();
    assert!(
        error.contains("list gains: 4 values where the longest list has 6"),
        "{error}"
    );
}

#[test]
fn an_error_has_the_line_of_the_element_or_its_number() {
    for (text, said) in [
        (
            "[\n {\n  \"t\": 0,\n  \"counts_large\": 5\n },\n {\n  \"t\": 1,\n  \"counts_large\": \"six\"\n }\n]\n",
            "line 6: column counts_large: 'six' is not a number",
        ),
        (
            r#"[{"t": 0, "counts_large": 5}, {"t": 1, "counts_large": 5}, {"t": 2}]"#,
            "line 3: column counts_large: no field 'counts_large' in the line",
        ),
        (
            r#"{"t": [0, 0.1, 0.2], "counts_large": [5, NaN, 6]}"#,
            "line 2: column counts_large: 'NaN' is not a number",
        ),
        (
            r#"{"t": [0, 0.1, 0.2], "counts_large": [5, 6]}"#,
            "line 1: list counts_large: 2 values where the longest list has 3; make the lists equally long, or write",
        ),
        (
            r#"{"t": [0, 0.1, 0.2], "q": [[5, 6], [5], [6, 7]]}"#,
            "line 1: list q: value 2 has 1 numbers where the first one has 2; write one JSON object a line",
        ),
        (
            "\n{\n \"t\": 0,\n \"counts_large\": 5\n}\n",
            "line 2: one JSON object without lists of two values and more; write one JSON object a line",
        ),
        (
            r#"{"t": [0], "counts_large": [5]}"#,
            "line 1: no column t; found: t.0; counts_large.0; name the columns",
        ),
        (
            "{\n \"t\": [0],\n \"counts_large\": [5]\n}\n",
            "line 1: one JSON object without lists of two values and more; write one JSON object a line",
        ),
        (
            "{\n \"t\": [0, 1],\n \"counts_large\": [5, 6\n",
            "line 1: no JSON object (EOF while parsing a list at line 4 column 0); correct it, or write",
        ),
        (
            "{\"t\": 0, \"counts_large\": 5}\n{\"t\": 1, \"counts_large\": }\n",
            "line 2: no JSON object on a line of its own (expected value at column 26); write one JSON object a line",
        ),
        (
            "{\"t\": 0, \"counts_large\": 5}\n{\"t\": 1, \"counts_large\": 6},\n",
            "line 2: no JSON object on a line of its own (trailing characters at column 28); write one JSON object",
        ),
        (
            r#"[{"t": 0, "counts_large": 5}, {"t": 1, "counts_large": 5}, {"t": 2, "cou"#,
            "line 3: no JSON object; remove the line",
        ),
        (
            "[{\"t\": 0, \"counts_large\": 5}, {\"t\": 1, \"counts_large\": 5}]\nend\n",
            "line 3: no JSON object; remove the line",
        ),
    ] {
        let error = read(text).unwrap_err();
        assert!(
            error.starts_with(&format!("r.json: {said}")),
            "{text}: {error}"
        );
    }
}

/// A log with any wrong or missing byte is read or refused.
#[test]
fn wrong_bytes_are_no_panic() {
    for text in LAYOUTS {
        for at in (0..text.len()).filter(|at| text.is_char_boundary(*at)) {
            let (before, rest) = text.split_at(at);
            let after = rest.get(1..).unwrap_or_default();
            for byte in ["", "[", "]", "}", "\"", "\n"] {
                for text in [format!("{before}{byte}{after}"), format!("{before}{byte}")] {
                    if let Err(error) = read(&text) {
                        assert!(error.starts_with("r.json: "), "{text}: {error}");
                        assert!(!error.contains('\n'), "{text}: {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_position_with_fractions_is_offered_as_an_angle() {
    for (positions, unit) in [("[0, 2, 4]", "counts"), ("[0, 2.5, 4]", "rad")] {
        let error = read(&format!(
            r#"{{"time": [0, 0.1, 0.2], "angle": {positions}}}"#
        ))
        .unwrap_err();
        let option = format!("--column 't=time:s,counts_large=angle:{unit}'");
        assert!(error.contains(&option), "{error}");
    }
}

#[test]
fn what_has_one_object_a_line_or_no_json_is_left_as_it_is() {
    let objects = "{\"t\":0,\"q\":[1,2]}\n{\"t\":1,\"q\":[1,2]}\n";
    for text in [
        objects,
        "{\"t\": 0, \"counts\n{\"t\":1,\"counts_large\":2}\n",
        "{\"t\":0}\n",
        "[info] a log\nt,counts_large\n0,1\n0.001,2\n",
        "[\n",
        "(c) A, (B)\nt,counts_large\n0,1\n",
        "(1700000000.5) can0 141#00\n",
        "[[info]] a log\n",
        "t,x\n[1,2]\n",
        "",
    ] {
        assert_eq!(Other::of(text), None, "{text}");
    }
    // An object and 127 lists are 128 levels.
    let deep = format!("{{\"a\": {}0{}}}\n", "[".repeat(130), "]".repeat(130));
    let error = read(&deep.repeat(2)).unwrap_err();
    assert!(error.contains("recursion limit exceeded"), "{error}");
    let text = "[info] a log\nt,counts_large\n0,1\n0.001,2\n";
    assert_eq!(read(text).unwrap().trace.counts_large, [1, 2]);
}
