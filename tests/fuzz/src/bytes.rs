//! Numbers out of bytes.

use estimator_core::{Amps, ClockTicks, Count, Counts, Edge, Sample};

/// Reads numbers until the bytes end.
pub(crate) struct Bytes<'a>(pub(crate) &'a [u8]);

impl Bytes<'_> {
    pub(crate) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }

    pub(crate) fn byte(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    /// The sample after `last`: mostly small steps, now and then anything.
    pub(crate) fn sample(&mut self, last: &Sample) -> Option<Sample> {
        let kind = self.byte()?;
        let step = match kind & 7 {
            0 => self.u32()? as i32,
            1 => i32::from(i16::from_le_bytes(self.take()?)),
            2 => 0,
            _ => i32::from(self.byte()? as i8) >> (kind & 3),
        };
        let mut next = Sample {
            count: last.count + Counts(step),
            coupled: last.coupled + Counts(i32::from(kind as i8) >> 3),
            ..*last
        };
        if kind & 0x10 != 0 {
            next.current = Amps::new(self.f32()?);
        }
        if kind & 0x20 != 0 {
            next.edge = Some(Edge {
                boundary: Count(next.count.0.wrapping_add(u32::from(kind >> 7))),
                age: ClockTicks(self.u32()?),
            });
        }
        Some(next)
    }
}
