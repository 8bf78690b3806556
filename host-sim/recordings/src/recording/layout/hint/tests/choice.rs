//! The column that an example names, of several that could be meant.

use crate::recording::{read_log as read, read_log_at as read_at};

/// Nine rows of these columns.
fn rows(row: impl Fn(u32) -> String) -> String {
    (0..9).map(|k| row(k) + "\n").collect()
}

#[test]
fn without_a_time_the_rate_of_the_rows_is_asked_for() {
    // A shaft that swings, a column that rests, and a time of 2 bits.
    for (text, said) in [
        (
            rows(|k| format!("{},0.5", [0.1, 0.25, -0.5][k as usize % 3])),
            "--row-rate 1000 --column counts_large=1:rad, where the columns and the unit rad are guesses; read",
        ),
        (
            rows(|k| format!("0.5;{}", 8 * (k % 3))),
            "--row-rate 1000 --column counts_large=2:counts, where the columns and the unit counts are guesses",
        ),
    ] {
        let error = read(&text, "").unwrap_err();
        let begin = "no column rises in all of the first rows, as a time does; give the number of the position and the \
                     rate of the rows, for example ";
        assert!(error.contains(&format!("{begin}{said}")), "{error}");
        // With the rate it is a matter of the column alone.
        let error = read_at(Some(1000.0), &text, "").unwrap_err();
        let said = said.replace("--row-rate 1000 ", "");
        assert!(error.contains(&format!("for example {said}")), "{error}");
    }
    // Two rows tell nothing.
    let error = read("1,5\n0,6\n", "").unwrap_err();
    assert!(
        error.contains("--column t=1:s,counts_large=2:counts, "),
        "{error}"
    );
}

#[test]
fn number_of_the_row_and_what_rests_are_no_position() {
    for (text, place) in [
        // The time, what rests, the number of the row, a position.
        (rows(|k| format!("0.00{k},7,{},{}", 94 + k, 5 * (k % 4))), 4),
        // A position at rest is nearer than the number of the row.
        (rows(|k| format!("0.00{k},7,{}", 94 + k)), 2),
    ] {
        let error = read(&text, "").unwrap_err();
        let said = format!("--column t=1:s,counts_large={place}:counts, ");
        assert!(error.contains(&said), "{error}");
    }
}

#[test]
fn angle_that_moves_is_proposed_before_others() {
    for (names, place) in [
        ("x_position,position_y,angle", 3),
        ("pos_x,pos_y,rotation", 3),
        ("pos_x,pos_y,gain", 1),
        ("joint0_pos,joint1_pos,joint2_pos", 1),
    ] {
        let text = format!("stamp,{names}\n") + &rows(|k| format!("0.00{k},{k}.5,{k}.5,{k}.5"));
        let error = read(&text, "").unwrap_err();
        let name = names.split(',').nth(place - 1).unwrap();
        assert!(
            error.contains(&format!("counts_large={name}:rad")),
            "{error}"
        );
    }
    for names in ["joint0_pos,joint1_pos", "/a/position,/b/position"] {
        let text = format!("__time,{names}\n") + &rows(|k| format!("0.00{k},0.5,{k}.5"));
        let error = read(&text, "").unwrap_err();
        let name = names.split(',').nth(1).unwrap();
        assert!(
            error.contains(&format!("counts_large={name}:rad")),
            "{error}"
        );
    }
}

#[test]
fn two_times_are_a_choice() {
    let log = |names: &str| {
        let rows = rows(|k| format!("{},{},{},0.{k}", 2 * k, 10 + 5 * k, k * k));
        format!("{names},angle\n{rows}")
    };
    let error = read(&log("time_ms,real_time_ms,x"), "").unwrap_err();
    let said = "2 times fit: time_ms (500 rows a second); real_time_ms (200 rows a second); name one, for example --column \
                't=time_ms,";
    assert!(error.contains(said), "{error}");
    let error = read(&log("time_ms,stamp,x"), "t=time_ms").unwrap_err();
    assert!(!error.contains("times fit"), "{error}");
    // The part of a second belongs to the seconds beside it.
    let error = read(&log("stamp.sec,stamp.nanosec,x"), "").unwrap_err();
    assert!(!error.contains("times fit"), "{error}");
}

#[test]
fn name_with_words_in_brackets_needs_its_unit() {
    let text = format!("time_ms,pos (left)\n{}", rows(|k| format!("{k},{}", 7 * k)));
    let error = read(&text, "").unwrap_err();
    let said = "'t=time_ms,counts_large=pos (left):UNIT', where 'left' is no unit of counts_large (counts, ";
    assert!(error.contains(said), "{error}");
    let said = "): write the unit of the numbers in the place of UNIT, or convert them to one";
    assert!(error.contains(said), "{error}");
    read(&text, "t=time_ms,counts_large=pos (left):counts").unwrap();
}

#[test]
fn signals_that_are_lines_are_turned_with_their_separator() {
    for (separator, read_with) in [
        (" ", ""),
        ("\t", ""),
        (",", ", delimiter=','"),
        (";", ", delimiter=';'"),
    ] {
        let line = |from: u32| {
            let numbers: Vec<_> = (from..from + 101).map(|k| k.to_string()).collect();
            numbers.join(separator) + "\n"
        };
        let error = read(&(line(0) + &line(7)), "").unwrap_err();
        let said = format!("numpy.loadtxt(FILE{read_with}).T, delimiter=',')");
        assert!(error.contains(&said), "{error}");
    }
}
