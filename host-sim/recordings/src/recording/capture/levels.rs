//! Levels of an encoder's lines, and the count that follows from them.

use terminal::failure::Failure;

use crate::recording::layout::UNKNOWN;
use crate::recording::text::row::Row;

/// The level of a line in a row; `None` if the row has none, as after the end of a capture.
pub(super) fn level(row: &Row, called: &str, place: usize) -> Result<Option<bool>, Failure> {
    match row.text(called, place)? {
        "0" => return Ok(Some(false)),
        "1" => return Ok(Some(true)),
        UNKNOWN | "" => return Ok(None),
        _ => {}
    }
    let number = row.number(called, place)?;
    if number == 0.0 {
        Ok(Some(false))
    } else if number == 1.0 {
        Ok(Some(true))
    } else {
        Err(row.failure(
            called,
            &format!(
                "{number} is no level of a line, which is 0 or 1; export the lines as digital ones"
            ),
        ))
    }
}

/// The lines of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Two lines, A and B, a quarter of a period apart.
    Quadrature,
    /// Three lines of Hall sensors, a third of a period apart.
    Hall,
}

impl Kind {
    /// The encoder with this number of lines.
    pub(super) const fn of(lines: usize) -> Option<Self> {
        match lines {
            2 => Some(Self::Quadrature),
            3 => Some(Self::Hall),
            _ => None,
        }
    }

    /// Number of counts in a period of the lines.
    const fn counts(self) -> u32 {
        match self {
            Self::Quadrature => 4,
            Self::Hall => 6,
        }
    }

    /// Place of the levels in a period, in the order of a count that goes up; `None` for levels that do not
    /// occur.
    fn place(self, levels: &[bool]) -> Option<u32> {
        let order: &[&[u8]] = match self {
            Self::Quadrature => &[&[0, 0], &[1, 0], &[1, 1], &[0, 1]],
            Self::Hall => &[
                &[1, 0, 0],
                &[1, 1, 0],
                &[0, 1, 0],
                &[0, 1, 1],
                &[0, 0, 1],
                &[1, 0, 1],
            ],
        };
        let is_at = |known: &&[u8]| {
            known
                .iter()
                .zip(levels)
                .all(|(one, other)| (*one == 1) == *other)
        };
        (0..)
            .zip(order)
            .find(|(_, known)| is_at(known))
            .map(|(place, _)| place)
    }
}

/// What a row does to the count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    None,
    Edge,
    /// This many edges at once, of which all but one were lost. In the middle of a period they are in the
    /// direction of the edge before.
    Lost(u32),
    /// Levels that do not occur: the count stays.
    Invalid,
}

/// The levels of the lines, and the count.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    kind: Kind,
    /// Levels of the lines; none before the first row.
    at: Vec<bool>,
    /// Place of the latest levels that occur.
    place: Option<u32>,
    count: u32,
    /// Whether the latest edge counted down.
    is_down: bool,
    /// Whether each line has changed.
    pub(super) moved: Vec<bool>,
}

impl Levels {
    pub(super) fn new(kind: Kind, lines: usize) -> Self {
        Self {
            kind,
            at: Vec::new(),
            place: None,
            count: 0,
            is_down: false,
            moved: vec![false; lines],
        }
    }

    /// Takes the levels of the lines.
    pub(super) fn take(&mut self, at: &[bool]) -> Change {
        for (moved, (now, before)) in self.moved.iter_mut().zip(at.iter().zip(&self.at)) {
            *moved |= now != before;
        }
        at.clone_into(&mut self.at);
        let Some(place) = self.kind.place(at) else {
            return Change::Invalid;
        };
        let Some(before) = self.place.replace(place) else {
            return Change::None;
        };
        let period = self.kind.counts();
        let up = (place + period - before) % period;
        let down = period - up;
        if up == 0 {
            return Change::None;
        }
        if up != down {
            self.is_down = down < up;
        }
        let edges = up.min(down);
        self.count = match self.is_down {
            true => self.count.wrapping_sub(edges),
            false => self.count.wrapping_add(edges),
        };
        match edges {
            1 => Change::Edge,
            edges => Change::Lost(edges),
        }
    }

    pub(super) const fn count(&self) -> u32 {
        self.count
    }

    /// The boundary that the latest edge crossed: boundary e is between the counts e - 1 and e.
    pub(super) const fn boundary(&self) -> u32 {
        match self.is_down {
            true => self.count.wrapping_add(1),
            false => self.count,
        }
    }
}
