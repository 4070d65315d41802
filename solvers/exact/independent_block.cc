#include "solvers/exact/independent_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/exact/rational.h"

namespace lcpbench {
namespace {

// A share of the unit diagonal, added to it where dependent rows are looked for. Their pivots are about this, those of
// independent rows above kDependentPivot: that a chain of bodies with masses 1 and 10^6 in turns still is.
constexpr double kFindingPart = 0x1p-40;
constexpr double kDependentPivot = 0x1p-36;

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;
// For the rounding of an error bound itself, some hundred operations on numbers of one sign.
constexpr double kSlack = 1.01;
// Within these, and with all entries of J below kLargestEntry, what underflow loses of a scaled entry is below
// kUnderflow.
constexpr double kLeastDiagonal = 1e-200;
constexpr double kLargestDiagonal = 1e200;
constexpr double kLargestEntry = 1e50;
constexpr double kUnderflow = 1e-50;

using BlockMatrix = ProximalFactor::Matrix;

constexpr int kPowerSteps = 8;
// Parts of the estimated least eigenvalue that are tried in turn.
constexpr double kTriedParts[] = {0.5, 0.1, 0.01};

// Higham's gamma_k.
double Gamma(double operations) { return operations * kUnitRoundoff / (1 - operations * kUnitRoundoff); }

Eigen::VectorXd PowersOfTwo(const LcpProblem& problem, const std::vector<Index>& rows) {
  Eigen::VectorXd scale(static_cast<Index>(rows.size()));
  for (Index k = 0; k < scale.size(); ++k) {
    int exponent = 0;
    std::frexp(problem.DiagonalA()[rows[At(k)]], &exponent);
    // Half of it, rounded down.
    scale[k] = std::ldexp(1.0, -(exponent >= 0 ? exponent / 2 : -((1 - exponent) / 2)));
  }
  return scale;
}

}  // namespace

ProximalFactor::ProximalFactor(const LcpProblem& problem, std::vector<Index> rows, double part)
    : rows_(std::move(rows)), scale_(PowersOfTwo(problem, rows_)) {
  const SparseMatrix& A = problem.SparseA();
  std::vector<int> place(At(problem.size()), -1);
  for (size_t k = 0; k < rows_.size(); ++k) place[At(rows_[k])] = static_cast<int>(k);
  const auto n = static_cast<Index>(rows_.size());
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index k = 0; k < n; ++k) {
    for (SparseMatrix::InnerIterator it(A, rows_[At(k)]); it; ++it) {
      const int column = place[At(it.col())];
      if (column < 0 || column > k) continue;
      entries.emplace_back(static_cast<int>(k), column, it.value() * scale_[k] * scale_[column]);
    }
  }
  block_.resize(n, n);
  block_.setFromTriplets(entries.begin(), entries.end());
  if (n == 0) return;
  factor_.setShift(part);
  factor_.compute(block_);
  if (IsFactorized()) pivots_ = factor_.vectorD();
}

Eigen::VectorXd ProximalFactor::Solve(const Eigen::VectorXd& r) const {
  if (rows_.empty()) return r;
  if (!IsFactorized()) return Eigen::VectorXd::Constant(r.size(), std::numeric_limits<double>::quiet_NaN());
  return scale_.cwiseProduct(factor_.solve(scale_.cwiseProduct(r)));
}

double ProximalFactor::Pivot(Index k) const { return pivots_[factor_.permutationP().indices()[k]]; }

IndependentBlock::IndependentBlock(const LcpProblem& problem, const std::vector<Index>& rows) : problem_(problem) {
  const ProximalFactor all(problem, rows, kFindingPart);
  std::vector<Index> independent;
  for (size_t k = 0; k < rows.size(); ++k) {
    const bool depends = all.IsFactorized() && all.Pivot(static_cast<Index>(k)) <= kDependentPivot;
    (depends ? dependent_ : independent).push_back(rows[k]);
  }
  factor_.emplace(problem, std::move(independent), 0.0);
}

