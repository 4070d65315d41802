#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/derivative/derivative.h"
#include "solvers/exact/exact_lcp.h"

namespace lcpbench {

/// A problem of small integers by factors, a solution that is exact in doubles, and a direction of integers.
struct DerivativeCase {
  std::string kind;  ///< "plain, strict", ...
  LcpProblem problem;
  Eigen::VectorXd f;
  ProblemChange change;
  /// Opens contacts that touch without force, and makes friction at its bound slip: the mode of Vjp.
  Eigen::VectorXd opening_b;
};

/// Plain problems, by seed with or without joints, degenerate or not, forces unique or not: rows are copies of each
/// other then, and stay so along the direction. The same seed gives the same case.
DerivativeCase PlainCase(unsigned seed);
/// Up to three contacts with friction, at times with joints, sliding or bounded rows.
/// @param degenerate  contacts touch without force, friction is at its bound without slip, mu is 0 without slip, ...
DerivativeCase FrictionCase(unsigned seed, bool degenerate);

/// A strictly complementary FrictionCase whose first contact carries force, and once more an equal contact, along
/// directions that keep them equal.
DerivativeCase CopiedFrictionCase(unsigned seed);

/// The problem at t along the direction, exact in every number.
ExactLcp PerturbedExactly(const LcpProblem& problem, const ProblemChange& change, const Rational& t);

/// The exact derivative along the direction, rounded.
struct ExactChange {
  Eigen::VectorXd f;  ///< empty where it is not known
  Eigen::VectorXd w;
};
/// By solutions at t = 2^-120, in rationals: they differ from the derivative by a part of about 2^-100. All those near
/// f: none where the problem loses its solution, several where it branches. Of plain problems the forces of least norm;
/// of CopiedFrictionCase those near w, without f.
std::vector<ExactChange> ExactChanges(const DerivativeCase& test);

}  // namespace lcpbench
