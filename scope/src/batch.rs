//! Rows on their way to the pages.

use std::time::{Duration, Instant};

use axum::body::Bytes;

/// Interval of the batches: a page draws at most as often.
const INTERVAL: Duration = Duration::from_millis(16);

/// Rows of `f64`, little endian, behind a header of 16 bytes: number of rows and epoch as `u32`, and
/// the number of the first row since the start as `f64`. A page finds lost rows by the latter, and clears
/// its plots at a new epoch.
pub(crate) struct Batch {
    bytes: Vec<u8>,
    rows: u32,
    epoch: u32,
    first: u64,
    sent: Instant,
}

/// Bytes of the header.
pub(crate) const HEADER: usize = 16;

impl Batch {
    pub(crate) fn new() -> Self {
        Self {
            bytes: vec![0; HEADER],
            rows: 0,
            epoch: 0,
            first: 0,
            sent: Instant::now(),
        }
    }

    /// Adds a row.
    pub(crate) fn add(&mut self, row: &[f64]) {
        self.bytes
            .extend(row.iter().flat_map(|value| value.to_le_bytes()));
        self.rows += 1;
    }

    /// Begins a new epoch: the next rows do not continue those before.
    pub(crate) fn cut(&mut self) {
        self.first += u64::from(self.rows);
        self.rows = 0;
        self.bytes.truncate(HEADER);
        self.epoch += 1;
    }

    /// The rows since the last batch, if a batch is due.
    pub(crate) fn due(&mut self) -> Option<Bytes> {
        (self.sent.elapsed() >= INTERVAL).then(|| self.rest())?
    }

    /// The rows since the last batch, if there are any.
    pub(crate) fn rest(&mut self) -> Option<Bytes> {
        (self.rows > 0).then(|| {
            self.bytes[..4].copy_from_slice(&self.rows.to_le_bytes());
            self.bytes[4..8].copy_from_slice(&self.epoch.to_le_bytes());
            self.bytes[8..HEADER].copy_from_slice(&(self.first as f64).to_le_bytes());
            self.first += u64::from(self.rows);
            self.rows = 0;
            self.sent = Instant::now();
            let next = Vec::with_capacity(self.bytes.capacity());
            let full = std::mem::replace(&mut self.bytes, next);
            self.bytes.resize(HEADER, 0);
            Bytes::from(full)
        })
    }
}

/// The rows of a batch, and the number of the first one.
pub(crate) fn rows(bytes: &[u8]) -> (u64, Vec<Vec<f64>>) {
    let (header, values) = bytes.split_at(HEADER);
    let (words, _) = header.as_chunks::<8>();
    let number = u64::from_le_bytes(words[0]) as u32 as usize;
    let first = f64::from_le_bytes(words[1]) as u64;
    let (values, _) = values.as_chunks::<8>();
    let values: Vec<f64> = values
        .iter()
        .map(|value| f64::from_le_bytes(*value))
        .collect();
    let width = (values.len() / number.max(1)).max(1);
    (first, values.chunks(width).map(<[f64]>::to_vec).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page finds lost rows by their numbers: those that a cut drops are lost.
    #[test]
    fn rows_of_a_new_epoch_have_the_next_numbers() {
        let mut batch = Batch::new();
        batch.add(&[1.0, 2.0]);
        batch.add(&[3.0, 4.0]);
        batch.cut();
        assert_eq!(batch.rest(), None);
        batch.add(&[5.0, 6.0]);
        let bytes = batch.rest().expect("a row");
        assert_eq!(rows(&bytes), (2, vec![vec![5.0, 6.0]]));
        assert_eq!(bytes[4..8], 1_u32.to_le_bytes());
        batch.add(&[7.0, 8.0]);
        assert_eq!(batch.rest().map(|bytes| rows(&bytes).0), Some(3));
    }
}
