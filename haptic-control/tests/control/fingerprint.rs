//! The fingerprint of constants. Its example in the documentation has the authors' value of FNV-1a.

use haptic_control::Fingerprint;

/// FNV-1a of 32 bits from its definition.
fn fnv_1a(bytes: &[u8]) -> u32 {
    let step = |hash: u32, byte: &u8| (hash ^ u32::from(*byte)).wrapping_mul(16_777_619);
    bytes.iter().fold(2_166_136_261, step)
}

#[test]
fn number_has_the_hash_of_its_eight_bytes_least_first() {
    for x in [1.0, -0.25, 4096.0, f64::MIN_POSITIVE] {
        assert_eq!(Fingerprint::EMPTY.number(x).0, fnv_1a(&x.to_le_bytes()));
    }
}

#[test]
fn zeros_of_both_signs_have_one_hash() {
    let [plus, minus] = [0.0, -0.0].map(|zero| Fingerprint::EMPTY.number(zero));
    assert_eq!(plus, minus);
}

#[test]
fn text_continues_the_hash_of_what_precedes_it() {
    let joined = Fingerprint::EMPTY.text("inertia").text("damping");
    assert_eq!(joined.0, fnv_1a(b"inertiadamping"));
}
