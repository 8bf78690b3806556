//! Logs: files, one of which can be standard input.

mod encoding;

use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use terminal::checksum::Sum;
use terminal::failure::Failure;

use crate::recording::check_kind;
use encoding::{Converted, Encoding};

/// Name of standard input in messages, and as a recording.
const STDIN: &str = "standard input";

/// First bytes of a gzip file.
const GZIP: [u8; 2] = [0x1F, 0x8B];

/// Number of first bytes that hold a header.
pub(crate) const HEAD: u64 = 1 << 16;

/// Most bytes of a stream, which is kept in memory: some 2e7 rows.
const MOST: u64 = 1 << 30;

/// Whether `path` stands for standard input.
#[must_use]
pub fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Name of the file `path` in messages.
#[must_use]
pub fn called(path: &Path) -> String {
    match is_stdin(path) {
        true => STDIN.to_owned(),
        false => path.display().to_string(),
    }
}

/// Name of the file `path` without its folders.
#[must_use]
pub fn file_name(path: &Path) -> String {
    path.file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Name of the recording in the file `path`: the file's name.
#[must_use]
pub fn short_name(path: &Path) -> String {
    match is_stdin(path) {
        true => STDIN.to_owned(),
        false => file_name(path),
    }
}

/// Reads a file, or standard input if `path` is -.
///
/// # Errors
/// [`Failure::Input`] that names the file.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let name = called(path);
    if is_stdin(path) {
        let mut bytes = Vec::new();
        read_rest(io::stdin().lock(), &mut bytes, MOST, &name)?;
        return Ok(bytes);
    }
    std::fs::read(path).map_err(|error| cannot_read(&name, &error))
}

/// Reads the rest of a stream called `name`, which starts with `bytes`. A stream of more than `most` bytes is
/// refused.
fn read_rest(input: impl Read, bytes: &mut Vec<u8>, most: u64, name: &str) -> Result<(), Failure> {
    let left = most - bytes.len() as u64;
    let read = input.take(left + 1).read_to_end(bytes);
    read.map_err(|error| cannot_read(name, &error))?;
    if bytes.len() as u64 > most {
        return Err(Failure::Input(format!(
            "{name}: more than {most} bytes, and a stream is kept in memory; write it to a file and \
             give that"
        )));
    }
    Ok(())
}

/// Reads a log called `name` from a stream. Its first bytes are checked before the rest is read, because a
/// stream that is no log may have no end.
fn stream(mut input: impl Read, name: &str) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let failed = |error| cannot_read(name, &error);
    let head = input.by_ref().take(HEAD).read_to_end(&mut bytes);
    head.map_err(failed)?;
    match bytes.starts_with(&GZIP) {
        false => check_text(&bytes, name)?,
        true => {
            // The end of the packed bytes is not there yet: what comes before it is checked.
            let mut unpacked = Vec::new();
            let mut head = MultiGzDecoder::new(bytes.as_slice()).take(HEAD);
            let _cut = head.read_to_end(&mut unpacked);
            check_text(&unpacked, name)?;
        }
    }
    read_rest(input, &mut bytes, MOST, name)?;
    Ok(bytes)
}

/// Checks the first bytes of a stream, which may be in UTF-16.
fn check_text(head: &[u8], name: &str) -> Result<(), Failure> {
    match Encoding::utf16(head) {
        Some(_) => Ok(()),
        None => check_kind(head, name),
    }
}

/// A recording that can be read more than once.
pub struct Log {
    name: String,
    path: PathBuf,
    /// The bytes of standard input or of a pipe, which can be read only once.
    bytes: Option<Vec<u8>>,
}

impl Log {
    /// Opens the file `path`, or standard input where it is -.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file, if it cannot be read, or if it is a stream that is no text.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let name = called(path);
        let is_file = std::fs::metadata(path).is_ok_and(|file| file.is_file());
        let bytes = match (is_stdin(path), is_file) {
            (true, _) => Some(stream(io::stdin().lock(), &name)?),
            (false, true) => None,
            (false, false) => {
                let file = File::open(path).map_err(|error| cannot_read(&name, &error))?;
                Some(stream(file, &name)?)
            }
        };
        Ok(Self {
            name,
            path: path.to_owned(),
            bytes,
        })
    }

    /// What messages call the recording.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its bytes from the begin: unpacked if they are those of gzip, and in UTF-8 if they are UTF-16 or Latin-1.
    ///
    /// # Errors
    /// As [`Log::open`].
    pub fn reader(&self) -> Result<Box<dyn Read + '_>, Failure> {
        let packed: Box<dyn Read> = match &self.bytes {
            Some(bytes) => Box::new(bytes.as_slice()),
            None => Box::new(File::open(&self.path).map_err(|error| self.failure(&error))?),
        };
        let (begin, packed) = self.begin(packed, GZIP.len())?;
        let text: Box<dyn Read> = match begin == GZIP {
            true => Box::new(Unpacked(MultiGzDecoder::new(packed))),
            false => Box::new(packed),
        };
        let (begin, text) = self.begin(text, encoding::SEARCHED)?;
        let is_text = check_text(&begin, &self.name).is_ok();
        Ok(match Encoding::of(&begin).filter(|_| is_text) {
            Some(encoding) => Box::new(Converted::new(text, encoding)),
            None => Box::new(text),
        })
    }

    /// The first `bytes` of a stream, and the whole stream.
    fn begin<R: Read>(
        &self,
        mut input: R,
        bytes: usize,
    ) -> Result<(Vec<u8>, impl Read + use<R>), Failure> {
        let mut begin = Vec::new();
        let read = input.by_ref().take(bytes as u64).read_to_end(&mut begin);
        read.map_err(|error| self.failure(&error))?;
        Ok((begin.clone(), Cursor::new(begin).chain(input)))
    }

    fn failure(&self, error: &io::Error) -> Failure {
        cannot_read(&self.name, error)
    }

    /// Checksum of its bytes, as [`Log::reader`] reads them.
    ///
    /// # Errors
    /// As [`Log::open`].
    pub fn sum(&self) -> Result<u64, Failure> {
        let mut sum = Sum::default();
        let copied = io::copy(&mut self.reader()?, &mut sum);
        copied.map_err(|error| self.failure(&error))?;
        Ok(sum.0)
    }

    /// Its first bytes, which hold the header.
    ///
    /// # Errors
    /// As [`Log::open`].
    pub fn head(&self) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        let read = self.reader()?.take(HEAD).read_to_end(&mut bytes);
        read.map_err(|error| self.failure(&error))?;
        Ok(bytes)
    }
}

