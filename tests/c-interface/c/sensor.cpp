// The sensor for SimpleFOC over a motion: standard input has the time in microseconds and the angle in
// radians, standard output the velocity and its standard deviation after each update. At time 0 the sensor is
// initialised again.
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
    LimpidSensor sensor(given, 4096);
    unsigned long now;
    bool started = false;
    while (scanf("%lu %f", &now, &given.shown) == 2) {
        clock_now = (uint32_t)now;
        if (started && now > 0)
            sensor.update();
        else
            sensor.init();
        started = true;
        printf("%.9g %.9g\n", (double)sensor.getVelocity(), (double)sensor.getVelocityDeviation());
    }
    return 0;
}
