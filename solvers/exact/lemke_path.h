#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/exact/exact_input.h"
#include "solvers/exact/flint_matrix.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Where Lemke's path ends. Nothing is proved by it. Internal to solvers/exact/.
struct LemkeEnd {
  enum class Kind {
    kSolved,
    kRay,
    kTie,    ///< two walls at once: another direction may have none
    kLimit,  ///< out of time or steps, or joints that are dependent to 60 digits
  };
  Kind kind = Kind::kLimit;
  std::string modes;          ///< of the solution, as of ExactAnswer; tangents with mu = 0 are `o`
  std::vector<char> support;  ///< of the ray: unilateral rows with y > 0, and joints
  std::int64_t steps = 0;
};

/// Lemke's path in floating point of 60 digits, along the modes of contacts with at most one friction row each
/// [docs/friction.md section 5; Lemke 1965; Eaves 1976]. In doubles, rows that depend on others to rounding are all
/// alike; in exact numbers only some of them can be active, and which ones is decided at 1e-17 of the forces. More
/// digits see that.
///
/// P(z): w = A f + b + z d, with d in the interior of the cone dual to the friction cones and 0 on joints. For large z
/// every contact is open; from there z and f change linearly in one mode after the other until z = 0. In each step one
/// wall of a cell is crossed: a contact opens, closes, sticks or slips. O(n^2) operations of some 0.1 us a step, about
/// n to 2 n steps.
///
/// @param A, b  those of the problem, times any units
/// @param seed  of d, which is drawn by row, and a tie ends the path; 0, for plain problems: d_i = A_ii^1/2, and of
///              equal walls the first is taken
LemkeEnd FollowLemke(const ExactLcp& problem, const IntegerMatrix& A, const IntegerMatrix& b, unsigned seed,
                     const Deadline& deadline);

}  // namespace lcpbench
