//! A coarsened recording states its counts per revolution.

use crate::{Folder, HOST_SIM, json};

/// 1 s at 2 kHz and 5 rad/s, of an encoder of 100 000 counts per revolution.
fn fine() -> String {
    let mut text = String::from("t,counts_large\n");
    for k in 0..=2000 {
        let angle = 5.0 * f64::from(k) * 0.5e-3;
        let count = (angle / std::f64::consts::TAU * 1e5).floor();
        text += &format!("{},{count}\n", f64::from(k) * 0.5e-3);
    }
    text
}

fn coarse(counts: &str) -> (Folder, String) {
    let folder = Folder::new(HOST_SIM);
    folder.write("f.csv", fine());
    let command = "coarsen f.csv --fine-counts-per-rev 100000 --rate 1000 --out c.csv";
    let mut arguments: Vec<_> = command.split(' ').collect();
    arguments.extend(["--counts-per-rev", counts]);
    folder.good(&arguments);
    let text = folder.text("c.csv");
    (folder, text)
}

#[test]
fn counts_per_revolution_of_a_coarsened_recording_need_no_option() {
    let (folder, text) = coarse("1000");
    assert!(text.starts_with("# counts_per_rev = 1000\nt,counts_large,edge_tick,edge_bound\n"));
    let velocity = |arguments: &str| {
        let text = folder.good(arguments);
        let last = text.lines().last().unwrap();
        last.split_once(',').unwrap().1.parse::<f64>().unwrap()
    };
    // With 4096 counts, those of the default device, the velocity would be 1.2 rad/s.
    let with_file = velocity("replay c.csv --estimator m-over-t");
    assert!((with_file - 5.0).abs() < 0.05, "{with_file}");
    folder.write("d.toml", "large.counts_per_rev = 500\n");
    let with_device = velocity("replay c.csv --estimator m-over-t --device d.toml");
    assert!((with_device - 10.0).abs() < 0.1, "{with_device}");
    folder.write("i.toml", "large.inertia_kg_m2 = 2e-5\n");
    let without_counts = velocity("replay c.csv --estimator m-over-t --device i.toml");
    assert!((without_counts - 5.0).abs() < 0.05, "{without_counts}");
    for (command, said) in [
        (
            "replay c.csv --estimator pll --device i.toml",
            "c.csv: 1000 counts/rev, as the file states",
        ),
        (
            "replay c.csv --estimator pll --device d.toml --counts-per-rev 250",
            "250 counts/rev of the options are used; the recording states 1000",
        ),
        (
            "replay c.csv --estimator pll",
            "c.csv: 1000 counts/rev, as the file states",
        ),
        (
            "replay c.csv --estimator pll --device d.toml",
            "500 counts/rev of d.toml are used; the recording states 1000",
        ),
        (
            "plot c.csv --out p.svg",
            "1000 counts/rev, as the file states",
        ),
        ("recommend c.csv", "1000 counts/rev, as the file states"),
    ] {
        let output = folder.run(command);
        let notes = String::from_utf8(output.stderr).unwrap();
        assert!(notes.contains(said), "{command}: {notes}");
        assert!(!notes.contains("assumed"), "{command}: {notes}");
    }
    let ranked = json(&folder.good(&["recommend", "c.csv", "--json", "-"]));
    let rust = |row: &serde_json::Value| row["rust"].as_str().unwrap().contains("1000");
    assert!(ranked.iter().all(rust), "{ranked:?}");
}

#[test]
fn recordings_of_different_encoders_are_refused() {
    let (folder, text) = coarse("1000");
    folder.write("d.csv", text.replacen("= 1000", "= 500", 1));
    let error = folder.refused(&["recommend", "c.csv", "d.csv"]);
    let said = "d.csv: states 500 counts/rev and c.csv 1000; give recordings of one encoder";
    assert!(error.contains(said), "{error}");
    folder.write("e.csv", text.replacen("= 1000", "= many", 1));
    for command in ["replay", "plot", "recommend", "identify"] {
        let error = folder.refused(&[command, "e.csv"]);
        let said =
            "e.csv: line 1: counts_per_rev: 'many': must be a whole number from 16 to 4000000";
        assert!(error.contains(said), "{command}: {error}");
    }
}

