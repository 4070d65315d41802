#pragma once

#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem with what is known of its answer, for tests.
struct TestProblem {
  LcpProblem problem;
  LcpReference reference;
};

/// Facts of a symmetric positive semidefinite A.
MatrixFacts SymmetricPsd();

std::ostream& operator<<(std::ostream& out, const TestProblem& test);

using Triplets = std::vector<Eigen::Triplet<double, int>>;
/// The sum of these entries.
SparseMatrix MatrixOf(Index rows, Index columns, const Triplets& entries);
/// 0, 1, ..., n - 1.
std::vector<Index> EveryRow(Index n);
/// The same on every machine.
double Uniform(std::mt19937_64* random, double low, double high);
Eigen::VectorXd UniformVector(std::mt19937_64* random, Index n, double low, double high);

/// The exact LCPs of tests/data/oracle.
std::vector<TestProblem> OracleProblems();

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

/// Row k is factor[k] (1 where there is no vector) times row rows[k] of `problem`, with its law in the new unit. Where
/// rows come several times, the j-th of a friction row belongs to the j-th of its normal.
LcpProblem RowsOf(const LcpProblem& problem, const std::vector<Index>& rows, Eigen::VectorXd factor = {});

/// J -> S J, b -> S b, and inverse mass, or A, times `mass_scale`; laws come along.
LcpProblem ScaleRows(const LcpProblem& problem, const Eigen::VectorXd& scale, double mass_scale);

/// One problem of independent parts given by factors, its rows shuffled by `seed`.
LcpProblem Compose(const std::vector<LcpProblem>& parts, unsigned seed);

/// Unit masses on a vertical line, each resting on the one below, pushed by random loads: some contacts open. A is
/// tridiagonal.
LcpProblem Column(Index n, unsigned seed);

/// Discs in rows of ten on a floor, each touching the two below: as many contacts as translations, and side loads that
/// open some of them.
LcpProblem DiscPile(Index n, unsigned seed);

/// A solvable column of n rows, and two opposed rows on its top body that both demand to open: infeasible.
LcpProblem JammedColumn(Index n, unsigned seed);

/// A column of bodies standing on the ground, one vertical row between neighbours, mass 1 below and `ratio` above in
/// turns; only gravity. Every contact carries what lies above it, f_i = g (m_i + m_{i+1} + ...), and w = 0.
struct StackedColumn {
  LcpProblem problem;          ///< by factors, n rows
  std::vector<long double> f;  ///< exact but for the rounding of long double
};
StackedColumn MakeStackedColumn(Index n, double ratio);

}  // namespace lcpbench
