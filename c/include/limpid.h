/* Velocity from the counts of a quadrature encoder. 0.1.0
 *
 * Written by `cargo c-library header`; do not edit.
 *
 *   #include "imm.h"                     // host-sim export --estimator imm --c > imm.h; it includes this file
 *
 *   static limpid_imm_state_t state;
 *
 *   limpid_imm_start(&limpid_imm_parameters, &state, &sample);            // once, with the first sample
 *   float v = limpid_imm_update(&limpid_imm_parameters, &state, &sample); // at every tick, counts per tick
 *
 * - A tick is one control period. Velocities are in counts per tick: LIMPID_RAD_PER_S converts them.
 * - A count is modulo 2^32. Convert a counter of 16 bits with limpid_extended.
 * - Parameters are constants. State is yours: in static memory, on the stack, one per encoder. To
 *   reset an estimator, start it again. An interrupt may use one state while a task uses another.
 * - Pointers must be valid, aligned and not null. A state must have been started.
 * - No function allocates, locks, or calls a library of floating-point functions. None fails but _design.
 * - A function that ends in _design exists in the library for computers alone. It refuses wrong values with a
 *   status.
 */

#ifndef LIMPID_H
#define LIMPID_H


#include <stdint.h>

/*
 No error.
 */
#define LIMPID_OK 0

/*
 a parameter is outside of its range or not whole; see the type of the values.
 */
#define LIMPID_ERROR_RANGE 1

/*
 rate must be positive and finite (Hz).
 */
#define LIMPID_ERROR_RATE 2

/*
 rate must be above damping / (8 inertia), for a Kalman filter damping / (700 inertia) (Hz).
 */
#define LIMPID_ERROR_RATE_FOR_DAMPING 3

/*
 rate must give counts_per_rev torque_constant / (inertia rate^2) above 0 and below 10^6, for a Kalman filter 2 pi 10^9 (counts/A) (Hz).
 */
#define LIMPID_ERROR_RATE_FOR_CURRENT 4

/*
 rate must give counts_per_rev coulomb_friction / (inertia rate^2) below 10^6 counts (Hz).
 */
#define LIMPID_ERROR_RATE_FOR_FRICTION 5

/*
 rate must be between 100 and 1e5 (Hz).
 */
#define LIMPID_ERROR_RATE_OF_BANK 6

/*
 clock must be finite and at least the rate (Hz).
 */
#define LIMPID_ERROR_CLOCK 7

/*
 cutoff must be between 1e-6 and 1/2 of the rate (Hz).
 */
#define LIMPID_ERROR_CUTOFF 8

/*
 bandwidth must be between 1e-6 and 1/2 of the rate (Hz).
 */
#define LIMPID_ERROR_BANDWIDTH 9

/*
 acceleration must give counts_per_rev acceleration / (2 pi rate^2) from 1e-12 to 1e6 counts/tick^2 (rad/s^2).
 */
#define LIMPID_ERROR_ACCELERATION 10

/*
 filter_time must be above 0 and at most 10^4 ticks (s).
 */
#define LIMPID_ERROR_FILTER_TIME 11

/*
 window must be between 1 and N (intervals).
 */
#define LIMPID_ERROR_WINDOW 12

/*
 bound must be at most 2^14 (counts).
 */
#define LIMPID_ERROR_BOUND 13

/*
 settle must be below 2^15 (ticks).
 */
#define LIMPID_ERROR_SETTLE 14

/*
 fade must be between 1 and 2^15 (ticks).
 */
#define LIMPID_ERROR_FADE 15

/*
 counts_per_rev must be above 0 (counts).
 */
#define LIMPID_ERROR_COUNTS_PER_REV 16

/*
 inertia must be above 0 and finite (kg m^2).
 */
#define LIMPID_ERROR_INERTIA 17

/*
 damping must be at least 0 and finite (N m s/rad).
 */
#define LIMPID_ERROR_DAMPING 18

/*
 torque_constant must be above 0 and finite (N m/A).
 */
#define LIMPID_ERROR_TORQUE_CONSTANT 19

/*
 coulomb_friction must be at least 0 and finite (N m).
 */
#define LIMPID_ERROR_COULOMB_FRICTION 20

/*
 amplifier_lag must be at least 0 and below 10^6 ticks (s).
 */
#define LIMPID_ERROR_AMPLIFIER_LAG 21

/*
 coupled_counts_per_rev must be above 0 (counts).
 */
#define LIMPID_ERROR_COUPLED_COUNTS_PER_REV 22

/*
 jerk_density must be above 0, and the process noise made of it above 0 and finite (rad/s^3/sqrt(Hz)).
 */
#define LIMPID_ERROR_JERK_DENSITY 23

/*
 current_noise must be above 0, and the process noise made of it above 0 and finite (A).
 */
#define LIMPID_ERROR_CURRENT_NOISE 24

/*
 torque_noise must be above 0 and below 10^6, and its variance in a tick above 0 (N m/sqrt(Hz)).
 */
#define LIMPID_ERROR_TORQUE_NOISE 25

/*
 torque_noise must spread the velocity in a tick by 1e-9 to 512 counts/tick (N m/sqrt(Hz)).
 */
#define LIMPID_ERROR_TORQUE_NOISE_FOR_QUANTISED 26

/*
 disturbance must be above 0 and below 10^6, and its variance in a tick above 0 (N m).
 */
#define LIMPID_ERROR_DISTURBANCE 27

/*
 disturbance_time must be above 0 and below 10^9 (s).
 */
#define LIMPID_ERROR_DISTURBANCE_TIME 28

/*
 friction_share must be between 0 and 1.
 */
#define LIMPID_ERROR_FRICTION_SHARE 29

/*
 boundary_noise must be between 1e-4 and 1e3 (counts).
 */
#define LIMPID_ERROR_BOUNDARY_NOISE 30

/*
 process_noise must be at most 2^18 on the diagonal for a covariance in single precision (counts^2 in a tick).
 */
#define LIMPID_ERROR_PROCESS_NOISE 31

/*
 process_noise is too small or too large for the rate and the encoder: the steady gain does not converge in 2^20 ticks.
 */
#define LIMPID_ERROR_NOT_CONVERGED 32

/*
 process_noise makes the closed loop of model and steady gain unstable.
 */
#define LIMPID_ERROR_NOT_STABLE 33

/*
 N must be larger or the process noise too: the gain is not within 1e-6 of its limit at the end of the table (ticks).
 */
#define LIMPID_ERROR_TABLE 34

/*
 `finite-difference`: displacement over the last period (eq. 4). Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[1];
} limpid_finite_difference_t;

/*
 State of `finite-difference`, which the caller owns; valid after `limpid_finite_difference_start`.
 */
typedef struct {
  uint32_t words[1];
} limpid_finite_difference_state_t;

/*
 The measurements of one tick. What an estimator does not read may be zero.
 */
typedef struct {
  /*
   Count of the shaft whose velocity is estimated, modulo 2^32.
   */
  uint32_t count;
  /*
   Count of the shaft on the other side of the coupling, modulo 2^32.
   */
  uint32_t coupled;
  /*
   Motor current commanded over the period that ends with this sample, A. NaN and infinities count
   as 0, magnitudes above 1000 A as 1000 A.
   */
  float current;
  /*
   Not 0 if `edge_boundary` and `edge_age` are valid: there has been an edge with a time stamp.
   */
  uint32_t has_edge;
  /*
   Boundary that the latest edge crossed: boundary e lies between counts e - 1 and e.
   */
  uint32_t edge_boundary;
  /*
   Time from the latest edge to this sample, in ticks of the clock that stamps edges, saturating.
   */
  uint32_t edge_age;
} limpid_sample_t;

/*
 `low-pass`: first-order low-pass over the finite difference. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[2];
} limpid_low_pass_t;

/*
 State of `low-pass`, which the caller owns; valid after `limpid_low_pass_start`.
 */
typedef struct {
  uint32_t words[2];
} limpid_low_pass_state_t;

/*
 `foaw-end-fit`, up to 15 intervals: slope through both ends of the longest straight window. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[3];
} limpid_foaw_end_fit_15_t;

/*
 State of `foaw-end-fit`, which the caller owns; valid after `limpid_foaw_end_fit_15_start`.
 */
typedef struct {
  uint32_t words[43];
} limpid_foaw_end_fit_15_state_t;

/*
 `foaw-end-fit`, up to 64 intervals: slope through both ends of the longest straight window. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[3];
} limpid_foaw_end_fit_64_t;

/*
 State of `foaw-end-fit`, which the caller owns; valid after `limpid_foaw_end_fit_64_start`.
 */
typedef struct {
  uint32_t words[165];
} limpid_foaw_end_fit_64_state_t;

