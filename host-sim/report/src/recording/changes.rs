//! Changes of the safety state over time.

use haptic_control::Mode;

use super::{RecordingView, TOP};
use crate::canvas::{Anchor, Canvas, LABEL, text_width};
use crate::palette::MUTED;
use crate::plot::Plot;

/// Largest number of changes with labels.
const LABELS: usize = 12;

/// A vertical line at each change of the safety state, labelled with the new state above the first
/// panel.
pub(super) fn states(
    canvas: &Canvas,
    plot: &Plot,
    view: &RecordingView,
    labelled: bool,
) -> Result<(), String> {
    let changes = changes(view);
    // The labels of many changes would overlap.
    let labelled = labelled && changes.len() <= LABELS;
    let mut free = plot.left;
    for (t, what) in changes {
        let (x, _) = plot.at((t, plot.y.low));
        canvas.line(&[(x, plot.top), (x, plot.bottom)], MUTED, 1.0)?;
        if labelled && x >= free {
            canvas.text(&what, (x, TOP - 12.0), Anchor::Left, LABEL, MUTED)?;
            free = x + text_width(&what, LABEL) + 6.0;
        }
    }
    Ok(())
}

/// Times in the window at which state or cause change, s, and the new state.
pub(super) fn changes(view: &RecordingView) -> Vec<(f64, String)> {
    let (t, board) = (&view.recording.t, &view.recording.board);
    let Some(state) = board.column("state") else {
        return Vec::new();
    };
    let code = |row: usize| {
        (
            state[row],
            board.column("cause").map_or(0.0, |cause| cause[row]),
        )
    };
    let inside = |row: &usize| (view.window[0]..=view.window[1]).contains(&t[*row]);
    (1..t.len())
        .filter(|&row| code(row) != code(row - 1))
        .filter(inside)
        .map(|row| (t[row], label(code(row))))
        .collect()
}

fn label((state, cause): (f64, f64)) -> String {
    let known = (0..=u8::MAX)
        .map_while(Mode::from_code)
        .find(|mode| f64::from(*mode as u8) == state);
    let state = known.map_or_else(|| format!("state {state}"), |mode| mode.as_str().to_owned());
    match cause {
        0.0 => state,
        _ => format!("{state}, cause {cause}"),
    }
}
