//! Recordings written as CSV.

use std::fmt::Write as _;

use super::Recording;
use simulation::trace::EDGE_CLOCK_HZ;

impl Recording {
    /// The recording as CSV with its present columns, which [`Recording::read`] can read.
    #[must_use]
    pub fn to_csv(&self) -> Vec<u8> {
        let trace = &self.trace;
        let mut text = String::from("t,counts_large");
        let names = [
            ("counts_small", trace.counts_small.is_some()),
            ("current", trace.current.is_some()),
            ("current_small", self.current_small.is_some()),
            ("edge_tick,edge_bound", trace.edges.is_some()),
            ("true_omega", trace.true_omega.is_some()),
        ];
        for (name, _) in names.iter().filter(|(_, there)| *there) {
            text += ",";
            text += name;
        }
        text += "\n";
        let mut last = None;
        for (k, t) in self.t.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{t},{}", trace.counts_large[k] as i32);
            if let Some(column) = &trace.counts_small {
                let _ = write!(text, ",{}", column[k] as i32);
            }
            for column in [&trace.current, &self.current_small].into_iter().flatten() {
                let _ = write!(text, ",{}", column[k]);
            }
            if let Some(column) = &trace.edges {
                let _ = match column[k] {
                    None => write!(text, ",,"),
                    Some(edge) => {
                        let tick = ((t - edge.age_s) * EDGE_CLOCK_HZ).round();
                        let tick = same_edge(last, tick, edge.boundary).unwrap_or(tick);
                        last = Some((tick, edge.boundary));
                        write!(text, ",{tick},{}", edge.boundary as i32)
                    }
                };
            }
            if let Some(column) = &trace.true_omega {
                let _ = write!(text, ",{}", column[k]);
            }
            text += "\n";
        }
        text.into_bytes()
    }
}

/// The stamp of the row before, if its edge is the one at `tick` over `boundary`: the sum of time and age
/// is rounded, so that it may lie in the next tick.
fn same_edge(last: Option<(f64, u32)>, tick: f64, boundary: u32) -> Option<f64> {
    let (stamp, of) = last?;
    (of == boundary && (stamp - tick).abs() <= 1.0).then_some(stamp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use simulation::trace::{EdgeStamp, Trace};

    #[test]
    fn edge_has_one_stamp_however_old_it_is() {
        // In the middle between two ticks; then hours at rest.
        let edge_s = (84_000_000.0 + 0.5) / EDGE_CLOCK_HZ;
        let t: Vec<_> = (1..500).map(|k| 1.3 + f64::from(k) * 17.7).collect();
        let stamp = |t: &f64| {
            Some(EdgeStamp {
                age_s: t - edge_s,
                boundary: 5,
            })
        };
        let recording = Recording {
            trace: Trace {
                counts_large: vec![5; t.len()],
                edges: Some(t.iter().map(stamp).collect()),
                ..Trace::default()
            },
            t,
            ..Recording::default()
        };
        let text = String::from_utf8(recording.to_csv()).unwrap();
        let stamp = |line: &str| line.split(',').nth(2).map(str::to_owned);
        let mut stamps: Vec<_> = text.lines().skip(1).map(stamp).collect();
        stamps.dedup();
        assert_eq!(stamps.len(), 1, "{stamps:?}");
    }
}
