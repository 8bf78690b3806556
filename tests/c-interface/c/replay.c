/* Runs estimators over samples. Standard input has jobs until its end: the length of a name, the name,
 * the number of samples, the samples. Standard output has a job's results: per update the velocity, the
 * variance, the acceleration and the damping ratio, each 0 if the estimator does not report it. A first run
 * has the parameters of parameters.h, a second one those that the library designs, a third one updates over
 * intervals of one period, if the estimator takes them. WITHOUT_DESIGN leaves out the second one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "limpid.h"
#include "parameters.h"
#ifndef WITHOUT_DESIGN
#include "designs.h"
#endif

static void put(float value)
{
    if (fwrite(&value, sizeof value, 1, stdout) != 1) exit(3);
}

#define NONE(...) 0.0f

#define REPLAY(name, variance, acceleration, damping_ratio)                                                 \
    static void replay_##name(const limpid_##name##_t *parameters, const limpid_sample_t *samples, size_t n) \
    {                                                                                                       \
        limpid_##name##_state_t state;                                                                      \
        size_t k;                                                                                           \
        limpid_##name##_start(parameters, &state, &samples[0]);                                             \
        for (k = 1; k < n; k++) {                                                                           \
            put(limpid_##name##_update(parameters, &state, &samples[k]));                                   \
            put(variance(parameters, &state));                                                              \
            put(acceleration(parameters, &state));                                                          \
            put(damping_ratio(parameters, &state));                                                         \
        }                                                                                                   \
    }

CASES(REPLAY)

#define REPLAY_OVER(name)                                                                   \
    static void replay_over_##name(const limpid_sample_t *samples, size_t n)                \
    {                                                                                       \
        limpid_##name##_state_t state;                                                      \
        size_t k;                                                                           \
        limpid_##name##_start(&limpid_##name##_parameters, &state, &samples[0]);            \
        for (k = 1; k < n; k++)                                                             \
            put(limpid_##name##_update_over(&limpid_##name##_parameters, &state, &samples[k], 1.0f)); \
    }

VARYING(REPLAY_OVER)

#ifdef WITHOUT_DESIGN
#define RUN_DESIGNED(one)
#else
#define RUN_DESIGNED(one)                                                \
    limpid_##one##_t designed;                                           \
    int32_t status = design_##one(&designed);                            \
    if (status != LIMPID_OK) {                                           \
        fprintf(stderr, "%s: %s\n", name, limpid_status_text(status));   \
        exit(4);                                                         \
    }                                                                    \
    replay_##one(&designed, samples, n);
#endif

static void run(const char *name, const limpid_sample_t *samples, size_t n)
{
#define RUN(one, variance, acceleration, damping_ratio)       \
    if (strcmp(name, #one) == 0) {                            \
        replay_##one(&limpid_##one##_parameters, samples, n); \
        RUN_DESIGNED(one)                                     \
    }
    CASES(RUN)
#define RUN_OVER(one) \
    if (strcmp(name, #one) == 0) replay_over_##one(samples, n);
    VARYING(RUN_OVER)
}

int main(void)
{
    uint32_t length, n;
    while (fread(&length, sizeof length, 1, stdin) == 1) {
        char name[64] = "";
        limpid_sample_t *samples;
        if (length >= sizeof name || fread(name, 1, length, stdin) != length) return 2;
        if (fread(&n, sizeof n, 1, stdin) != 1 || n == 0) return 2;
        samples = (limpid_sample_t *)calloc(n, sizeof *samples);
        if (samples == NULL || fread(samples, sizeof *samples, n, stdin) != n) return 2;
        run(name, samples, n);
        free(samples);
    }
    return 0;
}