#[test]
fn counts_of_an_option_are_those_of_a_device_file() {
    let (folder, text) = coarse("1000");
    let unstated = text.split_once('\n').expect("a line of counts").1;
    folder.write("c.csv", unstated);
    folder.write("half.toml", "[large]\ncounts_per_rev = 500\n");
    for command in [
        "replay c.csv --estimator pll --out",
        "plot c.csv --estimator pll --out",
    ] {
        let command: Vec<_> = command.split(' ').collect();
        let by_file = folder.good(&[&command[..], &["-", "--device", "half.toml"]].concat());
        let by_option = folder.good(&[&command[..], &["-", "--counts-per-rev", "500"]].concat());
        assert_eq!(by_option, by_file, "{command:?}");
        let default = folder.good(&[&command[..], &["-"]].concat());
        assert_ne!(by_option, default, "{command:?}");
    }
    let table = folder.good(&[
        "replay",
        "c.csv",
        "--counts-per-rev",
        "500",
        "--out",
        "v.csv",
    ]);
    let said = "500 counts/rev (of --counts-per-rev; the default device: no --device given)";
    let words: Vec<_> = table.split_whitespace().collect();
    assert!(words.join(" ").contains(said), "{table}");
    for wrong in ["15", "4000001", "many"] {
        folder.refused(&["replay", "c.csv", "--counts-per-rev", wrong]);
    }
    let error = folder.refused(&["tune", "--counts-per-rev", "500", "--estimator", "pll"]);
    assert!(
        error.contains("read a recording: give RECORDING"),
        "{error}"
    );
}

#[test]
fn coarse_recording_is_coarsened_again() {
    let (folder, _) = coarse("1000");
    folder.good(&[
        "coarsen",
        "c.csv",
        "--counts-per-rev",
        "250",
        "--out",
        "d.csv",
    ]);
    let text = folder.text("d.csv");
    assert!(text.starts_with("# counts_per_rev = 250\n"), "{text}");
    // 5 rad/s of 250 counts for a second.
    let last = text.lines().last().unwrap().split(',').nth(1).unwrap();
    assert!(
        (last.parse::<f64>().unwrap() - 199.0).abs() <= 1.0,
        "{last}"
    );
}

