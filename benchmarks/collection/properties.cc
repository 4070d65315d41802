#include "benchmarks/collection/properties.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "model/scenes/random.h"
#include "solvers/exact/sparse_rank.h"

extern "C" {
// Fortran; the last argument is the length of `job`. NOLINTNEXTLINE(readability-identifier-naming)
void dgesdd_(const char* job, const int* m, const int* n, double* a, const int* lda, double* s, double* u,
             const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* iwork, int* info,
             std::size_t job_length);
}

namespace lcpbench {
namespace {

// Measures the bodies that can move and that a row touches.
void MeasureBodies(const LcpProblem& problem, ProblemProperties* measured) {
  const Eigen::VectorXd& inverse = problem.inverse_mass();
  const Index width = problem.columns_per_body();
  std::vector<char> touched(static_cast<size_t>((inverse.size() + width - 1) / width), 0);
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
      if (inverse[it.col()] > 0) touched[static_cast<size_t>(it.col() / width)] = 1;
    }
  }
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (size_t k = 0; k < touched.size(); ++k) {
    if (touched[k] == 0) continue;
    ++measured->bodies;
    const double mobility = inverse[width * static_cast<Index>(k)];
    if (mobility <= 0) continue;
    least = std::min(least, mobility);
    most = std::max(most, mobility);
  }
  if (most > 0) measured->mass_ratio = most / least;
}

// J M^-1/2 on columns with an entry, the other way round where that is lower than wide.
Eigen::MatrixXd Root(const LcpProblem& problem) {
  std::vector<int> place(static_cast<size_t>(problem.J().cols()), -1);
  int columns = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
      int& at = place[static_cast<size_t>(it.col())];
      if (at < 0 && it.value() != 0 && problem.inverse_mass()[it.col()] > 0) at = columns++;
    }
  }
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(problem.size(), columns);
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
      const int at = place[static_cast<size_t>(it.col())];
      if (at >= 0) root(i, at) = it.value() * std::sqrt(problem.inverse_mass()[it.col()]);
    }
  }
  return root;
}

// Singular values in descending order, with absolute errors of some roundings of the largest; overwrites the matrix.
Eigen::VectorXd SingularValues(Eigen::MatrixXd* matrix) {
  const int m = static_cast<int>(matrix->rows());
  const int n = static_cast<int>(matrix->cols());
  const int least = std::min(m, n);
  Eigen::VectorXd values(least);
  if (least == 0) return values;
  std::vector<int> integers(8 * static_cast<size_t>(least));
  const int one = 1;
  int info = 0;
  double unused = 0;
  // The first call asks for the length of the workspace.
  double length = 0;
  int words = -1;
  dgesdd_("N", &m, &n, matrix->data(), &m, values.data(), &unused, &one, &unused, &one, &length, &words,
          integers.data(), &info, 1);
  words = static_cast<int>(length);
  std::vector<double> work(static_cast<size_t>(words));
  dgesdd_("N", &m, &n, matrix->data(), &m, values.data(), &unused, &one, &unused, &one, work.data(), &words,
          integers.data(), &info, 1);
  if (info != 0) throw std::runtime_error("singular values: dgesdd returned " + std::to_string(info));
  return values;
}

// Rank and condition as double precision sees them.
void MeasureSingularValues(const LcpProblem& problem, ProblemProperties* measured) {
  Eigen::MatrixXd matrix = problem.has_factors() ? Root(problem) : problem.DenseA();
  const Eigen::VectorXd values = SingularValues(&matrix);
  // Below this a singular value is nothing but rounding.
  const double largest = values.size() > 0 ? values[0] : 0;
  const double noise = static_cast<double>(problem.size()) * std::numeric_limits<double>::epsilon() * largest;
  Index count = 0;
  while (count < values.size() && values[count] > noise) ++count;
  measured->numerical_rank = count;
  if (count == 0) {
    measured->condition = {std::nullopt, "A is zero"};
    return;
  }
  const double ratio = largest / values[count - 1];
  measured->condition = {problem.has_factors() ? ratio * ratio : ratio,
                         problem.has_factors() ? "singular values of J M^-1/2" : "singular values of A"};
}

// Power iteration and inverse iteration: lower bounds that are seldom far off.
Measured<double> EstimatedCondition(const LcpProblem& problem) {
  constexpr int kIterations = 60;
  const SparseMatrix& A = problem.SparseA();
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  factor.compute(Eigen::SparseMatrix<double>(A));
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) {
    return {std::nullopt, "A could not be factorised"};
  }
  Random random(1);
  const auto largest = [&](const auto& apply) {
    Eigen::VectorXd x(problem.size());
    for (double& value : x) value = random.Uniform(-1, 1);
    double length = 0;
    for (int k = 0; k < kIterations; ++k) {
      x = apply(Eigen::VectorXd(x / x.norm()));
      length = x.norm();
    }
    return length;
  };
  const double top = largest([&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return A * x; });
  const double bottom = largest([&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return factor.solve(x); });
  if (!std::isfinite(top * bottom)) return {std::nullopt, "the iteration does not stay finite"};
  return {top * bottom, "estimate: power iteration and inverse iteration, 60 steps each"};
}

}  // namespace

