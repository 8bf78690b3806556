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
        for (k, t) in self.t.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{t},{}", trace.counts_large[k]);
            if let Some(column) = &trace.counts_small {
                let _ = write!(text, ",{}", column[k]);
            }
            for column in [&trace.current, &self.current_small].into_iter().flatten() {
                let _ = write!(text, ",{}", column[k]);
            }
            if let Some(column) = &trace.edges {
                let _ = match column[k] {
                    None => write!(text, ",,"),
                    Some(edge) => {
                        let tick = ((t - edge.age_s) * EDGE_CLOCK_HZ).round();
                        write!(text, ",{tick},{}", edge.boundary)
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