/*
 `foaw-best-fit`, up to 15 intervals: least-squares slope of the longest straight window (eq. 6). Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[3];
} limpid_foaw_best_fit_15_t;

/*
 State of `foaw-best-fit`, which the caller owns; valid after `limpid_foaw_best_fit_15_start`.
 */
typedef struct {
  uint32_t words[35];
} limpid_foaw_best_fit_15_state_t;

/*
 `foaw-best-fit`, up to 64 intervals: least-squares slope of the longest straight window (eq. 6). Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[3];
} limpid_foaw_best_fit_64_t;

/*
 State of `foaw-best-fit`, which the caller owns; valid after `limpid_foaw_best_fit_64_start`.
 */
typedef struct {
  uint32_t words[133];
} limpid_foaw_best_fit_64_state_t;

/*
 `savitzky-golay`, up to 15 intervals: slope at the newest count of the least-squares parabola through a fixed window. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[8];
} limpid_savitzky_golay_15_t;

/*
 State of `savitzky-golay`, which the caller owns; valid after `limpid_savitzky_golay_15_start`.
 */
typedef struct {
  uint64_t words[8];
} limpid_savitzky_golay_15_state_t;

/*
 `savitzky-golay`, up to 64 intervals: slope at the newest count of the least-squares parabola through a fixed window. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[8];
} limpid_savitzky_golay_64_t;

/*
 State of `savitzky-golay`, which the caller owns; valid after `limpid_savitzky_golay_64_start`.
 */
typedef struct {
  uint64_t words[20];
} limpid_savitzky_golay_64_state_t;

/*
 `algebraic`, up to 15 intervals: algebraic differentiator: a line through the weighted differences of a fixed window. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[16];
} limpid_algebraic_15_t;

/*
 State of `algebraic`, which the caller owns; valid after `limpid_algebraic_15_start`.
 */
typedef struct {
  uint32_t words[9];
} limpid_algebraic_15_state_t;

/*
 `algebraic`, up to 64 intervals: algebraic differentiator: a line through the weighted differences of a fixed window. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[65];
} limpid_algebraic_64_t;

/*
 State of `algebraic`, which the caller owns; valid after `limpid_algebraic_64_start`.
 */
typedef struct {
  uint32_t words[34];
} limpid_algebraic_64_state_t;

/*
 `robust-exact`, up to 64 intervals: optimal robust exact differentiator: a window as long as the noise in it asks for. Parameters, which may be in flash.
 */
typedef struct {
  uint64_t words[2];
} limpid_robust_exact_64_t;

/*
 State of `robust-exact`, which the caller owns; valid after `limpid_robust_exact_64_start`.
 */
typedef struct {
  uint32_t words[66];
} limpid_robust_exact_64_state_t;

/*
 `kalman-triple`: Kalman filter on a triple integrator, full covariance (eqs. 9 to 12). Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[13];
} limpid_kalman_triple_t;

/*
 State of `kalman-triple`, which the caller owns; valid after `limpid_kalman_triple_start`.
 */
typedef struct {
  uint32_t words[13];
} limpid_kalman_triple_state_t;

/*
 `kalman-triple-table`, table of 24 ticks: Kalman filter on a triple integrator, preset table of gains from the start until they are steady. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[100];
} limpid_kalman_triple_table_24_t;

/*
 State of `kalman-triple-table`, which the caller owns; valid after `limpid_kalman_triple_table_24_start`.
 */
typedef struct {
  uint32_t words[5];
} limpid_kalman_triple_table_24_state_t;

/*
 `kalman-triple-table`, table of 168 ticks: Kalman filter on a triple integrator, preset table of gains from the start until they are steady. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[676];
} limpid_kalman_triple_table_168_t;

/*
 State of `kalman-triple-table`, which the caller owns; valid after `limpid_kalman_triple_table_168_start`.
 */
typedef struct {
  uint32_t words[5];
} limpid_kalman_triple_table_168_state_t;

/*
 `kalman-triple-steady`: Kalman filter on a triple integrator, preset steady gain. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[4];
} limpid_kalman_triple_steady_t;

/*
 State of `kalman-triple-steady`, which the caller owns; valid after `limpid_kalman_triple_steady_start`.
 */
typedef struct {
  uint32_t words[4];
} limpid_kalman_triple_steady_state_t;

/*
 `kalman-motor`: Kalman filter on the motor model with known current, full covariance (eqs. 14, 16). Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[10];
} limpid_kalman_motor_t;

/*
 State of `kalman-motor`, which the caller owns; valid after `limpid_kalman_motor_start`.
 */
typedef struct {
  uint32_t words[7];
} limpid_kalman_motor_state_t;

/*
 `kalman-motor-steady`: Kalman filter on the motor model with known current, preset steady gain. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[6];
} limpid_kalman_motor_steady_t;

/*
 State of `kalman-motor-steady`, which the caller owns; valid after `limpid_kalman_motor_steady_start`.
 */
typedef struct {
  uint32_t words[3];
} limpid_kalman_motor_steady_state_t;

/*
 `pll`: critically damped tracking loop, as motor boards have it. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[2];
} limpid_pll_t;

/*
 State of `pll`, which the caller owns; valid after `limpid_pll_start`.
 */
typedef struct {
  uint32_t words[3];
} limpid_pll_state_t;

/*
 `alpha-beta-gamma`: alpha-beta-gamma filter: a parabola through all counts, old ones fading. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[3];
} limpid_alpha_beta_gamma_t;

/*
 State of `alpha-beta-gamma`, which the caller owns; valid after `limpid_alpha_beta_gamma_start`.
 */
typedef struct {
  uint32_t words[4];
} limpid_alpha_beta_gamma_state_t;

/*
 `linear-eso`: linear extended-state observer: alpha-beta-gamma with the known motor current. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[4];
} limpid_linear_eso_t;

/*
 State of `linear-eso`, which the caller owns; valid after `limpid_linear_eso_start`.
 */
typedef struct {
  uint32_t words[4];
} limpid_linear_eso_state_t;

/*
 `super-twisting`: super-twisting differentiator (Levant), implicit steps. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[3];
} limpid_super_twisting_t;

/*
 State of `super-twisting`, which the caller owns; valid after `limpid_super_twisting_start`.
 */
typedef struct {
  uint32_t words[3];
} limpid_super_twisting_state_t;

/*
 `super-twisting-explicit`: super-twisting differentiator (Levant), explicit steps: chatters. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[2];
} limpid_super_twisting_explicit_t;

/*
 State of `super-twisting-explicit`, which the caller owns; valid after `limpid_super_twisting_explicit_start`.
 */
typedef struct {
  uint32_t words[3];
} limpid_super_twisting_explicit_state_t;

/*
 `tracking-differentiator`: tracking differentiator (Han): follows as fast as a bound on the acceleration allows. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[5];
} limpid_tracking_differentiator_t;

/*
 State of `tracking-differentiator`, which the caller owns; valid after `limpid_tracking_differentiator_start`.
 */
typedef struct {
  uint32_t words[3];
} limpid_tracking_differentiator_state_t;

/*
 `m-over-t`: counts over the time between edges, at most one count over the time since the last. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[1];
} limpid_m_over_t_t;

/*
 State of `m-over-t`, which the caller owns; valid after `limpid_m_over_t_start`.
 */
typedef struct {
  uint32_t words[4];
} limpid_m_over_t_state_t;

/*
 `m-over-t-learned`: m-over-t that learns the places of uneven boundaries, as of Hall sensors. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[1];
} limpid_m_over_t_learned_t;

/*
 State of `m-over-t-learned`, which the caller owns; valid after `limpid_m_over_t_learned_start`.
 */
typedef struct {
  uint32_t words[20];
} limpid_m_over_t_learned_state_t;

/*
 `imm`: bank of three filters that finds its own process noise. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[30];
} limpid_imm_t;

/*
 State of `imm`, which the caller owns; valid after `limpid_imm_start`.
 */
typedef struct {
  uint32_t words[37];
} limpid_imm_state_t;

/*
 `imm-edge`: the same bank, which also uses edge time stamps. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[31];
} limpid_imm_edge_t;

/*
 State of `imm-edge`, which the caller owns; valid after `limpid_imm_edge_start`.
 */
typedef struct {
  uint32_t words[37];
} limpid_imm_edge_state_t;

/*
 `imm-pair`: bank of two filters: the cheap one. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[30];
} limpid_imm_pair_t;

/*
 State of `imm-pair`, which the caller owns; valid after `limpid_imm_pair_start`.
 */
typedef struct {
  uint32_t words[27];
} limpid_imm_pair_state_t;

/*
 `imm-motor`: bank that also learns the effect of the motor current. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[65];
} limpid_imm_motor_t;

/*
 State of `imm-motor`, which the caller owns; valid after `limpid_imm_motor_start`.
 */
typedef struct {
  uint32_t words[112];
} limpid_imm_motor_state_t;

