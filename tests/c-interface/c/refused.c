/* Designs that are refused. Standard output has a line for each: the name of the status that it must have, 1 if
 * it has it, 1 if the storage is unchanged, the status, its text. */
#include <stdio.h>
#include <string.h>

#include "limpid.h"

/* A device at 1 kHz: of each design one value is another one. */
static const limpid_setup_t DEVICE = {4096u, 20000u, 1000.0, 84e6, 2e-5, 1e-3, 0.05, 2e-3, 1e-4};
static const limpid_observer_values_t OBSERVER = {1e-4, 1e-2, 1.0, 0.5, 0.3};

static void report(const char *name, int32_t expected, int32_t status, const unsigned char *bytes, size_t size)
{
    size_t k, unchanged = 1;
    for (k = 0; k < size; k++) unchanged &= bytes[k] == 0xA5;
    printf("%s %d %d %d %s\n", name, status == expected, (int)unchanged, (int)status, limpid_status_text(status));
}

#define REFUSED(name, expected, type, design)                                \
    do {                                                                     \
        limpid_##type##_t into;                                              \
        int32_t status;                                                      \
        memset(&into, 0xA5, sizeof into);                                    \
        status = design;                                                     \
        report(name, expected, status, (unsigned char *)&into, sizeof into); \
    } while (0)

