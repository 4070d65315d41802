#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <utility>

#include "benchmarks/collection/recipes/recipe.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem that a formula gives, and its answer where that is known in advance.
struct FormulaProblem {
  LcpProblem problem;
  /// Solves the problem exactly, in the doubles that it has.
  std::optional<Eigen::VectorXd> f = std::nullopt;
};

/// A family of problems that others published by a formula, for the tiers `literature` and `nonsymmetric`. Of the two
/// bounds that some of them have, the one that is active is the LCP's; the other one is never met (formulas.cc says why
/// for each). Numbers are made with + - * / and sqrt of doubles and with SinCos: the same bits on every machine.
struct Formula {
  std::string_view key;
  /// Where it was published.
  std::string_view source;
  /// Facts about A are in the problem. @throws InputError for a number of rows that the formula does not have
  FormulaProblem (*generate)(int rows, double parameter, std::uint64_t seed) = nullptr;
  std::pair<int, int> rows{2, 4000};  ///< the least and the most
  /// What a recipe's change of this name sets; "" where there is nothing to set.
  std::string_view parameter = {};
  double standard = 0;  ///< the parameter's value without a change
  double least = 0;     ///< the least value that it may have
  double most = 0;      ///< the largest
};

/// Null where no formula has this key.
const Formula* FindFormula(std::string_view key);

/// @throws InputError for rows or a change that the formula does not have
FormulaProblem MakeFormula(const Formula& formula, const Recipe& recipe);

}  // namespace lcpbench