/*
 `imm-motor-edge`: the same bank, which also uses edge time stamps. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[67];
} limpid_imm_motor_edge_t;

/*
 State of `imm-motor-edge`, which the caller owns; valid after `limpid_imm_motor_edge_start`.
 */
typedef struct {
  uint32_t words[112];
} limpid_imm_motor_edge_state_t;

/*
 `observer`: observer with current, slip and friction, corrected at the ends of the quantisation interval. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[478];
} limpid_observer_t;

/*
 State of `observer`, which the caller owns; valid after `limpid_observer_start`.
 */
typedef struct {
  uint32_t words[9];
} limpid_observer_state_t;

/*
 `observer-edge`: observer that also uses edge time stamps. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[480];
} limpid_observer_edge_t;

/*
 State of `observer-edge`, which the caller owns; valid after `limpid_observer_edge_start`.
 */
typedef struct {
  uint32_t words[14];
} limpid_observer_edge_state_t;

/*
 `adaptive`: observer that adapts damping, friction and torque constant, each per inertia. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[483];
} limpid_adaptive_t;

/*
 State of `adaptive`, which the caller owns; valid after `limpid_adaptive_start`.
 */
typedef struct {
  uint32_t words[30];
} limpid_adaptive_state_t;

/*
 `adaptive-edge`: adaptive observer that also uses edge time stamps. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[485];
} limpid_adaptive_edge_t;

/*
 State of `adaptive-edge`, which the caller owns; valid after `limpid_adaptive_edge_start`.
 */
typedef struct {
  uint32_t words[35];
} limpid_adaptive_edge_state_t;

/*
 `imm-adaptive`: bank that also follows adaptive, with a small probability for a wrong device. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[545];
} limpid_imm_adaptive_t;

/*
 State of `imm-adaptive`, which the caller owns; valid after `limpid_imm_adaptive_start`.
 */
typedef struct {
  uint32_t words[95];
} limpid_imm_adaptive_state_t;

/*
 `imm-adaptive-edge`: bank with edge time stamps that also follows adaptive-edge. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[549];
} limpid_imm_adaptive_edge_t;

/*
 State of `imm-adaptive-edge`, which the caller owns; valid after `limpid_imm_adaptive_edge_start`.
 */
typedef struct {
  uint32_t words[100];
} limpid_imm_adaptive_edge_state_t;

/*
 `observer-soft`: observer with truncated-Gaussian correction: also uses a count that agrees with the prediction. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[20];
} limpid_observer_soft_t;

/*
 State of `observer-soft`, which the caller owns; valid after `limpid_observer_soft_start`.
 */
typedef struct {
  uint32_t words[14];
} limpid_observer_soft_state_t;

/*
 `adaptive-soft`: observer-soft that adapts damping, friction and torque constant, each per inertia. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[25];
} limpid_adaptive_soft_t;

/*
 State of `adaptive-soft`, which the caller owns; valid after `limpid_adaptive_soft_start`.
 */
typedef struct {
  uint32_t words[35];
} limpid_adaptive_soft_state_t;

/*
 `observer-held`: observer without the small encoder. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[477];
} limpid_observer_held_t;

/*
 State of `observer-held`, which the caller owns; valid after `limpid_observer_held_start`.
 */
typedef struct {
  uint32_t words[8];
} limpid_observer_held_state_t;

/*
 `observer-edge-held`: observer-edge without the small encoder. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[479];
} limpid_observer_edge_held_t;

/*
 State of `observer-edge-held`, which the caller owns; valid after `limpid_observer_edge_held_start`.
 */
typedef struct {
  uint32_t words[13];
} limpid_observer_edge_held_state_t;

/*
 `adaptive-held`: observer-held that learns damping, friction and torque constant, from a model that may be wrong tenfold. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[489];
} limpid_adaptive_held_t;

/*
 State of `adaptive-held`, which the caller owns; valid after `limpid_adaptive_held_start`.
 */
typedef struct {
  uint32_t words[29];
} limpid_adaptive_held_state_t;

/*
 `adaptive-edge-held`: adaptive-held that also uses edge time stamps. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[491];
} limpid_adaptive_edge_held_t;

/*
 State of `adaptive-edge-held`, which the caller owns; valid after `limpid_adaptive_edge_held_start`.
 */
typedef struct {
  uint32_t words[34];
} limpid_adaptive_edge_held_state_t;

/*
 `observer-edge-blind`: observer-edge without current and small encoder. Parameters, which may be in flash.
 */
typedef struct {
  uint32_t words[475];
} limpid_observer_edge_blind_t;

/*
 State of `observer-edge-blind`, which the caller owns; valid after `limpid_observer_edge_blind_start`.
 */
typedef struct {
  uint32_t words[12];
} limpid_observer_edge_blind_state_t;

/*
 What an estimator is designed for. An estimator without a model of the device reads `counts_per_rev`
 and `rate_hz` alone; one without edges does not read `edge_clock_hz`.
 */
typedef struct {
  /*
   Counts per revolution of the encoder, four per line.
   */
  uint32_t counts_per_rev;
  /*
   Counts per revolution of the coupled shaft's encoder.
   */
  uint32_t coupled_counts_per_rev;
  /*
   Control rate, Hz.
   */
  double rate_hz;
  /*
   Rate of the clock that stamps edges, Hz.
   */
  double edge_clock_hz;
  /*
   Inertia of rotor and load, kg m^2.
   */
  double inertia;
  /*
   Viscous damping, N m s/rad: that of the coupling.
   */
  double damping;
  /*
   Torque constant, N m/A.
   */
  double torque_constant;
  /*
   Coulomb friction, N m.
   */
  double coulomb_friction;
  /*
   Time constant of the amplifier, s.
   */
  double amplifier_lag;
} limpid_setup_t;

/*
 Parameters of `low-pass` as a person gives them.
 */
typedef struct {
  /*
   cut-off of the filter, at most half the rate; Hz, 0.001 to 1e6.
   */
  double cutoff_hz;
} limpid_low_pass_values_t;

/*
 Parameters of `foaw-end-fit` as a person gives them.
 */
typedef struct {
  /*
   largest number of intervals in the window; intervals, 1 to 128, whole.
   */
  double n;
  /*
   noise bound: half-width of the band around the line; counts, 0 to 16384, whole.
   */
  double d;
} limpid_foaw_end_fit_values_t;

/*
 Parameters of `foaw-best-fit` as a person gives them.
 */
typedef struct {
  /*
   largest number of intervals in the window; intervals, 1 to 128, whole.
   */
  double n;
  /*
   noise bound: half-width of the band around the line; counts, 0 to 16384, whole.
   */
  double d;
} limpid_foaw_best_fit_values_t;

/*
 Parameters of `savitzky-golay` as a person gives them.
 */
typedef struct {
  /*
   number of intervals in the window; intervals, 1 to 128, whole.
   */
  double n;
} limpid_savitzky_golay_values_t;

/*
 Parameters of `algebraic` as a person gives them.
 */
typedef struct {
  /*
   number of intervals in the window; intervals, 1 to 128, whole.
   */
  double n;
} limpid_algebraic_values_t;

/*
 Parameters of `robust-exact` as a person gives them.
 */
typedef struct {
  /*
   largest acceleration that the differentiator expects; rad/s^2, 0.001 to 1e9.
   */
  double acceleration;
  /*
   largest number of intervals in the window; a longer one costs run time alone; intervals, 1 to 128, whole.
   */
  double n;
} limpid_robust_exact_values_t;

/*
 Parameters of `kalman-triple` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the jerk that the filter expects; rad/s^3/sqrt(Hz), 1e-9 to 1e12.
   */
  double jerk;
} limpid_kalman_triple_values_t;

/*
 Parameters of `kalman-triple-table` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the jerk that the filter expects; rad/s^3/sqrt(Hz), 1e-9 to 1e12.
   */
  double jerk;
} limpid_kalman_triple_table_values_t;

/*
 Parameters of `kalman-triple-steady` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the jerk that the filter expects; rad/s^3/sqrt(Hz), 1e-9 to 1e12.
   */
  double jerk;
} limpid_kalman_triple_steady_values_t;

/*
 Parameters of `kalman-motor` as a person gives them.
 */
typedef struct {
  /*
   standard deviation of the current's error, drawn anew each tick; A, 1e-9 to 1e6.
   */
  double current_noise;
} limpid_kalman_motor_values_t;

/*
 Parameters of `kalman-motor-steady` as a person gives them.
 */
typedef struct {
  /*
   standard deviation of the current's error, drawn anew each tick; A, 1e-9 to 1e6.
   */
  double current_noise;
} limpid_kalman_motor_steady_values_t;

/*
 Parameters of `pll` as a person gives them.
 */
