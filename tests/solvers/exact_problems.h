#pragma once

#include <random>

#include "tests/solvers/test_problems.h"

namespace lcpbench {

/// Small integers and chances, the same on every machine with one standard library.
class TestRandom {
 public:
  explicit TestRandom(unsigned seed) : engine_(seed) {}
  int Integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  bool Chance(double probability) { return std::uniform_real_distribution<double>(0, 1)(engine_) < probability; }

 private:
  std::mt19937 engine_;
};

/// Facts of a symmetric positive semidefinite A.
MatrixFacts SymmetricPsd();

/// A solvable problem of 1 to `largest` rows with a planted answer.
/// A = G diag(m) G^T with small integers G (n x r, so every rank occurs) and m powers of two with exponents up to +-13
/// (`wide_masses`): all of A and b is exact in double, and so are singularity, duplicates, opposed rows and degeneracy.
TestProblem PlantedExactly(unsigned seed, Index largest, bool wide_masses);

/// An unsolvable problem of 2 to `largest` rows, some of them bilateral, with A and b exact in double.
LcpProblem InfeasibleExactly(unsigned seed, Index largest);

/// A singular problem of 2 to `largest` rows with w = 0 for all its many solutions, f = 1 being one of them.
LcpProblem FullyDegenerate(unsigned seed, Index largest);

}  // namespace lcpbench
