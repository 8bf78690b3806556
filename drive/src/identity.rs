//! The identity of a board as text.

use drivers::link::PROTOCOL;
use haptic_control::Fingerprint;
use tuned::{DEVICE_FINGERPRINT, PRESETS_FINGERPRINT};

use crate::board::Answer;
use crate::watch;

/// One line per property.
pub(crate) fn text(answer: &Answer) -> String {
    let hello = &answer.hello;
    let features: Vec<_> = hello.features.names().collect();
    let features = match &features[..] {
        [] => "none".to_owned(),
        names => names.join(", "),
    };
    let protocol = match hello.protocol {
        PROTOCOL => PROTOCOL.to_string(),
        other => {
            format!("{other}; this tool speaks {PROTOCOL} and sends such a board disarm alone")
        }
    };
    let brown_out = match hello.brown_out_reset {
        true => "yes",
        false => "no",
    };
    let mut rows = vec![
        ("protocol", protocol),
        (
            "firmware",
            format!("{}, commit {}", hello.version, hello.commit),
        ),
        ("features", features),
        ("control rate", format!("{} Hz", hello.rate)),
        ("device", hash(hello.device, DEVICE_FINGERPRINT)),
        ("presets", hash(hello.presets, PRESETS_FINGERPRINT)),
        ("reset", format!("cause {}", watch::cause(hello.cause))),
        ("reset below 2.7 V", brown_out.to_owned()),
    ];
    if let Some(rejected) = answer.rejected {
        let counts = format!(
            "{} not finite, {} out of bounds, {} unknown, {} before bring-up, {} bytes of garbage",
            rejected.not_finite,
            rejected.out_of_bounds,
            rejected.unknown,
            rejected.unverified,
            rejected.garbage
        );
        rows.push(("rejected commands", counts));
    }
    let lines = rows
        .iter()
        .map(|(name, value)| format!("{name:<19}{value}\n"));
    lines.collect()
}

/// A hash of the image, compared with that of the files for which this tool was built.
fn hash(image: u32, tool: Fingerprint) -> String {
    match Fingerprint(image) {
        same if same == tool => same.to_string(),
        other => format!("{other}; this tool is built for {tool}"),
    }
}
