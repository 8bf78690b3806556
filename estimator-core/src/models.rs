//! Models of the motion: the constants of a motor, and linear models built from them.

mod coupled_motor;
pub(crate) mod linear;
mod motor_current;
mod motor_model;
mod triple_integrator;

pub use coupled_motor::CoupledMotor;
pub use linear::{Input, Model};
pub use motor_current::CurrentInput;
pub use motor_model::MotorModel;
pub use triple_integrator::NoInput;
