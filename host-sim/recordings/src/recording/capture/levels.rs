//! Levels of two lines in quadrature, and the count that follows from them.

use terminal::failure::Failure;

use super::super::layout::UNKNOWN;
use super::super::row::Row;

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

/// What a row does to the count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    None,
    Edge,
    /// Both lines changed: two edges, in the direction of the edge before.
    Both,
}

/// The levels of both lines, and the count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    /// Levels of A and B; `None` before the first row.
    at: Option<[bool; 2]>,
    count: u32,
    /// Whether the latest edge counted down.
    is_down: bool,
    /// Whether each line has changed.
    pub(super) moved: [bool; 2],
}

impl Levels {
    pub(super) const START: Self = Self {
        at: None,
        count: 0,
        is_down: false,
        moved: [false; 2],
    };

    /// Takes the levels of A and B.
    pub(super) fn take(&mut self, at: [bool; 2]) -> Change {
        let Some(before) = self.at.replace(at) else {
            return Change::None;
        };
        for line in 0..2 {
            self.moved[line] |= at[line] != before[line];
        }
        let (edges, change) = match (quarter(at) + 4 - quarter(before)) % 4 {
            0 => return Change::None,
            2 => (2, Change::Both),
            step => {
                self.is_down = step == 3;
                (1, Change::Edge)
            }
        };
        self.count = match self.is_down {
            true => self.count.wrapping_sub(edges),
            false => self.count.wrapping_add(edges),
        };
        change
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

/// Quarter of a period in which the lines are while A leads B: 00, 10, 11, 01.
const fn quarter([a, b]: [bool; 2]) -> u8 {
    2 * b as u8 + (a != b) as u8
}
