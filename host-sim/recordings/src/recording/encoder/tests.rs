use crate::recording::{ReadOptions, Recording};

/// Rows of time, motor and handle, with columns and modulus as on the command line. The default
/// device has 4096 counts per revolution on the motor and 20000 on the handle.
fn read(rows: &[(&str, &str)], columns: &str, modulus: &[&str]) -> Result<Recording, String> {
    let mut options = ReadOptions::default();
    if !columns.is_empty() {
        options.add_columns(columns).unwrap();
    }
    for text in modulus {
        options.set_modulus(text).unwrap();
    }
    let mut text = "t,counts_large,counts_small\n".to_owned();
    for (k, (large, small)) in rows.iter().enumerate() {
        text += &format!("{},{large},{small}\n", k as f64 / 1000.0);
    }
    let read = Recording::parse_as(text.as_bytes(), "r.csv", &options);
    read.map_err(|error| error.to_string())
}

fn counts(of: &[u32]) -> Vec<i32> {
    of.iter().map(|&count| count as i32).collect()
}

/// A whole turn of 4096 counts is 360 degrees; halves are rounded up.
#[test]
fn angles_are_counts_to_the_nearest() {
    let degrees = "counts_large=counts_large:deg,counts_small=counts_small:rev";
    let rows = [("0", "0"), ("90", "0.5"), ("-90", "-2"), ("45.0219", "1")];
    let recording = read(&rows, degrees, &[]).unwrap();
    // 45.0219 degrees are 512.2492 counts.
    let large = counts(&recording.trace.counts_large);
    assert_eq!(large, [0, 1024, -1024, 512]);
    let small = counts(recording.trace.counts_small.as_ref().unwrap());
    assert_eq!(small, [0, 10_000, -40_000, 20_000]);
    let rounded = |recording: &Recording| {
        let said = recording.notes.iter();
        said.filter(|note| note.contains("are rounded to the nearest"))
            .count()
    };
    assert_eq!(rounded(&recording), 0, "{:?}", recording.notes);
    // A quarter of a turn and half a count.
    let halves = [("90.0439453125", "0"), ("-90.0439453125", "0")];
    let recording = read(&halves, degrees, &[]).unwrap();
    assert_eq!(counts(&recording.trace.counts_large), [1025, -1024]);
    // 45.0221 degrees are 512.2514 counts: more than a quarter off.
    let rows = [("0", "0"), ("45.0221", "0.5")];
    assert_eq!(rounded(&read(&rows, degrees, &[]).unwrap()), 1);
    // 45.03 degrees are 512.3413 counts.
    let rows = [("0", "0"), ("45.03", "0.5")];
    let recording = read(&rows, degrees, &[]).unwrap();
    assert_eq!(rounded(&recording), 1);
    let note =
        "counts_large: positions are up to 0.34 counts from whole counts with 4096 counts/rev";
    assert!(
        recording.notes.iter().any(|n| n.starts_with(note)),
        "{:?}",
        recording.notes
    );
}

/// Angles from a zero between two counts, with as many digits as a float has.
#[test]
fn zero_of_an_angle_is_anywhere() {
    for zero in [0.0, 0.25, 0.5, 0.7, -0.5] {
        let angle = |k: i32| f64::from(((f64::from(k) + zero) * 360.0 / 4096.0) as f32);
        let angles: Vec<_> = (0..2000).map(|k| angle(k - 700).to_string()).collect();
        let rows: Vec<_> = angles.iter().map(|angle| (angle.as_str(), "0")).collect();
        let recording = read(&rows, "counts_large=counts_large:deg", &[]).unwrap();
        let large = counts(&recording.trace.counts_large);
        assert!(
            large.windows(2).all(|pair| pair[1] - pair[0] == 1),
            "{zero}"
        );
        assert!(
            !recording
                .notes
                .iter()
                .any(|note| note.contains("positions"))
        );
    }
}

