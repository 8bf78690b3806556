use crate::recording::read_log as read;

/// A log with the times `times`, and counts of 1 a row.
fn log(times: &[&str]) -> String {
    let rows = times.iter().enumerate();
    let rows = rows.map(|(k, t)| format!("\"{t}\",{k}\n"));
    format!("t,counts_large\n{}", rows.collect::<String>())
}

#[test]
fn dates_and_times_of_day_are_seconds_from_midnight_on() {
    let clock = "t is a time of day or a duration: s from 0:00:00 on";
    let date = "t is a date and a time: s from the midnight before the first row on";
    for (times, said, exact) in [
        (
            ["12:00:00", "12:00:00.0625", "12:00:00,125"],
            clock,
            43_200.0,
        ),
        (
            [
                "0 days 00:00:01",
                "0 days 00:00:01.0625",
                "0 days 00:00:01.125",
            ],
            clock,
            1.0,
        ),
        (
            [
                "2025-03-01T00:00:02",
                "2025-03-01 00:00:02.0625",
                "2025-03-01 00:00:02,125",
            ],
            date,
            2.0,
        ),
        // The midnight before the first row is that of UTC, and the offset may change.
        (
            [
                "2025-03-01T00:30:00+01:00",
                "2025-03-01T00:30:00.0625+01:00",
                "2025-02-28T23:30:00.125Z",
            ],
            date,
            84_600.0,
        ),
    ] {
        let recording = read(&log(&times), "").unwrap();
        assert_eq!(
            recording.t,
            [exact, exact + 0.0625, exact + 0.125],
            "{times:?}"
        );
        assert_eq!(recording.notes, [said]);
    }
}

#[test]
fn times_may_have_their_unit_in_the_field() {
    let recording = read(&log(&["0 sec", "0.0625 sec", "0.125 sec"]), "").unwrap();
    assert_eq!(recording.t, [0.0, 0.0625, 0.125]);
    let recording = read(&log(&["0 ms", "62.5 ms", "1.25e-1 s"]), "t=t:us").unwrap();
    assert_eq!(recording.t, [0.0, 0.0625, 0.125]);
    for wrong in ["1 min", "1 deg", "nan s", "s", "1 2 s"] {
        let error = read(&log(&["0 s", wrong]), "").unwrap_err();
        assert!(error.starts_with("r.csv: line 3: column t: "), "{error}");
    }
}

#[test]
fn signed_counter_wraps_to_negative_times() {
    let text =
        "time_us,counts\n2147481648,0\n2147482648,1\n-2147483648,2\n-2147482648,3\n-2147481648,4\n";
    let recording = read(text, "").unwrap();
    let steps: Vec<_> = recording
        .t
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .collect();
    assert!(
        steps.iter().all(|step| (step - 1e-3).abs() < 1e-6),
        "{steps:?}"
    );
    let said =
        "t wraps at 2^32 us and is unwrapped, the first time in line 4: a counter of 32 bits";
    assert!(
        recording.notes.iter().any(|note| note == said),
        "{:?}",
        recording.notes
    );
    // A time that is negative before goes back.
    let error = read("time_us,counts\n0,0\n1000,1\n-500,2\n", "").unwrap_err();
    assert!(error.contains("line 4"), "{error}");
}

/// The step over the wrap, and a counter of microseconds in another unit.
#[test]
fn counter_whose_step_is_a_large_part_of_its_period_wraps() {
    for (name, first, step, period, digits, said) in [
        (
            "time_us",
            60_000_u64,
            1000,
            1 << 16,
            1.0,
            "t wraps at 2^16 us and is unwrapped, the first time in line 8",
        ),
        (
            "time_us",
            50_000,
            10_000,
            1 << 16,
            1.0,
            "t wraps at 2^16 us and is unwrapped, the first time in line 4",
        ),
        (
            "time_ms",
            4_294_960_000,
            2000,
            1 << 32,
            1e3,
            "t wraps at 2^32 us and is unwrapped, the first time in line 6",
        ),
        (
            "time_s",
            4_294_960_000,
            2000,
            1 << 32,
            1e6,
            "t wraps at 2^32 us and is unwrapped, the first time in line 6",
        ),
    ] {
        let row = |k: u64| format!("{},{k}\n", ((first + k * step) % period) as f64 / digits);
        let text = format!("{name},counts\n{}", (0..20).map(row).collect::<String>());
        let recording = read(&text, "").unwrap();
        for pair in recording.t.windows(2) {
            assert!(
                (pair[1] - pair[0] - step as f64 * 1e-6).abs() < 1e-7,
                "{name}: {pair:?}"
            );
        }
        let has_note = recording.notes.iter().any(|note| note.starts_with(said));
        assert!(has_note, "{name}: {:?}", recording.notes);
    }
    // Whole milliseconds of the counter: 4294967 is before 0.
    let row = |k: u64| format!("{},{k}\n", (4_294_960_000 + k * 2000) % (1 << 32) / 1000);
    let text = format!("time_ms,counts\n{}", (0..20).map(row).collect::<String>());
    let recording = read(&text, "").unwrap();
    assert!(
        (recording.t[19] - recording.t[0] - 0.038).abs() < 1e-3,
        "{:?}",
        recording.t
    );
    // A clock that was set back, and a second run.
    for back in [
        "time_us,counts\n60000,0\n61000,1\n900,2\n",
        "time_ms,counts\n4294960,0\n4294962,1\n8,2\n",
    ] {
        assert!(read(back, "").unwrap_err().contains("line 4: column t: "));
    }
}

