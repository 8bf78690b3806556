//! Files that are no text: compressed, in another encoding, or data of another program.

use terminal::failure::Failure;

/// First bytes of a file, what it is, and the remedy.
const KINDS: [(&[u8], &str, &str); 8] = [
    (b"PK\x03\x04", "a zip file", "unpack it with unzip -p"),
    (
        b"\x28\xB5\x2F\xFD",
        "a zstd file",
        "unpack it with zstd -dc",
    ),
    (b"\xFD7zXZ", "an xz file", "unpack it with xz -dc"),
    (b"BZh", "a bzip2 file", "unpack it with bzip2 -dc"),
    (b"PAR1", "a Parquet file", "write it as CSV"),
    (b"\x89HDF", "an HDF5 file", "write it as CSV"),
    (b"MATLAB 5.0 MAT", "a file of MATLAB", "write it as CSV"),
    (b"\x89MCAP", "an MCAP file", "write it as CSV"),
];

/// Bytes that are searched for the encoding.
const SEARCHED: usize = 256;

/// The file is no text if more than one of this many bytes is a control character.
const CONTROL_PART: usize = 20;

/// Checks that the log called `name` with the first bytes `head` is text in UTF-8.
///
/// # Errors
/// [`Failure::Input`] with the remedy.
pub(crate) fn check(head: &[u8], name: &str) -> Result<(), Failure> {
    let refused = |what: &str| Err(Failure::Input(format!("{name}: line 1: {what}")));
    if let Some((_, what, remedy)) = KINDS.iter().find(|(begin, ..)| head.starts_with(begin)) {
        return refused(&format!("this is {what}; {remedy}, or give the text as -"));
    }
    if let Some(encoding) = utf_16(head) {
        return refused(&format!(
            "the text is in UTF-16; save it in UTF-8, for example with iconv -f {encoding} -t UTF-8"
        ));
    }
    let head = &head[..head.len().min(SEARCHED)];
    let is_control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    if head.iter().filter(is_control).count() > head.len() / CONTROL_PART {
        return refused("the file is not text; write it as CSV");
    }
    Ok(())
}

/// The name of the encoding of a text in UTF-16, with or without a mark: most of its characters have a
/// byte of zero.
fn utf_16(head: &[u8]) -> Option<&'static str> {
    if head.starts_with(b"\xFF\xFE") || head.starts_with(b"\xFE\xFF") {
        return Some("UTF-16");
    }
    let head = &head[..head.len().min(SEARCHED)];
    let zeros = |parity: usize| {
        let bytes = head.iter().skip(parity).step_by(2);
        2 * bytes.filter(|byte| **byte == 0).count() > head.len() / 2
    };
    match (zeros(0), zeros(1)) {
        (false, true) => Some("UTF-16LE"),
        (true, false) => Some("UTF-16BE"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::Recording;

    fn error(bytes: &[u8]) -> String {
        Recording::parse(bytes, "r.csv").unwrap_err().to_string()
    }

    #[test]
    fn file_that_is_no_text_is_named_with_the_remedy() {
        let zip = error(b"PK\x03\x04\x14\0\0\0\x08\0own.csv");
        assert_eq!(
            zip,
            "r.csv: line 1: this is a zip file; unpack it with unzip -p, or give the text as -"
        );
        assert!(error(b"\x28\xB5\x2F\xFDxyz").contains("unpack it with zstd -dc"));
        let binary: Vec<u8> = (0..=255).collect();
        assert_eq!(
            error(&binary),
            "r.csv: line 1: the file is not text; write it as CSV"
        );
    }

    #[test]
    fn utf_16_is_found_without_a_mark() {
        let text = "t,counts_large\n0,1\n0.001,2\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for (bytes, encoding) in [(little, "UTF-16LE"), (big, "UTF-16BE")] {
            let said = format!(
                "r.csv: line 1: the text is in UTF-16; save it in UTF-8, for example with iconv -f \
                 {encoding} -t UTF-8"
            );
            assert_eq!(error(&bytes), said);
        }
        Recording::parse(text.as_bytes(), "r.csv").unwrap();
    }
}
