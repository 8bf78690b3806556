//! Tests of the options that errors name.

mod choice;
mod numbers;

use crate::recording::{read_log as read, read_log_at as read_at};

#[test]
fn columns_of_two_levels_are_named_where_no_position_is() {
    let log = |header: &str, level: u32| {
        let rows = (0..20).map(|k| format!("{k}e-3,{},{},1\n", k / 2 % 2, level * (k % 2)));
        format!("{header}\n# a comment\n\n{}", rows.collect::<String>())
    };
    let said = "r.csv: line 1: the columns s1, s2 are 0 or 1 in the first rows; if they are the lines of \
                an encoder, make a recording of them with host-sim decode";
    assert_eq!(read(&log("t,s1,s2,on", 1), "").unwrap_err(), said);
    let error = read(&log("t,enc_a,enc_b,on", 1), "").unwrap_err();
    assert!(
        error.contains("the columns enc_a, enc_b are 0 or 1"),
        "{error}"
    );
    for (header, level) in [("t,s1,s2,on", 2), ("t,s1,s2,pos", 1)] {
        let error = read(&log(header, level), "").unwrap_err();
        assert!(error.contains("no column counts_large; found: "), "{error}");
    }
    assert!(read(&log("t,s1,s2,on", 1), "counts_large=s1").is_ok());
}

#[test]
fn position_with_fractions_is_taken_for_an_angle() {
    for (rows, unit) in [
        ("0;7\n1;8", "counts"),
        ("0;7,0\n1;8", "counts"),
        ("0;7\n1;8,5", "rad"),
        ("0,5;7\n1;8", "counts"),
    ] {
        let error = read(&format!("time;position\n{rows}\n"), "").unwrap_err();
        let said = format!("for example --column 't=time:s,counts_large=position:{unit}'");
        assert!(error.contains(&said), "{rows}: {error}");
    }
}

#[test]
fn time_since_1970_is_proposed_with_its_unit() {
    for (first, unit) in [
        ("1700000000123456789", "ns"),
        ("1700000000123456", "us"),
        ("1700000000123", "ms"),
        ("1700000000.5", "s"),
        ("4200000000000", "s"),
    ] {
        // The column of the counts is none of time.
        let error = read(&format!("time;position\n{first};1700000000123\n"), "").unwrap_err();
        let said = format!("--column 't=time:{unit},counts_large=position:counts'");
        assert!(error.contains(&said), "{first}: {error}");
        // The numbers tell the unit.
        let is_guess = error.contains("where the units s and counts are guesses");
        assert_eq!(is_guess, first == "4200000000000", "{error}");
    }
}

#[test]
fn columns_without_names_are_proposed_by_their_first_numbers() {
    for (rows, said) in [
        (
            "0,1\n1,2\n",
            "t=1:s,counts_large=2:counts, where the columns and the units s and counts are guesses; read",
        ),
        (
            "0.5,1.25\n0.75,2\n",
            "t=1:s,counts_large=2:rad, where the columns and the units s and rad are guesses; read",
        ),
        (
            // The number of the device stays.
            "0.5,3,1.25\n0.75,3,2\n",
            "t=1:s,counts_large=3:rad, where the columns and the units s and rad are guesses; read",
        ),
        (
            "1700000000123,a,7\n1700000000124,a,8\n",
            "t=1:ms,counts_large=3:counts, where the columns and the unit counts are guesses; read",
        ),
        (
            "x,1700000000,999000000,7.5\nx,1700000001,0,8\n",
            "t=2:s+3:ns,counts_large=4:rad, where the columns and the units ns and rad are guesses; read",
        ),
        (
            "1700000000.5,7\n1700000000.6,8\n",
            "t=1:s,counts_large=2:counts, where the columns and the unit counts are guesses; read",
        ),
        (
            "12:00:00.1,7,3\n12:00:00.2,8,4\n",
            "t=1,counts_large=2:counts, where the columns and the unit counts are guesses; read",
        ),
    ] {
        let error = read(rows, "").unwrap_err();
        assert!(
            error.contains(&format!("for example --column {said}")),
            "{error}"
        );
    }
}

#[test]
fn whole_seconds_and_their_part_are_columns_of_any_name() {
    let text = "1700000000,999000000,7\n1700000001,0,8\n1700000001,1000000,9\n";
    let recording = read(text, "t=1:s+2:ns,counts_large=3:counts").unwrap();
    let steps: Vec<_> = recording
        .t
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .collect();
    assert!(
        steps.iter().all(|step| (step - 0.001).abs() < 1e-9),
        "{steps:?}"
    );
    let said = "t from column 1 (s) and column 2 (ns), counts_large from column 3 (counts)";
    assert!(
        recording.notes[0].starts_with(said),
        "{:?}",
        recording.notes
    );
    let error = read(text, "t=1:s+9:ns,counts_large=3:counts").unwrap_err();
    assert!(
        error.contains("no column '9', which --column names for t"),
        "{error}"
    );
    let error = read(text, "t=1:s+2:us,counts_large=3:counts").unwrap_err();
    assert!(error.contains("line 1: column t: "), "{error}");
    // Other units are no parts of a second, and the plus belongs to the name.
    for (columns, said) in [
        ("t=1:ms+2:ns,counts_large=3", "'ms+2' is no unit of t"),
        ("t=1:s+2:s,counts_large=3", "'s+2' is no unit of t"),
        ("t=1+2:ns,counts_large=3", "no column '1+2'"),
    ] {
        let error = read(text, columns).unwrap_err();
        assert!(error.contains(said), "{columns}: {error}");
    }
}