/// A log of 1 kHz around a full second, with the second and a part of it in two columns.
fn split(header: &str, first: i64, per_s: i64) -> String {
    let rows =
        (998..1003).map(|k| format!("{},{},{k}\n", first + k / 1000, k % 1000 * per_s / 1000));
    format!("{header},counts\n{}", rows.collect::<String>())
}

#[test]
fn seconds_and_their_part_are_one_time() {
    for (header, per_s) in [
        ("sec,nsec", 1_000_000_000),
        ("stamp.sec,stamp.nanosec", 1_000_000_000),
        ("header.stamp.secs,header.stamp.nsecs", 1_000_000_000),
        ("tv_sec,tv_usec", 1_000_000),
        ("time_s,time_ms", 1000),
    ] {
        let recording = read(&split(header, 7, per_s), "").unwrap();
        assert_eq!(recording.t, [7.998, 7.999, 8.0, 8.001, 8.002], "{header}");
        let (whole, part) = header.split_once(',').unwrap();
        let said = format!("t from '{whole}' (s) and '{part}' (");
        assert!(recording.notes[0].contains(&said), "{:?}", recording.notes);
        // Also where the option names the seconds alone.
        let named = read(&split(header, 7, per_s), &format!("t={whole}")).unwrap();
        assert_eq!(named.t, recording.t);
    }
    // The part may stand first.
    assert_eq!(
        read("usec,sec,counts\n5,1,0\n7,1,1\n", "").unwrap().t,
        [1.000_005, 1.000_007]
    );
    // 2023-11-14T22:13:20 is 80000 s after midnight; a float of seconds since 1970 has no microsecond.
    let recording = read(&split("sec,nsec", 1_700_000_000, 1_000_000_000), "").unwrap();
    assert_eq!(recording.t[0], 80_000.998);
    let said = "t is s from the midnight before the first row on";
    assert!(recording.notes.iter().any(|note| note == said));
}

#[test]
fn column_that_is_no_part_of_a_second_is_refused_with_the_remedy() {
    let rows = "1,900,0\n1,950,1\n2,1000,2\n2,1050,3\n";
    let log = format!("time_s,time_ms,counts\n{rows}");
    let error = read(&log, "").unwrap_err();
    let said = "r.csv: line 4: column t: 'time_ms' has 1000 ms, which is no part of the second that 'time_s' \
                counts; if it is a time of its own, name it with --column 't=time_ms:ms'";
    assert_eq!(error, said);
    let recording = read(&log, "t=time_ms:ms").unwrap();
    assert_eq!(recording.t, [0.9, 0.95, 1.0, 1.05]);
    // Seconds with a fraction need no other column.
    let log = "time_s,time_ms,counts\n0.9375,937.5,0\n1,1000,1\n1.0625,1062.5,2\n";
    assert_eq!(read(log, "t=time_s").unwrap().t, [0.9375, 1.0, 1.0625]);
    // Names that differ in more than the unit are of two times.
    let log = "start_sec,stamp_nsec,counts\n5,100,0\n5,200,1\n";
    assert_eq!(read(log, "t=stamp_nsec").unwrap().t, [100e-9, 200e-9]);
    assert!(
        read(log, "t=start_sec")
            .unwrap_err()
            .contains("50 % of the rows")
    );
}

