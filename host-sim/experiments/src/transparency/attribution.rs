//! Attribution of the parasitic force to its causes.
//!
//! The torque that the hand feels follows from the motion of the handle's shaft, and the torque that
//! the scene wants from the controller's arithmetic. Both sides together are an identity:
//! ```text
//! felt    = Kt i (1 + ripple) + b slip - friction - J dw/dt
//! Kt i    = Kt (i - u0) + Kt (u0 - u) + Kt (u - c) + (Kt c - asked) + asked
//! asked   = wanted - coupled(slip') + f(w')
//! felt - wanted = sum of the terms of [`Cause`]
//! ```
//! i is the small motor's current, u the current commanded to its amplifier from this tick on, u0 until
//! this tick, c the controller's command before the DAC. coupled is the torque that the controller
//! assumes to come through the coupler, f the friction that it feeds forward; primes mark estimated
//! velocities. The terms add up to the parasitic force at every tick, up to rounding.

mod ledger;
mod scores;

pub use ledger::Ledger;
pub use scores::{Attribution, Part};

macro_rules! causes {
    ($($(#[doc = $doc:literal])+ $cause:ident: $name:literal;)+) => {
        /// A cause of parasitic force; the documentation of each one is its torque.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Cause {
            $($(#[doc = $doc])+ $cause,)+
        }

        impl Cause {
            /// All causes, in the order of tables and charts.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$cause),+];

            /// Name in tables, charts and files.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$cause => $name,)+
                }
            }

            /// The torque of the cause in words.
            #[must_use]
            pub fn sentence(self) -> String {
                let lines: &[&str] = match self {
                    $(Self::$cause => &[$($doc),+],)+
                };
                lines.concat().trim().to_owned()
            }
        }
    };
}

causes! {
    /// `-J_S dw_S/dt`: inertia of the handle.
    Inertia: "inertia";
    /// `f(w_S) - friction_S`: friction of the small motor less what the controller would feed forward
    /// with the true velocity of the handle.
    Friction: "friction";
    /// `Kt_S i_S ripple`: torque ripple of the small motor.
    Ripple: "ripple";
    /// Slip left by the velocity loop: the torque of the coupler less the torque that the controller
    /// assumes for the true velocities, without the part of the slip that the estimation error causes.
    /// In a scene without the large motor it is the whole torque of the coupler.
    Slip: "slip";
    /// Error of the large motor's estimated velocity: `m (w_L - w_L')` of the tick before, which the small
    /// motor renders now, and `(b - m) d`, where d is the velocity that the error causes through the
    /// velocity loop, by its linear model. m is the measured part of the damping.
    Estimate: "estimate";
    /// Error of the handle's estimated velocity: `-m (w_S - w_S') + f(w_S') - f(w_S)` of the tick before,
    /// which the small motor renders now.
    HandleEstimate: "handle estimate";
    /// `Kt_S (i_S - u0)`: lag of the small motor's amplifier.
    Amplifier: "amplifier";
    /// `Kt_S (u0 - u)` without the torques of the estimation errors: the command of this tick has not
    /// acted yet.
    Sampling: "sampling";
    /// `Kt_S (u - c)`: the rounding of the small motor's DAC.
    Dac: "DAC";
    /// `Kt_S c - asked`: limits of current and slope of the small motor; after a stop, and in a scene
    /// without small motor, the whole torque that it does not render.
    Limits: "limits";
}

/// Number of causes.
pub const CAUSES: usize = Cause::ALL.len();
