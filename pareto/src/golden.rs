//! Tables in docs/benchmarks.md, each between two comments.

/// Where a table stands.
#[derive(Clone, Copy, Debug)]
pub struct Golden {
    /// The comment before it.
    pub begin: &'static str,
    /// The comment behind it.
    pub end: &'static str,
}

impl Golden {
    fn parts<'a>(&self, text: &'a str) -> Result<[&'a str; 3], String> {
        let missing = |comment: &str| format!("docs/benchmarks.md: no '{comment}'");
        let begin = text.split_once(self.begin);
        let (before, rest) = begin.ok_or_else(|| missing(self.begin))?;
        let (table, after) = rest.split_once(self.end).ok_or_else(|| missing(self.end))?;
        Ok([before, table, after])
    }

    /// `text` with the table `now` between its comments.
    ///
    /// # Errors
    /// One line if the comments are not there.
    pub fn placed(&self, text: &str, now: &str) -> Result<String, String> {
        let [before, _, after] = self.parts(text)?;
        let Self { begin, end } = self;
        Ok(format!("{before}{begin}\n\n{now}\n{end}{after}"))
    }

    /// Every row of the table in `text` with a figure that moved by more than a tenth (or 3) to be
    /// that of `now`.
    ///
    /// # Errors
    /// One line if the table is not there or has other rows.
    pub fn moved(&self, text: &str, now: &str) -> Result<Vec<String>, String> {
        let [_, written, _] = self.parts(text)?;
        let lines = |table: &str| -> Vec<String> {
            let rows = table.lines().filter(|line| line.starts_with('|'));
            rows.map(str::to_owned).collect()
        };
        let (written, now) = (lines(written), lines(now));
        if written.len() != now.len() {
            return Err(format!(
                "{} rows written, {} measured",
                written.len(),
                now.len()
            ));
        }
        let rows = written.iter().zip(&now);
        let moved = rows.filter(|(then, now)| !same(then, now));
        Ok(moved
            .map(|(then, now)| format!("{then}\nbecame {now}"))
            .collect())
    }
}

fn same(then: &str, now: &str) -> bool {
    then.split('|').zip(now.split('|')).all(|(then, now)| {
        match (then.trim().parse::<f64>(), now.trim().parse::<f64>()) {
            // RMS errors are small and the same everywhere, counts may move a little.
            (Ok(then), Ok(now)) => {
                (then - now).abs() <= (0.1 * then).max(if then < 3.0 { 0.0 } else { 3.0 })
            }
            _ => then.trim() == now.trim(),
        }
    })
}
