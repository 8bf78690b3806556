//! Statistics of the rows of each scene.

use std::fmt::Write as _;

use haptic_control::{DualStage, SceneKind};

use super::judge::{FELT_NM, HANDLE_RAD_S, Verdict, oscillation_limit_nm};
use super::row::RobustRow;
use super::variation::Subject;
use super::{Settings, corners};

use crate::closed_loop::{named, usual};
use crate::table::layout::{self, Column};

/// Quantiles of a distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// 95 % quantile.
    pub high: f64,
    /// Largest value.
    pub largest: f64,
    /// 5 % quantile.
    pub low: f64,
}

/// Statistics of one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// Name of the scene.
    pub scene: String,
    /// Largest allowed residual oscillation, N.m RMS.
    pub oscillation_limit_nm: f64,
    /// Numbers of stable runs, runs stopped in time, and violations.
    pub counts: [usize; 3],
    /// Largest speed of the handle, before and after a stop, rad/s.
    pub handle_rad_s: Spread,
    /// Largest speed of the large motor, rad/s.
    pub large_rad_s: Spread,
    /// Largest torque on the hand, before and after a stop, N.m.
    pub felt_nm: Spread,
    /// Largest parasitic force at the fingertip, N.
    pub parasitic_n: Spread,
    /// Residual oscillation of the runs without a stop, N.m RMS; `None` if all runs were stopped.
    pub oscillation_nm: Option<Spread>,
}

impl Spread {
    /// Quantiles of the values by nearest rank; `None` without values.
    #[must_use]
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let n = values.len();
        let rank = |part: f64| values[((part * n as f64).ceil() as usize).clamp(1, n) - 1];
        (n > 0).then(|| Self {
            low: rank(0.05),
            median: rank(0.5),
            high: rank(0.95),
            largest: rank(1.0),
        })
    }
}

/// Statistics of the scenes in the order of their rows.
///
/// # Errors
/// One line that names an unknown scene.
pub fn summaries(rows: &[RobustRow]) -> Result<Vec<SceneSummary>, String> {
    let scenes = rows.chunk_by(|a, b| a.scene == b.scene);
    scenes.map(summary).collect()
}

fn summary(rows: &[RobustRow]) -> Result<SceneSummary, String> {
    let scene = named(&rows[0].scene, SceneKind::environments())?;
    // The amplitude of a scene's vibration does not depend on device or rate.
    let nominal = usual(scene, &DualStage::DEFAULT, 10e3)?;
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let spread = |of: fn(&RobustRow) -> f64| Spread::of(rows.iter().map(of)).unwrap_or_default();
    Ok(SceneSummary {
        scene: scene.to_string(),
        oscillation_limit_nm: oscillation_limit_nm(&nominal),
        counts: [Verdict::Stable, Verdict::Stopped, Verdict::Violated].map(count),
        handle_rad_s: spread(|row| row.handle_rad_s.max(row.after_handle_rad_s.unwrap_or(0.0))),
        large_rad_s: spread(|row| row.large_rad_s),
        felt_nm: spread(|row| row.felt_nm.max(row.after_felt_nm.unwrap_or(0.0))),
        parasitic_n: spread(|row| row.parasitic_n),
        oscillation_nm: Spread::of(rows.iter().filter_map(|row| row.oscillation_nm)),
    })
}

/// One line on the settings of the experiment, of which `scenes` may have a single device.
#[must_use]
pub fn heading(settings: &Settings, scenes: &[SceneSummary]) -> String {
    let runs = |scene: &SceneSummary| scene.counts.iter().sum::<usize>();
    let devices = match scenes.iter().map(runs).max() {
        Some(1) => "1 device".to_owned(),
        _ => format!(
            "{} corners and {} drawn devices",
            corners::corners().len(),
            settings.devices
        ),
    };
    format!(
        "{} Hz, {}, {} s, seed {}: {devices} per scene",
        settings.rate_hz, settings.estimator, settings.seconds, settings.seed,
    )
}

