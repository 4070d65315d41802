#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/modes/polyhedron.h"

namespace lcpbench {

/// A mode string has a character a row [docs/friction.md section 1]: `O` open, `C` closed (unilateral); `o` normal row
/// open, `S` stick, `+` slip with w >= 0, `-` slip with w <= 0, `k` sliding (friction); `S` w = 0, `+` at lower, `-` at
/// upper (bounded); `B` bilateral. In each mode all laws are linear: its solutions are a polyhedron, and those of the
/// problem the union over all modes.

/// A polyhedron of solutions f, of one mode string.
struct ModePiece {
  std::string modes;
  Index dimension = 0;
  Polyhedron f;
};

/// What is proved of a problem with friction, sliding or bounded rows.
struct ModeAnswer {
  LcpReference::Status status = LcpReference::Status::kUnknown;
  RationalVector f, w;  ///< a solution
  std::string modes;    ///< of it
  /// All modes were tried: the members below are known, and no solution means that there is none.
  bool complete = false;
  std::vector<ModePiece> pieces;  ///< all solutions; no piece is contained in another
  Index components = 0;           ///< connected components of their union
  std::optional<bool> f_unique, w_unique;
  /// The ray of an infeasible problem: y >= 0 on unilateral rows, free on bilateral ones, 0 on friction rows, on
  /// bounded rows of the signs whose bound is infinite; A^T y = 0, b.y = -1. Empty: infeasible by modes only.
  RationalVector ray;
  std::int64_t tried = 0;  ///< modes, or steps of the path
  std::string detail;      ///< why nothing is known
};

/// Where the search starts and ends.
struct ModeOptions {
  /// All modes are tried where there are no more: those of 6 contacts with one tangent row each; 65536 are those of 8.
  std::int64_t most_modes = 4096;
  double time_limit_s = 3600;    ///< looked at between modes
  double (*now)() = &SteadyNow;  ///< the clock of the time limit
  /// Called above most_modes: modes that are tried first, in turn; not trusted.
  std::function<std::vector<std::string>()> guesses = {};
  bool follows_path = true;  ///< where no guess is right; seconds to hours
};

/// What is wrong with f as a solution in these modes, from the definitions alone; "" where it is one.
std::string FindFaultOfModes(const ExactLcp& problem, const std::string& modes, const RationalVector& f);

/// The modes of forces in doubles, by the sides of D^1/2 f - D^-1/2 w [Alart, Curnier 1991].
std::string ModesOf(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
