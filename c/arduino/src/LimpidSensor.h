/* A sensor for SimpleFOC with the velocity of the self-tuning filter bank `imm`.
 *
 *   #include <SimpleFOC.h>
 *   #include <LimpidSensor.h>
 *
 *   MagneticSensorI2C encoder(AS5600_I2C);
 *   LimpidSensor sensor(encoder, 4096);      // counts per revolution: four per line of an encoder
 *
 *   encoder.init();                          // before the sensor, which reads it
 *   sensor.init();
 *   motor.linkSensor(&sensor);
 *
 * The velocity reaches zero at rest and does not jump at low speed. The loop may be irregular: each update
 * takes the time since the one before. Let motor.LPF_velocity.Tf be 0: a filter behind this one adds delay.
 */
#ifndef LIMPID_SENSOR_H
#define LIMPID_SENSOR_H

#include "LimpidEstimators.h"
#include "LimpidMilliseconds.h"

#ifndef SENSOR_H
#error "LimpidSensor.h: include SimpleFOC.h first"
#endif

class LimpidSensor : public Sensor {
public:
    LimpidSensor(Sensor &sensor, uint32_t counts) : inner(sensor), counts_per_rev(counts) {}

    void init() override
    {
        inner.update();
        started = false;
        velocity = 0.0f;
        update();
    }

    void update() override
    {
        inner.update();
        const uint32_t now = micros();
        const uint32_t count = counted();
        /* The period of the parameters is a millisecond. */
        const float period = static_cast<float>(now - updated) * 1e-3f;
        if (!started) {
            const limpid_sample_t first = limpid_count(count);
            limpid_imm_start(&limpid_imm_parameters, &state, &first);
            started = true;
        } else if (period >= SHORTEST) {
            const limpid_sample_t sample = limpid_count(count);
            const float per_period = limpid_imm_update_over(&limpid_imm_parameters, &state, &sample, period);
            velocity = LIMPID_RAD_PER_S(per_period, counts_per_rev, LIMPID_IMM_RATE_HZ);
        } else {
            return;
        }
        updated = now;
    }

    float getMechanicalAngle() override { return inner.getMechanicalAngle(); }
    float getAngle() override { return inner.getAngle(); }
    double getPreciseAngle() override { return inner.getPreciseAngle(); }
    int32_t getFullRotations() override { return inner.getFullRotations(); }
    int needsSearch() override { return inner.needsSearch(); }

    /* Velocity at the latest update, rad/s. */
    float getVelocity() override { return velocity; }

    /* Standard deviation of the velocity according to the filter, rad/s; 0 before init(). */
    float getVelocityDeviation() const
    {
        if (!started) return 0.0f;
        const float deviation = limpid_std_dev(limpid_imm_variance(&limpid_imm_parameters, &state));
        return LIMPID_RAD_PER_S(deviation, counts_per_rev, LIMPID_IMM_RATE_HZ);
    }

protected:
    float getSensorAngle() override { return inner.getMechanicalAngle(); }

private:
    /* An update sooner than this, ms, is left to the next one. */
    static constexpr float SHORTEST = 0.02f;

    /* The angle in counts of the encoder, modulo 2^32. */
    uint32_t counted()
    {
        const float turn = inner.getMechanicalAngle() * (1.0f / 6.28318531f);
        const float nearest = turn * static_cast<float>(counts_per_rev) + 0.5f;
        /* The angle of some sensors is negative below 0, where a conversion rounds up. */
        int32_t within = static_cast<int32_t>(nearest);
        if (static_cast<float>(within) > nearest) within -= 1;
        return static_cast<uint32_t>(inner.getFullRotations()) * counts_per_rev + static_cast<uint32_t>(within);
    }

    Sensor &inner;
    const uint32_t counts_per_rev;
    limpid_imm_state_t state;
    float velocity = 0.0f;
    uint32_t updated = 0;
    bool started = false;
};

#endif
