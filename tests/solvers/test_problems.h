#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem with what is known of its answer, for tests.
struct TestProblem {
  LcpProblem problem;
  LcpReference reference;
};

std::ostream& operator<<(std::ostream& out, const TestProblem& test);

/// The exact LCPs of the oracle set; empty where the outside data is absent.
std::vector<TestProblem> OracleProblems();

/// The contact problems among the unit tests of the paper's own software; empty where the outside data is absent.
std::vector<LcpProblem> RecordedUnitProblems();

/// Small problems whose answers are written beside them.
std::vector<TestProblem> TextbookProblems();

/// Seeded contact-like problems given by factors, solvable by construction (planted complementary f and w) unless the
/// name says otherwise: every rank from full to 1, duplicated and opposed rows, degenerate rows, chains, bilateral
/// rows, rows rescaled by up to 10^+-6.
std::vector<TestProblem> GeneratedProblems();

/// A random problem with integer factors of rank about min(n, 3 bodies), planted solution.
/// @param bilateral_every  every k-th row is bilateral; 0 for none
/// @param degenerate_every every k-th row has f = w = 0; 0 for none
TestProblem PlantedProblem(Index n, int bodies, unsigned seed, int bilateral_every, int degenerate_every);

/// The same problem with rows in the order `order` (row i of the new one is row order[i] of the old one).
LcpProblem PermuteRows(const LcpProblem& problem, const std::vector<Index>& order);

/// J -> S J, b -> S b, and inverse mass times `mass_scale`.
LcpProblem ScaleRows(const LcpProblem& problem, const Eigen::VectorXd& scale, double mass_scale);

}  // namespace lcpbench
