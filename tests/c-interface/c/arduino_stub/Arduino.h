/* Declarations in the place of Arduino's core. */
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stdint.h>

enum { INPUT_PULLUP = 2, CHANGE = 1 };

uint32_t micros();
void pinMode(int pin, int mode);
int digitalRead(int pin);
int digitalPinToInterrupt(int pin);
void attachInterrupt(int interrupt, void (*handler)(), int mode);
void noInterrupts();
void interrupts();

struct SerialPort {
    void begin(long);
    void print(float, int);
    void println(const char *);
};

extern SerialPort Serial;

#endif
