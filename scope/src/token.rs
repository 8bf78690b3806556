//! Random words: the token of a page, and the nonce of its policy.

use std::fmt::Write as _;

/// 128 random bits in hexadecimal digits.
///
/// # Errors
/// One line if the system has no random numbers.
pub(crate) fn random() -> Result<String, String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| format!("no random numbers: {error}"))?;
    let mut text = String::new();
    for byte in bytes {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}
