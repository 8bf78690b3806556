//! Identification of the device from a recording of the image.

use experiments::closed_loop::Hand;
use experiments::identify::{Known, identify};
use haptic_control::{Mode, SceneKind, Stop};
use recordings::recording::Recording;
use simulation::device::Device;

use virtual_board::run::Setup;

use crate::image::{of_scene, run};

/// A device that is not the one that the image assumes, excited by the image's own scene while
/// a hand holds it: its constants come out of the frames.
#[test]
fn device_is_identified_from_the_images_excitation() {
    let mut device = Device::default();
    device.stages.large.inertia *= 1.2;
    device.stages.large.coulomb_friction *= 1.3;
    device.stages.damping *= 0.88;
    let excited = run(&Setup {
        device: device.clone(),
        ..of_scene(SceneKind::Excite, Hand::Still, 16.2)
    });
    let last = excited.telemetry.frames.last().unwrap();
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    let text = excited.csv().unwrap();
    let recording = Recording::parse(text.as_bytes(), "board").unwrap();
    let known = Known::TorqueConstant(device.stages.large.torque_constant);
    let found = identify(
        &[("board".to_owned(), recording)],
        &[],
        &Device::default(),
        known,
        false,
    )
    .unwrap();
    for (key, truth) in [
        ("large.inertia_kg_m2", device.stages.large.inertia),
        ("large.coulomb_nm", device.stages.large.coulomb_friction),
        ("coupler.damping_nms_per_rad", device.stages.damping),
    ] {
        let quantity = found.quantities.iter().find(|q| q.key == key);
        let quantity = quantity.unwrap_or_else(|| panic!("{key} among what is known"));
        assert_eq!(quantity.rejected, None, "{key}");
        let off = quantity.estimate.value / truth - 1.0;
        println!("{key}: {:.2} % off", 100.0 * off);
        assert!(off.abs() < 0.03, "{key} {off}");
        // The file that it is compared with says something else: it was not copied.
        assert!((quantity.file / truth - 1.0).abs() > 0.1, "{key}");
    }
}
