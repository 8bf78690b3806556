//! A separator that ends each row and separates no fields, `1,2,3;`, and the brackets of a matrix around such rows.

use super::separator::{Separator, comment};
use crate::recording::layout::numbers;

/// The separator that may end a row whose fields have another one.
const END: char = ';';

/// A line of text without the separator at its end, and without a bracket of a matrix, which has its other one in another
/// line.
pub(crate) fn cut(line: &str) -> &str {
    let text = line.trim_ascii();
    let text = text.strip_suffix(END).unwrap_or(text);
    match (text.contains('['), text.contains(']')) {
        (true, false) => text.strip_prefix('[').unwrap_or(text),
        (false, true) => text.strip_suffix(']').unwrap_or(text),
        _ => text,
    }
}

/// Whether all rows among `lines` end with a separator that they have nowhere else. A number with a decimal comma alone
/// is a column of its own: `0,5;`.
pub(crate) fn end(lines: &[&str]) -> bool {
    let with_it = |line: &&&str| comment(line).is_none() && line.contains(END);
    let mut rows = lines.iter().filter(with_it);
    let ends = |line: &&str| line.trim_ascii_end().ends_with(END) && !cut(line).contains(END);
    let is_row = |line: &&str| {
        let row = cut(line);
        let (separator, fields) = numbers(row)?;
        let is_decimal = separator == Separator::Comma && fields == 2 && !row.contains('.');
        (!is_decimal).then_some(fields)
    };
    let all = rows.clone().all(ends);
    all && rows.any(|line| is_row(line).is_some())
}

#[cfg(test)]
mod tests {
    use crate::recording::{read_log as read, read_log_at};

    #[test]
    fn separator_at_the_end_of_each_row_is_no_field() {
        for (header, columns) in [
            (
                "%time,volts,position\n%[ms],[V],[turns]\n",
                "t=time,counts_large=position",
            ),
            (
                "time,volts,position;\n",
                "t=time:ms,counts_large=position:rev",
            ),
            ("", "t=1:ms,counts_large=3:rev"),
        ] {
            for (separator, end) in [(",", ";"), (", ", " ; "), ("\t", ";"), ("  ", ";\r")] {
                let row = |k: u32| format!("{k},0.5,{}{end}\n", f64::from(k) * 0.125);
                let rows: String = (0..9).map(row).collect();
                let text = (header.to_owned() + &rows).replace(',', separator);
                let recording = read(&text, columns).unwrap();
                assert_eq!(recording.trace.counts_large[..3], [0, 512, 1024], "{text}");
                assert_eq!(recording.t[8], 0.008);
            }
        }
    }

    #[test]
    fn separator_of_fields_may_end_a_row_too() {
        let text = "time_ms;angle_deg;\n0;0,5;\n1;90,5;\n2;180,5;\n";
        assert_eq!(read(text, "").unwrap().trace.counts_large[..2], [6, 1030]);
        // A column with decimal commas.
        let text = "0,5;\n90,5;\n180,5;\n";
        let recording = read_log_at(Some(1000.0), text, "counts_large=1:deg").unwrap();
        assert_eq!(recording.trace.counts_large[..2], [6, 1030]);
    }

    #[test]
    fn rows_of_a_matrix_have_brackets_around_them() {
        let row = |k: u32| format!("    {k}   0.{k}    {}   1.5", 8 * k);
        let rows: Vec<_> = (0..9).map(row).collect();
        for end in ["]", "];"] {
            let names = " Sample   Time     Encoder 1 Pos   Control Effort\n\n";
            let text = format!("{names}[{}{end}\n", rows.join(";\n"));
            let recording = read(&text, "t=Time:s,counts_large=Encoder 1 Pos:counts").unwrap();
            assert_eq!(recording.trace.counts_large[..3], [0, 8, 16], "{end}");
            assert_eq!(recording.t[8], 0.8);
        }
    }
}
