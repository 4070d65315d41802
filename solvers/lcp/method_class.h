#pragma once

#include <optional>
#include <string_view>

namespace lcpbench {

/// Which sizes a method's cost allows: one rule for own solvers and peers.
enum class MethodClass {
  kAnySize,          ///< only the time limit ends it
  kDenseMatrix,      ///< works on a dense n x n matrix: n^2 numbers
  kExactArithmetic,  ///< rational numbers that grow with n
};

/// The largest problem that a solver of a class is given in campaigns, and why.
struct SizeLimit {
  int largest;              ///< rows
  std::string_view reason;  ///< as exclusions tell it
};

/// Fixed before any run by the method's cost, not by its results.
constexpr std::optional<SizeLimit> SizeLimitOf(MethodClass method_class) {
  switch (method_class) {
    case MethodClass::kDenseMatrix:
      return SizeLimit{5000, "works on the dense matrix, n^2 numbers"};
    case MethodClass::kExactArithmetic:
      return SizeLimit{30, "exact rational arithmetic"};
    case MethodClass::kAnySize:
      break;
  }
  return std::nullopt;
}

}  // namespace lcpbench
