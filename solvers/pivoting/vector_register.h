#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

/// Internal to solvers/: short loops over rows that are padded to whole vector registers.
namespace lcpbench {

/// Eight doubles: one vector register or several, whatever the machine has. Loads need no alignment. Functions take
/// pointers, since passing registers that a machine may lack has no fixed convention.
inline constexpr Eigen::Index kRegister = 8;
using Register [[gnu::vector_size(kRegister * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] = double;
using IntegerRegister [[gnu::vector_size(kRegister * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] =
    std::int64_t;

inline constexpr IntegerRegister kFirstRows = {0, 1, 2, 3, 4, 5, 6, 7};

inline const Register* AsRegisters(const double* x) { return reinterpret_cast<const Register*>(x); }
inline Register* AsRegisters(double* x) { return reinterpret_cast<Register*>(x); }

inline double Sum(const Register* x) {
  const double* v = reinterpret_cast<const double*>(x);
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

inline std::uint64_t Together(const IntegerRegister* x) {
  const auto* v = reinterpret_cast<const std::uint64_t*>(x);
  return ((v[0] | v[4]) | (v[2] | v[6])) | ((v[1] | v[5]) | (v[3] | v[7]));
}

inline double Least(const Register* x) {
  const double* v = reinterpret_cast<const double*>(x);
  const double a = std::min(std::min(v[0], v[4]), std::min(v[2], v[6]));
  const double b = std::min(std::min(v[1], v[5]), std::min(v[3], v[7]));
  return std::min(a, b);
}

}  // namespace lcpbench
