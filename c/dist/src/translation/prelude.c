/*
 * limpid.c of Limpid VERSION_OF_LIMPID: the functions of limpid.h for processors without a library.
 *
 * Translated by machine from the library in Rust: change nothing here. The velocities have the same bits as those of the
 * library, if the compiler computes floats by IEEE 754: no -ffast-math.
 */

#include "limpid.h"

#include <float.h>

#if UINTPTR_MAX > 0xffffffff
#error "limpid.c is for addresses of at most 32 bits: link the library of this processor instead"
#endif
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "limpid.c is for little-endian processors"
#endif
#if FLT_EVAL_METHOD != 0
#error "limpid.c is for compilers that round each operation to float"
#endif
#ifdef __FAST_MATH__
#error "limpid.c must be compiled without -ffast-math"
#endif

/* A product and a sum are rounded one by one, not fused. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

#define ADDRESS(pointer) ((uint32_t)(uintptr_t)(pointer))

#ifdef __GNUC__
#define COPY(to, from, size) __builtin_memcpy(to, from, size)
#define ALIGNED(address) __builtin_assume_aligned((const void *)(uintptr_t)(address), 4)
#define ALIGNED_TO(address) __builtin_assume_aligned((void *)(uintptr_t)(address), 4)
#define MAY_BE_UNUSED __attribute__((unused))
#else
#include <string.h>
#define COPY(to, from, size) memcpy(to, from, size)
#define ALIGNED(address) ((const void *)(uintptr_t)(address))
#define ALIGNED_TO(address) ((void *)(uintptr_t)(address))
#define MAY_BE_UNUSED
#endif

#define MEMORY(name, type)                                                     \
    MAY_BE_UNUSED static inline type load_##name(uint32_t address)             \
    {                                                                          \
        type value;                                                            \
        COPY(&value, ALIGNED(address), sizeof value);                        \
        return value;                                                          \
    }                                                                          \
    MAY_BE_UNUSED static inline void store_##name(uint32_t address, type value) \
    {                                                                          \
        COPY(ALIGNED_TO(address), &value, sizeof value);                     \
    }

/* Of smaller numbers and of numbers that may lie anywhere. */
#define ANYWHERE(name, type)                                                   \
    MAY_BE_UNUSED static inline type load_##name(uint32_t address)             \
    {                                                                          \
        type value;                                                            \
        COPY(&value, (const void *)(uintptr_t)address, sizeof value);        \
        return value;                                                          \
    }                                                                          \
    MAY_BE_UNUSED static inline void store_##name(uint32_t address, type value) \
    {                                                                          \
        COPY((void *)(uintptr_t)address, &value, sizeof value);              \
    }

MEMORY(u32, uint32_t)
MEMORY(u64, uint64_t)
MEMORY(f32, float)
ANYWHERE(u8, uint8_t)
ANYWHERE(i8, int8_t)
ANYWHERE(u16, uint16_t)
ANYWHERE(i16, int16_t)
ANYWHERE(u32_anywhere, uint32_t)
ANYWHERE(u64_anywhere, uint64_t)
ANYWHERE(f32_anywhere, float)

MAY_BE_UNUSED static inline uint32_t bits(float value)
{
    uint32_t result;
    COPY(&result, &value, sizeof result);
    return result;
}

MAY_BE_UNUSED static inline float of_bits(uint32_t value)
{
    float result;
    COPY(&result, &value, sizeof result);
    return result;
}

MAY_BE_UNUSED static inline float magnitude(float value)
{
    return of_bits(bits(value) & UINT32_C(0x7fffffff));
}

MAY_BE_UNUSED static inline float with_sign(float value, float sign)
{
    return of_bits((bits(value) & UINT32_C(0x7fffffff)) | (bits(sign) & UINT32_C(0x80000000)));
}

MAY_BE_UNUSED static inline uint32_t leading_zeros(uint32_t value)
{
    uint32_t count = 0;
    if (value == 0) return 32;
    for (; !(value & UINT32_C(0x80000000)); value <<= 1) count++;
    return count;
}