ProblemProperties MeasureProperties(const LcpProblem& problem) {
  ProblemProperties measured;
  measured.rows = problem.size();
  measured.bilateral = static_cast<Index>(problem.bilateral_rows().size());
  measured.friction = std::ssize(problem.friction_rows());
  measured.bounded = std::ssize(problem.bounded_rows());
  measured.nonzeros_A = problem.SparseA().nonZeros();
  if (problem.has_factors()) {
    measured.nonzeros_J = problem.J().nonZeros();
    MeasureBodies(problem, &measured);
  }
  measured.rank.value = RankOf(problem, kMostRowsDense);
  measured.rank.method = measured.rank.value ? "exact, modulo two primes of 62 bits"
                                             : "not measured above " + std::to_string(kMostRowsDense) + " rows of A";
  if (!measured.rank.value && problem.facts().rank) measured.rank = {problem.facts().rank, "by the problem's formula"};
  if (problem.size() <= kMostRowsDense) {
    MeasureSingularValues(problem, &measured);
  } else if (problem.size() > kMostRowsEstimated) {
    measured.condition.method = "not measured above " + std::to_string(kMostRowsEstimated) + " rows";
  } else if (measured.rank.value.has_value() && *measured.rank.value < problem.size()) {
    measured.condition.method = "A is singular, and too large for all its singular values";
  } else {
    measured.condition = EstimatedCondition(problem);
  }
  if (problem.size() > 0 && measured.rank.value.has_value()) {
    measured.redundancy = 1 - static_cast<double>(*measured.rank.value) / static_cast<double>(problem.size());
  }
  return measured;
}

namespace {

double RootOfDiagonal(const LcpProblem& problem, Index i) {
  return problem.DiagonalA()[i] > 0 ? std::sqrt(problem.DiagonalA()[i]) : 1;
}

void MeasureFriction(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w, double negligible,
                     AnswerProperties* answer) {
  const std::vector<FrictionRow>& rows = problem.friction_rows();
  if (rows.empty()) return;
  Index open = 0, slip = 0;
  for (const FrictionRow& row : rows) {
    if (std::abs(f[row.row]) * RootOfDiagonal(problem, row.row) > negligible) ++answer->friction_forces;
    if (std::abs(f[row.normal]) * RootOfDiagonal(problem, row.normal) <= negligible) {
      ++open;
    } else if (row.slip != 0 || std::abs(w[row.row]) / RootOfDiagonal(problem, row.row) > negligible) {
      ++slip;
    }
  }
  const auto share = [&rows](Index count) { return static_cast<double>(count) / static_cast<double>(rows.size()); };
  answer->open = share(open);
  answer->slip = share(slip);
  answer->stick = share(std::ssize(rows) - open - slip);
}

}  // namespace

AnswerProperties MeasureAnswer(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w,
                               double negligible) {
  AnswerProperties answer;
  Index active = 0;
  Index unilateral = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.kind(i) != RowKind::kUnilateral) continue;
    ++unilateral;
    const double root = RootOfDiagonal(problem, i);
    if (std::abs(w[i]) / root > negligible) continue;
    ++active;
    if (std::abs(f[i]) * root <= negligible) ++answer.degenerate;
  }
  if (unilateral > 0) answer.fraction_active = static_cast<double>(active) / static_cast<double>(unilateral);
  MeasureFriction(problem, f, w, negligible, &answer);
  return answer;
}

std::string Triviality(const LcpProblem& problem, const AnswerProperties& answer) {
  bool no_force = true;
  for (Index i = 0; i < problem.size() && no_force; ++i) {
    if (problem.kind(i) == RowKind::kFriction) continue;  // without a normal force there is none
    no_force = problem.is_bilateral(i) ? problem.b()[i] == 0 : problem.b()[i] >= 0;
  }
  if (no_force) return "f = 0";
  if (!problem.friction_rows().empty()) return answer.friction_forces == 0 ? "no friction force" : "";
  if (answer.fraction_active >= 1 || static_cast<Index>(problem.bilateral_rows().size()) == problem.size()) {
    return "all rows active";
  }
  return answer.fraction_active <= 0 ? "no active contact" : "";
}

}  // namespace lcpbench
