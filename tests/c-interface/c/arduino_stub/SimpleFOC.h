/* Declarations in the place of Arduino and SimpleFOC, which are not part of this project: what library and
 * examples use, with the members and defaults of SimpleFOC's class Sensor. */
#ifndef SENSOR_H
#define SENSOR_H

#include <math.h>
#include <stdint.h>

#include "Arduino.h"

class Sensor {
public:
    virtual ~Sensor() {}
    virtual float getMechanicalAngle() { return angle; }
    virtual float getAngle() { return static_cast<float>(turns) * 6.28318531f + angle; }
    virtual double getPreciseAngle() { return static_cast<double>(getAngle()); }
    virtual float getVelocity() { return 0.0f; }
    virtual int32_t getFullRotations() { return turns; }
    virtual int needsSearch() { return 0; }

    virtual void update()
    {
        const float now = getSensorAngle();
        if (fabsf(now - angle) > 5.0f) turns += now > angle ? -1 : 1;
        angle = now;
    }

protected:
    virtual float getSensorAngle() = 0;
    virtual void init() {}
    float angle = 0.0f;
    int32_t turns = 0;
};

struct MagneticSensorI2CConfig {};

static const MagneticSensorI2CConfig AS5600_I2C = {};

class MagneticSensorI2C : public Sensor {
public:
    explicit MagneticSensorI2C(MagneticSensorI2CConfig) {}
    void init() override {}

protected:
    float getSensorAngle() override { return 0.0f; }
};

enum MotionControlType { torque, velocity };

struct BLDCDriver3PWM {
    BLDCDriver3PWM(int, int, int, int) {}
    float voltage_power_supply = 0;
    int init() { return 1; }
};

struct BLDCMotor {
    explicit BLDCMotor(int) {}
    void linkSensor(Sensor *) {}
    void linkDriver(BLDCDriver3PWM *) {}
    void init() {}
    int initFOC() { return 1; }
    void loopFOC() {}
    void move(float) {}
    MotionControlType controller = MotionControlType::torque;
    struct {
        float Tf = 0;
    } LPF_velocity;
};

#endif