#[test]
fn gap_is_bridged_with_a_note_and_an_unsuitable_clock_is_named() {
    let folder = Folder::new(HOST_SIM);
    let options = "--counts-per-rev 1000 --fine-counts-per-rev 100000 --out c.csv";
    let arguments = |more: &str| -> Vec<String> {
        let line = format!("coarsen f.csv {options} {more}");
        line.split_whitespace().map(str::to_owned).collect()
    };
    let run = |more: &str| {
        let arguments = arguments(more);
        folder.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let lines: Vec<_> = fine().lines().map(str::to_owned).collect();
    folder.write("f.csv", [&lines[..801], &lines[1201..]].concat().join("\n"));
    let output = run("--rate 500");
    assert_eq!(output.status.code(), Some(0));
    let notes = String::from_utf8(output.stderr).unwrap();
    let said = "f.csv: 400 rows are missing in a gap before line 802 at 0.6 s; \
         cut the log before t = 0.6 s: resampled rows in this gap are a straight line";
    assert!(notes.contains(said), "{notes}");
    for (text, said) in [
        (
            fine().replacen("1,79577\n", "1.003,79577\n", 1),
            "f.csv: its rows come at 1994.02 Hz on the average, which is less than the 2000 Hz of --rate; \
             ask for at most --rate 1994, or cut the log at its gaps",
        ),
        (
            "t,counts_large\n0,0\n1000,1\n2000,2\n".to_owned(),
            "f.csv: column t: ",
        ),
    ] {
        folder.write("f.csv", text);
        let output = run("--rate 2000");
        assert_eq!(output.status.code(), Some(2));
        let line = String::from_utf8(output.stderr).unwrap();
        assert!(line.contains(said), "{line}");
    }
}

/// 4 s at 5 kHz of a shaft that swings slowly, of an encoder of 65536 counts per revolution: its counts,
/// and the text with times from `start` s on.
fn swing(start: u64, count: impl Fn(i64) -> i64) -> String {
    let mut text = String::from("t,counts_large\n");
    for k in 0..=20_000_u64 {
        let us = 200 * k;
        let angle = 20_000.0 * (1e-6 * us as f64).sin();
        let count = count(30_000 + angle.floor() as i64);
        let s = start + us / 1_000_000;
        text += &format!("{s}.{:06},{count}\n", us % 1_000_000);
    }
    text
}

const SWING: &str = "--fine-counts-per-rev 65536 --counts-per-rev 1024";

/// The fields of the rows of a coarse recording: time, count, stamp and boundary.
fn rows(text: &str) -> Vec<[Option<f64>; 4]> {
    let lines = text.lines().skip(2);
    let rows = lines.map(|line| {
        let mut fields = line.split(',').map(|field| field.parse().ok());
        std::array::from_fn(|_| fields.next().flatten())
    });
    rows.collect()
}

#[test]
fn times_since_1970_give_the_stamps_of_times_from_zero() {
    let folder = Folder::new(HOST_SIM);
    folder.write("zero.csv", swing(0, |count| count));
    folder.write("epoch.csv", swing(1_700_000_000, |count| count));
    for name in ["zero", "epoch"] {
        folder.good(format!("coarsen {name}.csv {SWING} --out {name}-c.csv").as_str());
    }
    let replay = "replay epoch-c.csv --estimator imm-edge --estimator m-over-t --out v.csv";
    folder.good(replay);
    let [zero, epoch] = ["zero-c.csv", "epoch-c.csv"].map(|name| rows(&folder.text(name)));
    assert_eq!(zero.len(), epoch.len());
    for all in [&zero, &epoch] {
        for pair in all.windows(2) {
            // The shaft does not cross a boundary and return within a row.
            if pair[0][1] == pair[1][1] {
                assert_eq!(pair[0][2..], pair[1][2..], "{pair:?}");
            }
        }
    }
    let mut compared = 0;
    for (zero, epoch) in zero.iter().zip(&epoch) {
        assert_eq!(zero[0], epoch[0]);
        if let (true, [_, _, Some(a), _], [_, _, Some(b), _]) = (zero[3] == epoch[3], zero, epoch) {
            // A time since 1970 is a multiple of 2^-22 s, 20 ticks of 84 MHz. An edge lies between two
            // times, less the first one.
            assert!((a - b).abs() <= 21.0, "{zero:?} {epoch:?}");
            compared += 1;
        }
    }
    assert!(compared > 3900, "{compared}");
}

#[test]
fn absolute_encoder_is_unwrapped_with_a_note() {
    let folder = Folder::new(HOST_SIM);
    // The swing from 30 000 counts down to 10 000 passes the zero of this encoder.
    let modulus = |modulus: i64| move |count: i64| (count - 20_000).rem_euclid(modulus);
    folder.write("a.csv", swing(0, |count| count - 20_000));
    folder.write("b.csv", swing(0, modulus(65_536)));
    folder.write("c.csv", swing(0, modulus(16_384)));
    folder.write(
        "d.csv",
        folder.text("b.csv").replace("counts_large", "fine_count"),
    );
    let coarse = |name: &str, note: Option<&str>| {
        let command = format!("coarsen {name}.csv {SWING} --rate 700 --out out.csv");
        let output = folder.run(command.as_str());
        assert_eq!(output.status.code(), Some(0));
        let errors = String::from_utf8(output.stderr).unwrap();
        match note {
            None => assert_eq!(errors, ""),
            Some(note) => assert!(errors.contains(note), "{errors}"),
        }
        folder.text("out.csv")
    };
    let straight = coarse("a", None);
    let note = "wraps at 65536 and is unwrapped: a revolution of an absolute encoder";
    assert_eq!(
        coarse("b", Some(&format!("b.csv: counts_large {note}\n"))),
        straight
    );
    assert_eq!(
        coarse("d", Some(&format!("d.csv: counts_large {note}\n"))),
        straight
    );
    let jumps = " from one row to the next and spans 16382 counts, with 65536 counts per revolution: if the \
                 encoder is absolute, give its counts with --fine-counts-per-rev, or --modulus \
                 counts_large=16384 if it has other counts per revolution\n";
    assert_ne!(coarse("c", Some(jumps)), straight);
}

#[test]
fn fine_counts_that_differ_from_the_stated_ones_are_reported() {
    let folder = Folder::new(HOST_SIM);
    let stated = format!("# counts_per_rev = 65536\n{}", swing(0, |count| count));
    folder.write("f.csv", stated);
    let notes = |option: &str| {
        let command = format!("coarsen f.csv {option} --counts-per-rev 1024 --out c.csv");
        let output = folder.run(command.as_str());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stderr).unwrap()
    };
    let said = "f.csv: 32768 counts/rev of the options are used; the recording states 65536\n";
    assert_eq!(notes("--fine-counts-per-rev 32768"), said);
    assert_eq!(notes("--fine-counts-per-rev 65536"), "");
    assert_eq!(notes(""), "");
    let list = "[[recording]]\nfile = 'f.csv'\nwhat = 'x'\nkind = 'fine'\ncounts_per_rev = 32768\n";
    folder.write("recordings.toml", list);
    let said = "f.csv: 32768 counts/rev of recordings.toml are used; the recording states 65536\n";
    assert_eq!(notes(""), said);
}