/// A swing of 1100 steps, as an encoder of `steps` a revolution gives it.
fn swing(steps: f64, written: impl Fn(f64) -> String, columns: &str) -> Vec<String> {
    let swing = (0..3000).map(|k| (1100.0 * (f64::from(k) * 0.01).sin()).floor());
    let positions: Vec<_> = swing.map(|step| written(step / steps)).collect();
    let rows: Vec<_> = positions.iter().map(|at| (at.as_str(), "0")).collect();
    let notes = read(&rows, columns, &[]).unwrap().notes.into_iter();
    notes
        .filter(|note| note.starts_with("counts_large: "))
        .collect()
}

#[test]
fn counts_per_revolution_are_those_of_the_steps_of_the_angle() {
    let degrees = |revolutions: f64| (360.0 * revolutions).to_string();
    let option = "counts_large=counts_large:deg";
    let given = "give 2156 counts/rev with --counts-per-rev, or as large.counts_per_rev in the file of --device";
    let off = "counts_large: positions are up to 0.50 counts from whole counts with 4096 counts/rev and are \
               rounded to the nearest; they are multiples of 1/2156 revolution: if these are the encoder's \
               counts, ";
    assert_eq!(swing(2155.86, degrees, option), [format!("{off}{given}")]);
    let coarse = "counts_large: positions change by multiples of 4 counts alone with 4096 counts/rev; they are \
                  multiples of 1/1024 revolution: if these are the encoder's counts, ";
    let given = given.replace("2156", "1024");
    assert_eq!(swing(1024.0, degrees, option), [format!("{coarse}{given}")]);
    assert!(swing(4096.0, degrees, option).is_empty());
    // A quantity that has no steps.
    let smooth = |revolutions: f64| format!("{}", (7e4 * revolutions).sin());
    let notes = swing(1024.0, smooth, option);
    assert!(
        notes[0].ends_with(
            "if the encoder has more counts, give them with --counts-per-rev, or as \
                                large.counts_per_rev in the file of --device"
        ),
        "{notes:?}"
    );
    // At 42 revolutions numbers of 32 bits are multiples of 2^-18, as in logs of ODrive; at 0.1 they are finer.
    for (begin, is_of_floats) in [(42.0, true), (0.1, false)] {
        let noisy = |turns: f64| (begin + turns.rem_euclid(50.0) / 262_144.0).to_string();
        let notes = swing(1.0, noisy, "counts_large=counts_large:rev");
        let own = "they are multiples of 1/262144 revolution: if";
        assert_eq!(!notes[0].contains(own), is_of_floats, "{notes:?}");
    }
    // Digits of a log in rad are no counts.
    for (digits, last) in [(2, "0.01"), (3, "0.001")] {
        let rounded = |turns: f64| format!("{:.digits$}", std::f64::consts::TAU * turns);
        let notes = swing(1e5, rounded, "counts_large=counts_large:rad");
        let said = format!(
            "; they are multiples of {last} rad, the last digit of the log: log more digits"
        );
        assert!(notes[0].ends_with(&said), "{notes:?}");
    }
    // Whole turns are no steps of an encoder: those of ODrive were counts once.
    let turns = swing(
        1.0,
        |turns| turns.to_string(),
        "counts_large=counts_large:rev",
    );
    let said = "counts_large: positions are whole revolutions alone: if the numbers are counts, name their unit \
                with --column OURS=THEIRS:counts";
    assert_eq!(turns, [said]);
}

#[test]
fn counts_that_change_by_several_are_reported() {
    let counts = |revolutions: f64| (4096.0 * revolutions).to_string();
    let said = "counts_large: the count changes by multiples of 8 alone: divide the column and the counts per \
                revolution by 8, because the estimators take each count for one of the encoder";
    assert_eq!(swing(512.0, counts, ""), [said]);
    assert!(swing(4096.0, counts, "").is_empty());
}

#[test]
fn angles_beyond_any_count_are_refused() {
    let turns = "counts_large=counts_large:rev";
    // 9e15 counts are 2.1973e12 turns.
    assert!(read(&[("0", "0"), ("2.197e12", "0")], turns, &[]).is_ok());
    let error = read(&[("0", "0"), ("-2.198e12", "0")], turns, &[]).unwrap_err();
    for part in ["r.csv: line 3: column counts_large: ", "is too large"] {
        assert!(error.contains(part), "{error}");
    }
}

