//! Images run with what `host-sim tune` wrote for the plant with friction.

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use estimator_core::{
    Amps, Count, Edge, Hertz, ObserverDesign, Sample, Uncertainty, VelocityEstimator,
};
use firmware_app::config::{DEVICE, RATE, TIMERS};
use firmware_app::large::{ADAPTIVE, ADAPTIVE_EDGE, Adaptive, AdaptiveEdge};
use haptic_control::DualStage;

fn setup(rate: Hertz) -> Setup {
    Setup {
        rate,
        stages: DualStage::DEFAULT,
    }
}

#[test]
fn build_script_reads_presets_like_host_sim() {
    let shipped = Parameters::default();
    let mut compared = 0;
    for rate in [500.0, 1000.0, 4000.0, 10_000.0, 20_000.0].map(Hertz) {
        for kind in Kind::all().iter().filter(|kind| kind.is_tunable()) {
            let values = shipped.values(kind, &setup(rate), PlantKind::Friction);
            for (parameter, value) in kind.parameters.iter().zip(values) {
                let tuned = tuned::find(kind.name, rate, parameter.name);
                let tuned = tuned.unwrap_or_else(|| panic!("{}.{}", kind.name, parameter.name));
                // host-sim lowers a frequency to half the rate.
                let tuned = if parameter.unit == "Hz" {
                    tuned.min(rate.0 / 2.0)
                } else {
                    tuned
                };
                assert_eq!(
                    tuned.to_bits(),
                    value.to_bits(),
                    "{}.{} at {} Hz",
                    kind.name,
                    parameter.name,
                    rate.0
                );
                compared += 1;
            }
        }
    }
    assert!(compared >= 5 * 40, "{compared} values");
}

/// The design of an observer of the image, with the values that host-sim uses for this plant.
fn designed(name: &str, plant: PlantKind) -> ObserverDesign {
    let kind = Kind::named(name).unwrap();
    let values = Parameters::default().values(kind, &setup(RATE), plant);
    let value = |name: &str| values[kind.parameter(name).unwrap()];
    let unsure = Uncertainty {
        torque_noise: value("torque_noise"),
        disturbance: value("load"),
        disturbance_time: value("load_time"),
        friction_share: value("friction_share"),
        boundary_noise: value("boundary_noise"),
    };
    ObserverDesign::new(&DEVICE.coupled_motor(), RATE, &unsure)
}

/// Velocities of a motor that is driven back and forth, with a stamped edge where the count moves.
fn velocities<E: VelocityEstimator>(e: &E) -> Vec<u32> {
    let mut state = e.start(&Sample::new(Count(0)));
    let (mut count, mut edge) = (0_i32, None);
    let ticks = (0..4000).map(|k| {
        let phase = f64::from(k) / 400.0;
        let now = (300.0 * phase.sin()).floor() as i32;
        if now != count {
            edge = Some(Edge {
                boundary: Count(now.max(count).cast_unsigned()),
                age: estimator_core::ClockTicks(2000),
            });
        }
        count = now;
        let mut sample =
            Sample::new(Count(count.cast_unsigned())).with_current(Amps::new(phase.cos() as f32));
        sample.edge = edge;
        e.update(&mut state, &sample).0.to_bits()
    });
    ticks.collect()
}

#[test]
fn the_adaptive_images_are_tuned_for_the_plant_with_friction() {
    let counts = |plant| -> Adaptive { designed("adaptive", plant).adaptive().build().unwrap() };
    let edges = |plant| -> AdaptiveEdge {
        let observer = designed("adaptive-edge", plant);
        observer.with_edges(TIMERS).adaptive().build().unwrap()
    };
    let [rough, smooth] = [PlantKind::Friction, PlantKind::Frictionless];
    assert_eq!(velocities(&ADAPTIVE), velocities(&counts(rough)));
    assert_ne!(velocities(&ADAPTIVE), velocities(&counts(smooth)));
    assert_eq!(velocities(&ADAPTIVE_EDGE), velocities(&edges(rough)));
    assert_ne!(velocities(&ADAPTIVE_EDGE), velocities(&edges(smooth)));
}
