//! Files that are no text: compressed, or data of another program.

use terminal::failure::Failure;

/// First bytes of a file, what it is, and the remedy.
const KINDS: [(&[u8], &str, &str); 24] = [
    (ZIP, "a zip file", "unpack it with unzip -p"),
    (b"\xD0\xCF\x11\xE0", "a workbook of Excel", SHEET),
    (b"\x93NUMPY", "a file of NumPy", NUMPY),
    (
        b"\x28\xB5\x2F\xFD",
        "a zstd file",
        "unpack it with zstd -dc",
    ),
    (b"\xFD7zXZ", "an xz file", "unpack it with xz -dc"),
    (b"BZh", "a bzip2 file", "unpack it with bzip2 -dc"),
    (
        b"7z\xBC\xAF\x27\x1C",
        "a 7z file",
        "unpack it with 7z x -so",
    ),
    (b"PAR1", "a Parquet file", CSV),
    (b"ARROW1", "a Feather file", CSV),
    (b"\x89HDF", "an HDF5 file", CSV),
    (b"MATLAB 5.0 MAT", "a file of MATLAB", MATLAB),
    (b"MATLAB 7.3 MAT", "a file of MATLAB", MATLAB),
    (b"\x89MCAP", "an MCAP file", CSV),
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
    (b"MDF     ", "an MDF file", CSV),
    (b"LOGG", "a BLF file of Vector", CSV),
    (b"<!DOCTYPE", "a page of HTML", PAGE),
    (b"<!doctype", "a page of HTML", PAGE),
    (b"<html", "a page of HTML", PAGE),
    (
        b"version https://git-lfs",
        "a pointer of Git LFS in the place of the log",
        "fetch the log with git lfs pull",
    ),
];

const ZIP: &[u8] = b"PK\x03\x04";

/// Bytes within a zip file that another program wrote, what it is, and the remedy.
const ZIPPED: [(&[u8], &str, &str); 3] = [
    (b"xl/", "a workbook of Excel", SHEET),
    (b"opendocument.spreadsheet", "a spreadsheet", SHEET),
    (b".npy", "a file of NumPy", NUMPY),
];

const CSV: &str = "write it as CSV";
const PAGE: &str = "download the log itself";
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
    let contains = |bytes: &[u8]| head.windows(bytes.len()).any(|part| part == bytes);
    let mut zipped = ZIPPED.iter().filter(|_| head.starts_with(ZIP));
    let kind = zipped
        .find(|(inside, ..)| contains(inside))
        .or_else(|| KINDS.iter().find(|(begin, ..)| head.starts_with(begin)));
    if let Some((_, what, remedy)) = kind {
        return refused(&format!("this is {what}; {remedy}, or give the text as -"));
    }
    // A logger that began anew may write any number of NUL bytes before its first line.
    let begin = head.iter().position(|byte| *byte != 0).unwrap_or(0);
    let head = &head[begin..];
    let head = &head[..head.len().min(SEARCHED)];
    let is_control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    let nuls = head.iter().filter(|byte| **byte == 0).count();
    // Less than half of a text are the NUL bytes of a logger that began anew.
    let ignored = if 2 * nuls < head.len() { nuls } else { 0 };
    let controls = head.iter().filter(is_control).count() - ignored;
    if controls > (head.len() - ignored) / CONTROL_PART {
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
        assert_eq!(
            error(b"<!DOCTYPE html>\n<html><body>404</body></html>\n"),
            "r.csv: line 1: this is a page of HTML; download the log itself, or give the text as -"
        );
        let pointer =
            error(b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n");
        assert!(
            pointer.contains("fetch the log with git lfs pull"),
            "{pointer}"
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
