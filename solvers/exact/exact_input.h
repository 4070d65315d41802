#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/exact/rational.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// FrictionRow in exact numbers.
struct ExactFrictionRow {
  Index row = 0;
  Index normal = 0;
  Rational mu;
  int slip = 0;
};

/// BoundedRow in exact numbers; nothing: infinite.
struct ExactBoundedRow {
  Index row = 0;
  std::optional<Rational> lower, upper;
};

/// w = A f + b, w >= 0, f >= 0, f.w = 0, on bilateral rows w = 0 and f free, and friction and bounded rows; in exact
/// numbers.
struct ExactLcp {
  std::string id;
  Index size = 0;
  std::vector<Rational> A;  ///< size x size by rows; symmetric but from ExactFromAny
  std::vector<Rational> b;
  std::vector<char> bilateral;
  bool has_factors = false;                     ///< A = J M^-1 J^T with M >= 0, hence positive semidefinite
  std::vector<ExactFrictionRow> friction = {};  ///< ascending rows
  std::vector<ExactBoundedRow> bounded = {};    ///< ascending rows

  bool is_plain() const { return friction.empty() && bounded.empty(); }
};

/// ExactLcp holds size^2 rationals, and solving takes hours long before it fills the memory.
inline constexpr Index kMostExactRows = 4000;

/// The problem, taken as its doubles, the product J M^-1 J^T without rounding.  O(size^2 entries of a row)
/// @throws InputError where A is not symmetric or has more than kMostExactRows rows
ExactLcp ExactFrom(const LcpProblem& problem);
/// The same where A need not be symmetric.
ExactLcp ExactFromAny(const LcpProblem& problem);

/// A record as ParseLcpRecord reads it, where "p/q" stays what it is.
/// @throws InputError naming `where`, the field, what was expected and what was found
ExactLcp ParseExactLcp(std::string_view line, const std::string& where);

/// Whether a record that ParseLcpRecord reads has a "p/q" among its numbers, which LcpProblem rounds.
bool HasFractions(std::string_view line);

}  // namespace lcpbench
