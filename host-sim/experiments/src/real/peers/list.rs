//! The comparators, with the defaults of their projects.

use estimator_core::{Hertz, Pll};
use peers::{
    Dvrk, Moteus, ODrive, OpenFfBoard, SimpleFocEncoder, SimpleFocSensor, VescFast, VescPll,
};
use simulation::trace::EDGE_CLOCK_HZ;

use super::path::Path;

/// A parameter of a peer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name with the unit.
    pub name: &'static str,
    /// The default of the project.
    pub default: f64,
    /// The values between which it is tuned.
    pub range: [f64; 2],
}

/// A velocity algorithm of another project.
#[derive(Clone, Copy, Debug)]
pub struct Peer {
    /// Name of its row with the default of the project.
    pub name: &'static str,
    /// Name of its row with the tuned values.
    pub tuned: &'static str,
    /// Rate at which it runs, Hz; `None` for that of the ticks.
    pub rate_hz: Option<f64>,
    /// Whether it reads edge time stamps.
    pub edges: bool,
    /// Its parameters; none if there is nothing to tune.
    pub parameters: &'static [Parameter],
    /// The velocities at the ticks with these values, rad/s.
    pub run: fn(&Path, &[f64]) -> Vec<f32>,
}

impl Peer {
    /// The values of the parameters in the project.
    #[must_use]
    pub fn defaults(&self) -> Vec<f64> {
        self.parameters.iter().map(|one| one.default).collect()
    }

    /// This peer at another rate.
    #[must_use]
    pub const fn at(self, rate_hz: Option<f64>) -> Self {
        Self { rate_hz, ..self }
    }
}

/// The clock that stamps edges.
const CLOCK: Hertz = Hertz(EDGE_CLOCK_HZ);

/// Counts in an electrical turn of VESC's default motor.
fn turn(path: &Path) -> f64 {
    f64::from(path.counts_per_rev()) / VescPll::RATIO
}

/// The peers.
pub const PEERS: &[Peer] = &[
    Peer {
        name: "peer:moteus",
        tuned: "peer:moteus-tuned",
        rate_hz: Some(Moteus::RATE.0),
        edges: false,
        parameters: &[Parameter {
            name: "pll_filter_hz",
            default: Moteus::CUTOFF.0,
            range: [2.0, 1000.0],
        }],
        run: |path, p| {
            path.velocities(&Moteus::new(
                Hertz(p[0]),
                path.rate(),
                path.counts_per_rev(),
            ))
        },
    },
    Peer {
        name: "peer:odrive",
        tuned: "peer:odrive-tuned",
        rate_hz: Some(ODrive::RATE.0),
        edges: false,
        parameters: &[Parameter {
            name: "bandwidth_rad_s",
            default: ODrive::BANDWIDTH_RAD_S,
            range: [5.0, 3900.0],
        }],
        run: |path, p| path.velocities(&ODrive::new(p[0], path.rate())),
    },
    Peer {
        name: "peer:vesc-pll",
        tuned: "peer:vesc-pll-tuned",
        rate_hz: Some(VescPll::RATE.0),
        edges: false,
        parameters: &[
            Parameter {
                name: "kp",
                default: VescPll::KP,
                range: [10.0, 12_000.0],
            },
            Parameter {
                name: "ki",
                default: VescPll::KI,
                range: [100.0, 1e6],
            },
        ],
        run: |path, p| path.velocities(&VescPll::new(p[0], p[1], path.rate(), turn(path))),
    },
    Peer {
        name: "peer:vesc-fast",
        tuned: "peer:vesc-fast-tuned",
        rate_hz: Some(VescPll::RATE.0),
        edges: false,
        parameters: &[Parameter {
            name: "share",
            default: VescFast::SHARE,
            range: [0.001, 1.0],
        }],
        run: |path, p| path.velocities(&VescFast::new(p[0], turn(path))),
    },
    Peer {
        name: "peer:simplefoc-sensor",
        tuned: "peer:simplefoc-sensor-tuned",
        rate_hz: None,
        edges: false,
        parameters: &[Parameter {
            name: "Tf_s",
            default: SimpleFocSensor::FILTER_TIME_S,
            range: [1e-4, 0.2],
        }],
        run: |path, p| path.velocities(&SimpleFocSensor::new(p[0], path.rate())),
    },
    Peer {
        name: "peer:simplefoc-encoder",
        tuned: "peer:simplefoc-encoder-tuned",
        rate_hz: None,
        edges: true,
        parameters: &[Parameter {
            name: "Tf_s",
            default: SimpleFocEncoder::FILTER_TIME_S,
            range: [1e-4, 0.2],
        }],
        run: |path, p| path.velocities(&SimpleFocEncoder::new(p[0], path.rate(), CLOCK)),
    },
    Peer {
        name: "peer:openffboard",
        tuned: "peer:openffboard-tuned",
        rate_hz: Some(OpenFfBoard::RATE.0),
        edges: false,
        parameters: &[Parameter {
            name: "frequency_hz",
            default: OpenFfBoard::PROFILES[1].0,
            range: [2.0, 450.0],
        }],
        run: |path, p| {
            let filter = OpenFfBoard::new(Hertz(p[0]), OpenFfBoard::Q, path.rate());
            path.velocities(&filter)
        },
    },
    Peer {
        name: "peer:dvrk-measured",
        tuned: "",
        rate_hz: Some(DVRK_HZ),
        edges: true,
        parameters: &[],
        run: |path, _| path.velocities(&Dvrk::measured(path.rate(), CLOCK)),
    },
    Peer {
        name: "peer:dvrk-predicted",
        tuned: "",
        rate_hz: Some(DVRK_HZ),
        edges: true,
        parameters: &[],
        run: |path, _| path.velocities(&Dvrk::predicted(path.rate(), CLOCK)),
    },
];

/// Rate at which the comparator of the dVRK takes edges, Hz: above that of the edges of the recordings
/// at 4096 counts per revolution.
const DVRK_HZ: f64 = 32_000.0;

/// The tracking loop of this project, to be tuned by the rule of the peers.
pub const PLL: Peer = Peer {
    name: "pll",
    tuned: "pll-tuned",
    rate_hz: None,
    edges: false,
    parameters: &[Parameter {
        name: "bandwidth_hz",
        // Nothing runs with this value: the shipped one depends on rate and encoder.
        default: 20.0,
        range: [0.5, 400.0],
    }],
    run: |path, p| {
        let loop_ = Pll::new(Hertz(p[0]), path.rate()).expect("a bandwidth below half of the rate");
        path.velocities(&loop_)
    },
};