#[test]
fn example_names_no_target_error_or_duration() {
    for (names, said) in [
        (
            "time_s,ref_theta,theta",
            "'t=time_s,counts_large=theta:counts', where the unit counts is a guess; read without",
        ),
        (
            "time_s,error_count,angle_deg",
            "'t=time_s,counts_large=angle_deg'; read without",
        ),
        (
            "loop_time_us,time,counts",
            "'t=time:s,counts_large=counts', where the unit s is a guess; read without",
        ),
        (
            "time_s,dpos_deg,pos_err",
            "'t=time_s,counts_large=POSITION:counts': by its name 'dpos_deg' is a rate, a target, an error, a \
             difference or an electrical angle; read without",
        ),
    ] {
        let error = read(&format!("{names}\n2,3,4\n3,4,5\n"), "").unwrap_err();
        assert!(
            error.contains(&format!("for example --column {said}")),
            "{error}"
        );
    }
}

#[test]
fn example_has_no_time_where_the_rate_is_stated() {
    for (text, said) in [
        (
            "x,y\n0,1\n1,2\n",
            "for example --column 'counts_large=POSITION:counts'; read without",
        ),
        (
            "0,1\n1,2\n",
            "give the number of the column, for example --column counts_large=2:counts, where the columns and",
        ),
        (
            "1\n2\n",
            "give the number of the column, for example --column counts_large=1:counts, where the columns and",
        ),
    ] {
        let error = read_at(Some(1000.0), text, "").unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    let error = read("1\n2\n", "").unwrap_err();
    let said = "there are no names but 1 column; give the number of the column and the rate of the rows, for \
                example --row-rate 1000 --column counts_large=1:counts, where";
    assert!(error.contains(said), "{error}");
}

#[test]
fn log_without_a_time_is_told_of_the_rate_of_its_rows() {
    let said = ", or give the rate of the rows with --row-rate HZ in the place of a time; ";
    for (header, tells) in [
        ("x,pos_deg", true),
        ("pos_deg,v_rad", true),
        ("T,pos_deg", false),
        ("clock_ms,pos_deg", false),
        ("Timer,pos_deg", false),
        ("dt_ms,pos_deg", true),
        ("a,pos_deg\n[ms],[deg]", false),
        ("a,pos_deg\n[A],[deg]", true),
    ] {
        let error = read(&format!("{header}\n0,1\n1,2\n"), "").unwrap_err();
        assert_eq!(error.contains(said), tells, "{header}: {error}");
    }
    let error = read("0,1\n1,2\n", "").unwrap_err();
    assert!(!error.contains(said), "{error}");
}

#[test]
fn position_of_a_known_log_without_a_time_has_its_unit() {
    for (name, unit) in [
        ("odrv0.axis0.encoder.pos_estimate", "rev"),
        ("odrv0.axis0.pos_estimate", "rev"),
        ("/joint_states/a/position", "rad"),
        ("position", "rad"),
        ("encoder_position", "rad"),
    ] {
        let error = read_at(Some(1000.0), &format!("# {name}\n-0.25\n0.5\n"), "").unwrap_err();
        assert!(
            error.contains(&format!("--column 'counts_large={name}:{unit}'")),
            "{error}"
        );
    }
}

#[test]
fn units_that_nothing_states_are_called_guesses() {
    for (header, row, said) in [
        (
            "Time,Position",
            "0,0.5",
            "'t=Time:s,counts_large=Position:rad', where the units s and rad are guesses; ",
        ),
        (
            "time_ms,angle",
            "0,5",
            "'t=time_ms,counts_large=angle:counts', where the unit counts is a guess; ",
        ),
        (
            "stamp,angle_deg_x",
            "1700000000000,5",
            ":ms,counts_large=angle_deg_x:counts', where the unit counts is a guess; ",
        ),
        (
            "a,encoder.pos_estimate",
            "0,0.5",
            "'t=TIME:s,counts_large=encoder.pos_estimate:rev', or give",
        ),
    ] {
        let error = read(&format!("{header}\n{row}\n{row}\n"), "").unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn joint_is_proposed_where_no_position_is_named() {
    for (header, said) in [
        (
            "stamp,joint1,joint2",
            "2 positions fit: joint1; joint2; name one",
        ),
        (
            "stamp,target_pos,elbow_joint",
            "counts_large=elbow_joint:rad', where",
        ),
        ("stamp,J1,angle", "counts_large=angle:rad', where"),
    ] {
        let error = read(&format!("{header}\n0,0.5,0.1\n1,0.7,0.2\n"), "").unwrap_err();
        assert!(error.contains(said), "{error}");
        assert!(!error.contains("by its name"), "{error}");
    }
}

#[test]
fn column_of_dates_is_the_time_of_the_example() {
    for (name, field, option) in [
        ("when", "2026-03-01T23:59:57.00K+05:30", "t=when"),
        ("timestamp", "2026-03-01T23:59:57.00K+0530", "t=timestamp"),
        ("when", "12:00:00.00K", "t=when"),
        ("time", "59:59.99K", "t=time"),
        // The unit of the name is none of the date.
        ("time_min", "12:00:00.00K", "t=time_min:s"),
    ] {
        let row = |k: usize| format!("{},{}\n", field.replace('K', &k.to_string()), 8 * k);
        let text = format!("{name},encoder\n{}", (0..10).map(row).collect::<String>());
        let error = read(&text, "").unwrap_err();
        let said = format!(
            "found: {name}; encoder, separated by ','; name the columns and units, for example --column \
             '{option},counts_large=encoder:counts', where the unit counts is a guess; read"
        );
        assert!(error.contains(&said), "{error}");
        let recording = read(&text, &format!("{option},counts_large=encoder:counts")).unwrap();
        let steps = recording.t.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.into_iter().all(|step| (step - 0.001).abs() < 1e-6));
    }
}

#[test]
fn positions_of_which_one_is_meant_are_listed() {
    for (names, said) in [
        (
            "time,x_counts,y_counts",
            "2 positions fit: x_counts; y_counts; name one, for example --column \
             't=time:s,counts_large=x_counts', where the unit s is a guess; read",
        ),
        // A name that stands twice is no option.
        (
            "t,counts,counts",
            "2 positions fit: counts in column 2; counts in column 3; name one, for example --column \
             'counts_large=2'; read",
        ),
        (
            "t,pos_mm,pos_raw",
            "name the columns and units, for example --column 'counts_large=pos_raw:counts', where",
        ),
        (
            "t,u_deg_pos,v_pos,w_pos,x_pos,y_pos",
            "5 positions fit: u_deg_pos; v_pos; w_pos; x_pos; ...; name one, for",
        ),
        (
            "time,time,counts",
            "name the columns and units, for example --column 't=time:s,counts_large=counts', where",
        ),
        (
            "counts,time,time",
            "name the columns and units, for example --column 't=2:s,counts_large=counts', where",
        ),
    ] {
        let field = |name: &str, k: usize| match name.starts_with('t') {
            true => format!("{}", k as f64 * 1e-3),
            false => k.to_string(),
        };
        let row = |k: usize| {
            let fields: Vec<_> = names.split(',').map(|name| field(name, k)).collect();
            format!("{}\n", fields.join(","))
        };
        let text = format!("{names}\n{}", (0..20).map(row).collect::<String>());
        let error = read(&text, "").unwrap_err();
        assert!(error.contains(said), "{names}: {error}");
        let (_, option) = error.split_once("--column '").unwrap();
        let (option, _) = option.split_once('\'').unwrap();
        read(&text, option).unwrap();
    }
}

#[test]
fn row_with_a_name_in_one_field_is_no_header() {
    let row = |k: usize| format!("(176722560{k}.000000) can0 pos=-{k}\n");
    let text: String = (0..9).map(row).collect();
    let said = "r.csv: line 1: the row has 'pos=-0', a name and a number in one field, and other fields without a \
                name; write the numbers alone, separated by commas, and the names in a line above them, for example \
                t,counts_large";
    assert_eq!(read(&text, "").unwrap_err(), said);
    // Other columns may be read.
    let row = |k: usize| format!("{k}e-3 {k} state=1\n");
    let text: String = (0..9).map(row).collect();
    let error = read(&text, "").unwrap_err();
    assert!(
        error.contains("--column t=1:s,counts_large=2:counts"),
        "{error}"
    );
}

#[test]
fn column_beside_the_time_is_proposed_whatever_its_name() {
    for (names, said) in [
        (
            "time_us,raw",
            "--column 't=time_us,counts_large=raw:counts', where the unit counts is a guess",
        ),
        (
            "value,ms",
            "--column 't=ms,counts_large=value:counts', where the unit counts is a guess",
        ),
        (
            "time_us,ra_arcsec",
            "--column 't=time_us,counts_large=ra_arcsec'",
        ),
        ("time_us,speed", "counts_large=POSITION:counts'"),
        ("time_us,raw,x", "counts_large=POSITION:counts'"),
    ] {
        let fields = "7,".repeat(names.split(',').count() - 2) + "8";
        let error = read(&format!("{names}\n0,{fields}\n1,{fields}\n"), "").unwrap_err();
        assert!(error.contains(said), "{names}: {error}");
    }
}
