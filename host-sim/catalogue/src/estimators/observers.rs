//! How the observers and the M/T method are built from their parameters.

use estimator_core::{
    AmplifierCurrent, CountUpdate, Correction, CurrentSource, DesignError, EdgeUpdate, Fixed, HeldShaft,
    Hertz, Adaptation, MOverT, NoCurrent, Observer, Signals, SlipSource, CoupledEncoder, QuantisedUpdate,
    Uncertainty,
};

use super::build::scale;
use super::erased::{Estimator, confident, erased, learner};
use super::{Kind, Parameter, Search, Setup, Values};
use simulation::trace::EDGE_CLOCK_HZ;

const TORQUE_NOISE: Parameter = Parameter {
    name: "torque_noise",
    unit: "N.m/sqrt(Hz)",
    meaning: "spectral density of the white torque that the observer expects",
    lowest: 1e-12,
    highest: 1.0,
    whole: false,
    search: Search::Log(5e-7, 5e-4),
};

const LOAD: Parameter = Parameter {
    name: "load",
    unit: "N.m",
    meaning: "standard deviation of the slow torque that nothing explains",
    lowest: 1e-12,
    highest: 1e3,
    whole: false,
    search: Search::Log(1e-5, 1e-2),
};

const LOAD_TIME: Parameter = Parameter {
    name: "load_time",
    unit: "s",
    meaning: "correlation time of that torque",
    lowest: 1e-6,
    highest: 1e6,
    whole: false,
    search: Search::Fixed(0.1),
};

const FRICTION_SHARE: Parameter = Parameter {
    name: "friction_share",
    unit: "",
    meaning: "part of it that is taken for friction",
    lowest: 0.0,
    highest: 1.0,
    whole: false,
    search: Search::Fixed(0.7),
};

const BOUNDARY_NOISE: Parameter = Parameter {
    name: "boundary_noise",
    unit: "counts",
    meaning: "error of a boundary's place: the disc's, and the rounding of the model",
    lowest: 1e-4,
    highest: 1e3,
    whole: false,
    search: Search::Fixed(0.0625),
};

/// A disc whose four phases are learned has 0.02 to 0.03 counts left.
const DISC_NOISE: Parameter = Parameter {
    search: Search::Fixed(0.03),
    ..BOUNDARY_NOISE
};

const PARAMETERS: &[Parameter] = &[
    TORQUE_NOISE,
    LOAD,
    LOAD_TIME,
    FRICTION_SHARE,
    BOUNDARY_NOISE,
];

const WITH_EDGES: &[Parameter] = &[TORQUE_NOISE, LOAD, LOAD_TIME, FRICTION_SHARE, DISC_NOISE];

/// Without a current there is no friction to believe in.
const BLIND: &[Parameter] = &[
    TORQUE_NOISE,
    Parameter {
        search: Search::Log(1e-4, 1.0),
        ..LOAD
    },
    LOAD_TIME,
    DISC_NOISE,
];

const CURRENT_AND_SLIP: Signals = Signals {
    small: true,
    ..Signals::COUNT_AND_CURRENT
};

const EDGE: Signals = Signals {
    edge: true,
    ..Signals::COUNT
};

type Known<M, L> = Observer<AmplifierCurrent, CoupledEncoder, M, L>;

