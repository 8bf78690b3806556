//! Any bytes as a file that somebody hands over.

use recordings::recording::Recording;
use simulation::device::Device;

/// Reads `data` as each kind of file.
///
/// # Panics
/// If a message is not one line or names no file.
pub fn run(data: &[u8]) {
    match Recording::parse(data, "any.csv") {
        Ok(recording) => {
            assert!(recording.t.windows(2).all(|pair| pair[0] <= pair[1]));
            assert!(recording.trace.rate_hz.is_finite() && recording.trace.rate_hz > 0.0);
        }
        Err(failure) => {
            let said = failure.to_string();
            assert!(said.starts_with("any.csv"), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
    let device = std::str::from_utf8(data)
        .ok()
        .and_then(|text| Device::from_toml_str(text).ok());
    if let Some(device) = device {
        assert_eq!(device.check_values(), Ok(()));
    }
}
