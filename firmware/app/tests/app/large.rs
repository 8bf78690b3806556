use estimator_core::{
    Confidence as _, Count, ObserverDesign, Sample, Side, VelocityEstimator as _,
};
use firmware_app::ammeter::{Ammeter, Measure};
use firmware_app::config::{DEVICE, RATE};
use firmware_app::large::{
    ADAPTIVE, ADAPTIVE_EDGE, Adaptive, AdaptiveEdge, BOTH, Both, FILTER, Filter, LEARNING,
    LargeEstimator, Learnable as _, WINDOW, Window,
};

#[test]
fn handover_by_number_takes_40_ms() {
    let first = Sample::new(Count(0));
    let mut state = BOTH.start(&first);
    assert_eq!(Both::in_charge(&state), Some(0));
    assert_eq!(Both::choice(0), Some(Side::First));
    assert_eq!(Both::choice(2), None);
    BOTH.update(&mut state, &first);
    Both::choose(&mut state, Both::choice(1).expect("the filter"));
    let numbers: Vec<_> = (0..1000)
        .map(|_| {
            BOTH.update(&mut state, &first);
            Both::in_charge(&state)
        })
        .collect();
    let taking_over = numbers.iter().take_while(|number| number.is_none()).count();
    assert!((399..=400).contains(&taking_over), "{taking_over} ticks");
    assert!(
        numbers[taking_over..]
            .iter()
            .all(|number| *number == Some(1))
    );
    assert_eq!(
        BOTH.variance(&state),
        FILTER.variance(&FILTER.start(&first))
    );
    assert_eq!(BOTH.learned(&state).deviations(), None);
}

fn alone<E: LargeEstimator>(estimator: &E, learns: bool) {
    let state = estimator.start(&Sample::new(Count(0)));
    assert_eq!(E::in_charge(&state), Some(0));
    assert!((0..=u8::MAX).all(|number| E::choice(number).is_none()));
    assert_eq!(estimator.learned(&state).deviations().is_some(), learns);
}

#[test]
fn single_estimator_is_number_0_and_cannot_be_changed() {
    alone::<Window>(&WINDOW, false);
    alone::<Filter>(&FILTER, false);
    alone::<Adaptive>(&ADAPTIVE, true);
    alone::<AdaptiveEdge>(&ADAPTIVE_EDGE, true);
}

#[test]
fn learned_parameters_are_those_of_the_estimator() {
    let mut state = ADAPTIVE.start(&Sample::new(Count(0)));
    // A motor that turns ever faster without a current fits no damping in the range.
    for k in 0..20_000_u32 {
        ADAPTIVE.update(
            &mut state,
            &Sample::new(Count(k * k / 40_000)).with_coupled(Count(0)),
        );
    }
    let learned = ADAPTIVE.learned(&state);
    assert_eq!(learned, ADAPTIVE.parameter_errors(&state));
    assert_eq!(learned.deviations(), Some(learned));
    assert_ne!(learned, Default::default());
}

/// A current that is measured has the lag of the amplifier in it.
#[test]
fn observer_of_commanded_currents_alone_has_the_lag_of_the_amplifier() {
    let commanded = DEVICE.coupled_motor();
    assert!(commanded.amplifier_lag > 0.0);
    let mut measured = commanded;
    measured.amplifier_lag = 0.0;
    let is_designed_for = [commanded, measured].map(|motor| {
        let uncertainty = tuned::uncertainty(LEARNING[0], RATE);
        let design = ObserverDesign::new(&motor, RATE, &uncertainty);
        design.adaptive().build().expect("a design") == ADAPTIVE
    });
    let measures = <Ammeter as Measure>::WANTED;
    assert_eq!(is_designed_for, [!measures, measures]);
}
