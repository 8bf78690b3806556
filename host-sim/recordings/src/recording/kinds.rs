//! Files that are no text: compressed, or data of another program.

use terminal::failure::Failure;

/// First bytes of a file, bytes that are among the further ones, what it is, and the remedy.
const KINDS: [(&[u8], &[u8], &str, &str); 23] = [
    (ZIP, b"xl/", "a workbook of Excel", SHEET),
    (ZIP, b"opendocument.spreadsheet", "a spreadsheet", SHEET),
    (ZIP, b".npy", "a file of NumPy", NUMPY),
    (ZIP, b"", "a zip file", "unpack it with unzip -p"),
    (b"\xD0\xCF\x11\xE0", b"", "a workbook of Excel", SHEET),
    (b"\x93NUMPY", b"", "a file of NumPy", NUMPY),
    (
        b"\x28\xB5\x2F\xFD",
        b"",
        "a zstd file",
        "unpack it with zstd -dc",
    ),
    (b"\xFD7zXZ", b"", "an xz file", "unpack it with xz -dc"),
    (b"BZh", b"", "a bzip2 file", "unpack it with bzip2 -dc"),
    (
        b"7z\xBC\xAF\x27\x1C",
        b"",
        "a 7z file",
        "unpack it with 7z x -so",
    ),
    (b"PAR1", b"", "a Parquet file", CSV),
    (b"ARROW1", b"", "a Feather file", CSV),
    (b"\x89HDF", b"", "an HDF5 file", CSV),
    (b"MATLAB 5.0 MAT", b"", "a file of MATLAB", MATLAB),
    (b"MATLAB 7.3 MAT", b"", "a file of MATLAB", MATLAB),
    (b"\x89MCAP", b"", "an MCAP file", CSV),
    (
        b"TDSm",
        b"",
        "a TDMS file of LabVIEW",
        "write it as CSV or LVM",
    ),
    (
        b"<SALEAE>",
        b"",
        "a binary export of Logic 2",
        "export the lines as CSV",
    ),
    (b"#ROSBAG", b"", "a bag of ROS 1", "write a topic as CSV"),
    (
        b"SQLite format 3",
        b"",
        "an SQLite database, as a bag of ROS 2",
        "write a topic as CSV",
    ),
    (
        b"ULog",
        b"",
        "a ULog of PX4",
        "write it as CSV with ulog2csv",
    ),
    (b"MDF     ", b"", "an MDF file", CSV),
    (b"LOGG", b"", "a BLF file of Vector", CSV),
];

const ZIP: &[u8] = b"PK\x03\x04";
const CSV: &str = "write it as CSV";
const SHEET: &str = "save the sheet as CSV";
const NUMPY: &str =
    "write the columns with numpy.savetxt, or give the arrays to limpid.replay in Python";
const MATLAB: &str = "write the columns with writetable";

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
    let is_kind = |(begin, inside, ..): &&(&[u8], &[u8], &str, &str)| {
        let contains = || head.windows(inside.len()).any(|part| part == *inside);
        head.starts_with(begin) && (inside.is_empty() || contains())
    };
    if let Some((_, _, what, remedy)) = KINDS.iter().find(is_kind) {
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
        let workbook =
            error(b"PK\x03\x04\x14\0docProps/app.xml\0PK\x03\x04\x14\0xl/theme/theme1.xml");
        assert!(
            workbook.contains("this is a workbook of Excel; save the sheet as CSV, or"),
            "{workbook}"
        );
        let arrays = error(b"PK\x03\x04\x2D\0arr_0.npy\x93NUMPY");
        assert!(
            arrays.contains("this is a file of NumPy; write"),
            "{arrays}"
        );
        assert!(
            error(b"#ROSBAG V2.0\n").contains("this is a bag of ROS 1; write a topic as CSV, or")
        );
        // 12 of 256 bytes are less than a twentieth.
        let controls = |number| {
            let mut bytes = vec![1; number];
            bytes.resize(256, b'x');
            error(&bytes)
        };
        assert!(!controls(12).contains("not text"), "{}", controls(12));
        assert!(controls(13).contains("the file is not text"));
        let binary: Vec<u8> = (0..=255).collect();
        assert_eq!(
            error(&binary),
            "r.csv: line 1: the file is not text; write it as CSV"
        );
    }
}
