//! Tests of tables with the numbers of one signal a row.

use crate::recording::read_log as read;

#[test]
fn numbers_of_one_time_are_one_row() {
    for (header, row, shaft, iq) in [
        ("Timestamp,Name,Value", "T,K,", "shaft", "iq"),
        ("time,series,unit,value", "T,K,A,", "shaft", "iq"),
        ("_time,_field,topic,_value", "T,K,m,", "shaft.m", "iq.m"),
    ] {
        let mut text = format!("# a log\n{header}\n");
        for k in 0..9 {
            for (key, value) in [("temp", 20), ("shaft", 8 * k), ("iq", k)] {
                text += &row.replace('T', &format!("0.{k}")).replace('K', key);
                text += &format!("{value}\n");
            }
        }
        let time = header.split(',').next().unwrap();
        let options = format!("t={time}:s,counts_large={shaft}:counts,current={iq}:A");
        let recording = read(&text, &options).unwrap();
        assert_eq!(recording.trace.counts_large[..3], [0, 8, 16], "{header}");
        assert_eq!(recording.trace.current.unwrap()[..3], [0.0, 1.0, 2.0]);
        assert_eq!(recording.t.len(), 9);
    }
}

#[test]
fn numbers_of_a_joint_have_its_name() {
    let mut text = String::from("time_s,joint,state,counts,iq\n");
    for k in 0..9 {
        text += &format!(
            "0.{k}0,left,RUN,{},0.5\n0.{k}5,right,RUN,{},0\n",
            8 * k,
            9 - k
        );
    }
    let error = read(&text, "").unwrap_err();
    assert!(
        error.contains("found: time_s; left.counts; left.iq; right.counts; right.iq"),
        "{error}"
    );
    let recording = read(
        &text,
        "t=time_s,counts_large=right.counts,current=left.iq:A",
    )
    .unwrap();
    assert_eq!(recording.trace.counts_large[..3], [9, 8, 7]);
    assert_eq!(recording.trace.current.unwrap()[..2], [0.5; 2]);
    // Where the user names a column of the table, or it has one of ours, its rows are the rows.
    let wide = read(&text, "t=time_s,counts_large=counts").unwrap();
    assert_eq!(wide.trace.counts_large[..3], [0, 9, 8]);
    let own = read(&text.replace("counts", "counts_large"), "t=time_s").unwrap();
    assert_eq!(own.trace.counts_large[..3], [0, 9, 8]);
    // So are those of one joint.
    let one: String = text
        .lines()
        .filter(|line| !line.contains("right"))
        .map(|line| format!("{line}\n"))
        .collect();
    assert_eq!(read(&one, "").unwrap().trace.counts_large[..3], [0, 8, 16]);
}

#[test]
fn name_without_a_number_has_its_latest_one() {
    let mut text = String::from("time;signal;value\n0,0;iq;7\n");
    for k in 1..9 {
        text += &format!("0,{k}1;shaft;{}\n0,{k}2;iq;{k},5\n0,{k}3;vbus;24\n", 8 * k);
    }
    let options = "t=time:s,counts_large=shaft:counts,current=iq:A";
    let recording = read(&text, options).unwrap();
    assert_eq!(recording.trace.counts_large[..3], [8, 16, 24]);
    assert_eq!(recording.trace.current.unwrap()[..3], [7.0, 1.5, 2.5]);
    let said = "17 rows without a position are left out, the first in line 2";
    assert!(
        recording.notes.iter().any(|note| note == said),
        "{:?}",
        recording.notes
    );
    // Two numbers of one name at one time are two rows.
    let twice = read(&text.replace("0,22;iq", "0,21;shaft"), options).unwrap_err();
    let said = "of the rows have the time of the row before, the first in line 7 at 0.21 s";
    assert!(twice.contains(said), "{twice}");
}

