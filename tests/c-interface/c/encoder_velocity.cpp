// The example for Arduino at a constant velocity of 1000 counts per second, in a loop of 100 us that is blocked for
// 50 ms in each 630 ms. Standard output has the velocities that it prints, rad/s.
#include <stdio.h>

#include "Arduino.h"

// The clock wraps after a second.
static uint32_t clock_now = 4293967296u;

uint32_t micros() { return clock_now; }
void pinMode(int, int) {}
int digitalRead(int) { return 0; }
int digitalPinToInterrupt(int pin) { return pin; }
void attachInterrupt(int, void (*)(), int) {}
void noInterrupts() {}
void interrupts() {}

SerialPort Serial;

void SerialPort::begin(long) {}
void SerialPort::print(float number, int) { printf("%.9g\n", static_cast<double>(number)); }
void SerialPort::println(const char *) {}

#include "EncoderVelocity.ino"

int main()
{
    setup();
    for (uint32_t us = 0; us < 20000000; us += 100) {
        clock_now += 100;
        count = us / 1000;
        if (us / 1000 % 630 >= 50) loop();
    }
    return 0;
}