/// The second of log and options is read as the first.
#[test]
fn logs_of_other_programs_are_coarsened() {
    let folder = Folder::new(HOST_SIM);
    let rows = |header: &str, row: &dyn Fn(f64, i64) -> String| {
        let mut text = format!("{header}\n");
        for k in 0..2000 {
            let t = f64::from(k) * 0.5e-3;
            text += &row(t, (4e3 * (7.0 * t).sin()).floor() as i64);
        }
        text
    };
    let own = rows("t,counts_large,current,true_omega", &|t, count| {
        format!("{t},{count},{},2\n", 1.25 * t)
    });
    folder.write("own.csv", own);
    let fine = rows(
        "note;true_omega_rad_s;motor_torque_nm;fine_count;time_s",
        &|t, count| {
            let torque = (0.05 * 1.25 * t).to_string().replace('.', ",");
            format!("x;2;{torque};{count};{}\n", t.to_string().replace('.', ","))
        },
    );
    folder.write("fine.csv", fine);
    let named = rows("ms\tq\tenc\trpm", &|t, count| {
        let rpm = 60.0 / std::f64::consts::TAU * 2.0;
        format!(
            "{}\t{}\t{}\t{rpm}\n",
            1e3 * t,
            1.25 * t,
            count.rem_euclid(10_000)
        )
    });
    folder.write("named.csv", named);
    folder.write("d.toml", "large.torque_constant_nm_per_a = 0.05\n");
    let coarse = |name: &str, more: &str| {
        let options = "--fine-counts-per-rev 100000 --counts-per-rev 1000 --device d.toml --out -";
        let text = folder.good(format!("coarsen {name}.csv {options}{more}").as_str());
        let numbers = |line: &str| -> Vec<Option<f64>> {
            let fields = line.split(',');
            fields.map(|field| field.parse().ok()).collect()
        };
        text.lines().skip(2).map(numbers).collect::<Vec<_>>()
    };
    let own = coarse("own", "");
    folder.good("coarsen own.csv --fine-counts-per-rev 100000 --counts-per-rev 1000 --out c.csv");
    let text = folder.text("c.csv");
    let header: Vec<_> = text.lines().nth(1).unwrap().split(',').collect();
    for column in ["edge_tick", "current", "true_omega"] {
        assert!(header.contains(&column), "{header:?}");
    }
    let named = " --column t=ms:ms,current=q:A --column counts_large=enc --column true_omega=rpm:rpm \
                 --modulus 10000";
    for (name, more) in [("fine", ""), ("named", named)] {
        let coarse = coarse(name, more);
        assert_eq!(coarse.len(), own.len(), "{name}");
        for (coarse, own) in coarse.iter().zip(&own) {
            assert_eq!(coarse.len(), own.len(), "{name}");
            for (column, (a, b)) in header.iter().zip(coarse.iter().zip(own)) {
                // A time that is rounded moves a stamp by a tick at most.
                let tolerance = if *column == "edge_tick" { 1.001 } else { 1e-6 };
                let near = a.zip(*b).map(|(a, b)| (a - b).abs() <= tolerance);
                assert!(near.unwrap_or(a == b), "{name}: {coarse:?} {own:?}");
            }
        }
    }
    let error = folder
        .refused("coarsen named.csv --fine-counts-per-rev 100000 --counts-per-rev 64 --out -");
    assert!(
        error.contains("named.csv: line 1: no column counts_large; "),
        "{error}"
    );
    let notes = folder
        .run("coarsen fine.csv --fine-counts-per-rev 100000 --counts-per-rev 64 --out c.csv")
        .stderr;
    let said = "current from 'motor_torque_nm' (N.m with 0.0468 N.m/A)";
    assert!(String::from_utf8(notes).unwrap().contains(said));
}