/* A design with parameters, and one without. */
#define WITH(expected, type, field, wrong, values)                                          \
    do {                                                                                    \
        limpid_setup_t setup = DEVICE;                                                      \
        setup.field = wrong;                                                                \
        REFUSED(#expected, expected, type, limpid_##type##_design(&into, &setup, &values)); \
    } while (0)

#define WITHOUT(expected, type, field, wrong)                                      \
    do {                                                                           \
        limpid_setup_t setup = DEVICE;                                             \
        setup.field = wrong;                                                       \
        REFUSED(#expected, expected, type, limpid_##type##_design(&into, &setup)); \
    } while (0)

int main(void)
{
    static const limpid_observer_soft_values_t loud = {1.0, 1e-2, 1.0, 0.5, 0.3};
    static const limpid_foaw_end_fit_values_t whole = {15.0, 1.0}, half = {15.5, 1.0}, none = {0.0, 1.0};
    static const limpid_foaw_end_fit_values_t above = {129.0, 1.0}, wide = {64.0, 1.0}, negative = {15.0, -1.0};
    static const limpid_low_pass_values_t low = {20.0}, high = {600.0};
    static const limpid_pll_values_t fast = {600.0};
    static const limpid_kalman_motor_values_t current = {0.1};
    static const limpid_kalman_triple_values_t jerk = {1e3};
    static const limpid_kalman_triple_steady_values_t still = {1e-9};
    static const limpid_kalman_triple_table_values_t slow = {1.0};
    static const limpid_super_twisting_values_t abrupt = {1e9};
    static const limpid_tracking_differentiator_values_t long_filter = {60.0, 100.0};
    limpid_low_pass_values_t no_number = {0.0};
    static const limpid_kalman_motor_values_t quiet = {1e-9};
    static const limpid_kalman_triple_values_t jolt = {1e12}, smooth = {1e-9};
    limpid_observer_values_t share = OBSERVER, unloaded = OBSERVER;
    limpid_foaw_end_fit_15_t accepted;
    no_number.cutoff_hz = no_number.cutoff_hz / no_number.cutoff_hz;
    share.friction_share = 1.5;
    unloaded.torque_noise = 1.0;
    unloaded.load = 1e-12;

    memset(&accepted, 0xA5, sizeof accepted);
    report("LIMPID_OK", LIMPID_OK, limpid_foaw_end_fit_15_design(&accepted, &DEVICE, &whole),
           (unsigned char *)&accepted, sizeof accepted);

    WITH(LIMPID_ERROR_RANGE, foaw_end_fit_15, rate_hz, 1000.0, half);
    WITH(LIMPID_ERROR_RANGE, foaw_end_fit_15, rate_hz, 1000.0, none);
    WITH(LIMPID_ERROR_RANGE, foaw_end_fit_15, rate_hz, 1000.0, above);
    WITH(LIMPID_ERROR_RANGE, foaw_end_fit_15, rate_hz, 1000.0, negative);
    WITH(LIMPID_ERROR_RANGE, low_pass, rate_hz, 1000.0, no_number);
    WITH(LIMPID_ERROR_RANGE, observer, rate_hz, 1000.0, share);
    WITH(LIMPID_ERROR_RATE, low_pass, rate_hz, 0.0, low);
    WITH(LIMPID_ERROR_RATE_FOR_DAMPING, kalman_motor, damping, 1e3, current);
    WITH(LIMPID_ERROR_RATE_FOR_CURRENT, observer, torque_constant, 1e9, OBSERVER);
    WITH(LIMPID_ERROR_RATE_FOR_FRICTION, observer, coulomb_friction, 1e9, OBSERVER);
    WITHOUT(LIMPID_ERROR_RATE_OF_BANK, imm, rate_hz, 50.0);
    WITHOUT(LIMPID_ERROR_RATE, finite_difference, rate_hz, 0.0);
    WITHOUT(LIMPID_ERROR_RATE, finite_difference, rate_hz, no_number.cutoff_hz);
    WITHOUT(LIMPID_ERROR_RATE, finite_difference, rate_hz, -1000.0);
    WITHOUT(LIMPID_ERROR_COUNTS_PER_REV, finite_difference, counts_per_rev, 0u);
    WITHOUT(LIMPID_ERROR_COUNTS_PER_REV, imm, counts_per_rev, 0u);
    WITH(LIMPID_ERROR_COUNTS_PER_REV, low_pass, counts_per_rev, 0u, low);
    WITHOUT(LIMPID_ERROR_CLOCK, m_over_t, edge_clock_hz, 500.0);
    WITH(LIMPID_ERROR_CUTOFF, low_pass, rate_hz, 1000.0, high);
    WITH(LIMPID_ERROR_BANDWIDTH, pll, rate_hz, 1000.0, fast);
    WITH(LIMPID_ERROR_ACCELERATION, super_twisting, rate_hz, 1.0, abrupt);
    WITH(LIMPID_ERROR_FILTER_TIME, tracking_differentiator, rate_hz, 1000.0, long_filter);
    WITH(LIMPID_ERROR_WINDOW, foaw_end_fit_15, rate_hz, 1000.0, wide);
    WITH(LIMPID_ERROR_COUNTS_PER_REV, kalman_triple, counts_per_rev, 0u, jerk);
    WITH(LIMPID_ERROR_INERTIA, kalman_motor, inertia, 0.0, current);
    WITH(LIMPID_ERROR_DAMPING, kalman_motor, damping, -1.0, current);
    WITH(LIMPID_ERROR_TORQUE_CONSTANT, kalman_motor, torque_constant, 0.0, current);
    WITH(LIMPID_ERROR_COULOMB_FRICTION, observer, coulomb_friction, -1.0, OBSERVER);
    WITH(LIMPID_ERROR_AMPLIFIER_LAG, observer, amplifier_lag, -1.0, OBSERVER);
    WITH(LIMPID_ERROR_COUPLED_COUNTS_PER_REV, observer, coupled_counts_per_rev, 0u, OBSERVER);
    WITH(LIMPID_ERROR_JERK_DENSITY, kalman_triple, rate_hz, 1e70, smooth);
    WITH(LIMPID_ERROR_CURRENT_NOISE, kalman_motor, rate_hz, 1e80, quiet);
    WITH(LIMPID_ERROR_TORQUE_NOISE, observer, inertia, 1e300, OBSERVER);
    WITH(LIMPID_ERROR_DISTURBANCE, observer, inertia, 6e151, unloaded);
    WITH(LIMPID_ERROR_PROCESS_NOISE, kalman_triple, rate_hz, 1000.0, jolt);
    WITH(LIMPID_ERROR_TORQUE_NOISE_FOR_QUANTISED, observer_soft, rate_hz, 1000.0, loud);
    WITH(LIMPID_ERROR_NOT_CONVERGED, kalman_triple_steady, rate_hz, 1000.0, still);
    WITH(LIMPID_ERROR_TABLE, kalman_triple_table_24, rate_hz, 1000.0, slow);
    return 0;
}
