//! Where output goes: devices, pipes, links, standard output, and what an interrupt leaves.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::{Folder, HOST_SIM};

const RECORDING: &str = "t,counts_large\n0,1\n0.001,2\n0.002,3\n";
const REPLAY: [&str; 4] = ["replay", "r.csv", "--estimator", "finite-difference"];
/// What [`REPLAY`] writes.
const ESTIMATES: &str = "t,finite-difference\n0,0\n0.001,1.5339808\n0.002,1.5339808\n";

fn folder() -> Folder {
    let folder = Folder::new(HOST_SIM);
    folder.write("r.csv", RECORDING);
    folder
}

fn replay_to(out: &str) -> Vec<&str> {
    [&REPLAY[..], &["--out", out]].concat()
}

fn spawn(folder: &Folder, arguments: &[&str]) -> Child {
    let mut command = folder.command(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

fn sh(folder: &Folder, script: &str) -> std::process::Output {
    let mut command = Command::new("bash");
    command.args(["-c", script, HOST_SIM]);
    command.current_dir(folder.path()).output().unwrap()
}

/// Standard output of a script in which `$0` is the program.
fn good_sh(folder: &Folder, script: &str) -> String {
    let output = sh(folder, script);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{script}: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn symbolic_link_is_kept_and_its_target_is_replaced() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("deep")).unwrap();
    folder.write("deep/target.csv", "old");
    fs::set_permissions(path("deep/target.csv"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("deep/target.csv", path("link.csv")).unwrap();
    symlink("link.csv", path("link-to-link.csv")).unwrap();
    folder.good(&replay_to("link-to-link.csv"));
    for link in ["link.csv", "link-to-link.csv"] {
        assert!(
            fs::symlink_metadata(path(link)).unwrap().is_symlink(),
            "{link}"
        );
    }
    assert_eq!(
        fs::read_to_string(path("deep/target.csv")).unwrap(),
        ESTIMATES
    );
    let mode = fs::metadata(path("deep/target.csv"))
        .unwrap()
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o640);

    // A link to nothing yet creates its target.
    symlink("deep/new.csv", path("dangling.csv")).unwrap();
    folder.good(&replay_to("dangling.csv"));
    assert!(
        fs::symlink_metadata(path("dangling.csv"))
            .unwrap()
            .is_symlink()
    );
    assert_eq!(fs::read_to_string(path("deep/new.csv")).unwrap(), ESTIMATES);

    symlink("deep", path("folder-link")).unwrap();
    let error = folder.refused(&replay_to("folder-link"));
    assert!(
        error.contains("folder-link: is a folder; choose the name of a file"),
        "{error}"
    );
    symlink("loop", path("loop")).unwrap();
    let error = folder.refused(&replay_to("loop"));
    assert!(error.contains("loop: cannot write"), "{error}");
    assert_eq!(fs::read_dir(path("deep")).unwrap().count(), 2);
}

#[test]
fn pipes_and_devices_are_written_in_place() {
    let folder = folder();
    assert!(
        Command::new("mkfifo")
            .arg(folder.path().join("fifo"))
            .status()
            .unwrap()
            .success()
    );
    let reader = {
        let path = folder.path().join("fifo");
        std::thread::spawn(move || fs::read_to_string(path).unwrap())
    };
    folder.good(&replay_to("fifo"));
    let kind = fs::symlink_metadata(folder.path().join("fifo"))
        .unwrap()
        .file_type();
    assert!(kind.is_fifo(), "{kind:?}");
    // Without this check, a reader of a replaced pipe would wait for ever.
    assert_eq!(reader.join().unwrap(), ESTIMATES);

    // Links to devices: a program that replaces them does no harm outside of this folder.
    for device in ["null", "full"] {
        symlink(Path::new("/dev").join(device), folder.path().join(device)).unwrap();
    }
    folder.good(&replay_to("null"));
    let error = folder.refused(&replay_to("full"));
    assert!(
        error.contains("full: cannot write: No space left"),
        "{error}"
    );
    for device in ["null", "full"] {
        let link = fs::symlink_metadata(folder.path().join(device)).unwrap();
        let target = fs::metadata(Path::new("/dev").join(device))
            .unwrap()
            .file_type();
        assert!(link.is_symlink() && target.is_char_device(), "{device}");
    }
}

#[test]
fn dash_and_names_of_standard_output_are_standard_output() {
    let folder = folder();
    // By links: a program that replaces what they name harms only them.
    symlink("/dev/stdout", folder.path().join("stdout")).unwrap();
    symlink("/dev/fd/1", folder.path().join("one")).unwrap();
    for out in ["-", "stdout", "one"] {
        assert_eq!(folder.good(&replay_to(out)), ESTIMATES, "{out}");
        // Redirected to a file, which is not replaced under the shell's feet.
        let script = format!(
            "{{ echo first; \"$0\" {} --out {out}; }} > o.csv",
            REPLAY.join(" ")
        );
        good_sh(&folder, &script);
        let written = folder.text("o.csv");
        assert_eq!(written, format!("first\n{ESTIMATES}"), "{out}");
    }
    let substituted = format!("\"$0\" {} --out >(cat > p.csv); wait $!", REPLAY.join(" "));
    good_sh(&folder, &substituted);
    assert_eq!(folder.text("p.csv"), ESTIMATES);

    let svg = folder.good(&["plot", "r.csv", "--out", "-"]);
    assert!(
        svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"),
        "{svg}"
    );
    let tune = "tune --rate 1000 --seeds 1 --seconds 1 --scenario step --estimator pll \
                --frictionless --out -";
    let presets = folder.good(tune);
    assert!(presets.starts_with("# host-sim tune") && presets.contains("bandwidth_hz = "));
    assert!(!presets.trim_end().ends_with('-'), "{presets}");
    let shard = "robust --scene off --rate 1000 --seconds 0.05 --devices 0 --shard 1/1 --out o";
    folder.good(shard);
    for arguments in [
        "compare --out -",
        "zwidth --out -",
        "sensitivity --out stdout",
        "robust --out -",
        "merge o/shard-1-of-1.jsonl --out -",
        "identify r.csv --report -",
    ] {
        let error = folder.refused(arguments);
        assert!(error.contains("name a folder"), "{arguments}: {error}");
    }
    for arguments in [
        "identify r.csv --out - --json -",
        "replay r.csv --out - --json -",
    ] {
        let error = folder.refused(arguments);
        assert!(
            error.contains("--out - and --json -: only one"),
            "{arguments}: {error}"
        );
    }
}

#[test]
fn every_file_option_says_that_a_dash_is_standard_output() {
    let folder = Folder::new(HOST_SIM);
    let commands = folder.good(&["--help"]);
    let commands = commands
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1);
    let commands = commands.take_while(|line| !line.is_empty());
    // Further lines of a description are indented further.
    let names = commands.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let mut options = 0;
    for name in names.filter(|name| !["", "help"].contains(name)) {
        let help = folder.good(&[name, "--help"]);
        let wrapped: Vec<_> = help.split_whitespace().collect();
        let help = wrapped.join(" ");
        let (_, help) = help.split_once(" Options: ").unwrap();
        for start in ["--out <FILE", "--json <FILE"] {
            let Some((_, said)) = help.split_once(start) else {
                continue;
            };
            let said = said.split(" --").next().unwrap_or_default();
            assert!(
                said.contains("- is standard output"),
                "{name} {start}: {said}"
            );
            options += 1;
        }
    }
    assert!(options >= 13, "{options} options");
}

#[test]
fn interrupted_write_leaves_the_old_file_alone() {
    let folder = Folder::new(HOST_SIM);
    let mut text = String::from("t,counts_large\n");
    for k in 0..300_000 {
        text += &format!("{}.{:03},{}\n", k / 1000, k % 1000, k / 7);
    }
    folder.write("r.csv", text);
    folder.write("v.csv", "old");
    let before = folder.names();
    let mut interrupted = 0;
    for signal in ["-INT", "-TERM"].into_iter().cycle().take(40) {
        let mut child = spawn(&folder, &["replay", "r.csv", "--out", "v.csv"]);
        let ended = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break Some(status);
            }
            if folder.names() != before {
                break None;
            }
            std::thread::sleep(Duration::from_micros(200));
        };
        assert_eq!(ended, None, "ended before a partial file was seen");
        let id = child.id().to_string();
        assert!(
            Command::new("kill")
                .args([signal, &id])
                .status()
                .unwrap()
                .success()
        );
        let status = child.wait().unwrap();
        assert_eq!(status.signal(), None, "{signal}");
        assert_eq!(folder.names(), before, "{signal}: {status}");
        match status.code() {
            Some(130) => interrupted += 1,
            // The signal came after the last byte.
            code => assert_eq!(code, Some(0), "{signal}"),
        }
        let now = folder.text("v.csv");
        assert_eq!(now == "old", status.code() == Some(130));
        if interrupted == 4 {
            return;
        }
        folder.write("v.csv", "old");
    }
    panic!("{interrupted} of 40 runs were interrupted while they wrote");
}

