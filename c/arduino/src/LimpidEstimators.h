/* The estimators of limpid.h as C++ classes: limpid::imm, limpid::pll and so on.
 *
 *   #include <LimpidEstimators.h>
 *   #include "parameters.h"              // host-sim export --estimator imm --rate 1000 --c --out parameters.h
 *
 *   limpid::imm filter(limpid_imm_parameters);
 *
 *   float counts_per_tick = filter.update(encoder_count);     // every millisecond
 *
 * A class keeps a reference to its parameters, which must outlive it: a temporary does not compile.
 */
#ifndef LIMPID_ESTIMATORS_H
#define LIMPID_ESTIMATORS_H

#include "limpid.h"

namespace limpid {

#define LIMPID_CLASS(name)                                                                     \
    class name {                                                                               \
    public:                                                                                    \
        explicit name(const limpid_##name##_t &designed) : parameters(designed) {}             \
        explicit name(const limpid_##name##_t &&) = delete;                                    \
                                                                                               \
        /* Sets the state to rest at this sample. The first update does so too. */             \
        void start(const limpid_sample_t &first)                                               \
        {                                                                                      \
            limpid_##name##_start(&parameters, &state, &first);                                \
            started = true;                                                                    \
        }                                                                                      \
                                                                                               \
        /* Velocity at this sample, counts per tick; 0 at the first one. */                    \
        float update(const limpid_sample_t &sample)                                            \
        {                                                                                      \
            if (started) return limpid_##name##_update(&parameters, &state, &sample);          \
            start(sample);                                                                     \
            return 0.0f;                                                                       \
        }                                                                                      \
                                                                                               \
        float update(uint32_t count) { return update(limpid_count(count)); }                   \
                                                                                               \
        const limpid_##name##_t &parameters;                                                   \
        limpid_##name##_state_t state;                                                         \
        bool started = false;                                                                  \
    };

LIMPID_ESTIMATORS(LIMPID_CLASS)

#undef LIMPID_CLASS

}  // namespace limpid

#endif
