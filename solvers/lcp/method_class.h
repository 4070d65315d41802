#pragma once

namespace lcpbench {

/// What a method's cost allows it to be given: one rule for everybody, own solvers and peers
/// (benchmarks/campaign/exclusion_rules.h).
enum class MethodClass {
  kAnySize,          ///< only the time limit ends it
  kDenseMatrix,      ///< works on a dense n x n matrix: n^2 numbers
  kExactArithmetic,  ///< rational numbers that grow with n
};

}  // namespace lcpbench