typedef struct {
  /*
   frequency of the loop's poles, at most half the rate; Hz, 0.001 to 1e6.
   */
  double bandwidth_hz;
} limpid_pll_values_t;

/*
 Parameters of `alpha-beta-gamma` as a person gives them.
 */
typedef struct {
  /*
   frequency of the loop's poles, at most half the rate; Hz, 0.001 to 1e6.
   */
  double bandwidth_hz;
} limpid_alpha_beta_gamma_values_t;

/*
 Parameters of `linear-eso` as a person gives them.
 */
typedef struct {
  /*
   frequency of the loop's poles, at most half the rate; Hz, 0.001 to 1e6.
   */
  double bandwidth_hz;
} limpid_linear_eso_values_t;

/*
 Parameters of `super-twisting` as a person gives them.
 */
typedef struct {
  /*
   largest acceleration that the differentiator expects; rad/s^2, 0.001 to 1e9.
   */
  double acceleration;
} limpid_super_twisting_values_t;

/*
 Parameters of `super-twisting-explicit` as a person gives them.
 */
typedef struct {
  /*
   largest acceleration that the differentiator expects; rad/s^2, 0.001 to 1e9.
   */
  double acceleration;
} limpid_super_twisting_explicit_values_t;

/*
 Parameters of `tracking-differentiator` as a person gives them.
 */
typedef struct {
  /*
   largest acceleration that the differentiator expects; rad/s^2, 0.001 to 1e9.
   */
  double acceleration;
  /*
   filter time of the linear region; below a tick it is a tick; s, 1e-6 to 100.
   */
  double filter_time;
} limpid_tracking_differentiator_values_t;

/*
 Parameters of `observer` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_observer_values_t;

/*
 Parameters of `observer-edge` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_observer_edge_values_t;

/*
 Parameters of `adaptive` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_adaptive_values_t;

/*
 Parameters of `adaptive-edge` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_adaptive_edge_values_t;

/*
 Parameters of `imm-adaptive` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_imm_adaptive_values_t;

/*
 Parameters of `imm-adaptive-edge` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_imm_adaptive_edge_values_t;

/*
 Parameters of `observer-soft` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_observer_soft_values_t;

/*
 Parameters of `adaptive-soft` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_adaptive_soft_values_t;

/*
 Parameters of `observer-held` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_observer_held_values_t;

/*
 Parameters of `observer-edge-held` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_observer_edge_held_values_t;

/*
 Parameters of `adaptive-held` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_adaptive_held_values_t;

/*
 Parameters of `adaptive-edge-held` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   share of the slow disturbance torque that is attributed to friction; without unit, 0 to 1.
   */
  double friction_share;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_adaptive_edge_held_values_t;

/*
 Parameters of `observer-edge-blind` as a person gives them.
 */
typedef struct {
  /*
   spectral density of the white torque that the observer expects; N.m/sqrt(Hz), 1e-12 to 1.
   */
  double torque_noise;
  /*
   standard deviation of the slow disturbance torque; N.m, 1e-12 to 1000.
   */
  double load;
  /*
   correlation time of the slow disturbance torque; s, 1e-6 to 1e6.
   */
  double load_time;
  /*
   standard deviation of a boundary's position: disc errors and rounding of the model; counts, 1e-4 to 1000.
   */
  double boundary_noise;
} limpid_observer_edge_blind_values_t;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 `finite-difference`: sets the state to rest at the first sample.
 */
void limpid_finite_difference_start(const limpid_finite_difference_t *parameters,
                                    limpid_finite_difference_state_t *state,
                                    const limpid_sample_t *first);

/*
 `finite-difference`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_finite_difference_update(const limpid_finite_difference_t *parameters,
                                      limpid_finite_difference_state_t *state,
                                      const limpid_sample_t *sample);

/*
 `finite-difference`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_finite_difference_update_over(const limpid_finite_difference_t *parameters,
                                           limpid_finite_difference_state_t *state,
                                           const limpid_sample_t *sample,
                                           float period);

/*
 `finite-difference`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_finite_difference_variance(const limpid_finite_difference_t *parameters,
                                        const limpid_finite_difference_state_t *state);

/*
 `low-pass`: sets the state to rest at the first sample.
 */
void limpid_low_pass_start(const limpid_low_pass_t *parameters,
                           limpid_low_pass_state_t *state,
                           const limpid_sample_t *first);

/*
 `low-pass`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_low_pass_update(const limpid_low_pass_t *parameters,
                             limpid_low_pass_state_t *state,
                             const limpid_sample_t *sample);

/*
 `low-pass`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_low_pass_update_over(const limpid_low_pass_t *parameters,
                                  limpid_low_pass_state_t *state,
                                  const limpid_sample_t *sample,
                                  float period);

/*
 `foaw-end-fit`: sets the state to rest at the first sample.
 */
void limpid_foaw_end_fit_15_start(const limpid_foaw_end_fit_15_t *parameters,
                                  limpid_foaw_end_fit_15_state_t *state,
                                  const limpid_sample_t *first);

/*
 `foaw-end-fit`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_foaw_end_fit_15_update(const limpid_foaw_end_fit_15_t *parameters,
                                    limpid_foaw_end_fit_15_state_t *state,
                                    const limpid_sample_t *sample);

/*
 `foaw-end-fit`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_foaw_end_fit_15_variance(const limpid_foaw_end_fit_15_t *parameters,
                                      const limpid_foaw_end_fit_15_state_t *state);

/*
 `foaw-end-fit`: sets the state to rest at the first sample.
 */
void limpid_foaw_end_fit_64_start(const limpid_foaw_end_fit_64_t *parameters,
                                  limpid_foaw_end_fit_64_state_t *state,
                                  const limpid_sample_t *first);

/*
 `foaw-end-fit`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_foaw_end_fit_64_update(const limpid_foaw_end_fit_64_t *parameters,
                                    limpid_foaw_end_fit_64_state_t *state,
                                    const limpid_sample_t *sample);

/*
 `foaw-end-fit`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_foaw_end_fit_64_variance(const limpid_foaw_end_fit_64_t *parameters,
                                      const limpid_foaw_end_fit_64_state_t *state);

/*
 `foaw-best-fit`: sets the state to rest at the first sample.
 */
void limpid_foaw_best_fit_15_start(const limpid_foaw_best_fit_15_t *parameters,
                                   limpid_foaw_best_fit_15_state_t *state,
                                   const limpid_sample_t *first);

/*
 `foaw-best-fit`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_foaw_best_fit_15_update(const limpid_foaw_best_fit_15_t *parameters,
                                     limpid_foaw_best_fit_15_state_t *state,
                                     const limpid_sample_t *sample);

/*
 `foaw-best-fit`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_foaw_best_fit_15_variance(const limpid_foaw_best_fit_15_t *parameters,
                                       const limpid_foaw_best_fit_15_state_t *state);

/*
 `foaw-best-fit`: sets the state to rest at the first sample.
 */
void limpid_foaw_best_fit_64_start(const limpid_foaw_best_fit_64_t *parameters,
                                   limpid_foaw_best_fit_64_state_t *state,
                                   const limpid_sample_t *first);

/*
 `foaw-best-fit`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_foaw_best_fit_64_update(const limpid_foaw_best_fit_64_t *parameters,
                                     limpid_foaw_best_fit_64_state_t *state,
                                     const limpid_sample_t *sample);

/*
 `foaw-best-fit`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_foaw_best_fit_64_variance(const limpid_foaw_best_fit_64_t *parameters,
                                       const limpid_foaw_best_fit_64_state_t *state);

/*
 `savitzky-golay`: sets the state to rest at the first sample.
 */
void limpid_savitzky_golay_15_start(const limpid_savitzky_golay_15_t *parameters,
                                    limpid_savitzky_golay_15_state_t *state,
                                    const limpid_sample_t *first);

/*
 `savitzky-golay`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_savitzky_golay_15_update(const limpid_savitzky_golay_15_t *parameters,
                                      limpid_savitzky_golay_15_state_t *state,
                                      const limpid_sample_t *sample);

/*
 `savitzky-golay`: sets the state to rest at the first sample.
 */
void limpid_savitzky_golay_64_start(const limpid_savitzky_golay_64_t *parameters,
                                    limpid_savitzky_golay_64_state_t *state,
                                    const limpid_sample_t *first);

/*
 `savitzky-golay`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_savitzky_golay_64_update(const limpid_savitzky_golay_64_t *parameters,
                                      limpid_savitzky_golay_64_state_t *state,
                                      const limpid_sample_t *sample);

/*
 `algebraic`: sets the state to rest at the first sample.
 */
void limpid_algebraic_15_start(const limpid_algebraic_15_t *parameters,
                               limpid_algebraic_15_state_t *state,
                               const limpid_sample_t *first);

