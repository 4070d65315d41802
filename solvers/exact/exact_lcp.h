#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_input.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// An answer, exact in every number.
struct ExactAnswer {
  enum class Status {
    kSolved,
    kInfeasible,
    kNotSemidefinite,  ///< A is not PSD: no guarantee
    kTimeLimit,
  };
  Status status = Status::kTimeLimit;

  std::vector<Rational> w;  ///< of a solved problem: unique, as A is PSD
  std::vector<Rational> f;  ///< a solution whose active rows are independent
  /// The solution of least Euclidean norm, and whether it is the only one; empty where `detail` says why.
  std::vector<Rational> f_least_norm;
  /// l with f_least_norm - A l >= 0 on unilateral rows with w = 0, = 0 there where f > 0 and on bilateral rows; l = 0
  /// where w > 0: the proof of least norm (its Lagrange multipliers).
  std::vector<Rational> multipliers;
  std::optional<bool> f_unique;
  Index nullity_on_active = 0;    ///< of A on the rows with w = 0
  std::vector<Index> degenerate;  ///< unilateral rows with w = 0 and least-norm f = 0

  /// The ray of an infeasible problem: y >= 0 on unilateral rows, A y = 0, b.y = -1. [Farkas]
  std::vector<Rational> ray;

  Index rank = 0;  ///< of A
  /// Ranks and nullities are proved; else each is right but with a probability below 2^-50 (two random primes).
  bool rank_is_proved = false;
  std::int64_t pivots = 0;  ///< exact solves with a basis
  std::string detail;
};
const char* ToString(ExactAnswer::Status status);

/// What is known in doubles: forces, or a ray of an infeasible problem; either may be empty.
struct ExactGuess {
  Eigen::VectorXd f;
  Eigen::VectorXd ray;
};

struct ExactOptions {
  double time_limit_s = 3600;    ///< looked at between exact solves
  double (*now)() = &SteadyNow;  ///< the clock of the time limit
  /// Ranks are proved up to this many rows; uniqueness of f, where it takes a program of its own, likewise.
  Index most_rows_of_proofs = 120;
  /// Only what a solver is asked for: status, w and f, or the ray. Ranks, the least-norm f, degenerate rows and
  /// uniqueness are left at their defaults; the answer is as exact as ever.
  bool answer_only = false;
  /// A solution in doubles of a problem, by any solver: where the exact method starts. Its answer is not
  /// trusted. Without one the start is f = 0.
  std::function<ExactGuess(const LcpProblem& problem)> guess;
};

/// Solves a plain problem with symmetric positive semidefinite A, by exact pivots from the active set of the guess, or
/// from one that Lemke's method finds in 60 digits where that is not right almost at once (redundant rows): blocks of
/// all violated rows while their number falls, then the criss-cross method with least indices, which ends from any
/// basis for sufficient matrices, PSD ones among them [den Hertog, Roos, Terlaky, The linear complementarity problem,
/// sufficient matrices, and the criss-cross method, Linear Algebra Appl. 187, 1993]. Systems are solved by p-adic
/// lifting [Dixon 1982, by FLINT]: O(n^3) word operations and O(n^2) of the length of the answer, some hundred bits a
/// row.
ExactAnswer SolveExactly(const ExactLcp& problem, const ExactOptions& options);

/// Checks an answer in exact arithmetic from the definitions alone: equations, signs, complementarity, the conditions
/// of a ray, and of the least-norm f that it solves. Empty where the answer is right, else what is wrong.
std::string FindFault(const ExactLcp& problem, const ExactAnswer& answer);

}  // namespace lcpbench
