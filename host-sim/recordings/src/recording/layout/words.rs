//! Words in the names of columns.

/// Parts of the names of positions, and of times.
pub(crate) const POSITIONS: &[&str] = &[
    "counts", "encoder", "enc", "pos", "angle", "theta", "rotation", "q",
];
pub(crate) const TIMES: &[&str] = &["time", "stamp", "ts"];

/// Parts of the names of what is derived from a position.
const DERIVED: &[&str] = &["vel", "speed", "omega", "acc", "dot"];

/// Parts of the names of positions that are no measured position of the shaft, or of another angle. `soll` and `consign`
/// are targets in German and French; `e` and `d` are electrical and desired: `theta_e`, `theta_d`.
const INDIRECT: &[&str] = &[
    "err", "target", "cmd", "command", "demand", "request", "ref", "set", "sp", "des", "goal",
    "elec", "delta", "diff", "rate", "tcp", "soll", "consign", "e", "d",
];

/// Parts of a name beside which `q` is no joint: quantities of the q axis, and parts of a quaternion.
const NO_JOINT: &[&str] = &["i", "u", "v", "current", "curr", "voltage", "volt"];

/// Parts of the names of coordinates.
const COORDINATES: &[&str] = &["w", "x", "y", "z"];

/// Parts of the names of durations, which are no time of a row.
const DURATIONS: &[&str] = &[
    "dt", "loop", "delta", "diff", "duration", "period", "latency",
];

/// Whether a part of `name` is one of the `words`: a word of one or two letters is a whole part, one of three begins or
/// ends a part, and a longer one, or one of several parts, is anywhere. A sequence is no encoder.
pub(crate) fn has(name: &str, words: &[&str]) -> bool {
    let lower = name.to_lowercase();
    let parts = parts(name);
    let is_in = |word: &str| match word.len() {
        _ if word.contains('_') => lower.contains(word),
        0..=2 => parts.iter().any(|part| part == word),
        3 => parts
            .iter()
            .any(|part| part.starts_with(word) || part.ends_with(word)),
        _ => lower.contains(word),
    };
    words.iter().any(|word| is_in(word))
}

/// The parts of a name between other characters, at capitals and at digits, in lower case.
fn parts(name: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut before = ' ';
    for c in name.chars() {
        let begins =
            (c.is_uppercase() && before.is_lowercase()) || c.is_numeric() != before.is_numeric();
        if !c.is_alphanumeric() || begins {
            parts.push(String::new());
        }
        if let Some(part) = parts.last_mut().filter(|_| c.is_alphanumeric()) {
            part.extend(c.to_lowercase());
        }
        before = c;
    }
    parts
}

/// Whether `name` is that of a rate of a position: omega, theta_dot, dtheta.
pub(crate) fn is_derived(name: &str) -> bool {
    let differential = |part: String| {
        let position = part.strip_prefix('d');
        position.is_some_and(|position| POSITIONS.contains(&position))
    };
    has(name, DERIVED) || parts(name).into_iter().any(differential)
}

/// Whether `name` is that of a position that is not measured at the shaft, or of none: a target, an error, a difference,
/// an electrical angle, a quantity of the q axis.
pub(crate) fn is_indirect(name: &str) -> bool {
    let desired = |part: String| {
        let position = part.strip_suffix('d');
        position.is_some_and(|position| POSITIONS.contains(&position))
    };
    let parts = parts(name);
    let has_part = |words: &[&str]| parts.iter().any(|part| words.contains(&part.as_str()));
    let is_axis = has_part(&["q"]) && (has_part(NO_JOINT) || has_part(COORDINATES));
    is_axis || has(name, INDIRECT) || parts.into_iter().any(desired)
}

/// Whether `name` is that of a coordinate of a point or of a part of a quaternion, as a camera or a tool has them.
pub(crate) fn is_coordinate(name: &str) -> bool {
    let parts = parts(name);
    parts
        .iter()
        .any(|part| COORDINATES.contains(&part.as_str()))
}

/// Whether `name` is that of a joint and of nothing that is measured at it: `joint_1`, `elbow_joint`, `J3`.
pub(crate) fn is_joint(name: &str) -> bool {
    let parts = parts(name);
    let mut parts = parts.iter().filter(|part| !part.is_empty()).rev();
    let is_number = |part: &&String| part.parse::<u8>().is_ok();
    match parts.next() {
        Some(number) if is_number(&number) => parts
            .next()
            .is_some_and(|name| ["joint", "j"].contains(&name.as_str())),
        last => last.is_some_and(|name| name == "joint"),
    }
}

/// Whether `name` is that of a duration.
pub(crate) fn is_duration(name: &str) -> bool {
    has(name, DURATIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_words_are_whole_parts_of_a_name() {
        for name in [
            "encoder",
            "Encoder 1",
            "motorEnc",
            "enc1_raw",
            "motorencoder",
            "jointpos",
            "PosLeft",
            "actual_position",
            "wheelangle",
            "actual_q_0",
        ] {
            assert!(has(name, POSITIONS), "{name}");
        }
        for name in [
            "sequence",
            "frequency",
            "reference",
            "silence",
            "latency_s",
            "purpose",
        ] {
            assert!(!has(name, POSITIONS), "{name}");
        }
        assert!(has("time_ms", &["ms"]) && has("T(ms)", &["ms"]) && has("iqRef", &["iq"]));
        assert!(has("motor_i_q", &["i_q"]) && !has("rms_A", &["ms"]));
    }

    #[test]
    fn coordinate_is_a_part_of_a_name() {
        for name in ["x_position", "pose.y", "rotation_w", "PosZ"] {
            assert!(is_coordinate(name), "{name}");
        }
        for name in ["exp_pos", "xpos", "angle", "max_angle"] {
            assert!(!is_coordinate(name), "{name}");
        }
    }

    #[test]
    fn joint_is_a_whole_name() {
        for name in [
            "joint1",
            "joint_1",
            "J3",
            "/arm/elbow_joint",
            "shoulder_pan_joint",
        ] {
            assert!(is_joint(name), "{name}");
        }
        for name in [
            "/joint_states/header/seq",
            "joint1_velocity",
            "j",
            "adj_3_gain",
            "obj",
            "3",
            "",
        ] {
            assert!(!is_joint(name), "{name}");
        }
    }

    #[test]
    fn rates_targets_and_durations_are_known_by_their_names() {
        for name in [
            "theta_dot_rad",
            "dtheta",
            "angleDot",
            "dpos_deg",
            "speed",
            "accZ",
        ] {
            assert!(is_derived(name), "{name}");
        }
        for name in [
            "theta_d_rad",
            "Sollwinkel",
            "angle_consigne",
            "posd",
            "theta_e",
            "angle_sp",
            "pos_demand",
            "refPos",
            "posErr",
            "elecAngle",
            "target_q_0",
            "actual_TCP_pose_0",
            "qd",
            "i_q",
            "current_q",
            "q_w",
        ] {
            assert!(is_indirect(name) && !is_derived(name), "{name}");
        }
        for name in [
            "theta",
            "encoded_pos",
            "pos_rad",
            "angle_deg",
            "EncoderLeft",
            "actual_q_0",
            "q1",
        ] {
            assert!(!is_indirect(name) && !is_derived(name), "{name}");
        }
        for name in ["dt_us", "loop_time_us", "latency_ms", "deltaTime"] {
            assert!(is_duration(name), "{name}");
        }
        assert!(!is_duration("time_ms") && !is_duration("timestamp"));
    }
}