/*
 `algebraic`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_algebraic_15_update(const limpid_algebraic_15_t *parameters,
                                 limpid_algebraic_15_state_t *state,
                                 const limpid_sample_t *sample);

/*
 `algebraic`: sets the state to rest at the first sample.
 */
void limpid_algebraic_64_start(const limpid_algebraic_64_t *parameters,
                               limpid_algebraic_64_state_t *state,
                               const limpid_sample_t *first);

/*
 `algebraic`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_algebraic_64_update(const limpid_algebraic_64_t *parameters,
                                 limpid_algebraic_64_state_t *state,
                                 const limpid_sample_t *sample);

/*
 `robust-exact`: sets the state to rest at the first sample.
 */
void limpid_robust_exact_64_start(const limpid_robust_exact_64_t *parameters,
                                  limpid_robust_exact_64_state_t *state,
                                  const limpid_sample_t *first);

/*
 `robust-exact`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_robust_exact_64_update(const limpid_robust_exact_64_t *parameters,
                                    limpid_robust_exact_64_state_t *state,
                                    const limpid_sample_t *sample);

/*
 `kalman-triple`: sets the state to rest at the first sample.
 */
void limpid_kalman_triple_start(const limpid_kalman_triple_t *parameters,
                                limpid_kalman_triple_state_t *state,
                                const limpid_sample_t *first);

/*
 `kalman-triple`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_kalman_triple_update(const limpid_kalman_triple_t *parameters,
                                  limpid_kalman_triple_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `kalman-triple`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_kalman_triple_variance(const limpid_kalman_triple_t *parameters,
                                    const limpid_kalman_triple_state_t *state);

/*
 `kalman-triple`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_kalman_triple_acceleration(const limpid_kalman_triple_t *parameters,
                                        const limpid_kalman_triple_state_t *state);

/*
 `kalman-triple-table`: sets the state to rest at the first sample.
 */
void limpid_kalman_triple_table_24_start(const limpid_kalman_triple_table_24_t *parameters,
                                         limpid_kalman_triple_table_24_state_t *state,
                                         const limpid_sample_t *first);

/*
 `kalman-triple-table`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_kalman_triple_table_24_update(const limpid_kalman_triple_table_24_t *parameters,
                                           limpid_kalman_triple_table_24_state_t *state,
                                           const limpid_sample_t *sample);

/*
 `kalman-triple-table`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_kalman_triple_table_24_variance(const limpid_kalman_triple_table_24_t *parameters,
                                             const limpid_kalman_triple_table_24_state_t *state);

/*
 `kalman-triple-table`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_kalman_triple_table_24_acceleration(const limpid_kalman_triple_table_24_t *parameters,
                                                 const limpid_kalman_triple_table_24_state_t *state);

/*
 `kalman-triple-table`: sets the state to rest at the first sample.
 */
void limpid_kalman_triple_table_168_start(const limpid_kalman_triple_table_168_t *parameters,
                                          limpid_kalman_triple_table_168_state_t *state,
                                          const limpid_sample_t *first);

/*
 `kalman-triple-table`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_kalman_triple_table_168_update(const limpid_kalman_triple_table_168_t *parameters,
                                            limpid_kalman_triple_table_168_state_t *state,
                                            const limpid_sample_t *sample);

/*
 `kalman-triple-table`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_kalman_triple_table_168_variance(const limpid_kalman_triple_table_168_t *parameters,
                                              const limpid_kalman_triple_table_168_state_t *state);

/*
 `kalman-triple-table`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_kalman_triple_table_168_acceleration(const limpid_kalman_triple_table_168_t *parameters,
                                                  const limpid_kalman_triple_table_168_state_t *state);

/*
 `kalman-triple-steady`: sets the state to rest at the first sample.
 */
void limpid_kalman_triple_steady_start(const limpid_kalman_triple_steady_t *parameters,
                                       limpid_kalman_triple_steady_state_t *state,
                                       const limpid_sample_t *first);

/*
 `kalman-triple-steady`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_kalman_triple_steady_update(const limpid_kalman_triple_steady_t *parameters,
                                         limpid_kalman_triple_steady_state_t *state,
                                         const limpid_sample_t *sample);

/*
 `kalman-triple-steady`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_kalman_triple_steady_variance(const limpid_kalman_triple_steady_t *parameters,
                                           const limpid_kalman_triple_steady_state_t *state);

/*
 `kalman-triple-steady`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_kalman_triple_steady_acceleration(const limpid_kalman_triple_steady_t *parameters,
                                               const limpid_kalman_triple_steady_state_t *state);

/*
 `kalman-motor`: sets the state to rest at the first sample.
 */
void limpid_kalman_motor_start(const limpid_kalman_motor_t *parameters,
                               limpid_kalman_motor_state_t *state,
                               const limpid_sample_t *first);

/*
 `kalman-motor`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current.
 */
float limpid_kalman_motor_update(const limpid_kalman_motor_t *parameters,
                                 limpid_kalman_motor_state_t *state,
                                 const limpid_sample_t *sample);

/*
 `kalman-motor`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_kalman_motor_variance(const limpid_kalman_motor_t *parameters,
                                   const limpid_kalman_motor_state_t *state);

/*
 `kalman-motor-steady`: sets the state to rest at the first sample.
 */
void limpid_kalman_motor_steady_start(const limpid_kalman_motor_steady_t *parameters,
                                      limpid_kalman_motor_steady_state_t *state,
                                      const limpid_sample_t *first);

/*
 `kalman-motor-steady`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current.
 */
float limpid_kalman_motor_steady_update(const limpid_kalman_motor_steady_t *parameters,
                                        limpid_kalman_motor_steady_state_t *state,
                                        const limpid_sample_t *sample);

/*
 `kalman-motor-steady`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_kalman_motor_steady_variance(const limpid_kalman_motor_steady_t *parameters,
                                          const limpid_kalman_motor_steady_state_t *state);

/*
 `pll`: sets the state to rest at the first sample.
 */
void limpid_pll_start(const limpid_pll_t *parameters,
                      limpid_pll_state_t *state,
                      const limpid_sample_t *first);

/*
 `pll`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_pll_update(const limpid_pll_t *parameters,
                        limpid_pll_state_t *state,
                        const limpid_sample_t *sample);

/*
 `alpha-beta-gamma`: sets the state to rest at the first sample.
 */
void limpid_alpha_beta_gamma_start(const limpid_alpha_beta_gamma_t *parameters,
                                   limpid_alpha_beta_gamma_state_t *state,
                                   const limpid_sample_t *first);

/*
 `alpha-beta-gamma`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_alpha_beta_gamma_update(const limpid_alpha_beta_gamma_t *parameters,
                                     limpid_alpha_beta_gamma_state_t *state,
                                     const limpid_sample_t *sample);

/*
 `linear-eso`: sets the state to rest at the first sample.
 */
void limpid_linear_eso_start(const limpid_linear_eso_t *parameters,
                             limpid_linear_eso_state_t *state,
                             const limpid_sample_t *first);

/*
 `linear-eso`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current.
 */
float limpid_linear_eso_update(const limpid_linear_eso_t *parameters,
                               limpid_linear_eso_state_t *state,
                               const limpid_sample_t *sample);

/*
 `super-twisting`: sets the state to rest at the first sample.
 */
void limpid_super_twisting_start(const limpid_super_twisting_t *parameters,
                                 limpid_super_twisting_state_t *state,
                                 const limpid_sample_t *first);

/*
 `super-twisting`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_super_twisting_update(const limpid_super_twisting_t *parameters,
                                   limpid_super_twisting_state_t *state,
                                   const limpid_sample_t *sample);

/*
 `super-twisting-explicit`: sets the state to rest at the first sample.
 */
void limpid_super_twisting_explicit_start(const limpid_super_twisting_explicit_t *parameters,
                                          limpid_super_twisting_explicit_state_t *state,
                                          const limpid_sample_t *first);

/*
 `super-twisting-explicit`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_super_twisting_explicit_update(const limpid_super_twisting_explicit_t *parameters,
                                            limpid_super_twisting_explicit_state_t *state,
                                            const limpid_sample_t *sample);

/*
 `tracking-differentiator`: sets the state to rest at the first sample.
 */
void limpid_tracking_differentiator_start(const limpid_tracking_differentiator_t *parameters,
                                          limpid_tracking_differentiator_state_t *state,
                                          const limpid_sample_t *first);

/*
 `tracking-differentiator`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_tracking_differentiator_update(const limpid_tracking_differentiator_t *parameters,
                                            limpid_tracking_differentiator_state_t *state,
                                            const limpid_sample_t *sample);

/*
 `m-over-t`: sets the state to rest at the first sample.
 */
void limpid_m_over_t_start(const limpid_m_over_t_t *parameters,
                           limpid_m_over_t_state_t *state,
                           const limpid_sample_t *first);