#[test]
fn a_microsecond_is_kept_in_a_date() {
    let times: Vec<_> = (0..50)
        .map(|k| format!("2025-03-01T23:59:00.{:06}Z", 20 * k))
        .collect();
    let times: Vec<_> = times.iter().map(String::as_str).collect();
    let recording = read(&log(&times), "").unwrap();
    assert!(
        (recording.trace.rate_hz - 50e3).abs() < 0.1,
        "{}",
        recording.trace.rate_hz
    );
}

#[test]
fn clock_passes_midnight() {
    let recording = read(
        &log(&["23:59:59.875", "23:59:59.9375", "00:00:00", "00:00:00.0625"]),
        "",
    )
    .unwrap();
    assert_eq!(
        recording.t,
        [86_399.875, 86_399.937_5, 86_400.0, 86_400.062_5]
    );
    assert_eq!(
        recording.notes[1],
        "midnight passes in line 4, and t goes on"
    );
    // As a number: VESC Tool logs the milliseconds of today.
    let text = "t,counts_large\n86399980,0\n86399990,1\n0,2\n10,3\n";
    let recording = read(text, "t=t:ms").unwrap();
    assert_eq!(recording.t, [86_399.98, 86_399.99, 86_400.0, 86_400.01]);
    assert_eq!(
        recording.notes[1],
        "midnight passes in line 4, and t goes on"
    );
    // A day is in a date, so nothing is added there.
    let dated = [
        "2025-03-02T23:59:59",
        "2025-03-02T23:59:59.875",
        "2025-03-02T00:00:00",
    ];
    let error = read(&log(&dated), "").unwrap_err();
    assert!(
        error.starts_with("r.csv: line 4: column t: 0 s is before the 86399.875 s above it"),
        "{error}"
    );
}

#[test]
fn forms_of_time_do_not_mix() {
    for times in [
        ["12:00:00", "43200.5"],
        ["43200", "12:00:00.5"],
        ["2025-03-01T12:00:00", "2025-03-01T12:00:00.5Z"],
        ["12:00:00", "2025-03-01T12:00:00.5"],
    ] {
        let error = read(&log(&times), "").unwrap_err();
        let said =
            "r.csv: line 3: column t: the form of the time differs from that of the rows above";
        assert!(error.starts_with(said), "{error}");
    }
}

#[test]
fn header_is_found_above_times_of_day() {
    let text = "made by a logger\nClock;Position\n12:00:00.1;5\n12:00:00.2;6\n";
    let error = read(text, "").unwrap_err();
    assert!(
        error.starts_with("r.csv: line 2: no column t; found: Clock; Position"),
        "{error}"
    );
    let recording = read(text, "t=Clock,counts_large=Position").unwrap();
    assert_eq!(recording.trace.counts_large, [5, 6]);
}

#[test]
fn counter_of_32_bits_is_unwrapped() {
    let mut text = String::from("t,counts_large\n");
    for k in 0..50_u32 {
        text += &format!("{},{k}\n", (1000 * k).wrapping_sub(5_500));
    }
    let recording = read(&text, "t=t:us").unwrap();
    let note =
        "t wraps at 2^32 us and is unwrapped, the first time in line 8: a counter of 32 bits";
    assert_eq!(recording.notes[1], note);
    assert_eq!(recording.trace.rate_hz, 1000.0);
    assert_eq!(recording.uneven_steps, 0);
    let (t, last) = (&recording.t, recording.t.len() - 1);
    assert!((t[last] - t[0] - 1e-3 * last as f64).abs() < 1e-9);
    // Of 16 bits; a step back by less is none.
    let short = |back: u32| -> String {
        let rows = (65_530..65_536)
            .chain(65_536 - back..65_542 - back)
            .zip(0..);
        rows.map(|(ms, k): (u32, u32)| format!("{ms},{k}\n"))
            .collect()
    };
    let text = |rows: String| format!("t,counts_large\n{rows}");
    let recording = read(&text(short(65_536)), "t=t:ms").unwrap();
    let note =
        "t wraps at 2^16 ms and is unwrapped, the first time in line 8: a counter of 16 bits";
    assert_eq!(recording.notes[1], note);
    assert!((recording.t[11] - 65.541).abs() < 1e-9);
    assert!(read(&text(short(64_000)), "t=t:ms").is_err());
    // Seconds are no counter, and a step to below zero is no wrap.
    for (unit, times) in [
        ("s", "4294967295,0\n0,1\n"),
        ("us", "4294966000,0\n-1000,1\n"),
    ] {
        let error = read(&format!("t,counts_large\n{times}"), &format!("t=t:{unit}"));
        assert!(
            error.unwrap_err().contains("sort the rows by time"),
            "{times}"
        );
    }
}
