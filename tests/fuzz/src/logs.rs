//! Any bytes as the rows of a log, and what the commands compute from it.

use catalogue::parameters::Parameters;
use experiments::identify::{self, Known, identify};
use experiments::recommend::{Settings, recommend};
use experiments::reference::Reference;
use recordings::recording::{ReadOptions, Recording};
use simulation::device::Device;
use simulation::trace::{EdgeStamp, Trace};

use crate::bytes::Bytes;

/// Most rows of a log.
const ROWS: usize = 2000;

/// Name of the log in messages.
const NAME: &str = "any.csv";

/// Rates of the rows, Hz.
const RATES: [f64; 8] = [
    20.0, 100.0, 333.3, 500.0, 1000.0, 4000.0, 10_000.0, 50_000.0,
];

/// Makes a log of `data`, and runs the commands `recommend` and `identify` on it.
///
/// # Panics
/// If a velocity, an error or a constant is not finite, or a message is not one line or names no log.
pub fn run(data: &[u8]) {
    let device = Device::default();
    let Some(mut recording) = recording(data) else {
        return;
    };
    let counts_per_rev = device.stages.large.counts_per_rev;
    let notes = recording.unwrap_counts(&ReadOptions::of(&device));
    notes.iter().for_each(|note| check_line(note));
    if let Ok(reference) = Reference::of(&recording, counts_per_rev) {
        let rows = recording.t.len();
        assert_eq!((reference.omega.len(), reference.sd.len()), (rows, rows));
        assert!(reference.sd.iter().all(|sd| *sd >= 0.0));
        assert!(reference.bandwidth_hz > 0.0 && reference.bandwidth_hz.is_finite());
    }
    let logs = [(NAME.to_owned(), recording)];
    let parameters = Parameters::default();
    let settings = Settings {
        device: &device,
        is_known: true,
        parameters: &parameters,
        budget: 100.0,
        cost: |_, _| None,
    };
    match recommend(&logs, &settings, &|| {}) {
        Ok(found) => {
            for ranked in &found.ranked {
                let name = ranked.estimator;
                assert!(
                    ranked.rms_pct >= 0.0 && ranked.rms_pct.is_finite(),
                    "{name}"
                );
            }
            for estimate in found.outcomes.iter().flat_map(|outcome| &outcome.estimates) {
                assert!(
                    estimate.velocity.iter().all(|v| v.is_finite()),
                    "{}",
                    estimate.estimator
                );
            }
            found.notes.iter().for_each(|note| check_line(note));
        }
        Err(failure) => check_message(&failure.to_string()),
    }
    let known = Known::TorqueConstant(device.stages.large.torque_constant);
    match identify(&logs, &[None], &device, known, true) {
        Ok(found) => {
            for quantity in found.quantities.iter().filter(|one| one.is_told()) {
                let estimate = quantity.estimate;
                assert!(estimate.value.is_finite(), "{}", quantity.key);
                assert!(estimate.half >= 0.0, "{}", quantity.key);
            }
            let text = identify::text(&found);
            assert!(!text.contains("NaN"), "{text}");
        }
        Err(failure) => check_message(&failure.to_string()),
    }
}

fn check_line(text: &str) {
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(!text.contains("NaN"), "{text}");
}

fn check_message(text: &str) {
    check_line(text);
    assert!(text.starts_with(NAME), "{text}");
}

/// The log of `data`: pieces of constant acceleration, each with what a real log may have: noise, a jump, a gap,
/// uneven times, a count that stays.
fn recording(data: &[u8]) -> Option<Recording> {
    let mut bytes = Bytes(data);
    let rate_hz = RATES[usize::from(bytes.byte()?) % RATES.len()];
    let columns = bytes.byte()?;
    let has = |bit: u8| columns & 1 << bit != 0;
    let mut t = Vec::new();
    let mut trace = Trace {
        rate_hz,
        counts_small: has(0).then(Vec::new),
        current: has(1).then(Vec::new),
        edges: has(2).then(Vec::new),
        true_omega: has(3).then(Vec::new),
        ..Trace::default()
    };
    let (mut time, mut position, mut velocity) = (0.0, 0.0, 0.0);
    let mut random = 1u32;
    // A shaft that the current drives against a viscous friction: gain and friction of a tick.
    let driven = (
        f64::from(bytes.byte()?) / 16.0,
        f64::from(bytes.byte()?) / 1024.0,
    );
    while let Some([kind, rows, acceleration]) = bytes.take() {
        let pushed = f64::from(acceleration as i8) * f64::exp2(f64::from(kind >> 5));
        let current = match kind & 0x1f {
            1 => f64::from(bytes.f32()?),
            _ => pushed / 8192.0,
        };
        if kind & 0xf == 2 {
            position += f64::from(bytes.u32()? as i32);
        }
        if kind & 0xf == 4 {
            time += f64::from(bytes.byte()?) * 16.0 / rate_hz;
        }
        if kind & 24 == 24 {
            velocity = 0.0;
        }
        for _ in 0..=rows {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = f64::from(random) / f64::from(u32::MAX) - 0.5;
            velocity += match has(5) {
                true => driven.0 * current - driven.1 * velocity,
                false => pushed / 1024.0,
            };
            if !velocity.is_finite() {
                break;
            }
            position += velocity;
            time += match has(4) && kind & 8 != 0 {
                true => (1.0 + 1.9 * noise) / rate_hz,
                false => 1.0 / rate_hz,
            };
            let count = (position + if kind & 16 == 0 { 0.0 } else { 8.0 * noise }).floor();
            let count = count as i64 as u32;
            t.push(time);
            trace.counts_large.push(count);
            if let Some(counts) = &mut trace.counts_small {
                counts.push(count.wrapping_add(random >> 29));
            }
            if let Some(currents) = &mut trace.current {
                currents.push(if current.is_finite() { current } else { 0.0 });
            }
            if let Some(edges) = &mut trace.edges {
                let age_s = (noise + 0.5) * 2.0 / rate_hz;
                let boundary = count.wrapping_add(random >> 30);
                edges.push((random >> 28 != 0).then_some(EdgeStamp { age_s, boundary }));
            }
            if let Some(truth) = &mut trace.true_omega {
                truth.push(velocity * rate_hz * 1e-3);
            }
        }
        if t.len() >= ROWS {
            break;
        }
    }
    Recording::of_columns(t, trace, NAME).ok()
}
