//! The control rate that an image allows, from the table of the control task.
//!
//! A rate is allowed if the longest control task that was counted takes at most half of the period by
//! estimated cycles, in every scene of the image and with each of its estimators.

use crate::tables::CONTROL;
use crate::{Difference, Row};

/// Window of FOAW in the image whose control task is counted, intervals.
pub const COUNTED_WINDOW: usize = 32;

/// Images whose control task is counted: the large motor's estimator as the table names it, and the features
/// of the firmware, separated by commas.
pub const IMAGES: [(&str, &str); 5] = [
    ("foaw-end-fit, n = 32", ""),
    (STEADY, "large-kalman"),
    ("adaptive", "large-adaptive"),
    ("adaptive-edge", "large-adaptive,edge-capture"),
    (
        EVERY_OPTION,
        "large-kalman,reference,edge-capture,current-monitor,index-pulse,supply-monitor,handle-imm",
    ),
];

/// The control rate at which the images are counted, Hz, and that of an image that is built without `RATE`.
pub const COUNTED_HZ: u32 = 10_000;

/// The estimator with the same cost of every update.
pub const STEADY: &str = "kalman-triple-steady";
/// [`STEADY`] in the image with all that can be added to one.
pub(crate) const EVERY_OPTION: &str = "kalman-triple-steady, every option";
/// Name of the estimator in a scene that uses no velocity.
pub const NONE: &str = "none";

/// The scene in which the cost of options is taken. Each of them acts in it.
const FREE: &str = "free-air";

/// Features that add nothing to the control task: one estimator costs less than the choice between two.
const FREE_OF_COST: [&str; 4] = ["default", "nucleo-f429zi", "auto-arm", "large-foaw"];

/// The least of the highest rates of an image, and where it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Highest {
    /// Highest control rate, Hz.
    pub hz: f64,
    /// Name of the scene.
    pub scene: String,
    /// Name of the estimator in the table, with options if the image has any.
    pub with: String,
}

/// The highest control rate of an image with these features, with one scene or all.
///
/// # Errors
/// One line if the table cannot be read, or has no row of this image: an unknown scene.
pub fn highest<'a>(
    features: impl IntoIterator<Item = &'a str>,
    scene: Option<&str>,
) -> Result<Highest, Difference> {
    of(&CONTROL.read()?, features, scene)
}

/// Checks that an image may run at a control rate.
///
/// # Errors
/// One line with the scene and the estimator that need a lower rate; as [`highest`].
pub fn check<'a>(
    rate_hz: u32,
    features: impl IntoIterator<Item = &'a str>,
    scene: Option<&str>,
) -> Result<(), Difference> {
    let Highest { hz, scene, with } = highest(features, scene)?;
    if f64::from(rate_hz) <= hz {
        return Ok(());
    }
    Err(format!(
        "RATE={rate_hz}: the longest control task of scene {scene} with {with} allows at most {hz:.0} Hz \
         (measured/control.csv, half of the core by estimated cycles): take a lower RATE, one scene \
         (SCENE=NAME) or another estimator (--features large-kalman)"
    ))
}