/// Table with one line per scene, in lines of `width` characters: numbers of the verdicts, then
/// median, 95 % quantile and largest value of each quantity. The limits follow below it.
#[must_use]
pub fn table(settings: &Settings, scenes: &[SceneSummary], width: usize) -> String {
    let mut text = heading(settings, scenes).replacen(": ", ":\n", 1) + "\n";
    let count = |name, i: usize| {
        let cells = scenes.iter().map(|scene| scene.counts[i].to_string());
        Column::numbers("", name, cells)
    };
    let number = |value: f64, factor: f64| three_digits(factor * value);
    let spread = |head, unit, factor: f64, of: &dyn Fn(&SceneSummary) -> Option<Spread>| {
        let cells = scenes.iter().map(|scene| match of(scene) {
            None => "-".to_owned(),
            Some(Spread {
                median,
                high,
                largest,
                ..
            }) => [median, high, largest]
                .map(|value| number(value, factor))
                .join(" "),
        });
        Column::text(head, unit, cells)
    };
    let columns = [
        count("stable", 0),
        count("stopped", 1),
        count("violated", 2),
        spread("handle", "rad/s", 1.0, &|scene| Some(scene.handle_rad_s)),
        spread("felt", "mN.m", 1e3, &|scene| Some(scene.felt_nm)),
        spread("parasitic", "N", 1.0, &|scene| Some(scene.parasitic_n)),
        spread("oscillation", "mN.m", 1e3, &|scene| scene.oscillation_nm),
        Column::numbers(
            "limit",
            "mN.m",
            scenes
                .iter()
                .map(|scene| number(scene.oscillation_limit_nm, 1e3)),
        ),
    ];
    let names = scenes.iter().map(|scene| scene.scene.clone());
    text += &layout::table(&Column::text("", "scene", names), &columns, width);
    let _ = writeln!(
        text,
        "Median, 95 %, largest. Limits: handle {HANDLE_RAD_S} rad/s, felt {} mN.m, oscillation\n\
         as shown.",
        1e3 * FELT_NM
    );
    text
}

/// One line for each limit of a device that keeps devices nearer to the nominal one than they were drawn.
///
/// # Errors
/// One line that names an unknown scene or device.
pub fn limited(settings: &Settings, rows: &[RobustRow]) -> Result<Vec<String>, String> {
    let mut found: Vec<(String, usize, String)> = Vec::new();
    for row in rows {
        let scene = named(&row.scene, SceneKind::environments())?;
        let (whole, _) = row
            .device
            .parse::<Subject>()?
            .variation(settings.seed, scene);
        let Err(limit) = whole.of(&settings.device).validate() else {
            continue;
        };
        let key = limit.split([' ', ':']).next().unwrap_or_default();
        match found.iter_mut().find(|(known, ..)| known == key) {
            Some((_, count, _)) => *count += 1,
            None => {
                let first = format!(
                    "the first is scene {}, device {}, with {}, because of {limit}",
                    row.scene,
                    row.device,
                    whole.changes(row.variation)
                );
                found.push((key.to_owned(), 1, first));
            }
        }
    }
    let all = rows.len();
    let line = |(_, count, first)| {
        format!("{count} of {all} runs are limited to what a device can be: {first}")
    };
    Ok(found.into_iter().map(line).collect())
}

