#include "solvers/exact/bounded_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/exact/dyadic_lcp.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/exact/independent_block.h"
#include "solvers/lcp/solver.h"
#include "support/input_error.h"

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
constexpr int kMostPivotsPerDependentRow = 20;
// A share of the scaled diagonal: far above the rounding of doubles, and below the least eigenvalues that are not 0.
constexpr double kProximal = 0x1p-30;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where rows depend on others to the rounding of doubles, the problem as its doubles say it still tells which of them
// are active: at the last digits of b, forces being moved along each other by any amount. This finds out, by pivots as
// of the primal simplex method.
//
// Dependent rows are first brought to f = 0, each by the ray of forces that leaves the gaps of a basis G of
// independent rows alone, up to the first force of G that becomes 0, whose place it takes. Then, with gaps in
// integers, the row of the most negative gap enters G in the same way, until there is none.
//
// O(fill) of a sparse factor a pivot, some hundred pivots per hundred dependent rows
class VertexSearch {
 public:
  VertexSearch(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale, const Deadline& deadline)
      : problem_(problem), lcp_(lcp), scale_(scale), deadline_(deadline) {}

  // False where pivoting does not end, or where the problem may have no solution.
  // @param f  forces >= 0 with small gaps on all rows with f > 0
  bool Search(const std::vector<Index>& independent, const std::vector<Index>& dependent, std::vector<BigInteger> f) {
    basis_ = independent;
    f_ = std::move(f);
    Factorize();
    for (const Index k : dependent) {
      if (problem_.is_bilateral(k) || force(k) == 0) continue;
      if (deadline_.Expired() || !BringToZero(k)) return false;
    }
    const int most = pivots_ + kMostPivotsPerDependentRow * static_cast<int>(dependent.size() + 1);
    while (pivots_ < most && !deadline_.Expired()) {
      RefineForces(problem_, lcp_, scale_, *factor_, {}, kDecidingBits, deadline_, &f_, &w_);
      if (DropNegative()) continue;
      const Index k = MostNegativeGap();
      if (k < 0) return true;
      if (!Enter(k)) return false;
    }
    return false;
  }

  // G, ascending: the active rows.
  const std::vector<Index>& basis() const { return basis_; }
  // By the digits of DyadicScale.
  const std::vector<BigInteger>& f() const { return f_; }
  int pivots() const { return pivots_; }

 private:
  struct Ray {
    Eigen::VectorXd d;  // A_GG^-1 A_Gk
    double stiffness;   // A_kk - A_kG d, as a part of A_kk
  };

  BigInteger& force(Index i) { return f_[At(i)]; }
  double ForceOf(Index i) { return ToDouble(force(i), scale_.force_bits); }
  BigInteger Digits(double value) const { return Scaled(value, scale_.force_bits); }
  std::vector<Index>::iterator PlaceOf(Index i) { return std::lower_bound(basis_.begin(), basis_.end(), i); }
  bool IsInBasis(Index i) { return std::binary_search(basis_.begin(), basis_.end(), i); }

  // Factorizes a basis that is exactly singular, with the proximal part.
  void Factorize() {
    factor_.emplace(problem_, basis_, 0.0);
    if (!factor_->IsFactorized()) factor_.emplace(problem_, basis_, kProximal);
  }
  void Leave(Index i) {
    basis_.erase(PlaceOf(i));
    force(i) = 0;
  }
  void Replace(Index leaving, Index entering) {
    if (leaving >= 0) Leave(leaving);
    basis_.insert(PlaceOf(entering), entering);
    ++pivots_;
    Factorize();
  }

