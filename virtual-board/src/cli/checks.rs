//! Checks of the arguments before the run, and of their commands after it.

use std::path::Path;

use drive::named::{Known, chosen};
use terminal::failure::Failure;
use terminal::output::{check_place, is_same, is_stdout, one_file, refuse_input};

use super::Arguments;
use crate::fault::Fault;
use crate::identity;
use crate::image::Image;
use crate::run::Outcome;
use crate::scene;

/// The output files with their options.
fn outputs(arguments: &Arguments) -> Vec<(&'static str, &Path)> {
    let files = [
        ("--record", &arguments.record),
        ("--rtt", &arguments.rtt),
        ("--trace", &arguments.trace),
    ];
    let given = files.into_iter();
    given
        .filter_map(|(option, path)| Some((option, path.as_deref()?)))
        .collect()
}

/// Whether an output goes to standard output, which then has nothing else.
pub(super) fn has_stdout(arguments: &Arguments) -> bool {
    outputs(arguments).iter().any(|(_, path)| is_stdout(path))
}

/// Refuses output files that have no place, that are an input, or two that are one file.
pub(super) fn in_place(arguments: &Arguments, image: &Path) -> Result<(), Failure> {
    let outputs = outputs(arguments);
    let inputs = [Some(image), arguments.device.as_deref()];
    for (k, (option, path)) in outputs.iter().enumerate() {
        check_place(path)?;
        for input in inputs.into_iter().flatten() {
            refuse_input(option, path, input, input.display())?;
        }
        let is_one = |other: &Path| is_same(other, path) || (is_stdout(other) && is_stdout(path));
        if let Some((other, _)) = outputs[..k].iter().find(|(_, other)| is_one(other)) {
            return Err(one_file(option, path, other));
        }
    }
    Ok(())
}

/// Refuses events after the end of the run.
pub(super) fn in_time(arguments: &Arguments) -> Result<(), Failure> {
    let end = arguments.seconds();
    let faults = arguments.fault.iter();
    let faults = faults.map(|(at, fault)| ("fault", *at, fault.as_str().to_owned()));
    let tunes = arguments.tune.iter();
    let tunes = tunes.map(|(at, what)| ("tune", *at, what.clone()));
    let estimators = arguments.estimator.iter();
    let estimators = estimators.map(|(at, number)| ("estimator", *at, number.0.to_string()));
    let late = faults
        .chain(tunes)
        .chain(estimators)
        .find(|(_, at, _)| *at > end);
    late.map_or(Ok(()), |(option, at, what)| {
        let what = format!("--{option} {what}@{at}: the run ends at {end} s");
        Err(Failure::Input(format!("{what}; give a longer --seconds")))
    })
}

/// Refuses values and estimators that the image does not take.
pub(super) fn in_bounds(arguments: &Arguments, image: &Image) -> Result<(), Failure> {
    if arguments.tune.is_empty() && arguments.estimator.is_empty() {
        return Ok(());
    }
    // An image that does not boot shows it in its run.
    let Some(hello) = identity::of(image)? else {
        return Ok(());
    };
    let mut known = Known::usual();
    let mut tunes: Vec<_> = arguments.tune.iter().collect();
    tunes.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    for (_, text) in tunes {
        scene::check(arguments.scene, text, &hello, &mut known)?;
    }
    for (_, number) in &arguments.estimator {
        let number = number.0;
        chosen(number, &hello).map_err(|error| format!("--estimator {number}: {error}"))?;
    }
    Ok(())
}

/// Fails if the image has refused a command of the run: what the run shows is not what was asked for.
pub(super) fn taken(arguments: &Arguments, outcome: &Outcome) -> Result<(), Failure> {
    // Random bytes may be commands.
    let is_flood = |(_, fault): &(f64, Fault)| *fault == Fault::CommandFlood;
    if arguments.fault.iter().any(is_flood) {
        return Ok(());
    }
    outcome.refusal().map_or(Ok(()), |reason| {
        let remedy = match arguments.blank {
            true => ", or leave --blank out",
            false => "",
        };
        Err(Failure::Check(format!(
            "the image refused a command: {reason}{remedy}"
        )))
    })
}