fn three_digits(value: f64) -> String {
    match value.abs() {
        size if size >= 1e6 => format!("{value:.0e}"),
        size if size >= 99.95 => format!("{value:.0}"),
        size if size >= 9.995 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

/// Message with the number of violations, the first one, and the command that repeats it; `None`
/// without a violation.
#[must_use]
pub fn complaint(settings: &Settings, rows: &[RobustRow]) -> Option<String> {
    let violated = || rows.iter().filter(|row| row.verdict == Verdict::Violated);
    let row = violated().next()?;
    let reason = row.reason.map_or_else(String::new, |reason| {
        let name = serde_json::to_value(reason).unwrap_or_default();
        name.as_str().unwrap_or_default().to_owned()
    });
    Some(format!(
        "{} of {} runs violated a limit; the first is scene {}, device {}, seed {}: {reason}; repeat it with \
         host-sim robust --scene {} --rate {} --estimator {} --devices {} --seconds {} --seed {} \
         --only {} and the same --device, --set, --presets",
        violated().count(),
        rows.len(),
        row.scene,
        row.device,
        settings.seed,
        row.scene,
        settings.rate_hz,
        settings.estimator,
        settings.devices,
        settings.seconds,
        settings.seed,
        row.device,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_has_the_larger_value_of_before_and_after_a_stop() {
        let (variation, _) = Subject::Drawn(3).variation(7, SceneKind::FreeAir);
        let stable = RobustRow {
            scene: "free-air".into(),
            device: "0".into(),
            verdict: Verdict::Stable,
            reason: None,
            stop: None,
            stop_s: None,
            handle_rad_s: 11.0,
            large_rad_s: 5.0,
            felt_nm: 0.02,
            felt_n: 0.6,
            parasitic_n: 0.3,
            oscillation_nm: Some(0.0007),
            after_handle_rad_s: None,
            after_felt_nm: None,
            variation,
        };
        let stopped = RobustRow {
            verdict: Verdict::Stopped,
            handle_rad_s: 7.0,
            large_rad_s: 6.0,
            felt_nm: 0.03,
            parasitic_n: 0.2,
            oscillation_nm: None,
            after_handle_rad_s: Some(29.0),
            after_felt_nm: Some(0.09),
            ..stable.clone()
        };
        let [scene] = &summaries(&[stable, stopped]).unwrap()[..] else {
            panic!("one scene");
        };
        assert_eq!(scene.counts, [1, 1, 0]);
        // Of two values the smaller is the median.
        let spreads = [
            scene.handle_rad_s,
            scene.large_rad_s,
            scene.felt_nm,
            scene.parasitic_n,
            scene.oscillation_nm.unwrap(),
        ];
        assert_eq!(
            spreads.map(|spread| [spread.median, spread.largest]),
            [
                [11.0, 29.0],
                [5.0, 6.0],
                [0.02, 0.09],
                [0.2, 0.3],
                [0.0007, 0.0007]
            ]
        );
    }

    #[test]
    fn table_has_median_95_percent_and_largest_value_in_its_units() {
        let spread = |unit: f64| Spread {
            low: 0.5 * unit,
            median: unit,
            high: 2.0 * unit,
            largest: 3.0 * unit,
        };
        let scene = SceneSummary {
            scene: "wall".into(),
            oscillation_limit_nm: 0.0015,
            counts: [7, 2, 1],
            handle_rad_s: spread(10.0),
            large_rad_s: spread(99.0),
            felt_nm: spread(0.02),
            parasitic_n: spread(0.1),
            oscillation_nm: Some(spread(1e-4)),
        };
        let settings = crate::robust::tests::settings(&["wall"], 0);
        let text = table(&settings, &[scene], 1000);
        let line = text.lines().find(|line| line.contains("wall")).unwrap();
        let cells: Vec<_> = line.split_whitespace().collect();
        let expected =
            "wall 7 2 1 10.0 20.0 30.0 20.0 40.0 60.0 0.10 0.20 0.30 0.10 0.20 0.30 1.50";
        assert_eq!(cells.join(" "), expected, "{text}");
    }

    #[test]
    fn quantiles_ignore_missing_values() {
        let spread = Spread::of((1..=100).rev().map(f64::from)).unwrap();
        assert_eq!(
            (spread.low, spread.median, spread.high, spread.largest),
            (5.0, 50.0, 95.0, 100.0)
        );
        let one = Spread::of(std::iter::once(3.0)).unwrap();
        assert_eq!((one.low, one.largest), (3.0, 3.0));
        assert_eq!(Spread::of(std::iter::empty()), None);
    }
}
