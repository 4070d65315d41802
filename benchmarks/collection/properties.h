#pragma once

#include <map>
#include <optional>
#include <string>

#include "benchmarks/collection/recipes/changes.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A number and how it was got; or none, and why.
template <typename Value>
struct Measured {
  std::optional<Value> value;
  std::string method;
};

/// What a problem is, whatever its answer.
struct ProblemProperties {
  Index rows = 0;
  Index bilateral = 0;
  Index bodies = 0;  ///< that can move and that a row touches; 0 without factors
  Index nonzeros_A = 0;
  std::optional<Index> nonzeros_J;
  Measured<Index> rank;
  /// Eigenvalues of A that are no mere rounding. Less than the rank where rows depend on each other but for rounding.
  std::optional<Index> numerical_rank;
  /// The largest of those eigenvalues by the smallest.
  Measured<double> condition;
  std::optional<double> redundancy;  ///< 1 - rank / rows, where the rank is known
  std::optional<double> mass_ratio;  ///< largest mass of those bodies by the smallest; factors only
  std::map<std::string, int> kinds;  ///< constraints by kind (CountKinds); empty where no scene is known
};

/// Up to this many rows conditions are by all singular values, and ranks without factors are measured.
inline constexpr Index kMostRowsDense = 2000;
/// Up to this many rows conditions are estimated where A is nonsingular; above there are none.
inline constexpr Index kMostRowsEstimated = 20'000;

/// O(rows^2 columns) up to kMostRowsDense, then what a sparse factorization of A costs, and then O(entries of A).
ProblemProperties MeasureProperties(const LcpProblem& problem);

/// How the answer lies: by exact zeros of w and f where these are proved, else by `negligible`.
struct AnswerProperties {
  double fraction_active = 0;  ///< unilateral rows with w = 0, by unilateral rows
  Index degenerate = 0;        ///< unilateral rows with w = f = 0
};

/// @param negligible  D^-1/2 w, D^1/2 f at most this are 0
AnswerProperties MeasureAnswer(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w,
                               double negligible);

/// What a solver need not be good at: "f = 0" where that is the answer (b >= 0, b = 0 on bilateral rows), "all rows
/// active" where w = 0 on all rows, so that -A^+ b or another solution of linear equations is one, "no active contact"
/// where w > 0 on all unilateral rows, so that the bilateral ones decide the answer alone. Empty: none of these.
std::string Triviality(const LcpProblem& problem, const AnswerProperties& answer);

}  // namespace lcpbench
