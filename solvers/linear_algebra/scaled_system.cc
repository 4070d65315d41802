#include "solvers/linear_algebra/scaled_system.h"

#include <algorithm>
#include <cmath>

#include "solvers/lcp/in_sequence.h"

namespace lcpbench {
namespace {

// Beyond this many entries A is not formed where the factors can do without it
// (12 bytes an entry).
constexpr double kAffordableEntries = 3e7;
// Body space is taken where sum (column count of J)^2, which is about three times the entries of A for contacts of
// rigid bodies, exceeds this multiple of the entries of J. Measured at 3e3 to 1e5 rows: up to 6 (discs) contact space
// is factorized 1.5 to 3 times faster, from 9 on (boxes, walls, bearings) body space is 1.4 to 4 times faster.
constexpr double kBodySpaceRatio = 7;

}  // namespace

void ScaledSystem::Prepare(const LcpProblem& problem, Space space) {
  problem_ = problem;
  analyses_ = 0;
  double contact_entries = 0;
  if (problem.has_factors()) {
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(problem.J().cols());
    for (Index i = 0; i < problem.size(); ++i) {
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) counts[it.col()] += 1;
    }
    for (Index k = 0; k < counts.size(); ++k) {
      if (problem.inverse_mass()[k] > 0) contact_entries += counts[k] * counts[k];
    }
  }
  ScaleRows();
  body_space_ = ChooseBodySpace(space, contact_entries);
  if (body_space_) {
    BuildBodySpace();
  } else {
    BuildContactSpace();
  }
}

bool ScaledSystem::ChooseBodySpace(Space space, double contact_entries) {
  if (space == Space::kContact || !BodySpace::Suits(*problem_)) return false;
  if (space == Space::kBody || contact_entries > kAffordableEntries) return true;
  return contact_entries > kBodySpaceRatio * static_cast<double>(problem_->J().nonZeros());
}

void ScaledSystem::ScaleRows() {
  rows_.Reset(*problem_);
  const Eigen::VectorXd& d = problem_->DiagonalA();
  for (Index i = 0; i < size(); ++i) rows_.scale[i] = d[i] > 0 ? 1 / std::sqrt(d[i]) : 1.0;
  rows_.diagonal.setOnes();
  if (problem_->has_factors()) {
    parts_.FindByColumns(problem_->J(), problem_->inverse_mass());
  } else {
    parts_.Find(problem_->SparseA(), std::vector<char>(static_cast<size_t>(size()), 1));
  }
}

void ScaledSystem::SetB(const LcpProblem& problem) {
  problem_ = problem;
  const Eigen::VectorXd& b = problem.b();
  rows_.b = rows_.scale.cwiseProduct(b);
  const double norm = rows_.b.norm();
  rows_.b_norm = norm > 0 ? norm : 1.0;
  for (Index k = 0; k < parts_.count(); ++k) {
    double largest = 0;
    bool is_live = false;  // f = 0 is no solution
    for (const Index i : parts_.rows(k)) {
      largest = std::max(largest, std::abs(rows_.b[i]));
      is_live = is_live || (rows_.is_joint(i) ? b[i] != 0 : b[i] < 0);
    }
    for (const Index i : parts_.rows(k)) {
      rows_.b_unit[i] = largest > 0 ? largest : 1.0;
      rows_.b[i] /= rows_.b_unit[i];
      rows_.can_act[static_cast<size_t>(i)] = is_live && problem.DiagonalA()[i] > 0 ? 1 : 0;
    }
  }
}

void ScaledSystem::BuildContactSpace() {
  const LcpProblem& problem = *problem_;
  const Index n = problem.size();
  scaled_A_ = problem.SparseA();
  for (Index i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(scaled_A_, i); it; ++it) {
      const bool moves = problem.DiagonalA()[i] > 0;
      it.valueRef() = it.col() == i ? (moves ? 1.0 : 0.0) : it.value() * rows_.scale[i] * rows_.scale[it.col()];
    }
  }
  // Row-major upper triangle = column-major lower triangle of the symmetric matrix.
  const SparseMatrix upper = scaled_A_.triangularView<Eigen::Upper>();
  const Eigen::Map<const CholmodFactor::ColumnMatrix> lower(n, n, upper.nonZeros(), upper.outerIndexPtr(),
                                                            upper.innerIndexPtr(), upper.valuePtr());
  if (InSequence::on() && factor_.TakeValues(lower)) return;
  ++analyses_;
  factor_.Analyze(CholmodFactor::Definiteness::kPositiveDefinite, lower);
}

void ScaledSystem::BuildBodySpace() {
  std::vector<char> can_act(static_cast<size_t>(size()));
  for (Index i = 0; i < size(); ++i) can_act[static_cast<size_t>(i)] = problem_->DiagonalA()[i] > 0 ? 1 : 0;
  bodies_.Prepare(*problem_, can_act);
  bodies_.Load(*problem_, rows_.scale.cwiseInverse());
  analyses_ += bodies_.analyses();
}

void ScaledSystem::Multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const {
  if (body_space_) {
    y->resize(size());
    bodies_.Multiply(x.data(), y->data());
  } else {
    y->noalias() = scaled_A_ * x;
  }
}

bool ScaledSystem::Factorize(const Eigen::VectorXd& theta) {
  if (body_space_) {
    pivots_ = theta;
    for (Index i = 0; i < size(); ++i) {
      if (idle(i)) pivots_[i] = kOut;
    }
    return bodies_.Factorize(pivots_);
  }
  for (Index i = 0; i < size(); ++i) factor_.SetDiagonal(i, 1.0 + (idle(i) ? kOut : theta[i]));
  return factor_.Factorize();
}

void ScaledSystem::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  if (body_space_) {
    bodies_.Solve(r, x);
  } else {
    factor_.Solve(r, x);
  }
}

}  // namespace lcpbench