/// Both encoders wrap at their own modulus, in both directions, and a counter may count from its
/// modulus down to 0 below zero.
#[test]
fn readings_are_unwrapped_at_the_modulus() {
    let both = ["1000", "counts_small=360"];
    let rows = [("990", "5"), ("998", "1"), ("6", "357"), ("-990", "-1")];
    let recording = read(&rows, "", &both).unwrap();
    let large = counts(&recording.trace.counts_large);
    assert_eq!(large, [990, 998, 1006, 1010]);
    let small = counts(recording.trace.counts_small.as_ref().unwrap());
    assert_eq!(small, [5, 1, -3, -1]);
    assert!(read(&[("-1000", "0"), ("999", "0")], "", &both).is_ok());
    for reading in ["1000", "-1001"] {
        let error = read(&[("0", "0"), (reading, "0")], "", &both).unwrap_err();
        for part in [
            "r.csv: line 3: column counts_large: ",
            reading,
            "with --modulus 1000: raw must be below modulus",
        ] {
            assert!(error.contains(part), "{error}");
        }
    }
}

#[test]
fn column_that_may_be_a_line_of_an_encoder_is_reported() {
    let row =
        |k: usize, large: [&'static str; 2], small: [&'static str; 2]| (large[k % 2], small[k % 2]);
    let notes = |rows: usize, large, small| {
        let rows: Vec<_> = (0..rows).map(|k| row(k, large, small)).collect();
        read(&rows, "", &[]).unwrap().notes
    };
    let line = |column, changes| {
        format!(
            "{column} is 0 or 1 in all rows, and changes {changes} times: if it is one line of a \
             quadrature encoder, count the edges of both lines with host-sim decode"
        )
    };
    assert_eq!(
        notes(11, ["0", "1"], ["5", "6"]),
        [line("counts_large", 10)]
    );
    assert_eq!(
        notes(12, ["0", "-1"], ["1", "0"]),
        [line("counts_small", 11)]
    );
    // Few changes are those of a shaft at rest, and 2 is a count.
    assert!(notes(10, ["0", "1"], ["0", "2"]).is_empty());
    assert!(notes(20, ["1", "2"], ["7", "7"]).is_empty());
}

/// Milliseconds, milliamperes and degrees a second.
#[test]
fn numbers_are_converted_to_the_units_of_a_recording() {
    let mut options = ReadOptions::default();
    options
        .add_columns("t=t:ms,current=i:mA,true_omega=w:deg/s,counts_large=n")
        .unwrap();
    let text = "t,n,i,w\n0,0,1500,180\n1,1,-250,-90\n";
    let recording = Recording::parse_as(text.as_bytes(), "r.csv", &options).unwrap();
    let near = |ours: &[f64], exact: [f64; 2]| {
        assert!(
            (ours.iter().zip(exact)).all(|(a, b)| (a - b).abs() < 1e-12),
            "{ours:?} {exact:?}"
        );
    };
    near(&recording.t, [0.0, 1e-3]);
    near(recording.trace.current.as_ref().unwrap(), [1.5, -0.25]);
    let pi = std::f64::consts::PI;
    near(
        recording.trace.true_omega.as_ref().unwrap(),
        [pi, -pi / 2.0],
    );
}

/// Two speeds, 100 and 201 counts a row, are near multiples of a step that no encoder has.
#[test]
fn counts_have_no_step_that_is_not_whole() {
    let counts: Vec<_> = (0..400_u32)
        .map(|k| (k / 2 * 301 + k % 2 * 100).to_string())
        .collect();
    let rows: Vec<_> = counts.iter().map(|count| (count.as_str(), "0")).collect();
    let notes = read(&rows, "", &[]).unwrap().notes;
    assert!(
        !notes.iter().any(|note| note.contains("multiples")),
        "{notes:?}"
    );
}
