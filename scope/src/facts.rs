//! What a page has to know, from the tables of the firmware and of the catalogue.

use channels::CHANNELS;
use drive::guided::Guided;
use drivers::Setting;
use experiments::compare::interval;
use firmware_app::config::{DEVICE, RATE};
use firmware_app::large;
use firmware_app::scene::BOUNDS;
use haptic_control::{SceneKind, Stop};
use serde_json::{Value, json};
use simulation::device::Device;
use virtual_board::live::{FASTEST_RAD_S, FOLLOWING_PER_S};

use crate::estimators::Estimators;
use crate::fault_watch::sentence;

/// The facts of a source with this device. The source adds its own.
pub(crate) fn of_device(device: &Device) -> Value {
    let interval = interval(device);
    json!({
        "channels": CHANNELS,
        "estimators": estimators(),
        "scenes": SceneKind::ALL.map(scene),
        "image_estimators": large::NAMES,
        "causes": Stop::ALL.map(|stop| json!([stop.as_str(), sentence(stop.meaning())])),
        "faults": [],
        "settings": Setting::ALL.iter().map(|setting| setting_facts(*setting)).collect::<Vec<_>>(),
        "guides": Guided::ALL.map(Guided::as_str),
        "hand": {
            "stiffness": device.hand.stiffness_nm_per_rad,
            "damping": device.hand.damping_nms_per_rad,
            "fastest": FASTEST_RAD_S,
            "following": FOLLOWING_PER_S,
        },
        "device": {
            "diameter": device.handle.diameter_m,
            "threshold_mn": 1e3 * device.interval.threshold_n,
            "counts_per_rev": device.stages.large.counts_per_rev,
        },
        "interval": {
            "weber": interval.weber,
            "floor": interval.floor_rad_s,
            "mn_per_rad_s": interval.force_mn_per_rad_s,
        },
    })
}

fn scene(scene: SceneKind) -> Value {
    let facts = scene.facts();
    let usual = scene.usual(&DEVICE, RATE).ok();
    let parameters = facts.parameters.iter().zip(0..).map(|(parameter, number)| {
        let range = parameter.quantity.range(&BOUNDS);
        json!({
            "name": parameter.name,
            "unit": parameter.quantity.unit(),
            "least": range.start(),
            "most": range.end(),
            "usual": usual.as_ref().and_then(|usual| usual.value(number, RATE)),
        })
    });
    json!({
        "number": scene.number(),
        "name": facts.name,
        "summary": facts.summary,
        "parameters": parameters.collect::<Vec<_>>(),
    })
}

fn setting_facts(setting: Setting) -> Value {
    let facts = setting.facts();
    json!({
        "name": facts.name,
        "meaning": facts.meaning,
        "unit": if facts.unit == "1" { "" } else { facts.unit },
        "least": facts.least,
        "most": facts.most,
        "whole": facts.is_whole,
    })
}

fn estimators() -> Vec<Value> {
    let kinds = Estimators::kinds();
    let row = kinds
        .iter()
        .map(|kind| json!({ "name": kind.name, "summary": kind.summary }));
    row.collect()
}
