// A motor of SimpleFOC with the velocity of Limpid: closed velocity loop with a magnetic encoder.

#include <SimpleFOC.h>
#include <LimpidSensor.h>

MagneticSensorI2C encoder(AS5600_I2C);
LimpidSensor sensor(encoder, 4096);

BLDCMotor motor(7);
BLDCDriver3PWM driver(9, 5, 6, 8);

void setup()
{
    encoder.init();
    sensor.init();
    motor.linkSensor(&sensor);

    driver.voltage_power_supply = 12;
    driver.init();
    motor.linkDriver(&driver);

    motor.controller = MotionControlType::velocity;
    motor.LPF_velocity.Tf = 0;  // the sensor has filtered
    motor.init();
    motor.initFOC();
}

void loop()
{
    motor.loopFOC();
    motor.move(2.0f);
}