fn of<'a>(
    rows: &[Row],
    features: impl IntoIterator<Item = &'a str>,
    scene: Option<&str>,
) -> Result<Highest, Difference> {
    let features = features.into_iter();
    let features: Vec<_> = features
        .filter(|feature| !FREE_OF_COST.contains(feature))
        .collect();
    // The counted image with most of these features, and no other.
    let parts = |image: &str| {
        image
            .split_terminator(',')
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let counted = IMAGES.iter().filter(|(name, _)| *name != EVERY_OPTION);
    let counted = counted.map(|(name, image)| (*name, parts(image)));
    let counted = counted.filter(|(_, own)| own.iter().all(|part| features.contains(&&**part)));
    let (estimator, own) = counted
        .max_by_key(|(_, own)| own.len())
        .expect("an image without features");
    let options = features.len() > own.len();
    let cycles = |scene: &str, estimator: &str| {
        let found = rows
            .iter()
            .find(|row| row.text("scene") == Ok(scene) && row.text("estimator") == Ok(estimator));
        let missing = || CONTROL.wrong(format!("no row of scene {scene} with {estimator}"));
        found.ok_or_else(missing)?.number("cycles_most")
    };
    let more = if options {
        cycles(FREE, EVERY_OPTION)? - cycles(FREE, STEADY)?
    } else {
        0.0
    };
    let mut highest: Option<Highest> = None;
    for row in rows {
        let (own, with) = (row.text("scene")?, row.text("estimator")?);
        if scene.is_some_and(|scene| scene != own) || ![estimator, NONE].contains(&with) {
            continue;
        }
        let counted = row.number("cycles_most")?;
        let hz = 1e3 * row.number("khz_cycles_most")? * counted / (counted + more);
        if highest.as_ref().is_none_or(|least| hz < least.hz) {
            highest = Some(Highest {
                hz,
                scene: own.to_owned(),
                with: format!("{with}{}", if options { " and options" } else { "" }),
            });
        }
    }
    let missing = || {
        CONTROL.wrong(format!(
            "no row of scene {} with {estimator}",
            scene.unwrap_or("")
        ))
    };
    highest.ok_or_else(missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scene, estimator, longest task in cycles. 2000 cycles are 42 kHz.
    const ROWS: [(&str, &str, u32); 9] = [
        ("off", NONE, 800),
        ("free-air", IMAGES[0].0, 2000),
        ("free-air", STEADY, 1300),
        ("free-air", "adaptive", 1900),
        ("free-air", "adaptive-edge", 2200),
        ("free-air", EVERY_OPTION, 2500),
        ("wall", IMAGES[0].0, 2150),
        ("wall", STEADY, 1350),
        ("wall", EVERY_OPTION, 2600),
    ];

    fn rows() -> Vec<Row> {
        let names = CONTROL.columns.iter().map(|(name, _)| (*name).to_owned());
        let row = |(scene, estimator, cycles): (&str, &str, u32)| {
            let cell = |name: &String| match &**name {
                "scene" => scene.to_owned(),
                "estimator" => estimator.to_owned(),
                "cycles_most" => cycles.to_string(),
                "khz_cycles_most" => format!("{:.1}", 84e3 / f64::from(cycles)),
                _ => "0".to_owned(),
            };
            Row::new(
                "control",
                names.clone().map(|name| (name.clone(), cell(&name))),
            )
        };
        ROWS.map(row).into()
    }

    fn khz(features: &str, scene: Option<&str>) -> (f64, String, String) {
        let found = of(&rows(), features.split_terminator(','), scene).unwrap();
        ((found.hz / 100.0).round() / 10.0, found.scene, found.with)
    }

    #[test]
    fn longest_task_of_the_scenes_and_estimators_of_an_image_decides() {
        let of = |hz, scene: &str, with: &str| (hz, scene.to_owned(), with.to_owned());
        let foaw = IMAGES[0].0;
        assert_eq!(khz("", None), of(39.1, "wall", foaw));
        assert_eq!(
            khz("default,large-foaw,auto-arm", None),
            of(39.1, "wall", foaw)
        );
        assert_eq!(khz("", Some("free-air")), of(42.0, "free-air", foaw));
        assert_eq!(khz("large-kalman", None), of(62.2, "wall", STEADY));
        assert_eq!(
            khz("large-adaptive", None),
            of(44.2, "free-air", "adaptive")
        );
        let edges = khz("edge-capture,large-adaptive", None);
        assert_eq!(edges, of(38.2, "free-air", "adaptive-edge"));
        assert_eq!(khz("", Some("off")), of(105.0, "off", NONE));
    }

    #[test]
    fn any_option_costs_as_much_as_all_of_them() {
        for option in ["handle-imm", "supply-monitor", "reference", "edge-capture"] {
            let (khz, scene, with) = khz(&format!("large-kalman,{option}"), None);
            assert_eq!((khz, &*scene), (32.9, "wall"), "{option}");
            assert!(with.ends_with("and options"), "{with}");
        }
        assert_eq!(khz("handle-imm", None).0, 25.1);
    }

    #[test]
    fn counted_window_is_that_of_the_table() {
        let (name, features) = IMAGES[0];
        assert_eq!(
            (name, features),
            (&*format!("foaw-end-fit, n = {COUNTED_WINDOW}"), "")
        );
    }

    #[test]
    fn scene_without_a_row_is_reported() {
        let error = of(&rows(), [], Some("fog")).unwrap_err();
        assert_eq!(
            error,
            "measured/control.csv: no row of scene fog with foaw-end-fit, n = 32"
        );
    }

    #[test]
    fn every_counted_image_allows_the_default_rate() {
        for (_, features) in IMAGES {
            check(COUNTED_HZ, features.split_terminator(','), None).unwrap();
        }
        let error = check(400_000, [], Some("off")).unwrap_err();
        assert!(
            error.starts_with("RATE=400000: the longest control task of scene off"),
            "{error}"
        );
    }
}
