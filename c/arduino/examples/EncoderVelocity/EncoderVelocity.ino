// Velocity of a quadrature encoder, every millisecond, printed ten times a second.

#include <LimpidEstimators.h>
#include <LimpidMilliseconds.h>

const int PIN_A = 2;
const int PIN_B = 3;
const uint32_t COUNTS_PER_REV = 1200;  // both edges of one input: two per line of an encoder of 600 lines

volatile uint32_t count = 0;
limpid::imm filter(limpid_imm_parameters);

// Where the flash is shared with a file system, an interrupt runs from memory.
#ifndef IRAM_ATTR
#define IRAM_ATTR
#endif

void IRAM_ATTR edge()
{
    count += (digitalRead(PIN_A) == digitalRead(PIN_B)) ? 1 : -1;
}

void setup()
{
    Serial.begin(115200);
    pinMode(PIN_A, INPUT_PULLUP);
    pinMode(PIN_B, INPUT_PULLUP);
    attachInterrupt(digitalPinToInterrupt(PIN_A), edge, CHANGE);
}

void loop()
{
    static uint32_t due = micros();
    static int ticks = 0;
    const int32_t late = static_cast<int32_t>(micros() - due);
    if (late < 0) return;
    due += 1000;

    noInterrupts();
    const uint32_t now = count;
    interrupts();

    // After a loop that was blocked for more than a period, the counts of several periods would be those of one.
    if (late >= 1000) {
        due = micros() + 1000;
        filter.start(limpid_count(now));
        return;
    }

    const float velocity = LIMPID_RAD_PER_S(filter.update(now), COUNTS_PER_REV, LIMPID_IMM_RATE_HZ);
    if (++ticks == 100) {
        ticks = 0;
        Serial.print(velocity, 4);
        Serial.println(" rad/s");
    }
}
