#define LIMPID_VERSION "VERSION_OF_LIMPID"

/* EACH(name) for every estimator: limpid_##name##_t, limpid_##name##_update and so on. */
#define LIMPID_ESTIMATORS(EACH)LIST_OF_ESTIMATORS

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
