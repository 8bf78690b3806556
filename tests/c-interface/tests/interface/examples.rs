//! The library for Arduino and the example for STM32: they compile, and the sensor for SimpleFOC keeps its
//! promises on a simulated motion.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use c_interface::{CORTEX_M4F, Compiler, compiled, folder, missing};
use limpid_dist::{BOARDS, COMPUTER, arduino, build, header, milliseconds, source};

const CPP11: Compiler = Compiler {
    program: "g++",
    arguments: &[
        "-x",
        "c++",
        "-std=c++11",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-pedantic",
        "-Wconversion",
        "-Wold-style-cast",
        "-Wshadow",
    ],
};

fn here(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_example_for_stm32_compiles() {
    if missing(CORTEX_M4F.program) {
        return;
    }
    let folder = folder("stm32");
    std::fs::write(
        folder.join("parameters.h"),
        milliseconds().expect("a design").as_bytes(),
    )
    .expect("target");
    let stub = format!("-I{}", here("c/stm32_stub"));
    let source = "../../../c/examples/stm32_hal/main.c";
    let more = ["-pedantic", "-c", &stub];
    compiled(&CORTEX_M4F, source, &folder, &more, &folder.join("main.o"));
}

#[test]
fn the_library_for_arduino_has_an_object_per_processor_and_its_examples_compile() {
    let folder = folder("Limpid");
    // An earlier run may have left what no run replaces.
    std::fs::remove_dir_all(&folder).expect("just made");
    arduino(&folder).expect("the folder");
    let properties = std::fs::read_to_string(folder.join("library.properties")).expect("written");
    let version = format!("version={}\n", env!("CARGO_PKG_VERSION"));
    assert!(properties.contains(&version) && properties.contains("precompiled=true\n"));
    assert_eq!(
        std::fs::read_to_string(folder.join("src/limpid.h")).expect("written"),
        header().expect("a header")
    );
    for processor in BOARDS.iter().flat_map(|one| one.arduino) {
        let library = folder.join("src").join(processor).join("liblimpid.a");
        assert!(
            library.metadata().expect("written").len() > 100_000,
            "{}",
            library.display()
        );
    }
    // Where a library is linked the source is empty.
    let file = std::fs::read_to_string(folder.join("src/limpid.c")).expect("written");
    let inside = file.strip_prefix("#ifdef __XTENSA__\n");
    let inside = inside.and_then(|text| text.strip_suffix("#endif\n"));
    assert_eq!(inside, Some(&*source().expect("limpid.c")));
    if missing(CPP11.program) {
        return;
    }
    let stub = format!("-I{}", here("c/arduino_stub"));
    let source = format!("-I{}", folder.join("src").display());
    for example in ["EncoderVelocity", "SimpleFocSensor"] {
        let sketch = folder.join(format!("examples/{example}/{example}.ino"));
        let more = ["-include", "Arduino.h", &stub, &source, "-c"];
        compiled(
            &CPP11,
            &sketch.display().to_string(),
            &folder,
            &more,
            &folder.join("sketch.o"),
        );
    }
}

/// A motion: time in µs and the true angle and velocity at it, rad and rad/s, of the velocities and seconds
/// given. The loop is irregular: 150 to 600 µs.
fn motion(velocities: &[(f64, f64)]) -> Vec<(u64, f64, f64)> {
    motion_from(1_000_000, velocities)
}

/// A [`motion`] that begins at this time, µs.
fn motion_from(mut now: u64, velocities: &[(f64, f64)]) -> Vec<(u64, f64, f64)> {
    let mut random = 1u32;
    let mut angle = 0.3;
    let mut motion = Vec::new();
    for &(velocity, seconds) in velocities {
        let end = now + (seconds * 1e6) as u64;
        while now < end {
            motion.push((now, angle, velocity));
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let step = 150 + u64::from(random >> 16) % 451;
            now += step;
            angle += velocity * step as f64 * 1e-6;
        }
    }
    motion
}

/// The angle within a turn, in counts, as a sensor of SimpleFOC shows it.
type Within = fn(f64) -> f64;

/// Velocity and standard deviation of the sensor at each time of a motion, with 4096 counts per turn. Both are 0
/// before the sensor is initialised.
fn sensed(program: &Path, motion: &[(u64, f64, f64)], within: Within) -> Vec<[f64; 2]> {
    let counts = 4096.0 / std::f64::consts::TAU;
    let mut input = String::new();
    for (now, angle, _) in motion {
        let shown = within((angle * counts).floor()) / counts;
        writeln!(input, "{now} {shown:.7}").expect("a string");
    }
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut to = child.stdin.take().expect("piped");
    let writer = std::thread::spawn(move || to.write_all(input.as_bytes()));
    let output = child.wait_with_output().expect("the program ends");
    writer
        .join()
        .expect("no panic")
        .expect("the program reads everything");
    let text = String::from_utf8(output.stdout).expect("text");
    let (before, text) = text.split_once('\n').expect("lines");
    assert_eq!(before, "0 0");
    text.lines()
        .map(|line| {
            let mut numbers = line
                .split(' ')
                .map(|number| number.parse().expect("a number"));
            [(); 2].map(|()| numbers.next().expect("two numbers"))
        })
        .collect()
}

/// A program in C++ with the library for Arduino, in a folder of its own, unless there is no compiler.
fn program(source: &str, name: &str) -> Option<PathBuf> {
    if missing(CPP11.program) {
        return None;
    }
    let folder = folder(name);
    std::fs::write(
        folder.join("LimpidMilliseconds.h"),
        milliseconds().expect("a design").as_bytes(),
    )
    .expect("target");
    let library = build(&COMPUTER).expect("the library");
    let library = library.to_str().expect("a path in UTF-8");
    let program = folder.join("program");
    let stub = format!("-I{}", here("c/arduino_stub"));
    let sources = format!("-I{}", here("../../c/arduino/src"));
    let example = format!("-I{}", here("../../c/arduino/examples/EncoderVelocity"));
    let more = [
        &*stub,
        &sources,
        &example,
        "-x",
        "none",
        library,
        "-lpthread",
        "-ldl",
        "-lm",
    ];
    compiled(&CPP11, source, &folder, &more, &program);
    Some(program)
}

/// A loop that was blocked for 50 periods has the counts of 50 periods, which are not those of one.
#[test]
fn example_has_no_velocity_beyond_that_of_the_encoder_after_a_blocked_loop() {
    let Some(program) = program("encoder_velocity.cpp", "encoder-velocity") else {
        return;
    };
    let output = Command::new(program).output().expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("text");
    let velocities: Vec<f64> = text
        .lines()
        .map(|line| line.parse().expect("a number"))
        .collect();
    // A thousand counts a second, 1200 a revolution.
    let truth = 1000.0 / 1200.0 * std::f64::consts::TAU;
    assert!(velocities.len() > 150, "{velocities:?}");
    // Soon after a start the estimate is still on its way from rest.
    assert!(
        velocities.iter().all(|v| (0.0..1.2 * truth).contains(v)),
        "{truth}: {velocities:?}"
    );
    let near = velocities
        .iter()
        .filter(|v| (**v - truth).abs() < 0.02 * truth);
    assert!(
        near.count() * 10 > 7 * velocities.len(),
        "{truth}: {velocities:?}"
    );
}

/// The clock of Arduino counts microseconds modulo 2^32, and a period is exact however large the clock is.
#[test]
fn velocity_is_the_same_at_a_wrap_of_the_clock() {
    let Some(program) = program("sensor.cpp", "sensor-clock") else {
        return;
    };
    let velocities = [(3.0, 2.0), (-40.0, 2.0)];
    let within: Within = |counts| counts.rem_euclid(4096.0);
    let early = sensed(&program, &motion(&velocities), within);
    let wrapping = motion_from(u64::from(u32::MAX) - 2_000_000, &velocities);
    let late = sensed(&program, &wrapping, within);
    let same = early
        .iter()
        .zip(&late)
        .take_while(|(early, late)| early == late);
    assert_eq!(same.count(), late.len(), "the first update that differs");
}

/// A loop can be faster than the sensor and its clock: updates 5 µs apart wait for one at 20 µs.
#[test]
fn updates_in_quick_succession_are_taken_once_in_20_us() {
    let Some(program) = program("sensor.cpp", "sensor-quick") else {
        return;
    };
    let within: Within = |counts| counts.rem_euclid(4096.0);
    let omega = 3.0;
    let at = |step: u64| (1_000_000 + step, 0.3 + omega * step as f64 * 1e-6, omega);
    let quick: Vec<_> = (0..400_000).map(|k| at(5 * k)).collect();
    let every_20_us: Vec<_> = quick.iter().copied().step_by(4).collect();
    let sensed_quick = sensed(&program, &quick, within);
    let sensed_20_us = sensed(&program, &every_20_us, within);
    for (k, quick) in sensed_quick.iter().enumerate() {
        assert_eq!(*quick, sensed_20_us[k / 4], "update {k}");
    }
    let last = sensed_20_us[sensed_20_us.len() - 1][0];
    assert!((last - omega).abs() < 0.1, "{last}");
}

/// A class keeps a reference to its parameters, so that a temporary would be gone at the first update.
#[test]
fn class_refuses_parameters_that_are_a_temporary() {
    if missing(CPP11.program) {
        return;
    }
    let folder = folder("temporary");
    std::fs::write(
        folder.join("LimpidMilliseconds.h"),
        milliseconds().expect("a design").as_bytes(),
    )
    .expect("target");
    let sources = format!("-I{}", here("../../c/arduino/src"));
    let more = ["-c", &*sources];
    compiled(&CPP11, "temporary.cpp", &folder, &more, &folder.join("x.o"));
}

/// The sensor of SimpleFOC itself divides the angle by the time since it last changed and keeps its
/// velocity for ever when the motor has stopped.
#[test]
fn velocity_of_the_sensor_reaches_zero_and_does_not_jump() {
    let Some(program) = program("sensor.cpp", "sensor") else {
        return;
    };
    // A sensor that is initialised again knows no motion.
    let mut again = motion(&[(3.0, 0.2)]);
    again.push((0, again[again.len() - 1].1, 0.0));
    let positive: Within = |counts| counts.rem_euclid(4096.0);
    let velocities = sensed(&program, &again, positive);
    let [.., [before, _], [after, _]] = velocities[..] else {
        panic!("{velocities:?}");
    };
    assert!(
        (before - 3.0).abs() < 0.1 && after == 0.0,
        "{before} {after}"
    );

    // Through 0 and downwards, also with an angle that is negative there, as that of Hall sensors.
    let down = self::motion(&[(0.0, 0.5), (-0.5, 4.0)]);
    for within in [positive, |counts| counts % 4096.0] {
        let velocities = sensed(&program, &down, within);
        let settled = down.iter().zip(&velocities).skip(2000);
        let worst = settled.fold(0.0, |worst: f64, ((_, _, truth), [v, _])| {
            worst.max((v - truth).abs())
        });
        assert!(worst < 0.02, "{worst}");
    }

    // One count is 1.5 mrad: in a loop of 375 µs it is a jump of 4.1 rad/s of a plain difference.
    let motion = motion(&[(0.5, 3.0), (0.0, 2.0), (-40.0, 2.0), (0.0, 2.0)]);
    let sensed = sensed(&program, &motion, positive);
    assert_eq!(sensed.len(), motion.len());
    let at = |from_s: f64, to_s: f64| {
        let us = [from_s, to_s].map(|s| (s * 1e6) as u64 + 1_000_000);
        let within = move |(now, _, _): &&(u64, f64, f64)| us[0] <= *now && *now < us[1];
        motion
            .iter()
            .zip(&sensed)
            .filter(move |(one, _)| within(one))
    };
    let worst = |from_s, to_s| {
        at(from_s, to_s)
            .map(|((_, _, truth), [v, _])| (v - truth).abs())
            .fold(0.0, f64::max)
    };
    println!(
        "slow {:.3}, fast {:.3} rad/s",
        worst(1.0, 3.0),
        worst(5.5, 7.0)
    );
    // At a constant velocity the bank is far below a plain difference, also in the irregular loop.
    assert!(worst(1.0, 3.0) < 0.01, "{}", worst(1.0, 3.0));
    assert!(worst(5.5, 7.0) < 0.02, "{}", worst(5.5, 7.0));
    // Half a second after the motor has stopped, the velocity is zero, and it stays so.
    for rest in [3.5, 7.5] {
        assert!(at(rest, rest + 1.5).count() > 3000);
        assert!(
            at(rest, rest + 1.5).all(|(_, [v, _])| *v == 0.0),
            "rest after {rest} s"
        );
    }
    // The standard deviation contains the error: below three of it in 95 % of the moving updates.
    let moving: Vec<_> = at(1.0, 3.0).chain(at(5.5, 7.0)).collect();
    let within = moving
        .iter()
        .filter(|((_, _, truth), [v, deviation])| (v - truth).abs() < 3.0 * deviation);
    assert!(within.count() * 100 > 95 * moving.len());
}
