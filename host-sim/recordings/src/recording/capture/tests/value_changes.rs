use super::{DURATION, changes, check, decode};
use crate::recording::read_log;

/// The dump of the motion as a logic analyser writes it, with ticks of `tick_ns`.
fn dump(timescale: &str, tick_ns: f64) -> String {
    let rows = changes(|t, [a, b]| format!("#{:.0} {a}! {b}\" 0#\n", 1e9 * t / tick_ns));
    format!(
        "$date Sat Nov 28 20:00:00 2026 $end\n$version libsigrok 0.5.2 $end\n$comment\n  Acquisition with 3/8 \
         channels at 1 MHz\n$end\n$timescale {timescale} $end\n$scope module libsigrok $end\n\
         $var wire 1 ! D0 $end\n$var wire 1 \" D1 $end\n$var wire 1 # D2 $end\n$upscope $end\n\
         $enddefinitions $end\n{rows}"
    )
}

#[test]
fn dumps_are_the_motion_in_any_unit_of_time() {
    for (timescale, tick_ns) in [
        ("1 us", 1e3),
        ("100ns", 100.0),
        ("10 ps", 0.01),
        ("1 fs", 1e-6),
    ] {
        let recording = decode(&dump(timescale, tick_ns), "", "D0|D1", None).unwrap();
        check(&recording, 1, timescale);
        let said = "t from 'time [ns]' (ns), line A from column 'D0', line B from column 'D1'";
        assert!(recording.notes[0] == said, "{:?}", recording.notes);
    }
    let dos = dump("1 us", 1e3).replace('\n', "\r\n");
    check(&decode(&dos, "", "D1|D0", None).unwrap(), -1, "reversed");
    let no_end = dump("1 us", 1e3);
    let recording = decode(no_end.trim_end(), "", "D0|D1", None).unwrap();
    check(&recording, 1, "no end of line");
}

/// A simulator writes one change a line, the first levels without a time, and a variable under several names.
#[test]
fn variables_of_a_simulation_are_named_by_their_scopes() {
    let rows = changes(|t, [a, b]| {
        let count = (1e6 * t).round() as u32;
        format!("#{count}\n{a}a\n{b}b\nb{count:b} n\nr{t} r\nsrun s\n")
    });
    let text = format!(
        "$version\n  a simulator\n$end\n$timescale 1us $end\n$scope module top $end\n$var wire 1 a line [0] $end\n\
         $var wire 1 b line [1] $end\n$var reg 8 n n [7:0] $end\n$var real 64 r r $end\n$var string 1 s s $end\n\
         $scope module part $end\n$var wire 1 a phase $end\n$upscope $end\n$scope module other $end\n\
         $var wire 1 b phase $end\n$upscope $end\n$upscope $end\n$enddefinitions $end\n\
         $dumpvars\nxa\nzb\n$end\n{rows}"
    );
    for (lines, sign) in [
        ("line[0]|line[1]", 1),
        ("top.other.phase|top.part.phase", -1),
    ] {
        check(&decode(&text, "", lines, None).unwrap(), sign, lines);
    }
    let error = decode(&text, "", "n|line[1]", None).unwrap_err();
    assert!(error.contains("column 'n': "), "{error}");
    assert!(error.contains(" is no level of a line"), "{error}");
    let error = decode(&text, "", "", None).unwrap_err();
    let said = "found: time [ns]; line[0]; line[1]; n; r; s; top.part.phase; top.ot ...";
    assert!(error.contains(said), "{error}");
}

/// A dump has no position, unless a variable is one.
#[test]
fn bits_of_a_dump_lead_to_decode() {
    let text = dump("1 us", 1e3).replace("D0", "a").replace("D1", "b");
    let text = text.replace("$var wire 1 # D2", "$var wire 8 # n");
    let error = read_log(&text, "").unwrap_err();
    let said = "the columns a, b are 0 or 1 in the first rows; if they are the lines of an encoder";
    assert!(error.contains(said), "{error}");
    let recording = read_log(&text, "counts_large=n").unwrap();
    assert_eq!(recording.t[1], 0.000_558);
}

#[test]
fn a_dump_that_is_wrong_is_refused_by_its_line() {
    let end = format!("#{:.0}", 1e6 * DURATION);
    for (from, to, said) in [
        (
            "$timescale 1 us $end\n",
            "",
            "line 11: not a value change dump (VCD): no $timescale",
        ),
        (
            "1 us",
            "1 min",
            "line 6: not a value change dump (VCD): invalid timescale unit",
        ),
        (
            "$enddefinitions $end\n",
            "",
            "line 12: not a value change dump (VCD): no $enddefinitions",
        ),
        (
            "$upscope $end\n",
            "$upscope\n",
            "line 12: not a value change dump (VCD): ",
        ),
        (
            "0!",
            "0%",
            "line 94: not a value change dump (VCD): no $var has the code %",
        ),
        (
            &end,
            "1",
            "the file ends in a command; remove the line if the file was cut there",
        ),
        (&end, "#5", "line 94: column t: 0.000005 s is before the "),
    ] {
        let text = dump("1 us", 1e3);
        let at = text.rfind(from).unwrap();
        let tail = text[at..].replacen(from, to, 1);
        let tail = if from == end { to } else { &tail };
        let text = format!("{}{tail}", &text[..at]);
        let error = decode(&text, "", "D0|D1", None).unwrap_err();
        assert!(error.contains(said), "{from}: {error}");
    }
}
