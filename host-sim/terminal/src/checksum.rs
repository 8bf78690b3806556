//! Hash of bytes (64-bit FNV-1a): to detect changes of a file or a run, and to derive seeds.

use std::io::{self, Write};

/// FNV-1a of `bytes`, 64 bits.
#[must_use]
pub fn sum(bytes: &[u8]) -> u64 {
    let mut sum = Sum::default();
    sum.add(bytes);
    sum.0
}

/// FNV-1a of the bytes that were added or written to it.
pub struct Sum(pub u64);

impl Default for Sum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Sum {
    /// Appends `bytes` to what is hashed.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |sum, &byte| {
            (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
    }
}

impl Write for Sum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the authors' test vectors (Fowler, Noll and Vo).
    #[test]
    fn checksums_are_those_of_the_function_that_is_named() {
        for (text, expected) in [
            ("", 0xcbf2_9ce4_8422_2325),
            ("a", 0xaf63_dc4c_8601_ec8c),
            ("foobar", 0x8594_4171_f739_67e8),
        ] {
            assert_eq!(sum(text.as_bytes()), expected, "{text}");
        }
        let mut parts = Sum::default();
        io::copy(&mut &b"foo"[..], &mut parts).unwrap();
        io::copy(&mut &b"bar"[..], &mut parts).unwrap();
        assert_eq!(parts.0, 0x8594_4171_f739_67e8);
    }
}
