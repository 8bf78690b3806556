// The sensor for SimpleFOC over a motion: standard input has the time in microseconds and the angle in
// radians, standard output the velocity and its standard deviation: before the sensor is initialised, then after
// each update. At time 0 the sensor is initialised again. The clock counts modulo 2^32.
#include <new>
#include <stdio.h>

#include "SimpleFOC.h"

#include "LimpidSensor.h"

static uint32_t clock_now;

uint32_t micros()
{
    return clock_now;
}

class Given : public Sensor {
public:
    float shown = 0.0f;

protected:
    float getSensorAngle() override { return shown; }
};

int main()
{
    Given given;
    // What the sensor does not set is 0.75, as in memory that was used before.
    alignas(LimpidSensor) static unsigned char storage[sizeof(LimpidSensor)];
    for (volatile unsigned char &byte : storage) byte = 0x3f;
    LimpidSensor &sensor = *new (storage) LimpidSensor(given, 4096);
    unsigned long long now;
    bool started = false;
    printf("%.9g %.9g\n", static_cast<double>(sensor.getVelocity()), static_cast<double>(sensor.getVelocityDeviation()));
    while (scanf("%llu %f", &now, &given.shown) == 2) {
        clock_now = static_cast<uint32_t>(now);
        if (started && now > 0)
            sensor.update();
        else
            sensor.init();
        started = true;
        printf("%.9g %.9g\n", static_cast<double>(sensor.getVelocity()), static_cast<double>(sensor.getVelocityDeviation()));
    }
    return 0;
}