/*
 `m-over-t`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, has_edge, edge_boundary, edge_age.
 */
float limpid_m_over_t_update(const limpid_m_over_t_t *parameters,
                             limpid_m_over_t_state_t *state,
                             const limpid_sample_t *sample);

/*
 `m-over-t`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_m_over_t_update_over(const limpid_m_over_t_t *parameters,
                                  limpid_m_over_t_state_t *state,
                                  const limpid_sample_t *sample,
                                  float period);

/*
 `m-over-t-learned`: sets the state to rest at the first sample.
 */
void limpid_m_over_t_learned_start(const limpid_m_over_t_learned_t *parameters,
                                   limpid_m_over_t_learned_state_t *state,
                                   const limpid_sample_t *first);

/*
 `m-over-t-learned`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, has_edge, edge_boundary, edge_age.
 */
float limpid_m_over_t_learned_update(const limpid_m_over_t_learned_t *parameters,
                                     limpid_m_over_t_learned_state_t *state,
                                     const limpid_sample_t *sample);

/*
 `m-over-t-learned`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_m_over_t_learned_update_over(const limpid_m_over_t_learned_t *parameters,
                                          limpid_m_over_t_learned_state_t *state,
                                          const limpid_sample_t *sample,
                                          float period);

/*
 `imm`: sets the state to rest at the first sample.
 */
void limpid_imm_start(const limpid_imm_t *parameters,
                      limpid_imm_state_t *state,
                      const limpid_sample_t *first);

/*
 `imm`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_imm_update(const limpid_imm_t *parameters,
                        limpid_imm_state_t *state,
                        const limpid_sample_t *sample);

/*
 `imm`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_imm_update_over(const limpid_imm_t *parameters,
                             limpid_imm_state_t *state,
                             const limpid_sample_t *sample,
                             float period);

/*
 `imm`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_variance(const limpid_imm_t *parameters, const limpid_imm_state_t *state);

/*
 `imm`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_acceleration(const limpid_imm_t *parameters, const limpid_imm_state_t *state);

/*
 `imm-edge`: sets the state to rest at the first sample.
 */
void limpid_imm_edge_start(const limpid_imm_edge_t *parameters,
                           limpid_imm_edge_state_t *state,
                           const limpid_sample_t *first);

/*
 `imm-edge`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, has_edge, edge_boundary, edge_age.
 */
float limpid_imm_edge_update(const limpid_imm_edge_t *parameters,
                             limpid_imm_edge_state_t *state,
                             const limpid_sample_t *sample);

/*
 `imm-edge`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_imm_edge_update_over(const limpid_imm_edge_t *parameters,
                                  limpid_imm_edge_state_t *state,
                                  const limpid_sample_t *sample,
                                  float period);

/*
 `imm-edge`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_edge_variance(const limpid_imm_edge_t *parameters, const limpid_imm_edge_state_t *state);

/*
 `imm-edge`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_edge_acceleration(const limpid_imm_edge_t *parameters, const limpid_imm_edge_state_t *state);

/*
 `imm-pair`: sets the state to rest at the first sample.
 */
void limpid_imm_pair_start(const limpid_imm_pair_t *parameters,
                           limpid_imm_pair_state_t *state,
                           const limpid_sample_t *first);

/*
 `imm-pair`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count.
 */
float limpid_imm_pair_update(const limpid_imm_pair_t *parameters,
                             limpid_imm_pair_state_t *state,
                             const limpid_sample_t *sample);

/*
 `imm-pair`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.
 */
float limpid_imm_pair_update_over(const limpid_imm_pair_t *parameters,
                                  limpid_imm_pair_state_t *state,
                                  const limpid_sample_t *sample,
                                  float period);

/*
 `imm-pair`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_pair_variance(const limpid_imm_pair_t *parameters, const limpid_imm_pair_state_t *state);

/*
 `imm-pair`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_pair_acceleration(const limpid_imm_pair_t *parameters, const limpid_imm_pair_state_t *state);

/*
 `imm-motor`: sets the state to rest at the first sample.
 */
void limpid_imm_motor_start(const limpid_imm_motor_t *parameters,
                            limpid_imm_motor_state_t *state,
                            const limpid_sample_t *first);

/*
 `imm-motor`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current.
 */
float limpid_imm_motor_update(const limpid_imm_motor_t *parameters,
                              limpid_imm_motor_state_t *state,
                              const limpid_sample_t *sample);

/*
 `imm-motor`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_motor_variance(const limpid_imm_motor_t *parameters, const limpid_imm_motor_state_t *state);

/*
 `imm-motor`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_motor_acceleration(const limpid_imm_motor_t *parameters,
                                    const limpid_imm_motor_state_t *state);

/*
 `imm-motor-edge`: sets the state to rest at the first sample.
 */
void limpid_imm_motor_edge_start(const limpid_imm_motor_edge_t *parameters,
                                 limpid_imm_motor_edge_state_t *state,
                                 const limpid_sample_t *first);

/*
 `imm-motor-edge`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current, has_edge, edge_boundary, edge_age.
 */
float limpid_imm_motor_edge_update(const limpid_imm_motor_edge_t *parameters,
                                   limpid_imm_motor_edge_state_t *state,
                                   const limpid_sample_t *sample);

/*
 `imm-motor-edge`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_motor_edge_variance(const limpid_imm_motor_edge_t *parameters,
                                     const limpid_imm_motor_edge_state_t *state);

/*
 `imm-motor-edge`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_motor_edge_acceleration(const limpid_imm_motor_edge_t *parameters,
                                         const limpid_imm_motor_edge_state_t *state);

/*
 `observer`: sets the state to rest at the first sample.
 */
void limpid_observer_start(const limpid_observer_t *parameters,
                           limpid_observer_state_t *state,
                           const limpid_sample_t *first);

/*
 `observer`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current.
 */
float limpid_observer_update(const limpid_observer_t *parameters,
                             limpid_observer_state_t *state,
                             const limpid_sample_t *sample);

/*
 `observer`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_observer_variance(const limpid_observer_t *parameters, const limpid_observer_state_t *state);

/*
 `observer-edge`: sets the state to rest at the first sample.
 */
void limpid_observer_edge_start(const limpid_observer_edge_t *parameters,
                                limpid_observer_edge_state_t *state,
                                const limpid_sample_t *first);

/*
 `observer-edge`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current, has_edge, edge_boundary, edge_age.
 */