#[test]
fn report_folder_holds_the_files_of_one_run() {
    let folder = Folder::new(HOST_SIM);
    let run = |more: &str| {
        let arguments = "compare --out page --seconds 1 --rate 1000 --estimator pll ".to_owned();
        let arguments = arguments + more;
        folder.good(&arguments);
    };
    let figures = || {
        fs::read_dir(folder.path().join("page/figures"))
            .unwrap()
            .count()
    };
    run("--closed-loop --scene free-air --scene wall");
    assert!(folder.path().join("page/closed-loop.csv").exists());
    folder.write("page/notes.txt", "mine");
    let first = figures();
    run("--scenario hold");
    let second = figures();
    assert!(second < first, "{second} figures after {first}");
    let page = folder.text("page/index.html");
    assert_eq!(page.matches("<svg ").count(), second);
    assert!(!folder.path().join("page/closed-loop.csv").exists());
    assert!(!folder.path().join("page/closed-loop.json").exists());
    assert!(folder.path().join("page/notes.txt").exists());

    // A run that fails keeps the old page with its scores.
    let old = fs::read(folder.path().join("page/scores.csv")).unwrap();
    fs::create_dir(folder.path().join("page/closed-loop.json")).unwrap();
    let failing = "compare --out page --seconds 1 --rate 1000 --estimator pll --closed-loop \
                   --scene off";
    let error = folder.refused(failing);
    assert!(error.contains("closed-loop.json: cannot write"), "{error}");
    assert_eq!(
        fs::read(folder.path().join("page/scores.csv")).unwrap(),
        old
    );
    assert_eq!(folder.text("page/index.html"), page);
}
