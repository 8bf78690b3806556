//! Raw bytes of RTT, decoded with the image that sent them.
//!
//! It is a crate of its own because the decoder needs as many crates as the rest of host-sim: a feature of
//! [`recordings`] would be on in every build of the workspace's default members.

use defmt_decoder::{DecodeError, Table};
use recordings::telemetry::Telemetry;

/// Decodes bytes from up channel 0 of the image `elf`.
///
/// # Errors
/// One line on an image without defmt or with another version of it.
pub fn decode(elf: &[u8], bytes: &[u8]) -> Result<Telemetry, String> {
    let table = Table::parse(elf)
        .map_err(|error| format!("defmt: {error}"))?
        .ok_or("the image has no defmt table")?;
    let mut decoder = table.new_stream_decoder();
    let mut telemetry = Telemetry::default();
    // The bytes are given in pieces, because the decoder shifts its buffer for each frame.
    for piece in bytes.chunks(256) {
        decoder.received(piece);
        loop {
            match decoder.decode() {
                Ok(frame) => telemetry.line(&frame.display_message().to_string()),
                Err(DecodeError::UnexpectedEof) => break,
                Err(DecodeError::Malformed) => {
                    telemetry
                        .malformed
                        .push("a frame that defmt cannot decode".to_owned());
                    if !table.encoding().can_recover() {
                        return Ok(telemetry);
                    }
                }
            }
        }
    }
    Ok(telemetry)
}
