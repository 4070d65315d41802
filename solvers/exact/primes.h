#pragma once

#include <flint/flint.h>

namespace lcpbench {

/// Two primes of 62 bits that ranks are taken modulo; of no relation to any input.
inline constexpr mp_limb_t kPrimes[] = {4611686018427387847UL, 4611686018427387817UL};

}  // namespace lcpbench
