#include "solvers/exact/vertex_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

// Gaps are decided upon at this part of the loads: doubles round at 2^-53 of terms that may be 10^6 times larger.
constexpr long kDecidingBits = 120;
// Parts of the largest entry of a ray that are taken for rounding.
constexpr double kPivotTolerance = 1e-9;
// Bounds as near to each other as this are one; the largest pivot among them is taken.
constexpr double kTie = 1e-9;
// A row with less of its A_kk left depends on the basis.
constexpr double kDependentStiffness = 1e-9;
constexpr int kMostPivotsPerRow = 20;

}  // namespace

void VertexSearch::Factorise() { factor_.emplace(problem_, basis_, 0.0); }

void VertexSearch::Replace(Index leaving, Index entering) {
  if (leaving >= 0) {
    basis_.erase(std::lower_bound(basis_.begin(), basis_.end(), leaving));
    in_basis_[At(leaving)] = 0;
    (*f_)[At(leaving)] = 0;
  }
  if (entering >= 0) {
    basis_.insert(std::lower_bound(basis_.begin(), basis_.end(), entering), entering);
    in_basis_[At(entering)] = 1;
  }
  ++pivots_;
  Factorise();
}

VertexSearch::Ray VertexSearch::FindRay(Index k) const {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(static_cast<Index>(basis_.size()));
  for (SparseMatrix::InnerIterator it(problem_.SparseA(), k); it; ++it) {
    const auto place = std::lower_bound(basis_.begin(), basis_.end(), it.col());
    if (place != basis_.end() && *place == it.col()) column[place - basis_.begin()] = it.value();
  }
  Ray ray{factor_->Solve(column), 0};
  const double diagonal = problem_.DiagonalA()[k];
  ray.stiffness = (diagonal - column.dot(ray.d)) / diagonal;
  return ray;
}

Index VertexSearch::Bound(const Eigen::VectorXd& d, double* t) const {
  double largest = 0;
  for (Index k = 0; k < d.size(); ++k) {
    largest = std::max(largest, std::abs(d[k]) * RootOfDiagonal(problem_, basis_[At(k)]));
  }
  Index found = -1;
  double pivot = 0;
  *t = std::numeric_limits<double>::infinity();
  for (const bool ties : {false, true}) {
    const double least = *t;
    for (Index k = 0; k < d.size(); ++k) {
      const Index i = basis_[At(k)];
      const double scaled = -d[k] * RootOfDiagonal(problem_, i);
      if (problem_.is_bilateral(i) || scaled <= kPivotTolerance * largest) continue;
      const double bound = std::max(0.0, ToDouble((*f_)[At(i)], scale_.force_bits)) / -d[k];
      if (!ties) {
        *t = std::min(*t, bound);
      } else if (bound <= least * (1 + kTie) && scaled > pivot) {
        pivot = scaled;
        found = i;
        *t = bound;
      }
    }
  }
  return found;
}

void VertexSearch::Move(const Eigen::VectorXd& d, double t) {
  for (Index k = 0; k < d.size(); ++k) (*f_)[At(basis_[At(k)])] += Scaled(t * d[k], scale_.force_bits);
}

bool VertexSearch::BringToZero(Index k) {
  const Ray ray = FindRay(k);
  if (!ray.d.allFinite()) return false;
  double t = 0;
  const Index leaving = Bound(ray.d, &t);
  const double own = ToDouble((*f_)[At(k)], scale_.force_bits);
  if (t >= own) {
    Move(ray.d, own);
    (*f_)[At(k)] = 0;
    return true;
  }
  Move(ray.d, t);
  (*f_)[At(k)] -= Scaled(t, scale_.force_bits);
  Replace(leaving, k);
  return true;
}

bool VertexSearch::Enter(Index k) {
  const Ray ray = FindRay(k);
  if (!ray.d.allFinite()) return false;
  double t = 0;
  const Index leaving = Bound(-ray.d, &t);
  double closing = std::numeric_limits<double>::infinity();
  if (ray.stiffness > kDependentStiffness) {
    const double gap = ToDouble(w_[At(k)], lcp_.matrix_bits() + scale_.force_bits);
    closing = -gap / (ray.stiffness * problem_.DiagonalA()[k]);
  }
  const double step = std::min(t, closing);
  if (!std::isfinite(step)) return false;
  Move(ray.d, -step);
  (*f_)[At(k)] += Scaled(step, scale_.force_bits);
  Replace(t <= closing ? leaving : -1, k);
  return true;
}

// Forces that rounding has taken below 0.
bool VertexSearch::DropNegative() {
  std::vector<Index> negative;
  for (const Index i : basis_) {
    if (!problem_.is_bilateral(i) && (*f_)[At(i)] < 0) negative.push_back(i);
  }
  for (const Index i : negative) {
    basis_.erase(std::lower_bound(basis_.begin(), basis_.end(), i));
    in_basis_[At(i)] = 0;
    (*f_)[At(i)] = 0;
  }
  if (negative.empty()) return false;
  ++pivots_;
  Factorise();
  return true;
}

Index VertexSearch::MostNegativeGap() const {
  Index found = -1;
  double least = 0;
  for (Index i = 0; i < problem_.size(); ++i) {
    if (in_basis_[At(i)] != 0 || problem_.is_bilateral(i) || !(problem_.DiagonalA()[i] > 0)) continue;
    if (w_[At(i)] >= 0) continue;
    const double gap = ToDouble(w_[At(i)], lcp_.matrix_bits() + scale_.force_bits + scale_.load_exponent) /
                       RootOfDiagonal(problem_, i);
    if (found >= 0 && gap >= least) continue;
    found = i;
    least = gap;
  }
  return found;
}

bool VertexSearch::Run(const std::vector<Index>& independent, const std::vector<Index>& dependent,
                       std::vector<BigInteger>* f) {
  f_ = f;
  basis_ = independent;
  in_basis_.assign(At(problem_.size()), 0);
  for (const Index i : basis_) in_basis_[At(i)] = 1;
  pivots_ = 0;
  Factorise();
  for (const Index k : dependent) {
    if (problem_.is_bilateral(k) || (*f_)[At(k)] == 0) continue;
    if (deadline_.Expired() || !BringToZero(k)) return false;
  }
  const int most = pivots_ + kMostPivotsPerRow * static_cast<int>(dependent.size() + 1);
  while (pivots_ < most && !deadline_.Expired()) {
    RefineForces(problem_, lcp_, scale_, *factor_, {}, kDecidingBits, deadline_, f_, &w_);
    if (DropNegative()) continue;
    const Index k = MostNegativeGap();
    if (k < 0) return true;
    if (!Enter(k)) return false;
  }
  return false;
}

}  // namespace lcpbench