/// Bytes that are unpacked.
struct Unpacked<R>(MultiGzDecoder<R>);

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let broken =
            |error| io::Error::other(format!("not a complete gzip file: {error}; copy it again"));
        self.0.read(to).map_err(broken)
    }
}

pub(crate) fn cannot_read(name: &str, error: &io::Error) -> Failure {
    Failure::Input(format!("{name}: cannot read: {error}"))
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn packed(text: &str) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(text.as_bytes()).unwrap();
        encoder.finish().unwrap()
    }

    fn log(bytes: Vec<u8>) -> Log {
        Log {
            name: "log.gz".to_owned(),
            path: PathBuf::from("log.gz"),
            bytes: Some(bytes),
        }
    }

    /// Parts that were packed one after the other are one log, as for gunzip.
    #[test]
    fn packed_logs_are_unpacked_whole() {
        let both = [packed("t,counts_large\n0,1\n"), packed("0.001,2\n")].concat();
        assert_eq!(log(both).head().unwrap(), b"t,counts_large\n0,1\n0.001,2\n");
        assert_eq!(log(b"t".to_vec()).head().unwrap(), b"t");
    }

    /// Counts the bytes that are read.
    struct Counted<R>(R, u64);

    impl<R: Read> Read for Counted<R> {
        fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
            let bytes = self.0.read(to)?;
            self.1 += bytes as u64;
            Ok(bytes)
        }
    }

    #[test]
    fn stream_that_is_no_text_is_refused_by_its_first_bytes() {
        let mut zeros = GzEncoder::new(Vec::new(), Compression::none());
        zeros.write_all(&vec![0; 1 << 20]).unwrap();
        let zeros = zeros.finish().unwrap();
        let plain: Box<dyn Read> = Box::new(io::repeat(0).take(1 << 20));
        let unpacked_later: Box<dyn Read> = Box::new(zeros.as_slice());
        for input in [plain, unpacked_later] {
            let mut input = Counted(input, 0);
            let error = stream(&mut input, "pipe").unwrap_err().to_string();
            assert_eq!(error, "pipe: line 1: the file is not text; write it as CSV");
            assert_eq!(input.1, HEAD);
        }
        let text = "t,counts_large\n0,1\n".repeat(10_000);
        assert_eq!(stream(text.as_bytes(), "pipe").unwrap(), text.as_bytes());
        let text = packed(&text);
        assert_eq!(stream(text.as_slice(), "pipe").unwrap(), text);
    }

    #[test]
    fn text_in_another_encoding_is_utf8() {
        let text = log(b"t,\xB0\n0,1\n".to_vec()).head().unwrap();
        assert_eq!(text, "t,°\n0,1\n".as_bytes());
        // Zstd, of which no byte is a control character.
        let zstd = b"\x28\xB5\x2F\xFDxyz".to_vec();
        assert_eq!(log(zstd.clone()).head().unwrap(), zstd);
    }

    #[test]
    fn a_cut_packed_log_is_not_taken_for_a_whole_one() {
        let mut cut = packed("t,counts_large\n0,1\n");
        cut.truncate(cut.len() - 6);
        let error = log(cut).sum().unwrap_err().to_string();
        for part in [
            "log.gz: cannot read: not a complete gzip file",
            "copy it again",
        ] {
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn stream_without_an_end_is_refused() {
        let begin = b"t,counts_large\n".to_vec();
        for (length, fits) in [(85, true), (86, false), (u64::MAX, false)] {
            let mut bytes = begin.clone();
            let found = read_rest(io::repeat(b'0').take(length), &mut bytes, 100, "pipe");
            assert_eq!(found.is_ok(), fits, "{length}");
            assert!(bytes.len() <= 101);
            if let Err(error) = found {
                assert!(error.to_string().contains("pipe: more than 100 bytes"));
            }
        }
    }
}
