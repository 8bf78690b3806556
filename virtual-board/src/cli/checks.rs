//! Checks of the arguments before the run.

use drive::named::chosen;
use terminal::failure::Failure;
use terminal::output::check_place;

use super::Arguments;
use crate::identity;
use crate::image::Image;
use crate::scene;

/// Refuses output files that have no place.
pub(super) fn in_place(arguments: &Arguments) -> Result<(), Failure> {
    let files = [&arguments.record, &arguments.rtt, &arguments.trace];
    files
        .into_iter()
        .flatten()
        .try_for_each(|file| check_place(file))
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
    for (_, text) in &arguments.tune {
        scene::check(arguments.scene, text, &hello)?;
    }
    for (_, number) in &arguments.estimator {
        let number = number.0;
        chosen(number, &hello).map_err(|error| format!("--estimator {number}: {error}"))?;
    }
    Ok(())
}