double IndependentBlock::EstimateLeastEigenvalue() const {
  const Eigen::VectorXd& scale = factor_->scale();
  Eigen::VectorXd x(factor_->block().rows());
  for (Index k = 0; k < x.size(); ++k) x[k] = std::cos(static_cast<double>(k));  // no vector of any structure
  double growth = 0;
  for (int step = 0; step < kPowerSteps; ++step) {
    x.normalize();
    x = factor_->Solve(x.cwiseQuotient(scale)).cwiseQuotient(scale);
    growth = x.norm();
    if (!std::isfinite(growth) || growth == 0) return 0;
  }
  return 1 / growth;
}

// | |S (A_GG - exact) S| |_inf: from factors, an entry of A is a sum of as many products as a row of J has entries.
double IndependentBlock::EntryErrors() const {
  if (!problem_.has_factors()) return 0;
  const SparseMatrix& J = problem_.J();
  const std::vector<Index>& rows = independent();
  const Eigen::VectorXd& scale = factor_->scale();
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(J.cols());
  Index most = 0;
  for (size_t k = 0; k < rows.size(); ++k) {
    Index entries = 0;
    for (SparseMatrix::InnerIterator it(J, rows[k]); it; ++it, ++entries) {
      moved[it.col()] += std::abs(it.value()) * scale[static_cast<Index>(k)];
    }
    most = std::max(most, entries);
  }
  moved = moved.cwiseProduct(problem_.inverse_mass());
  double largest = 0;
  for (size_t k = 0; k < rows.size(); ++k) {
    double sum = 0;
    for (SparseMatrix::InnerIterator it(J, rows[k]); it; ++it) sum += std::abs(it.value()) * moved[it.col()];
    largest = std::max(largest, sum * scale[static_cast<Index>(k)]);
  }
  return kSlack * Gamma(static_cast<double>(most) + 2) * largest;
}

double IndependentBlock::LeastEigenvalueBound() const {
  const BlockMatrix& block = factor_->block();
  const Index n = block.rows();
  if (n == 0) return 1;
  if (!factor_->IsFactorized()) return 0;
  for (const Index i : independent()) {
    const double diagonal = problem_.DiagonalA()[i];
    if (!(diagonal >= kLeastDiagonal && diagonal <= kLargestDiagonal)) return 0;
  }
  if (problem_.has_factors() && problem_.J().nonZeros() > 0 && problem_.J().coeffs().abs().maxCoeff() > kLargestEntry) {
    return 0;
  }
  const double estimate = EstimateLeastEigenvalue();
  const double entry_errors = EntryErrors();
  for (const double part : kTriedParts) {
    const double c = part * estimate;
    BlockMatrix shifted = block;
    for (Index k = 0; k < n; ++k) shifted.coeffRef(k, k) -= c;
    const Eigen::SimplicialLLT<BlockMatrix> factor(shifted);
    if (factor.info() != Eigen::Success) continue;
    const BlockMatrix& L = factor.matrixL().nestedExpression();
    // |L| |L^T| 1, and the most entries of a row.
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(n);
    std::vector<Index> entries(At(n), 0);
    for (Index j = 0; j < n; ++j) {
      double column = 0;
      for (BlockMatrix::InnerIterator it(L, j); it; ++it) column += std::abs(it.value());
      for (BlockMatrix::InnerIterator it(L, j); it; ++it) {
        sums[it.row()] += std::abs(it.value()) * column;
        ++entries[At(it.row())];
      }
    }
    const double most = static_cast<double>(*std::max_element(entries.begin(), entries.end()));
    // On the diagonal c is subtracted with a rounding.
    const double errors = kSlack * (Gamma(most + 1) * sums.maxCoeff() + 2 * kUnitRoundoff + entry_errors) +
                          static_cast<double>(n) * kUnderflow;
    const double bound = (c - errors) / kSlack;
    if (bound > 0) return bound;
  }
  return 0;
}

}  // namespace lcpbench
