#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <cstddef>

#include "solvers/lcp/problem.h"
#include "support/array_index.h"

namespace lcpbench {

/// Rationals of any size, always reduced. Doubles are the exact rationals that they are.
using Rational = boost::multiprecision::mpq_rational;
/// Integers of any size.
using BigInteger = boost::multiprecision::mpz_int;

/// value 2^bits.
inline Rational Shifted(Rational value, long bits) {
  auto* data = value.backend().data();
  if (bits >= 0) {
    mpq_mul_2exp(data, data, static_cast<mp_bitcnt_t>(bits));
  } else {
    mpq_div_2exp(data, data, static_cast<mp_bitcnt_t>(-bits));
  }
  return value;
}

}  // namespace lcpbench