float limpid_observer_edge_update(const limpid_observer_edge_t *parameters,
                                  limpid_observer_edge_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `observer-edge`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_observer_edge_variance(const limpid_observer_edge_t *parameters,
                                    const limpid_observer_edge_state_t *state);

/*
 `adaptive`: sets the state to rest at the first sample.
 */
void limpid_adaptive_start(const limpid_adaptive_t *parameters,
                           limpid_adaptive_state_t *state,
                           const limpid_sample_t *first);

/*
 `adaptive`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current.
 */
float limpid_adaptive_update(const limpid_adaptive_t *parameters,
                             limpid_adaptive_state_t *state,
                             const limpid_sample_t *sample);

/*
 `adaptive`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_adaptive_variance(const limpid_adaptive_t *parameters, const limpid_adaptive_state_t *state);

/*
 `adaptive`: ratio of the learned damping to the assumed one.
 */
float limpid_adaptive_damping_ratio(const limpid_adaptive_t *parameters,
                                    const limpid_adaptive_state_t *state);

/*
 `adaptive-edge`: sets the state to rest at the first sample.
 */
void limpid_adaptive_edge_start(const limpid_adaptive_edge_t *parameters,
                                limpid_adaptive_edge_state_t *state,
                                const limpid_sample_t *first);

/*
 `adaptive-edge`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current, has_edge, edge_boundary, edge_age.
 */
float limpid_adaptive_edge_update(const limpid_adaptive_edge_t *parameters,
                                  limpid_adaptive_edge_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `adaptive-edge`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_adaptive_edge_variance(const limpid_adaptive_edge_t *parameters,
                                    const limpid_adaptive_edge_state_t *state);

/*
 `adaptive-edge`: ratio of the learned damping to the assumed one.
 */
float limpid_adaptive_edge_damping_ratio(const limpid_adaptive_edge_t *parameters,
                                         const limpid_adaptive_edge_state_t *state);

/*
 `imm-adaptive`: sets the state to rest at the first sample.
 */
void limpid_imm_adaptive_start(const limpid_imm_adaptive_t *parameters,
                               limpid_imm_adaptive_state_t *state,
                               const limpid_sample_t *first);

/*
 `imm-adaptive`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current.
 */
float limpid_imm_adaptive_update(const limpid_imm_adaptive_t *parameters,
                                 limpid_imm_adaptive_state_t *state,
                                 const limpid_sample_t *sample);

/*
 `imm-adaptive`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_adaptive_variance(const limpid_imm_adaptive_t *parameters,
                                   const limpid_imm_adaptive_state_t *state);

/*
 `imm-adaptive`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_adaptive_acceleration(const limpid_imm_adaptive_t *parameters,
                                       const limpid_imm_adaptive_state_t *state);

/*
 `imm-adaptive-edge`: sets the state to rest at the first sample.
 */
void limpid_imm_adaptive_edge_start(const limpid_imm_adaptive_edge_t *parameters,
                                    limpid_imm_adaptive_edge_state_t *state,
                                    const limpid_sample_t *first);

/*
 `imm-adaptive-edge`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current, has_edge, edge_boundary, edge_age.
 */
float limpid_imm_adaptive_edge_update(const limpid_imm_adaptive_edge_t *parameters,
                                      limpid_imm_adaptive_edge_state_t *state,
                                      const limpid_sample_t *sample);

/*
 `imm-adaptive-edge`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_imm_adaptive_edge_variance(const limpid_imm_adaptive_edge_t *parameters,
                                        const limpid_imm_adaptive_edge_state_t *state);

/*
 `imm-adaptive-edge`: acceleration at the latest sample, counts per tick^2.
 */
float limpid_imm_adaptive_edge_acceleration(const limpid_imm_adaptive_edge_t *parameters,
                                            const limpid_imm_adaptive_edge_state_t *state);

/*
 `observer-soft`: sets the state to rest at the first sample.
 */
void limpid_observer_soft_start(const limpid_observer_soft_t *parameters,
                                limpid_observer_soft_state_t *state,
                                const limpid_sample_t *first);

/*
 `observer-soft`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current.
 */
float limpid_observer_soft_update(const limpid_observer_soft_t *parameters,
                                  limpid_observer_soft_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `observer-soft`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_observer_soft_variance(const limpid_observer_soft_t *parameters,
                                    const limpid_observer_soft_state_t *state);

/*
 `adaptive-soft`: sets the state to rest at the first sample.
 */
void limpid_adaptive_soft_start(const limpid_adaptive_soft_t *parameters,
                                limpid_adaptive_soft_state_t *state,
                                const limpid_sample_t *first);

/*
 `adaptive-soft`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, coupled, current.
 */
float limpid_adaptive_soft_update(const limpid_adaptive_soft_t *parameters,
                                  limpid_adaptive_soft_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `adaptive-soft`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_adaptive_soft_variance(const limpid_adaptive_soft_t *parameters,
                                    const limpid_adaptive_soft_state_t *state);

/*
 `adaptive-soft`: ratio of the learned damping to the assumed one.
 */
float limpid_adaptive_soft_damping_ratio(const limpid_adaptive_soft_t *parameters,
                                         const limpid_adaptive_soft_state_t *state);

/*
 `observer-held`: sets the state to rest at the first sample.
 */
void limpid_observer_held_start(const limpid_observer_held_t *parameters,
                                limpid_observer_held_state_t *state,
                                const limpid_sample_t *first);

/*
 `observer-held`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current.
 */
float limpid_observer_held_update(const limpid_observer_held_t *parameters,
                                  limpid_observer_held_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `observer-held`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_observer_held_variance(const limpid_observer_held_t *parameters,
                                    const limpid_observer_held_state_t *state);

/*
 `observer-edge-held`: sets the state to rest at the first sample.
 */
void limpid_observer_edge_held_start(const limpid_observer_edge_held_t *parameters,
                                     limpid_observer_edge_held_state_t *state,
                                     const limpid_sample_t *first);

/*
 `observer-edge-held`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current, has_edge, edge_boundary, edge_age.
 */
float limpid_observer_edge_held_update(const limpid_observer_edge_held_t *parameters,
                                       limpid_observer_edge_held_state_t *state,
                                       const limpid_sample_t *sample);

/*
 `observer-edge-held`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_observer_edge_held_variance(const limpid_observer_edge_held_t *parameters,
                                         const limpid_observer_edge_held_state_t *state);

/*
 `adaptive-held`: sets the state to rest at the first sample.
 */
void limpid_adaptive_held_start(const limpid_adaptive_held_t *parameters,
                                limpid_adaptive_held_state_t *state,
                                const limpid_sample_t *first);

/*
 `adaptive-held`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current.
 */
float limpid_adaptive_held_update(const limpid_adaptive_held_t *parameters,
                                  limpid_adaptive_held_state_t *state,
                                  const limpid_sample_t *sample);

/*
 `adaptive-held`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_adaptive_held_variance(const limpid_adaptive_held_t *parameters,
                                    const limpid_adaptive_held_state_t *state);

/*
 `adaptive-edge-held`: sets the state to rest at the first sample.
 */
void limpid_adaptive_edge_held_start(const limpid_adaptive_edge_held_t *parameters,
                                     limpid_adaptive_edge_held_state_t *state,
                                     const limpid_sample_t *first);

/*
 `adaptive-edge-held`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, current, has_edge, edge_boundary, edge_age.
 */
float limpid_adaptive_edge_held_update(const limpid_adaptive_edge_held_t *parameters,
                                       limpid_adaptive_edge_held_state_t *state,
                                       const limpid_sample_t *sample);

/*
 `adaptive-edge-held`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_adaptive_edge_held_variance(const limpid_adaptive_edge_held_t *parameters,
                                         const limpid_adaptive_edge_held_state_t *state);

/*
 `observer-edge-blind`: sets the state to rest at the first sample.
 */
void limpid_observer_edge_blind_start(const limpid_observer_edge_blind_t *parameters,
                                      limpid_observer_edge_blind_state_t *state,
                                      const limpid_sample_t *first);

/*
 `observer-edge-blind`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: count, has_edge, edge_boundary, edge_age.
 */
float limpid_observer_edge_blind_update(const limpid_observer_edge_blind_t *parameters,
                                        limpid_observer_edge_blind_state_t *state,
                                        const limpid_sample_t *sample);

/*
 `observer-edge-blind`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.
 */
float limpid_observer_edge_blind_variance(const limpid_observer_edge_blind_t *parameters,
                                          const limpid_observer_edge_blind_state_t *state);

/*
 Standard deviation of a variance, correct to the last digit; at most four divisions for a normal number.
 */
float limpid_std_dev(float variance);

/*
 Designs `finite-difference`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_finite_difference_design(limpid_finite_difference_t *into, const limpid_setup_t *setup);

/*
 Designs `low-pass`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_low_pass_design(limpid_low_pass_t *into,
                               const limpid_setup_t *setup,
                               const limpid_low_pass_values_t *values);

/*
 Designs `foaw-end-fit`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_foaw_end_fit_15_design(limpid_foaw_end_fit_15_t *into,
                                      const limpid_setup_t *setup,
                                      const limpid_foaw_end_fit_values_t *values);

/*
 Designs `foaw-end-fit`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_foaw_end_fit_64_design(limpid_foaw_end_fit_64_t *into,
                                      const limpid_setup_t *setup,
                                      const limpid_foaw_end_fit_values_t *values);

/*
 Designs `foaw-best-fit`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_foaw_best_fit_15_design(limpid_foaw_best_fit_15_t *into,
                                       const limpid_setup_t *setup,
                                       const limpid_foaw_best_fit_values_t *values);

/*
 Designs `foaw-best-fit`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_foaw_best_fit_64_design(limpid_foaw_best_fit_64_t *into,
                                       const limpid_setup_t *setup,
                                       const limpid_foaw_best_fit_values_t *values);

/*
 Designs `savitzky-golay`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_savitzky_golay_15_design(limpid_savitzky_golay_15_t *into,
                                        const limpid_setup_t *setup,
                                        const limpid_savitzky_golay_values_t *values);

/*
 Designs `savitzky-golay`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_savitzky_golay_64_design(limpid_savitzky_golay_64_t *into,
                                        const limpid_setup_t *setup,
                                        const limpid_savitzky_golay_values_t *values);

/*
 Designs `algebraic`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_algebraic_15_design(limpid_algebraic_15_t *into,
                                   const limpid_setup_t *setup,
                                   const limpid_algebraic_values_t *values);

/*
 Designs `algebraic`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_algebraic_64_design(limpid_algebraic_64_t *into,
                                   const limpid_setup_t *setup,
                                   const limpid_algebraic_values_t *values);

/*
 Designs `robust-exact`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_robust_exact_64_design(limpid_robust_exact_64_t *into,
                                      const limpid_setup_t *setup,
                                      const limpid_robust_exact_values_t *values);

/*
 Designs `kalman-triple`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_kalman_triple_design(limpid_kalman_triple_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_kalman_triple_values_t *values);

/*
 Designs `kalman-triple-table`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_kalman_triple_table_24_design(limpid_kalman_triple_table_24_t *into,
                                             const limpid_setup_t *setup,
                                             const limpid_kalman_triple_table_values_t *values);

/*
 Designs `kalman-triple-table`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_kalman_triple_table_168_design(limpid_kalman_triple_table_168_t *into,
                                              const limpid_setup_t *setup,
                                              const limpid_kalman_triple_table_values_t *values);

/*
 Designs `kalman-triple-steady`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_kalman_triple_steady_design(limpid_kalman_triple_steady_t *into,
                                           const limpid_setup_t *setup,
                                           const limpid_kalman_triple_steady_values_t *values);

/*
 Designs `kalman-motor`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_kalman_motor_design(limpid_kalman_motor_t *into,
                                   const limpid_setup_t *setup,
                                   const limpid_kalman_motor_values_t *values);

/*
 Designs `kalman-motor-steady`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_kalman_motor_steady_design(limpid_kalman_motor_steady_t *into,
                                          const limpid_setup_t *setup,
                                          const limpid_kalman_motor_steady_values_t *values);

/*
 Designs `pll`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_pll_design(limpid_pll_t *into, const limpid_setup_t *setup, const limpid_pll_values_t *values);

/*
 Designs `alpha-beta-gamma`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_alpha_beta_gamma_design(limpid_alpha_beta_gamma_t *into,
                                       const limpid_setup_t *setup,
                                       const limpid_alpha_beta_gamma_values_t *values);

/*
 Designs `linear-eso`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_linear_eso_design(limpid_linear_eso_t *into,
                                 const limpid_setup_t *setup,
                                 const limpid_linear_eso_values_t *values);

/*
 Designs `super-twisting`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_super_twisting_design(limpid_super_twisting_t *into,
                                     const limpid_setup_t *setup,
                                     const limpid_super_twisting_values_t *values);

/*
 Designs `super-twisting-explicit`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_super_twisting_explicit_design(limpid_super_twisting_explicit_t *into,
                                              const limpid_setup_t *setup,
                                              const limpid_super_twisting_explicit_values_t *values);

/*
 Designs `tracking-differentiator`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_tracking_differentiator_design(limpid_tracking_differentiator_t *into,
                                              const limpid_setup_t *setup,
                                              const limpid_tracking_differentiator_values_t *values);

/*
 Designs `m-over-t`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_m_over_t_design(limpid_m_over_t_t *into, const limpid_setup_t *setup);

/*
 Designs `m-over-t-learned`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_m_over_t_learned_design(limpid_m_over_t_learned_t *into, const limpid_setup_t *setup);

/*
 Designs `imm`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_design(limpid_imm_t *into, const limpid_setup_t *setup);

/*
 Designs `imm-edge`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_edge_design(limpid_imm_edge_t *into, const limpid_setup_t *setup);

/*
 Designs `imm-pair`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_pair_design(limpid_imm_pair_t *into, const limpid_setup_t *setup);

/*
 Designs `imm-motor`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_motor_design(limpid_imm_motor_t *into, const limpid_setup_t *setup);

/*
 Designs `imm-motor-edge`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_motor_edge_design(limpid_imm_motor_edge_t *into, const limpid_setup_t *setup);

/*
 Designs `observer`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_observer_design(limpid_observer_t *into,
                               const limpid_setup_t *setup,
                               const limpid_observer_values_t *values);

/*
 Designs `observer-edge`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_observer_edge_design(limpid_observer_edge_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_observer_edge_values_t *values);

/*
 Designs `adaptive`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_adaptive_design(limpid_adaptive_t *into,
                               const limpid_setup_t *setup,
                               const limpid_adaptive_values_t *values);

/*
 Designs `adaptive-edge`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_adaptive_edge_design(limpid_adaptive_edge_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_adaptive_edge_values_t *values);

/*
 Designs `imm-adaptive`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_adaptive_design(limpid_imm_adaptive_t *into,
                                   const limpid_setup_t *setup,
                                   const limpid_imm_adaptive_values_t *values);

/*
 Designs `imm-adaptive-edge`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_imm_adaptive_edge_design(limpid_imm_adaptive_edge_t *into,
                                        const limpid_setup_t *setup,
                                        const limpid_imm_adaptive_edge_values_t *values);

/*
 Designs `observer-soft`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_observer_soft_design(limpid_observer_soft_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_observer_soft_values_t *values);

/*
 Designs `adaptive-soft`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_adaptive_soft_design(limpid_adaptive_soft_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_adaptive_soft_values_t *values);

/*
 Designs `observer-held`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_observer_held_design(limpid_observer_held_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_observer_held_values_t *values);

/*
 Designs `observer-edge-held`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_observer_edge_held_design(limpid_observer_edge_held_t *into,
                                         const limpid_setup_t *setup,
                                         const limpid_observer_edge_held_values_t *values);

/*
 Designs `adaptive-held`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_adaptive_held_design(limpid_adaptive_held_t *into,
                                    const limpid_setup_t *setup,
                                    const limpid_adaptive_held_values_t *values);

/*
 Designs `adaptive-edge-held`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_adaptive_edge_held_design(limpid_adaptive_edge_held_t *into,
                                         const limpid_setup_t *setup,
                                         const limpid_adaptive_edge_held_values_t *values);

/*
 Designs `observer-edge-blind`: writes its parameters. Returns 0, or a status and writes nothing.
 */
int32_t limpid_observer_edge_blind_design(limpid_observer_edge_blind_t *into,
                                          const limpid_setup_t *setup,
                                          const limpid_observer_edge_blind_values_t *values);

/*
 The text of a status.
 */
const char *limpid_status_text(int32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#define LIMPID_VERSION "0.1.0"

/* EACH(name) for every estimator: limpid_##name##_t, limpid_##name##_update and so on. */
#define LIMPID_ESTIMATORS(EACH) \
    EACH(finite_difference) \
    EACH(low_pass) \
    EACH(foaw_end_fit_15) \
    EACH(foaw_end_fit_64) \
    EACH(foaw_best_fit_15) \
    EACH(foaw_best_fit_64) \
    EACH(savitzky_golay_15) \
    EACH(savitzky_golay_64) \
    EACH(algebraic_15) \
    EACH(algebraic_64) \
    EACH(robust_exact_64) \
    EACH(kalman_triple) \
    EACH(kalman_triple_table_24) \
    EACH(kalman_triple_table_168) \
    EACH(kalman_triple_steady) \
    EACH(kalman_motor) \
    EACH(kalman_motor_steady) \
    EACH(pll) \
    EACH(alpha_beta_gamma) \
    EACH(linear_eso) \
    EACH(super_twisting) \
    EACH(super_twisting_explicit) \
    EACH(tracking_differentiator) \
    EACH(m_over_t) \
    EACH(m_over_t_learned) \
    EACH(imm) \
    EACH(imm_edge) \
    EACH(imm_pair) \
    EACH(imm_motor) \
    EACH(imm_motor_edge) \
    EACH(observer) \
    EACH(observer_edge) \
    EACH(adaptive) \
    EACH(adaptive_edge) \
    EACH(imm_adaptive) \
    EACH(imm_adaptive_edge) \
    EACH(observer_soft) \
    EACH(adaptive_soft) \
    EACH(observer_held) \
    EACH(observer_edge_held) \
    EACH(adaptive_held) \
    EACH(adaptive_edge_held) \
    EACH(observer_edge_blind)

/* The value as this type: the conversion that the language of the program takes without a warning. */
#ifdef __cplusplus
#define LIMPID_AS(type, value) static_cast<type>(value)
#else
#define LIMPID_AS(type, value) ((type)(value))
#endif

/* A velocity in counts per tick as rad/s, float. The factor is a constant if its arguments are. */
#define LIMPID_RAD_PER_S(velocity, counts_per_rev, rate_hz) \
    ((velocity) * LIMPID_AS(float, 2.0 * 3.14159265358979323846 * LIMPID_AS(double, rate_hz) / LIMPID_AS(double, counts_per_rev)))

/* An acceleration in counts per tick^2 as rad/s^2, float. */
#define LIMPID_RAD_PER_S2(acceleration, counts_per_rev, rate_hz) \
    (LIMPID_RAD_PER_S(acceleration, counts_per_rev, rate_hz) * LIMPID_AS(float, rate_hz))

/* A sample with a count and nothing else. */
static inline limpid_sample_t limpid_count(uint32_t count)
{
    limpid_sample_t sample = {0, 0, 0.0f, 0, 0, 0};
    sample.count = count;
    return sample;
}

/* The count after `before` that a counter of 16 bits shows as `counter`: the nearest one. */
static inline uint32_t limpid_extended(uint32_t before, uint16_t counter)
{
    uint32_t moved = (counter - before) & 0xffffu;
    return before + (moved < 0x8000u ? moved : moved - 0x10000u);
}

#endif
