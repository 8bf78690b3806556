/* The bench image in C: runs a job from its mailbox for ever. The emulator stops at ready(). */
#include "limpid.h"
#include "parameters.h"

enum { SAMPLES = 4096, WORDS = 5 };

volatile uint32_t job[2];
volatile uint32_t trace[SAMPLES * WORDS];
volatile float velocities[SAMPLES];

__attribute__((noinline)) void ready(void)
{
    __asm volatile("");
}

static inline limpid_sample_t sample(uint32_t k)
{
    volatile uint32_t *words = &trace[k * WORDS];
    union {
        uint32_t bits;
        float value;
    } current;
    limpid_sample_t result;
    result.count = words[0];
    result.coupled = words[1];
    current.bits = words[2];
    result.current = current.value;
    result.has_edge = words[4] != 0;
    result.edge_boundary = words[3];
    result.edge_age = words[4] - (words[4] != 0);
    return result;
}

#define RUNNER(name, ...)                                                                                 \
    __attribute__((noinline)) void run_##name(uint32_t n)                                                 \
    {                                                                                                     \
        typedef float update_t(const limpid_##name##_t *, limpid_##name##_state_t *, const limpid_sample_t *); \
        update_t *volatile pointer = limpid_##name##_update;                                              \
        update_t *update = pointer;                                                                       \
        static limpid_##name##_state_t state;                                                             \
        limpid_sample_t one = sample(0);                                                                  \
        uint32_t k;                                                                                       \
        limpid_##name##_start(&limpid_##name##_parameters, &state, &one);                                 \
        for (k = 1; k < n; k++) {                                                                         \
            one = sample(k);                                                                              \
            velocities[k - 1] = update(&limpid_##name##_parameters, &state, &one);                        \
        }                                                                                                 \
    }

CASES(RUNNER)

typedef void runner_t(uint32_t);

#define POINTER(name, ...) run_##name,

static runner_t *const runners[] = {CASES(POINTER)};

int main(void)
{
    for (;;) {
        ready();
        if (job[0] < sizeof runners / sizeof runners[0] && job[1] <= SAMPLES && job[1] > 0)
            runners[job[0]](job[1]);
    }
}

/* Start of the board: stack, FPU, no data to copy (there is none with a value), memory cleared. */
extern uint32_t bss_start[], bss_end[], stack_top[];

__attribute__((noreturn)) void start(void)
{
    uint32_t *word;
    *(volatile uint32_t *)0xe000ed88u |= 0xfu << 20;
    __asm volatile("dsb\n isb");
    for (word = bss_start; word < bss_end; word++) *word = 0;
    main();
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static void (*const vectors[2])(void) = {
    (void (*)(void))stack_top,
    start,
};
