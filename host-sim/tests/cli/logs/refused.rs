//! Logs that are refused with one line.

use super::{LOGS, split};
use crate::{Folder, HOST_SIM};

/// Logs that are refused, the options, and parts of the line.
pub(super) const REFUSED: &[(&str, &str, &[&str])] = &[
    (
        "unknown-names.csv",
        "",
        &[
            "line 1: no column t; found: stamp; shaft; speed, separated by ','",
            "--column 't=stamp:s,",
            "moteus, ODrive, VESC Tool, PlotJuggler, SimpleFOC",
        ],
    ),
    (
        "no-header.csv",
        "",
        &[
            "no names but 2 columns",
            "--column t=1:ms,counts_large=2:rad, where the columns and the units ms and rad are guesses; read",
        ],
    ),
    (
        "notes-in-header.csv",
        "",
        &[
            "line 1 has 4 names, and the rows have 3 columns",
            "write one name for each column, or give the numbers",
            "--column t=1:ms,counts_large=2:rad, where",
        ],
    ),
    ("simplefoc-monitor.txt", "", &["SimpleFOC", "--row-rate HZ"]),
    // The options of these are followed in motion.rs.
    (
        "french.csv",
        "",
        &["--column 't=temps (ms),counts_large=position (tr):rev', where the unit rev is a guess"],
    ),
    (
        "french.csv",
        "--column|t=temps (ms),counts_large=position (tr)",
        &[
            "'tr' at the end of the name is no unit",
            "--column 'counts_large=position (tr):rev'",
        ],
    ),
    (
        "german.csv",
        "",
        &["--column 't=Zeit in ms,counts_large=Winkel in Grad:deg', where the unit deg is a guess"],
    ),
    (
        "dates-of-a-column.csv",
        "",
        &["--column 't=when,counts_large=encoder:counts', where the unit counts is a guess; read"],
    ),
    (
        "dates.csv",
        "",
        &["--column 't=time,counts_large=encoder:counts', where the unit counts is a guess; read"],
    ),
    (
        "two-axes.csv",
        "",
        &[
            "2 positions fit: x_counts; y_counts; name one",
            "--column 't=time:s,counts_large=x_counts'",
        ],
    ),
    (
        "one-name-twice.csv",
        "",
        &[
            "2 positions fit: counts in column 2; counts in column 3; name one",
            "--column 'counts_large=2'",
        ],
    ),
    (
        "list-of-axes.jsonl",
        "",
        &[
            "2 positions fit: axes.0.pos_deg; axes.1.pos_deg; name one",
            "--column 't=time_ms,counts_large=axes.0.pos_deg'",
        ],
    ),
    (
        "can-dump.txt",
        "",
        &[
            "line 1: the row has 'pos=3276', a name and a number in one field, and other fields without a name",
        ],
    ),
    (
        "candump.log",
        "",
        &[
            "line 1: the rows are frames of a CAN bus, as '181#CC0C0000'; decode them, for example with cantools",
        ],
    ),
    (
        "hexadecimal.csv",
        "",
        &[
            "line 2: column counts_large: '1CCC' is not a number; if it is hexadecimal, write it in decimal; else",
        ],
    ),
    (
        "fortran.csv",
        "",
        &[
            "line 2: column t: '0.000000000D+00' is not a number; write its exponent with E in the place of D",
        ],
    ),
    (
        "ros2-echo.csv",
        "",
        &[
            "no names but 7 columns",
            "--column t=1:s+2:ns,counts_large=5:rad, where the columns and the units ns and rad are guesses",
        ],
    ),
    (
        "twincat-scope.csv",
        "",
        &[
            "line 7: no column t; found: Time; TorqueCurrent; Time; ActPos, separated by tabs",
            "--column 't=Time,counts_large=ActPos:counts', where the unit counts is a guess",
        ],
    ),
    (
        "not-a-number.csv",
        "",
        &["line 7: column counts_large: 'n/a' is not a number"],
    ),
    (
        "cut.csv",
        "",
        &["line 52: 1 field where the first line has 2; remove the line"],
    ),
    (
        "thousands.csv",
        "",
        &[
            "line 2: column counts_large: '1.234,0'",
            "without separators of thousands",
        ],
    ),
    (
        "decimal-commas-and-commas.csv",
        "",
        &["line 2: 3 fields", "need another separator than a comma"],
    ),
    (
        "time-goes-back.csv",
        "",
        &["line 4: column t: 0.0005 s is before the 0.001 s above it; sort the rows by time"],
    ),
    (
        "seconds-in-ms.csv",
        "",
        &["column t: rows 1 s apart", "--column t=NAME:ms"],
    ),
    (
        "two-joints.csv",
        "",
        &[
            "line 1: 2 positions fit a log of PlotJuggler: /a/position; /b/position; name one",
            "--column 't=__time:s,counts_large=/a/position:rad'",
        ],
    ),
    (
        "two-controllers.jsonl",
        "",
        &["line 31: field controller: 2 after 1; keep the lines of one"],
    ),
    (
        "broken.jsonl",
        "",
        &["line 2: no JSON object; remove the line"],
    ),
    (
        "absolute-4096.csv",
        "--modulus 3600",
        &["line 21: column counts_large: 3615 with --modulus 3600: raw must be below modulus"],
    ),
    (
        "milliseconds-at-700-hz.csv",
        "--column t=t_ms",
        &[
            "column t: ",
            "% of the steps",
            // 700 Hz, in a log of 0.24 s with whole milliseconds.
            "came at an even rate, give it with --row-rate 70",
            "add --resample",
        ],
    ),
    (
        "own.csv",
        "--column t=time",
        &["no column 'time', which --column names for t; found: t; counts_large"],
    ),
    (
        "own.csv",
        "--row-rate 500",
        &[
            "--row-rate 500: column 't' has 1000 rows a second; give --row-rate 1000 if they came at an even rate, leave",
        ],
    ),
    (
        "own.csv",
        "--column t=t:ms --row-rate 1000",
        &["--row-rate 1000: column 't' has 1000000 rows a second; give"],
    ),
    (
        "own.csv",
        "--modulus counts_small=4096",
        &["--modulus counts_small=4096: there is no column counts_small"],
    ),
    (
        "own.csv",
        "--resample 1",
        &["--resample 1: ", "at 5 Hz or more"],
    ),
];

#[test]
fn unreadable_logs_are_refused_with_one_line() {
    let folder = Folder::new(HOST_SIM);
    for (log, options, said) in REFUSED {
        let path = format!("{LOGS}/{log}");
        for command in ["replay", "plot"] {
            let mut arguments = vec![command, &path, "--out", "out"];
            arguments.extend(split(options));
            let line = folder.refused(&arguments);
            assert!(line.contains(log), "{log}: {line}");
            for part in *said {
                assert!(line.contains(part), "{log}: {line}");
            }
        }
    }
}
