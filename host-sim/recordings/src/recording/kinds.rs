//! Files that are no text: compressed, or data of another program.

use terminal::failure::Failure;

/// First bytes of a file, what it is, and the remedy.
const KINDS: [(&[u8], &str, &str); 13] = [
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
    (b"TDSm", "a TDMS file of LabVIEW", "write it as CSV or LVM"),
    (
        b"<SALEAE>",
        "a binary export of Logic 2",
        "export the lines as CSV",
    ),
    (b"#ROSBAG", "a bag of ROS 1", "write a topic as CSV"),
    (
        b"SQLite format 3",
        "an SQLite database, as a bag of ROS 2",
        "write a topic as CSV",
    ),
    (b"ULog", "a ULog of PX4", "write it as CSV with ulog2csv"),
];

/// Bytes that are searched for control characters.
const SEARCHED: usize = 256;

/// The file is no text if more than one of this many bytes is a control character.
const CONTROL_PART: usize = 20;

/// Checks that the log called `name` with the first bytes `head` is text.
///
/// # Errors
/// [`Failure::Input`] with the remedy.
pub(crate) fn check(head: &[u8], name: &str) -> Result<(), Failure> {
    let refused = |what: &str| Err(Failure::Input(format!("{name}: line 1: {what}")));
    if let Some((_, what, remedy)) = KINDS.iter().find(|(begin, ..)| head.starts_with(begin)) {
        return refused(&format!("this is {what}; {remedy}, or give the text as -"));
    }
    let head = &head[..head.len().min(SEARCHED)];
    let is_control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    if head.iter().filter(is_control).count() > head.len() / CONTROL_PART {
        return refused("the file is not text; write it as CSV");
    }
    Ok(())
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
        assert!(
            error(b"#ROSBAG V2.0\n").contains("this is a bag of ROS 1; write a topic as CSV, or")
        );
        let binary: Vec<u8> = (0..=255).collect();
        assert_eq!(
            error(&binary),
            "r.csv: line 1: the file is not text; write it as CSV"
        );
    }
}
