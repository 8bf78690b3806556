/* Velocity from the counts of a quadrature encoder. VERSION_OF_LIMPID
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
