//! Reported variances of the estimators against theory and against each other.

use estimator_core::{
    Amps, Confidence, Count, CountObserver, CoupledMotor, EndFit, FiniteDifference, Foaw, Handover,
    Hertz, Kalman, Model, Observer, Sample, Side, SteadyKalman, VelocityEstimator,
};

use crate::UNSURE;

const RATE: Hertz = Hertz(1000.0);

/// The full filter's variance falls to the limit that the steady one was given at compile time.
#[test]
fn full_filter_settles_to_the_variance_of_the_steady_filter() {
    for jerk in [1e2, 1e4, 1e5] {
        let model = Model::triple_integrator(4096, RATE, jerk).unwrap();
        let (full, steady) = (
            Kalman::new(&model).unwrap(),
            SteadyKalman::new(&model).unwrap(),
        );
        let first = Sample::new(Count(0));
        let limit = steady.variance(&steady.start(&first)).0;
        let mut state = full.start(&first);
        assert!(full.variance(&state).0 > 10.0 * limit, "{jerk}: {limit}");
        for k in 1..2000 {
            full.update(&mut state, &Sample::new(Count(3 * k)));
        }
        let settled = full.variance(&state).0;
        assert!(
            (settled / limit - 1.0).abs() < 1e-3,
            "{jerk}: {settled} {limit}"
        );
    }
}

/// Between two counts an observer has no measurement, so its variance grows.
#[test]
fn variance_of_an_observer_grows_without_counts() {
    let observer: CountObserver = Observer::new(&CoupledMotor::DCX35L, RATE, &UNSURE).unwrap();
    let at = |count| Sample::new(Count(count)).with_current(Amps::new(0.3));
    let mut state = observer.start(&at(0));
    for k in 0..200 {
        observer.update(&mut state, &at(5 * k));
    }
    let sure = observer.variance(&state);
    let (mut last, mut corrections) = (sure, 0);
    for _ in 0..40 {
        observer.update(&mut state, &Sample::new(Count(5 * 199)));
        let now = observer.variance(&state);
        // The state counts the ticks since the prediction was last outside its quantisation
        // interval.
        match *state.correction() {
            0.0 => corrections += 1,
            ticks if ticks > 1.0 => assert!(now > last, "{now:?} after {last:?}, {ticks} ticks"),
            // The first row of the table is for a gap of zero and of one tick.
            _ => assert_eq!(now, last),
        }
        last = now;
    }
    assert!((1..20).contains(&corrections), "{corrections}");
    // At rest the prediction agrees with the count, so no correction follows.
    assert!(last.0 > 4.0 * sure.0, "{} {}", last.0, sure.0);
}

#[test]
fn handover_reports_the_larger_variance_of_the_two() {
    let window = Foaw::<8, EndFit>::new(8, 1).unwrap();
    let both = Handover::new(window, FiniteDifference, 4, 4).unwrap();
    let mut state = both.start(&Sample::new(Count(0)));
    let mut said = Vec::new();
    for k in 1..40 {
        if k == 20 {
            state.select(Side::Second);
        }
        both.update(&mut state, &Sample::new(Count(k)));
        said.push((state.in_charge(), both.variance(&state).0));
    }
    assert_eq!(said[18], (Some(Side::First), 1.0 / 64.0));
    assert_eq!(said[20], (None, 1.0));
    assert_eq!(said[38], (Some(Side::Second), 1.0));
}

/// A restart keeps the choice of the estimator.
#[test]
fn restart_keeps_the_choice() {
    let window = Foaw::<8, EndFit>::new(8, 1).unwrap();
    let both = Handover::new(window, FiniteDifference, 4, 4).unwrap();
    let mut state = both.start(&Sample::new(Count(0)));
    both.restart(&mut state, &Sample::new(Count(90)));
    assert_eq!(state, both.start(&Sample::new(Count(90))));
    state.select(Side::Second);
    both.restart(&mut state, &Sample::new(Count(100)));
    assert_eq!(state.in_charge(), Some(Side::Second));
    // The state begins at rest at that sample, so its first output does not jump.
    assert_eq!(both.update(&mut state, &Sample::new(Count(103))).0, 3.0);
}
