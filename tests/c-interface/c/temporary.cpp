// The classes take parameters that last, and no temporary.
#include <type_traits>

#include "LimpidEstimators.h"
#include "LimpidMilliseconds.h"

limpid::imm filter(limpid_imm_parameters);

static_assert(std::is_constructible<limpid::imm, const limpid_imm_t &>::value, "constant parameters");
static_assert(std::is_constructible<limpid::imm, limpid_imm_t &>::value, "parameters");
static_assert(!std::is_constructible<limpid::imm, limpid_imm_t>::value, "a temporary");
static_assert(!std::is_constructible<limpid::imm, const limpid_imm_t>::value, "a constant temporary");