  Ray FindRay(Index k) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(static_cast<Index>(basis_.size()));
    for (SparseMatrix::InnerIterator it(problem_.SparseA(), k); it; ++it) {
      if (IsInBasis(it.col())) column[PlaceOf(it.col()) - basis_.begin()] = it.value();
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
      largest = std::max(largest, std::abs(d[k]) * RootOfDiagonal(problem_, basis_[At(k)]));
    }
    Index found = -1;
    double pivot = 0;
    *t = kInfinity;
    for (const bool ties : {false, true}) {
      const double least = *t;
      for (Index k = 0; k < d.size(); ++k) {
        const Index i = basis_[At(k)];
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
    for (Index k = 0; k < d.size(); ++k) force(basis_[At(k)]) += Digits(t * d[k]);
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
    for (const Index i : basis_) {
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
  std::vector<Index> basis_;
  std::vector<BigInteger> f_;
  std::optional<ProximalFactor> factor_;
  std::vector<BigInteger> w_;
  int pivots_ = 0;
};

// Bits of forces beyond |D^-1/2 b|_inf / max D^1/2, the size of a force that moves anything.
constexpr long kForceBits = 200;
// Gaps that are aimed at where they must not be negative, in units of D^1/2 |D^-1/2 b|_inf: far above the digits of the
// forces, even with 10^6 rows of mass ratio 10^6, and far below anything that counts.
constexpr long kTargetBits = 150;
constexpr int kMostExchanges = 30;
// More than there are: as far as refinement goes.
constexpr long kAllBits = 1000;
// What gains less than a factor of this has come to its end.
constexpr double kLeastGain = 2;
constexpr int kPatience = 4;

Index Count(const std::vector<Index>& rows) { return static_cast<Index>(rows.size()); }

void RequireBounded(const LcpProblem& problem) {
  if (problem.has_factors()) return;
  if (problem.Asymmetry() != 0) throw InputError(problem.id() + ": expected a symmetric A, found entries that differ");
  if (!problem.facts().positive_semidefinite) {
    throw InputError(problem.id() + ": expected J and invM, or an A that is stated to be positive semidefinite");
  }
}

// One RefineReference.
class Refinement {
 public:
  Refinement(const LcpProblem& problem, const Eigen::VectorXd& f_start, const BoundedOptions& options)
      : problem_(problem),
        lcp_(problem),
        deadline_(LcpOptions{.time_limit_s = options.time_limit_s}),
        most_dependent_rows_(options.most_dependent_rows),
        f_(At(problem.size())) {
    double largest_load = 0;
    double largest_root = 0;
    for (Index i = 0; i < size(); ++i) {
      const double root = RootOfDiagonal(problem_, i);
      largest_load = std::max(largest_load, std::abs(problem.b()[i]) / root);
      largest_root = std::max(largest_root, root);
    }
    scale_.load_exponent = largest_load > 0 ? FrexpExponent(largest_load) : 0;
    scale_.force_bits =
        std::max(lcp_.least_force_bits(), kForceBits - scale_.load_exponent + FrexpExponent(largest_root));
    Eigen::VectorXd w;
    problem.ComputeW(f_start, &w);
    active_.assign(At(size()), 0);
    for (Index i = 0; i < size(); ++i) {
      const double diagonal = problem.DiagonalA()[i];
      if (!(diagonal > 0)) continue;  // nothing depends on its force
      active_[At(i)] = problem.is_bilateral(i) || (f_start[i] > 0 && diagonal * f_start[i] > w[i]) ? 1 : 0;
      if (active_[At(i)] != 0) f_[At(i)] = Scaled(f_start[i], scale_.force_bits);
    }
  }

  BoundedReference Compute() {
    const std::vector<BigInteger> start = f_;
    const std::vector<char> active_at_start = active_;
    std::optional<IndependentBlock> factor;
    bool settled = false;
    while (!settled && reference_.exchanges < kMostExchanges && !deadline_.Expired()) {
      ++reference_.exchanges;
      factor.emplace(problem_, Rows());
      if (!factor->dependent().empty()) break;
      Refine(*factor, {});
      settled = !Exchange([this](Index i) { return w_[At(i)] >= 0; });
    }
    if (!settled) {
      f_ = start;
      active_ = active_at_start;
      Polish();
    }
    Clip();
    if (!settled) {
      factor.emplace(problem_, Rows());
      if (TakeVertex(*factor)) {
        factor.emplace(problem_, Rows());
        Refine(*factor, {});
        Clip();
      }
    }
    reference_.active = Count(Rows());
    reference_.dependent = Count(factor->dependent());
    if (!ProveActiveRows(*factor) && !ProveFeasible(*factor)) ProveNearby();
    reference_.f.resize(At(size()));
    for (Index i = 0; i < size(); ++i) reference_.f[At(i)] = Shifted(Rational(f_[At(i)]), -scale_.force_bits);
    return std::move(reference_);
  }

 private:
  Index size() const { return problem_.size(); }
  long gap_bits() const { return lcp_.matrix_bits() + scale_.force_bits; }
  std::vector<Index> Rows() const {
    std::vector<Index> rows;
    for (Index i = 0; i < size(); ++i) {
      if (active_[At(i)] != 0) rows.push_back(i);
    }
    return rows;
  }

  void Evaluate() { lcp_.ComputeGaps(f_, scale_.force_bits, &w_); }

  // Until w is `target` on the independent rows, as far as that goes.
  void Refine(const IndependentBlock& factor, const std::vector<BigInteger>& target) {
    reference_.refinements +=
        RefineForces(problem_, lcp_, scale_, factor.factor(), target, kAllBits, deadline_, &f_, &w_);
  }

  // What rounding has left below 0 is 0.
  void Clip() {
    for (Index i = 0; i < size(); ++i) {
      if (!problem_.is_bilateral(i) && f_[At(i)] < 0) f_[At(i)] = 0;
    }
    Evaluate();
  }

  // Active rows with a force below 0 and others whose gap is not right change sides; false where there are none.
  template <typename Predicate>
  bool Exchange(Predicate has_right_gap) {
    bool any = false;
    for (Index i = 0; i < size(); ++i) {
      if (problem_.is_bilateral(i) || !(problem_.DiagonalA()[i] > 0)) continue;
      const bool is_active = active_[At(i)] != 0;
      if (is_active ? f_[At(i)] >= 0 : has_right_gap(i)) continue;
      if (is_active) f_[At(i)] = 0;
      active_[At(i)] = is_active ? 0 : 1;
      any = true;
    }
    return any;
  }

  // Where rows depend on others, forces do: the proximal point method moves them as little as it takes. A step from c
  // solves the problem with A + kProximal S^-2 and b - kProximal S^-2 c [Rockafellar 1976]. Keeps the best.
  void Polish() {
    std::vector<BigInteger> best = f_;
    double least = std::numeric_limits<double>::infinity();
    for (int patience = kPatience; patience > 0 && !deadline_.Expired(); --patience) {
      Evaluate();
      const double shift = lcp_.ScaledNorm(Shift(), gap_bits());
      if (shift * kLeastGain <= least) patience = kPatience;
      if (shift < least) {
        least = shift;
        best = f_;
      }
      if (shift == 0 || !ProximalStep(FrexpExponent(shift))) break;
    }
    f_ = std::move(best);
  }

  // Which rows of a set of dependent ones are active as their doubles say it; false where that comes to no end.
  bool TakeVertex(const IndependentBlock& factor) {
    const Index dependent = Count(factor.dependent());
    if (dependent == 0 || dependent > most_dependent_rows_) return false;
    VertexSearch search(problem_, lcp_, scale_, deadline_);
    const bool found = search.Search(factor.independent(), factor.dependent(), f_);
    reference_.pivots = search.pivots();
    if (!found) return false;
    f_ = search.f();
    active_.assign(At(size()), 0);
    for (const Index i : search.basis()) active_[At(i)] = 1;
    return true;
  }

  // By exchanges in blocks from the active rows before; residuals are scaled by 2^-unit. False where it breaks down.
  bool ProximalStep(long unit) {
    const std::vector<BigInteger> center = f_;
    for (int exchange = 0; exchange < kMostExchanges && !deadline_.Expired(); ++exchange) {
      const std::vector<Index> rows = Rows();
      for (Index i = 0; i < size(); ++i) {
        f_[At(i)] = active_[At(i)] != 0 ? center[At(i)] : BigInteger(0);
      }
      Evaluate();
      if (!proximal_.has_value() || proximal_->rows() != rows) proximal_.emplace(problem_, rows, kProximal);
      Eigen::VectorXd residual(Count(rows));
      for (Index k = 0; k < residual.size(); ++k) residual[k] = ToDouble(w_[At(rows[At(k)])], gap_bits() + unit);
      const Eigen::VectorXd change = proximal_->Solve(residual);
      if (!change.allFinite()) return false;
      for (Index k = 0; k < change.size(); ++k) f_[At(rows[At(k)])] -= Scaled(change[k], scale_.force_bits + unit);
      ++reference_.refinements;
      Evaluate();
      // S^-2 is D but for a factor of 2.
      const auto is_pulled_open = [&](Index i) {
        const double pull = kProximal * problem_.DiagonalA()[i] * ToDouble(center[At(i)], scale_.force_bits + unit);
        return ToDouble(w_[At(i)], gap_bits() + unit) >= pull;
      };
      if (!Exchange(is_pulled_open)) return true;
    }
    return true;
  }

  // False where they are not proved to be the active ones; then detail says why.
  bool ProveActiveRows(const IndependentBlock& factor) {
    reference_.detail = ProveOrTellWhyNot(factor);
    return reference_.detail.empty();
  }

  std::string ProveOrTellWhyNot(const IndependentBlock& factor) {
    if (!factor.dependent().empty()) return "some active rows depend on others";
    const double eigenvalue = factor.LeastEigenvalueBound();
    if (eigenvalue == 0) return "no bound > 0 of the least eigenvalue on the active rows";
    // R = |S w_F|; |S^-1 (x - f_F)| <= R / eigenvalue and |x - f_F|_A <= R / eigenvalue^1/2. All of these squared.
    const std::vector<Index>& rows = factor.independent();
    const Eigen::VectorXd& scale = factor.factor().scale();
    Rational squares = 0, largest = 0;
    for (size_t k = 0; k < rows.size(); ++k) squares += Squared(Gap(rows[k]) * Rational(scale[static_cast<Index>(k)]));
    const Rational energy = squares / Rational(eigenvalue), distance = energy / Rational(eigenvalue);
    for (size_t k = 0; k < rows.size(); ++k) {
      const Rational error = distance * Squared(Rational(scale[static_cast<Index>(k)]));
      const Rational force = Shifted(Rational(f_[At(rows[k])]), -scale_.force_bits);
      if (!problem_.is_bilateral(rows[k]) && !(force > 0 && error < Squared(force))) {
        return "a force is too small to be told from 0";
      }
      largest = std::max<Rational>(largest, error * Diagonal(rows[k]));
    }
    for (Index i = 0; i < size(); ++i) {
      if (active_[At(i)] != 0 || (problem_.is_bilateral(i) && w_[At(i)] == 0)) continue;
      if (problem_.is_bilateral(i)) return "a joint that nothing moves";
      if (!(w_[At(i)] > 0 && Diagonal(i) * energy < Squared(Gap(i)))) return "a gap is too small to be told from 0";
    }
    reference_.proof = BoundedReference::Proof::kActiveRows;
    reference_.energy_bound = RoundUp(energy);
    reference_.w_bound = RootUp(energy);
    reference_.f_bound = RootUp(largest);
    SetGaps([this](Index i) { return active_[At(i)] == 0; });
    return {};
  }

  static Rational Squared(const Rational& value) { return value * value; }
  Rational Gap(Index i) const { return Shifted(Rational(w_[At(i)]), -gap_bits()); }
  Rational Diagonal(Index i) const { return Shifted(Rational(lcp_.diagonal(i)), -lcp_.matrix_bits()); }

  // With gaps on the active rows that are too small to count and not negative.
  bool ProveFeasible(const IndependentBlock& factor) {
    for (Index i = 0; i < size(); ++i) {
      if (problem_.is_bilateral(i) && w_[At(i)] != 0) return false;
    }
    const std::vector<BigInteger> exact = f_;
    std::vector<BigInteger> target;
    for (const Index i : factor.independent()) {
      target.push_back(problem_.is_bilateral(i)
                           ? BigInteger(0)
                           : Scaled(RootOfDiagonal(problem_, i), gap_bits() + scale_.load_exponent - kTargetBits));
    }
    Refine(factor, target);
    BigInteger energy = 0;
    for (Index i = 0; i < size(); ++i) {
      if (problem_.is_bilateral(i) ? w_[At(i)] == 0 : w_[At(i)] >= 0 && f_[At(i)] >= 0) {
        energy += f_[At(i)] * w_[At(i)];  // 0 on bilateral rows
        continue;
      }
      f_ = exact;
      Evaluate();
      return false;
    }
    reference_.proof = BoundedReference::Proof::kFeasiblePoint;
    const double bound = RoundUp(Shifted(Rational(energy), -scale_.force_bits - gap_bits()));
    reference_.energy_bound = bound;
    reference_.w_bound = std::isfinite(bound) ? RootUp(Rational(bound)) : bound;
    SetGaps([](Index) { return true; });
    return true;
  }

  bool KeepsGap(Index i) const { return !problem_.is_bilateral(i) && f_[At(i)] == 0 && w_[At(i)] > 0; }

  // w - w~ of kNearbyProblem.
  std::vector<BigInteger> Shift() const {
    std::vector<BigInteger> shift(At(size()));
    for (Index i = 0; i < size(); ++i) {
      if (!KeepsGap(i)) shift[At(i)] = w_[At(i)];
    }
    return shift;
  }

  void ProveNearby() {
    reference_.proof = BoundedReference::Proof::kNearbyProblem;
    reference_.energy_shift = lcp_.ScaledNorm(Shift(), gap_bits());
    SetGaps([this](Index i) { return KeepsGap(i); });
  }

  template <class Predicate>
  void SetGaps(Predicate has_gap) {
    reference_.w.setZero(size());
    for (Index i = 0; i < size(); ++i) {
      if (has_gap(i)) reference_.w[i] = RoundToNearest(Gap(i));
    }
  }

  const LcpProblem& problem_;
  DyadicLcp lcp_;
  Deadline deadline_;
  Index most_dependent_rows_;
  DyadicScale scale_;
  std::optional<ProximalFactor> proximal_;
  std::vector<char> active_;
  std::vector<BigInteger> f_;  // in units of 2^-force_bits
  std::vector<BigInteger> w_;  // in units of 2^-gap_bits
  BoundedReference reference_;
};

}  // namespace

const char* ToString(BoundedReference::Proof proof) {
  constexpr const char* kNames[] = {"active rows", "feasible point", "nearby problem"};
  return kNames[static_cast<int>(proof)];
}

BoundedReference RefineReference(const LcpProblem& problem, const Eigen::VectorXd& f_start,
                                 const BoundedOptions& options) {
  RequireBounded(problem);
  if (f_start.size() != problem.size() || !f_start.allFinite()) {
    throw InputError(problem.id() + ": expected a start of " + std::to_string(problem.size()) + " finite forces");
  }
  return Refinement(problem, f_start, options).Compute();
}

}  // namespace lcpbench
