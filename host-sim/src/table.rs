//! Score tables for a terminal.

use std::fmt::Write as _;

use crate::contest::Row;

/// Every score of every row, one block a rate, plant and scenario.
#[must_use]
pub fn details(rows: &[Row]) -> String {
    let mut text = String::new();
    for block in rows.chunk_by(same_case) {
        let Row {
            scenario,
            rate_hz,
            plant,
            ..
        } = &block[0];
        let _ = writeln!(
            text,
            "{scenario} at {rate_hz} Hz, plant with {}",
            plant.name()
        );
        let _ = writeln!(
            text,
            "  {:<22}{:>9}{:>9}{:>10}{:>7}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
            "",
            "rms",
            "largest",
            "distance",
            "",
            "in",
            "outside",
            "delay",
            "noise",
            "chatter",
            "force",
            "within"
        );
        let _ = writeln!(
            text,
            "  {:<22}{:>9}{:>9}{:>10}{:>7}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
            "estimator",
            "rad/s",
            "rad/s",
            "rad/s",
            "% FD",
            "trans.",
            "%",
            "ms",
            "rad/s",
            "rad/s",
            "mN",
            "2 sd, %"
        );
        for row in block {
            let score = &row.score;
            let _ = writeln!(
                text,
                "  {:<22}{:>9}{:>9}{:>10}{:>7}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
                row.estimator,
                number(score.rms_rad_s),
                number(score.max_rad_s),
                number(score.distance_rad_s),
                number(row.percent.distance_pct),
                number(row.percent.distance_transient_pct),
                number(score.outside.map(|share| 100.0 * share)),
                number(score.delay_ms),
                number(score.noise_rad_s),
                number(score.chatter_rad_s),
                number(score.force_mn),
                number(row.within_2_sigma.map(|share| 100.0 * share)),
            );
        }
    }
    text
}

/// Mean distance outside the haptic interval in % of finite difference, estimators against
/// scenarios, one block a rate and plant. The last column pools all scenarios shown: the mean
/// of distances over the mean of finite difference's.
#[must_use]
pub fn overview(rows: &[Row]) -> String {
    let mut text = String::new();
    for block in rows.chunk_by(|a, b| a.rate_hz == b.rate_hz && a.plant == b.plant) {
        let cases: Vec<_> = block.chunk_by(same_case).collect();
        let _ = writeln!(
            text,
            "{} Hz, plant with {}: mean distance outside the haptic interval, % of finite difference",
            block[0].rate_hz,
            block[0].plant.name(),
        );
        let _ = write!(text, "  {:<22}", "estimator");
        for case in &cases {
            let _ = write!(text, "{:>11}", case[0].scenario);
        }
        let _ = writeln!(text, "{:>11}", "pooled");
        for (i, row) in cases[0].iter().enumerate() {
            let _ = write!(text, "  {:<22}", row.estimator);
            for case in &cases {
                let _ = write!(text, "{:>11}", number(case[i].percent.distance_pct));
            }
            let _ = writeln!(
                text,
                "{:>11}",
                number(pooled_pct(cases.iter().map(|case| &case[i])))
            );
        }
        text.push('\n');
    }
    text
}

/// Distance of one estimator over several cases of equal length, % of finite difference's.
#[must_use]
pub fn pooled_pct<'a>(rows: impl Iterator<Item = &'a Row>) -> Option<f64> {
    let (mut of, mut whole) = (0.0, 0.0);
    for row in rows {
        let distance = row.score.distance_rad_s?;
        of += distance;
        // A percentage is missing where finite difference never leaves the interval: it adds 0.
        whole += row.difference_distance_rad_s.unwrap_or(0.0);
    }
    (whole > 0.0).then(|| 100.0 * of / whole)
}

fn same_case(a: &Row, b: &Row) -> bool {
    a.scenario == b.scenario && a.rate_hz == b.rate_hz && a.plant == b.plant && a.seed == b.seed
}

/// Three digits, or a dash where there is no number.
pub(crate) fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(value) if value.abs() >= 1000.0 => format!("{value:.0}"),
        Some(value) if value.abs() >= 100.0 => format!("{value:.1}"),
        Some(value) if value.abs() >= 10.0 => format!("{value:.2}"),
        Some(value) if value.abs() >= 0.001 => format!("{value:.3}"),
        Some(value) => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_keep_three_digits() {
        let shown = [
            None,
            Some(0.0),
            Some(1234.5),
            Some(-12.345),
            Some(0.5),
            Some(2e-5),
        ];
        assert_eq!(
            shown.map(number),
            ["-", "0", "1234", "-12.35", "0.500", "2.0e-5"].map(String::from)
        );
    }
}
