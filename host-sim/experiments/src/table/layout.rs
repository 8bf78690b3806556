//! Columns of text within the width of a terminal.

/// Width if standard output is not a terminal, and in files.
pub const NARROW: usize = 80;

/// Spaces between two columns.
const GAP: usize = 2;

/// Width of the terminal on standard output, else [`NARROW`].
#[must_use]
pub fn terminal_width() -> usize {
    terminal_size::terminal_size_of(std::io::stdout())
        .map_or(NARROW, |(width, _)| usize::from(width.0))
}

/// A column: two lines of heading and a cell for each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    head: [String; 2],
    cells: Vec<String>,
    /// Text is left-aligned, numbers are right-aligned.
    is_text: bool,
}

impl Column {
    /// A column of numbers: heading, unit, a cell for each row.
    pub fn numbers(head: &str, unit: &str, cells: impl Iterator<Item = String>) -> Self {
        Self {
            head: [head.to_owned(), unit.to_owned()],
            cells: cells.collect(),
            is_text: false,
        }
    }

    /// A column of text.
    pub fn text(head: &str, unit: &str, cells: impl Iterator<Item = String>) -> Self {
        Self {
            is_text: true,
            ..Self::numbers(head, unit, cells)
        }
    }

    fn width(&self) -> usize {
        let texts = self.head.iter().chain(&self.cells);
        texts.map(|text| text.chars().count()).max().unwrap_or(0)
    }
}

/// The column `first` and the others side by side. Columns beyond `width` follow in further blocks,
/// each with `first` repeated.
#[must_use]
pub fn table(first: &Column, columns: &[Column], width: usize) -> String {
    let mut text = String::new();
    let mut rest = columns;
    while !rest.is_empty() || text.is_empty() {
        let mut used = GAP + first.width();
        let fits = |column: &&Column| {
            used += GAP + column.width();
            used <= width
        };
        let count = rest.iter().take_while(fits).count().max(1).min(rest.len());
        if !text.is_empty() {
            text.push('\n');
        }
        text += &block(first, &rest[..count]);
        rest = &rest[count..];
    }
    text
}

fn block(first: &Column, columns: &[Column]) -> String {
    let all = || std::iter::once(first).chain(columns);
    let mut text = String::new();
    for line in 0..2 {
        push_line(&mut text, all().map(|column| (column, &*column.head[line])));
    }
    for row in 0..first.cells.len() {
        push_line(&mut text, all().map(|column| (column, &*column.cells[row])));
    }
    text
}

/// Adds a line, unless it is empty.
fn push_line<'a>(text: &mut String, cells: impl Iterator<Item = (&'a Column, &'a str)>) {
    let mut line = String::new();
    for (column, cell) in cells {
        let width = column.width();
        line += &match column.is_text {
            true => format!("{:GAP$}{cell:<width$}", ""),
            false => format!("{:GAP$}{cell:>width$}", ""),
        };
    }
    let line = line.trim_end();
    if !line.is_empty() {
        text.push_str(line);
        text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(cells: &[&str]) -> impl Iterator<Item = String> {
        cells.iter().map(|cell| (*cell).to_owned())
    }

    #[test]
    fn columns_beyond_the_width_follow_in_another_block() {
        let first = Column::text("", "name", texts(&["a", "long one"]));
        let columns = [
            Column::numbers("rms", "rad/s", texts(&["1.5", "-"])),
            Column::numbers("delay", "ms", texts(&["12", "7"])),
        ];
        let one = "              rms  delay\n  name      rad/s     ms\n  a           1.5     12\n  \
                   long one      -      7\n";
        assert_eq!(table(&first, &columns, 24), one);
        let two = "              rms\n  name      rad/s\n  a           1.5\n  long one      -\n\n   \
                   \x20        delay\n  name         ms\n  a            12\n  long one      7\n";
        assert_eq!(table(&first, &columns, 23), two);
    }
}
