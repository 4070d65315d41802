#include "solvers/exact/vertex_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One FindVertex.
class VertexSearch {
 public:
  VertexSearch(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale, const Deadline& deadline)
      : problem_(problem), lcp_(lcp), scale_(scale), deadline_(deadline) {}

  // False where it comes to no end.
  bool Run(const std::vector<Index>& independent, const std::vector<Index>& dependent, std::vector<BigInteger> f) {
    vertex_ = {independent, std::move(f)};
    Factorize();
    for (const Index k : dependent) {
      if (problem_.is_bilateral(k) || force(k) == 0) continue;
      if (deadline_.Expired() || !BringToZero(k)) return false;
    }
    const int most = pivots_ + kMostPivotsPerRow * static_cast<int>(dependent.size() + 1);
    while (pivots_ < most && !deadline_.Expired()) {
      RefineForces(problem_, lcp_, scale_, *factor_, {}, kDecidingBits, deadline_, &vertex_.f, &w_);
      if (DropNegative()) continue;
      const Index k = MostNegativeGap();
      if (k < 0) return true;
      if (!Enter(k)) return false;
    }
    return false;
  }

  Vertex& vertex() { return vertex_; }
  int pivots() const { return pivots_; }

 private:
  struct Ray {
    Eigen::VectorXd d;  // A_GG^-1 A_Gk
    double stiffness;   // A_kk - A_kG d, as a part of A_kk
  };

  BigInteger& force(Index i) { return vertex_.f[At(i)]; }
  double ForceOf(Index i) { return ToDouble(force(i), scale_.force_bits); }
  BigInteger Digits(double value) const { return Scaled(value, scale_.force_bits); }
  std::vector<Index>::iterator PlaceOf(Index i) {
    return std::lower_bound(vertex_.basis.begin(), vertex_.basis.end(), i);
  }
  bool IsInBasis(Index i) { return std::binary_search(vertex_.basis.begin(), vertex_.basis.end(), i); }

  void Factorize() { factor_.emplace(problem_, vertex_.basis, 0.0); }
  void Leave(Index i) {
    vertex_.basis.erase(PlaceOf(i));
    force(i) = 0;
  }
  void Replace(Index leaving, Index entering) {
    if (leaving >= 0) Leave(leaving);
    vertex_.basis.insert(PlaceOf(entering), entering);
    ++pivots_;
    Factorize();
  }

  Ray FindRay(Index k) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(static_cast<Index>(vertex_.basis.size()));
    for (SparseMatrix::InnerIterator it(problem_.SparseA(), k); it; ++it) {
      if (IsInBasis(it.col())) column[PlaceOf(it.col()) - vertex_.basis.begin()] = it.value();
    }
    Ray ray{factor_->Solve(column), 0};
    const double diagonal = problem_.DiagonalA()[k];
    ray.stiffness = (diagonal - column.dot(ray.d)) / diagonal;
    return ray;
  }

  // The row of G that bounds f_G + t d >= 0 first, and the bound; -1 for none.
  Index Bound(const Eigen::VectorXd& d, double* t) {
    double largest = 0;
    for (Index k = 0; k < d.size(); ++k) {
      largest = std::max(largest, std::abs(d[k]) * RootOfDiagonal(problem_, vertex_.basis[At(k)]));
    }
    Index found = -1;
    double pivot = 0;
    *t = kInfinity;
    for (const bool ties : {false, true}) {
      const double least = *t;
      for (Index k = 0; k < d.size(); ++k) {
        const Index i = vertex_.basis[At(k)];
        const double scaled = -d[k] * RootOfDiagonal(problem_, i);
        if (problem_.is_bilateral(i) || scaled <= kPivotTolerance * largest) continue;
        const double bound = std::max(0.0, ForceOf(i)) / -d[k];
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

  void Move(const Eigen::VectorXd& d, double t) {
    for (Index k = 0; k < d.size(); ++k) force(vertex_.basis[At(k)]) += Digits(t * d[k]);
  }

  bool BringToZero(Index k) {
    const Ray ray = FindRay(k);
    if (!ray.d.allFinite()) return false;
    double t = 0;
    const Index leaving = Bound(ray.d, &t);
    const double own = ForceOf(k);
    Move(ray.d, std::min(t, own));
    if (t >= own) {
      force(k) = 0;
    } else {
      force(k) -= Digits(t);
      Replace(leaving, k);
    }
    return true;
  }

  bool Enter(Index k) {
    const Ray ray = FindRay(k);
    if (!ray.d.allFinite()) return false;
    double t = 0;
    const Index leaving = Bound(-ray.d, &t);
    double closing = kInfinity;
    if (ray.stiffness > kDependentStiffness) {
      const double gap = ToDouble(w_[At(k)], lcp_.matrix_bits() + scale_.force_bits);
      closing = -gap / (ray.stiffness * problem_.DiagonalA()[k]);
    }
    const double step = std::min(t, closing);
    if (!std::isfinite(step)) return false;
    Move(ray.d, -step);
    force(k) += Digits(step);
    Replace(t <= closing ? leaving : -1, k);
    return true;
  }

  // Forces that rounding has taken below 0.
  bool DropNegative() {
    std::vector<Index> negative;
    for (const Index i : vertex_.basis) {
      if (!problem_.is_bilateral(i) && force(i) < 0) negative.push_back(i);
    }
    if (negative.empty()) return false;
    for (const Index i : negative) Leave(i);
    ++pivots_;
    Factorize();
    return true;
  }

  Index MostNegativeGap() {
    Index found = -1;
    double least = 0;
    for (Index i = 0; i < problem_.size(); ++i) {
      if (w_[At(i)] >= 0 || IsInBasis(i) || problem_.is_bilateral(i) || !(problem_.DiagonalA()[i] > 0)) continue;
      const double gap = ToDouble(w_[At(i)], lcp_.matrix_bits() + scale_.force_bits + scale_.load_exponent) /
                         RootOfDiagonal(problem_, i);
      if (found >= 0 && gap >= least) continue;
      found = i;
      least = gap;
    }
    return found;
  }

  const LcpProblem& problem_;
  const DyadicLcp& lcp_;
  const DyadicScale& scale_;
  const Deadline& deadline_;
  Vertex vertex_;
  std::optional<ProximalFactor> factor_;
  std::vector<BigInteger> w_;
  int pivots_ = 0;
};

}  // namespace

std::optional<Vertex> FindVertex(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale,
                                 const std::vector<Index>& independent, const std::vector<Index>& dependent,
                                 std::vector<BigInteger> f, const Deadline& deadline, int* pivots) {
  VertexSearch search(problem, lcp, scale, deadline);
  const bool found = search.Run(independent, dependent, std::move(f));
  *pivots = search.pivots();
  if (!found) return std::nullopt;
  return std::move(search.vertex());
}

}  // namespace lcpbench