pub(super) const KINDS: &[Kind] = &[
    Kind {
        name: "m-over-t",
        summary: "counts over the time between edges, at most one count over the time since the last",
        needs: EDGE,
        parameters: &[],
        build: |setup, _| {
            let estimator = MOverT::new(Hertz(EDGE_CLOCK_HZ), setup.rate)?;
            Ok(erased(estimator, scale(setup)?))
        },
    },
    Kind {
        name: "observer",
        summary: "observer with current, slip, friction and dead zone, scheduled gains",
        needs: CURRENT_AND_SLIP,
        parameters: PARAMETERS,
        build: |setup, values| built(counts(setup, values)?, setup),
    },
    Kind {
        name: "observer-edge",
        summary: "the same with edge time stamps",
        needs: CURRENT_AND_SLIP.or(EDGE),
        parameters: WITH_EDGES,
        build: |setup, values| built(edges(setup, values)?, setup),
    },
    Kind {
        name: "adaptive",
        summary: "observer that learns damping, friction and torque constant per inertia",
        needs: CURRENT_AND_SLIP,
        parameters: PARAMETERS,
        build: |setup, values| learning(counts(setup, values)?, setup),
    },
    Kind {
        name: "adaptive-edge",
        summary: "the same with edge time stamps",
        needs: CURRENT_AND_SLIP.or(EDGE),
        parameters: WITH_EDGES,
        build: |setup, values| learning(edges(setup, values)?, setup),
    },
    Kind {
        name: "observer-soft",
        summary: "observer that hears counts inside their cell too",
        needs: CURRENT_AND_SLIP,
        parameters: PARAMETERS,
        build: |setup, values| built(soft(setup, values)?, setup),
    },
    Kind {
        name: "adaptive-soft",
        summary: "the same, learning as adaptive",
        needs: CURRENT_AND_SLIP,
        parameters: PARAMETERS,
        build: |setup, values| learning(soft(setup, values)?, setup),
    },
    Kind {
        name: "observer-held",
        summary: "observer without the small encoder",
        needs: Signals::COUNT_AND_CURRENT,
        parameters: PARAMETERS,
        build: |setup, values| built(counts(setup, values)?.held(), setup),
    },
    Kind {
        name: "observer-edge-held",
        summary: "observer-edge without the small encoder",
        needs: Signals::COUNT_AND_CURRENT.or(EDGE),
        parameters: WITH_EDGES,
        build: |setup, values| built(edges(setup, values)?.held(), setup),
    },
    Kind {
        name: "observer-edge-blind",
        summary: "observer-edge without current and small encoder",
        needs: EDGE,
        parameters: BLIND,
        build: |setup, values| built(blind(setup, values)?, setup),
    },
];

fn uncertainty(values: &[f64; 5]) -> Uncertainty {
    let &[
        torque_noise,
        load,
        load_time,
        friction_share,
        boundary_noise,
    ] = values;
    Uncertainty {
        torque_noise,
        load,
        load_time,
        friction_share,
        boundary_noise,
    }
}

fn counts(setup: &Setup, values: &Values) -> Result<Known<CountUpdate, Fixed>, DesignError> {
    let values = [values[0], values[1], values[2], values[3], values[4]];
    Observer::new(
        &setup.stages.coupled_motor(),
        setup.rate,
        &uncertainty(&values),
    )
}

fn blind(
    setup: &Setup,
    values: &Values,
) -> Result<Observer<NoCurrent, HeldShaft, EdgeUpdate, Fixed>, DesignError> {
    let values = [values[0], values[1], values[2], 0.0, values[3]];
    let clock = Hertz(EDGE_CLOCK_HZ);
    Observer::blind(
        &setup.stages.coupled_motor(),
        setup.rate,
        clock,
        &uncertainty(&values),
    )
}

fn edges(setup: &Setup, values: &Values) -> Result<Known<EdgeUpdate, Fixed>, DesignError> {
    counts(setup, values)?.with_edges(Hertz(EDGE_CLOCK_HZ), setup.rate)
}

fn soft(setup: &Setup, values: &Values) -> Result<Known<QuantisedUpdate, Fixed>, DesignError> {
    let values = [values[0], values[1], values[2], values[3], values[4]];
    Observer::quantised(
        &setup.stages.coupled_motor(),
        setup.rate,
        &uncertainty(&values),
    )
}

fn learning<M>(observer: Known<M, Fixed>, setup: &Setup) -> Result<Estimator, DesignError>
where
    M: Correction<State: Send> + Send + Sync + 'static,
{
    let observer = observer.adaptive(setup.stages.large.counts_per_rev, setup.rate)?;
    Ok(learner(observer, scale(setup)?, |observer, state| {
        observer.deviations(state).damping_ratio()
    }))
}

fn built<C, S, M, L>(
    observer: Observer<C, S, M, L>,
    setup: &Setup,
) -> Result<Estimator, DesignError>
where
    C: CurrentSource<State: Send> + Send + Sync + 'static,
    S: SlipSource<State: Send> + Send + Sync + 'static,
    M: Correction<State: Send> + Send + Sync + 'static,
    L: Adaptation<State: Send> + Send + Sync + 'static,
{
    Ok(confident(observer, scale(setup)?))
}
