//! Parameters that an image learns from a device with other constants than its own.

use experiments::closed_loop::Hand;
use haptic_control::SceneKind;
use recordings::health;
use recordings::recording::BoardColumns;
use recordings::telemetry::LearnedLine;
use simulation::device::Device;
use virtual_board::run::{Outcome, Setup};

use crate::image::{of_scene, run, run_image};

/// The last line of what was learned.
fn last_learned(run: &Outcome) -> Option<LearnedLine> {
    let frames = run.telemetry.frames.iter().rev();
    frames.filter_map(|frame| frame.side_lines.learned).next()
}

/// A coupler that has warmed up: a quarter of its damping is gone, and the image says so. A wall lets
/// the coupler slip; in free air it hardly does, and nothing can be learned of it.
#[test]
fn smaller_damping_is_learned_and_logged() {
    let setup = |part: f64| {
        let mut device = Device::default();
        device.stages.damping *= part;
        Setup {
            device,
            ..of_scene(SceneKind::Wall, Hand::Pushing, 12.0)
        }
    };
    for part in [1.0, 0.75] {
        let run = run_image("large-adaptive", &setup(part));
        let line = last_learned(&run).expect("a line");
        let learned = (1.0 + line.damping) / (1.0 + line.torque_constant);
        println!("damping {part} of what is assumed: learned {learned}");
        assert!((learned - part).abs() < 0.05, "{part}: {learned}");
        // The health line reports a change relative to the device of the image, and none relative to
        // the simulated device.
        let board = BoardColumns::parse(run.csv().unwrap().as_bytes(), "r").unwrap();
        let health = |device: &Device| health::lines(&board.learned.expect("columns"), device);
        let damping = |device: &Device| health(device).swap_remove(0);
        assert_eq!(damping(&Device::default()).contains("changed"), part != 1.0);
        assert!(!damping(&setup(part).device).contains("changed"), "{part}");
    }
    // An image without adaptation logs no learned parameters.
    let short = Setup {
        seconds: 0.5,
        ..setup(0.75)
    };
    assert_eq!(last_learned(&run(&short)), None);
}
