//! Estimators without a model of the motor, and Kalman filters over a linear model.

mod acceleration_bound;
mod algebraic;
mod alpha_beta_gamma;
#[cfg(test)]
pub(crate) mod draws;
mod explicit_super_twisting;
mod finite_difference;
mod foaw;
mod handover;
mod kalman;
mod late_current;
mod learned_m_over_t;
mod linear_eso;
mod low_pass;
mod m_over_t;
mod pll;
mod pole;
mod robust_exact;
mod savitzky_golay;
mod square_root;
mod steady_kalman;
mod super_twisting;
mod table_kalman;
mod tracking_differentiator;

pub use algebraic::{Algebraic, AlgebraicState};
pub use alpha_beta_gamma::{AlphaBetaGamma, AlphaBetaGammaState};
pub use explicit_super_twisting::{ExplicitSuperTwisting, ExplicitSuperTwistingState};
pub use finite_difference::FiniteDifference;
pub use foaw::{BestFit, EndFit, Fit, Foaw, FoawState};
pub use handover::{Handover, HandoverState, Side};
pub use kalman::{Kalman, KalmanMotor, KalmanState, KalmanTriple};
pub use late_current::{LateCurrent, LateCurrentState};
pub use learned_m_over_t::{LearnedMOverT, LearnedMOverTState};
pub use linear_eso::LinearEso;
pub use low_pass::{LowPass, LowPassState};
pub use m_over_t::{MOverT, MOverTState};
pub use pll::{Pll, PllState};
pub use robust_exact::{RobustExact, RobustExactState};
pub use savitzky_golay::{SavitzkyGolay, SavitzkyGolayState};
pub use steady_kalman::{SteadyKalman, SteadyKalmanMotor, SteadyKalmanState, SteadyKalmanTriple};
pub use super_twisting::{SuperTwisting, SuperTwistingState};
pub use table_kalman::{TableKalman, TableKalmanMotor, TableKalmanState, TableKalmanTriple};
pub use tracking_differentiator::{TrackingDifferentiator, TrackingDifferentiatorState};
