#pragma once

#include <random>
#include <span>

#include "tests/solvers/test_problems.h"

namespace lcpbench {

/// Numbers and chances, the same on every machine with one standard library.
class TestRandom {
 public:
  explicit TestRandom(unsigned seed) : engine_(seed) {}
  int Integer(Index low, Index high) {
    return static_cast<int>(std::uniform_int_distribution<Index>(low, high)(engine_));
  }
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  bool Chance(double probability) { return Uniform(0, 1) < probability; }

 private:
  std::mt19937 engine_;
};

/// A solvable problem of 1 to `largest` rows with a planted answer.
/// A = G diag(m) G^T with small integers G (n x r, so every rank occurs) and m powers of two with exponents up to +-13
/// (`wide_masses`): all of A and b is exact in double, and so are singularity, duplicates, opposed rows and degeneracy.
TestProblem PlantedExactly(unsigned seed, Index largest, bool wide_masses);

/// An unsolvable problem of 2 to `largest` rows, some of them bilateral, with A and b exact in double.
LcpProblem InfeasibleExactly(unsigned seed, Index largest);

/// A kind of problems with exact A and b; the same seed gives the same problem.
struct ExactFamily {
  const char* name;
  TestProblem (*make)(unsigned seed);
};

/// With a planted answer, up to 30 rows (chains: 120): every rank, wide masses, rows that are copies of few distinct
/// ones with either sign, mostly f = w = 0, all of them so, chains, rows that couple with no other (some of them
/// zero), joints only.
std::span<const ExactFamily> SolvableFamilies();

/// Without an answer: a row closes a combination of others, contacts that squeeze, joints that contradict each other,
/// rows that nothing can move.
std::span<const ExactFamily> UnsolvableFamilies();

/// A -> of_A S A S, b -> of_b S b with S = diag(rows), so that w -> of_b S w and f -> (of_b / of_A) S^-1 f. Exact for
/// powers of two.
TestProblem Rescaled(const TestProblem& test, const Eigen::VectorXd& rows, double of_A, double of_b);

}  // namespace lcpbench
