//! Tests of the command line.

use super::*;

/// The error of these arguments.
fn error(arguments: &[&str]) -> String {
    let all = ["cargo board"].iter().chain(arguments);
    let failure = run(all.map(OsString::from)).expect_err("an error");
    assert_eq!(failure.status(), 2);
    failure.to_string()
}

#[test]
fn options_that_cannot_be_used_are_named_before_the_image_is_read() {
    let folder = env!("CARGO_MANIFEST_DIR");
    for (arguments, said) in [
        (["--seconds", "-1"], "--seconds -1: must be above 0"),
        (["--seconds", "3601"], "and at most 3600 s"),
        (["--seconds", "nan"], "must be above 0"),
        (
            ["--fault", "stuck-a@-1"],
            "'-1' is not a time; give 0 to 3600 s",
        ),
        (
            ["--fault", "stuck-a@3.5"],
            "--fault stuck-a@3.5: the run ends at 3 s; give a longer --seconds",
        ),
        (
            ["--estimator", "1@4"],
            "--estimator 1@4: the run ends at 3 s",
        ),
        (["--seed", "-1"], "invalid value '-1' for '--seed <N>'"),
        (["--link", "-1"], "invalid value '-1' for '--link <PORT>'"),
        (
            ["--record", folder],
            "is a folder; choose the name of a file",
        ),
        (["--rtt", folder], "is a folder; choose the name of a file"),
        (
            ["--trace", folder],
            "is a folder; choose the name of a file",
        ),
    ] {
        let all = [&arguments[..], &["--image", "/nope.elf"]].concat();
        let error = error(&all);
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
}

#[test]
fn outputs_that_are_one_file_or_an_input_are_refused() {
    let image = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let device = concat!(env!("CARGO_MANIFEST_DIR"), "/src/lib.rs");
    for (arguments, said) in [
        (
            ["--record", "x.csv", "--rtt", "./x.csv"],
            "--rtt ./x.csv: is the file of --record too; name another one",
        ),
        (
            ["--rtt", "-", "--trace", "/dev/stdout"],
            "--trace /dev/stdout: is the file of --rtt too; name another one",
        ),
        (
            ["--seconds", "1", "--record", image],
            "Cargo.toml: would overwrite the input",
        ),
        (
            ["--device", device, "--rtt", device],
            "lib.rs: would overwrite the input",
        ),
    ] {
        let error = error(&[&arguments[..], &["--image", image]].concat());
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
}

#[test]
fn handle_of_a_board_before_its_bring_up_is_free() {
    let hand = |arguments: &[&str]| {
        let all = ["cargo board"].iter().chain(arguments);
        Arguments::parse_from(all).hand(&Device::default())
    };
    assert_eq!(hand(&[]), Hand::Moving);
    assert_eq!(hand(&["--blank"]), Hand::Gone(0.0));
    assert_eq!(hand(&["--blank", "--hand", "still"]), Hand::Still);
}

#[test]
fn values_and_estimators_that_the_image_does_not_take_are_refused_before_the_run() {
    let image = Image::build("").unwrap();
    let refused = |arguments: &[&str]| {
        let wall = ["--scene", "wall"];
        let scene = match arguments.contains(&"--scene") {
            true => &[][..],
            false => &wall,
        };
        let all = ["cargo board"].iter().chain(scene).chain(arguments);
        in_bounds(&Arguments::parse_from(all), &image).map_err(|error| error.to_string())
    };
    for (arguments, said) in [
        (
            ["--tune", "stiffness=9@0.2"],
            "out of bounds; give 0 to 0.35 N·m/rad",
        ),
        (
            ["--tune", "stiffness=nan@0.2"],
            "wall stiffness NaN N·m/rad: not finite; give a number",
        ),
        (
            ["--estimator", "7@0.2"],
            "--estimator 7: the image has no estimator 7",
        ),
    ] {
        let error = refused(&arguments).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    let all = ["--tune", "stiffness=0.35@0.2", "--estimator", "1@0.2"];
    assert_eq!(refused(&all), Ok(()));
    let detents = |arguments: &[&str]| refused(&[&["--scene", "detents"], arguments].concat());
    for tune in ["amplitude=0.04@0.5", "per-turn=1000@0.5"] {
        let error = detents(&["--tune", tune]).unwrap_err();
        let text = tune.trim_end_matches("@0.5");
        assert!(
            error.starts_with(&format!("--tune {text}: detents ")),
            "{error}"
        );
        assert!(
            error.contains("amplitude times per-turn is at most"),
            "{error}"
        );
    }
    // The order is that of the times.
    let all = ["--tune", "amplitude=0.04@0.5", "--tune", "per-turn=8@0.4"];
    assert_eq!(detents(&all), Ok(()));
    let image = Image::build("large-foaw").unwrap();
    let arguments = Arguments::parse_from(["cargo board", "--estimator", "0@0.2"]);
    let error = in_bounds(&arguments, &image).unwrap_err().to_string();
    assert!(error.contains("has foaw-end-fit alone"), "{error}");
}

#[test]
fn help_lists_scenes_and_their_parameters() {
    use clap::CommandFactory as _;

    let help = Arguments::command().render_long_help().to_string();
    for scene in SceneKind::ALL {
        let names = scene.facts().parameters.iter().map(|it| it.name);
        let names = names.collect::<Vec<_>>().join(", ");
        let line = format!("  {:<15}{names}", scene.name());
        let listed = help.lines().any(|it| it == line.trim_end());
        assert!(listed, "{scene}: {help}");
    }
}