#[test]
fn errors_name_line_and_names() {
    let text = "time,name,value\n0,shaft,1\n0.001,shaft,2\n0.002,iq,3\n";
    let error = read(text, "").unwrap_err();
    let said =
        "r.csv: line 1: no column t; found: time; shaft; iq, separated by ','; name the columns";
    assert!(error.starts_with(said), "{error}");
    let columns = "t=time:s,counts_large=shaft:counts";
    for (row, said) in [
        (
            "0.003,shaft",
            "line 5: 2 fields where the first line has 3; remove the line",
        ),
        (
            "0.003,shaft,x",
            "line 5: column counts_large: 'x' is not a number",
        ),
    ] {
        let error = read(&format!("{text}{row}\n"), columns).unwrap_err();
        assert!(error.starts_with(&format!("r.csv: {said}")), "{error}");
    }
    // Values of names that are numbers are columns.
    let error = read("time,channel,value\n0,1,5\n0.001,1,6\n", "").unwrap_err();
    assert!(error.contains("found: time; channel; value"), "{error}");
}

/// Rows of two motors in turn, whose numbers are in a column called `key`. The first one turns by more than three
/// revolutions if its positions are radians.
fn motors(key: &str) -> String {
    let row = |k: u32| format!("0.{k:02}0,1,{}.5,7\n0.{k:02}5,2,{},8\n", 8 * k, 90 - k);
    format!(
        "time_s,{key},position,iq\n{}",
        (0..50).map(row).collect::<String>()
    )
}

#[test]
fn numbers_of_motors_are_no_rows_of_one_shaft() {
    for key in [
        "id",
        "ID",
        "motor_id",
        "Motor ID",
        "axis",
        "node_id",
        "canId",
        "can_id",
        "servo",
        "joint_index",
        "device_id",
    ] {
        let text = motors(key);
        let error = read(&text, "").unwrap_err();
        let said = format!(
            "r.csv: line 1: each row is of one of several motors: '{key}' is 1; 2; name the columns of one motor, for \
             example --column 't=time_s,counts_large=1.position:deg', where the unit deg is a guess"
        );
        assert_eq!(error, said);
        let one = read(
            &text,
            "t=time_s,counts_large=2.position:counts,current=2.iq:A",
        )
        .unwrap();
        assert_eq!(one.trace.counts_large[..3], [90, 89, 88], "{key}");
        assert_eq!(one.trace.current.unwrap()[..2], [8.0; 2]);
        assert_eq!((one.t.len(), one.trace.rate_hz), (50, 100.0));
        // Neither the project's own name nor a name of the table is that of one shaft.
        let error = read(&text.replace("position", "counts_large"), "t=time_s").unwrap_err();
        assert!(
            error.contains("counts_large=1.counts_large:deg'"),
            "{error}"
        );
        let error = read(&text, "t=time_s,counts_large=position:counts").unwrap_err();
        assert!(
            error.contains("found: time_s; 1.position; 1.iq; 2.position; 2.iq"),
            "{error}"
        );
    }
}

#[test]
fn unit_of_a_motor_is_that_of_the_known_log() {
    let text = motors("id")
        .replace("iq", "q_A")
        .replace("time_s", "timestamp");
    let error = read(&text, "").unwrap_err();
    assert!(
        error.contains("'t=timestamp:s,counts_large=1.position:rev'"),
        "{error}"
    );
}

#[test]
fn other_numbers_are_no_motors() {
    let log = |header: &str, key: &dyn Fn(u32) -> String| {
        let row = |k: u32| format!("0.{k:03},{},{}\n", key(k), 8 * k);
        let rows: String = (0..200).map(row).collect();
        read(&format!("{header}\n{rows}"), "t=time_s,counts_large=counts")
    };
    // A number of the row, of one motor, of a test that goes on, and one with a fraction.
    for key in [
        &(|k: u32| k.to_string()) as &dyn Fn(u32) -> String,
        &|_| "3".to_owned(),
        &|k| (k / 50).to_string(),
        &|k| format!("{}.5", k % 2),
    ] {
        assert_eq!(log("time_s,id,counts", key).unwrap().t.len(), 200);
    }
    for name in ["grid", "valid", "mode", "encoder_ok"] {
        let header = format!("time_s,{name},counts");
        assert_eq!(log(&header, &|k| (k % 2).to_string()).unwrap().t.len(), 200);
    }
    // The position may have such a name.
    let text = log("time_s,counts,axis", &|k| (k % 2).to_string());
    assert_eq!(text.unwrap().t.len(), 200);
}
