#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "solvers/linear_algebra/dense_ldlt.h"
#include "solvers/linear_algebra/scaled_lcp.h"

namespace lcpbench {

/// The basis of a principal pivoting method, that is its active rows F, and the factor of A_FF: positions [0, m) of the
/// permuted problem are F, and the L D L^T of A_FF is updated when a row enters and when one leaves, O(m^2) each; it is
/// never made from scratch. Only Reserve allocates.
class ComplementaryBasis {
 public:
  using Index = Eigen::Index;

  void Reserve(Index max_rows) {
    if (max_rows <= df_.size()) return;
    lcp.Reserve(max_rows);
    ldlt_.Reserve(max_rows);
    for (Eigen::VectorXd* v : {&df_, &z_, &z_other_, &x_}) v->setZero(max_rows);
    for (std::vector<Index>* v : {&order_, &slot_}) v->resize(static_cast<size_t>(max_rows));
    kept_.reserve(static_cast<size_t>(max_rows));
  }
  /// F becomes empty; for the problem that `lcp` holds now.
  void Reset() {
    ldlt_.Reset(lcp.n);
    m_ = 0;
  }

  /// The problem in its current order. Callers move rows outside F only.
  PermutedLcp lcp;

  Index size() const { return m_; }
  /// The pivot of the row of F at position p in the order of the factor, when it entered.
  double pivot(Index p) const { return ldlt_.pivot(SlotOf(p)); }

  /// F := the positions [0, rows) but those whose pivot, in their order, is at most `threshold` A_pp. The rows left out
  /// move behind F, in no particular order; rows before the first of them stay. O(m^3)
  /// @param deadline  nullptr for none
  /// @returns false if the deadline passed meanwhile; F is empty then
  bool Factor(Index rows, double threshold, const Deadline* deadline) {
    constexpr Index kLanes = DenseLdlt::kLanes;
    constexpr Index kColumnsPerClockRead = 64;
    m_ = 0;
    kept_.clear();
    for (Index k = 0; k < rows; ++k) {
      if (k % kColumnsPerClockRead == kColumnsPerClockRead - 1 && deadline != nullptr && deadline->Expired()) {
        return false;
      }
      const double* from = lcp.column(k);
      double* to = ldlt_.column(k);
      // Both have columns of whole lanes.
      for (Index i = k / kLanes * kLanes; i < rows; i += kLanes) std::copy(from + i, from + i + kLanes, to + i);
      for (Index i = rows; i % kLanes != 0; ++i) to[i] = 0;
    }
    if (!ldlt_.Factor(rows, threshold, &kept_, deadline)) return false;
    for (Index k = 0; k < std::ssize(kept_); ++k) Place(k, kept_[static_cast<size_t>(k)]);
    m_ = rows;
    auto kept = kept_.rbegin();
    for (Index p = rows - 1; p >= 0; --p) {
      if (kept != kept_.rend() && *kept == p) {
        ++kept;
      } else {
        MoveOut(p);
      }
    }
    return true;
  }
  /// Where the first of the rows left out was; `rows` if there was none.
  Index first_left_out(Index rows) const {
    const auto is_other = [first = Index{0}](Index row) mutable { return row != first++; };
    return std::min(rows, std::find_if(kept_.begin(), kept_.end(), is_other) - kept_.begin());
  }

  /// The driven row d outside F: L^-1 A_Fd is kept, and follows rows that enter. Returns s = A_dd - A_dF A_FF^-1 A_Fd,
  /// the pivot that d would have in F.  O(m^2)
  double SetDriven(Index d) { return Eliminate(d, &z_); }
  /// df_F = -A_FF^-1 A_Fd for the driven row. Returns y.D y for y = (df_F, 1), D = diag A.  O(m^2)
  double Direction(Index d) {
    for (Index k = 0; k < m_; ++k) x_[k] = z_[k] * ldlt_.inverse_pivot(k);
    ldlt_.BackSolve(x_.data());
    double norm2 = lcp.diagonal[d];
    for (Index k = 0; k < m_; ++k) {
      const Index p = PositionOf(k);
      df_[p] = -x_[k];
      norm2 += lcp.diagonal[p] * x_[k] * x_[k];
    }
    return norm2;
  }
  /// By position; what stands behind F is the caller's, until F changes.
  const double* df() const { return df_.data(); }
  double* df() { return df_.data(); }

  /// The driven row d, of pivot s, joins F: it moves to position m, and the row there to its place.  O(m + n)
  void EnterDriven(Index d, double s) { Append(d, z_, s); }
  /// The pivot that row p (not the driven one) would have; to be followed by Enter, or by nothing.  O(m^2)
  double PivotOf(Index p) { return Eliminate(p, &z_other_); }
  /// Row p joins F after PivotOf(p) returned `pivot`. Returns the new s of the driven row d.  O(m + n)
  double Enter(Index p, double pivot, Index d) {
    // One more step of the forward substitution for the driven row.
    double z_new = lcp.column(d)[p];
    for (Index k = 0; k < m_; ++k) z_new -= z_other_[k] * z_[k] * ldlt_.inverse_pivot(k);
    z_[m_] = z_new;
    Append(p, z_other_, pivot);
    return ldlt_.PivotOf(z_.data(), lcp.diagonal[d]);
  }
  /// Row p of F leaves: it moves to position m - 1, now the first outside. The driven row must be set again.  O(m^2 +
  /// n)
  void Leave(Index p) {
    const Index k = SlotOf(p);
    ldlt_.Remove(k);
    for (Index j = k; j + 1 < m_; ++j) Place(j, PositionOf(j + 1));
    MoveOut(p);
  }

  /// f_F = -A_FF^-1 b_F. Returns the largest A_ii f_i^2.  O(m^2)
  double SolveForces() {
    lcp.f.head(m_) = -lcp.b.head(m_);
    SolveSystem(lcp.f.data());
    double largest = 0;
    for (Index p = 0; p < m_; ++p) largest = std::max(largest, lcp.diagonal[p] * lcp.f[p] * lcp.f[p]);
    return largest;
  }
  /// f_F -= A_FF^-1 w_F with w by position in lcp.w, which becomes 0.  O(m^2)
  void CorrectForces() {
    SolveSystem(lcp.w.data());
    lcp.f.head(m_) -= lcp.w.head(m_);
    lcp.w.head(m_).setZero();
  }
  /// x := A_FF^-1 x, x by position.  O(m^2)
  void SolveSystem(double* x) {
    for (Index k = 0; k < m_; ++k) x_[k] = x[PositionOf(k)];
    ldlt_.Solve(x_.data());
    for (Index k = 0; k < m_; ++k) x[PositionOf(k)] = x_[k];
  }

 private:
  Index PositionOf(Index slot) const { return order_[static_cast<size_t>(slot)]; }
  Index SlotOf(Index p) const { return slot_[static_cast<size_t>(p)]; }
  void Place(Index slot, Index p) {
    order_[static_cast<size_t>(slot)] = p;
    slot_[static_cast<size_t>(p)] = slot;
  }
  // The last position of F takes the place of p, which the factor no longer has.
  void MoveOut(Index p) {
    if (p == --m_) return;
    Place(SlotOf(m_), p);
    lcp.Swap(p, m_);
  }
  // z = L^-1 A_Fp. Returns the pivot of p.
  double Eliminate(Index p, Eigen::VectorXd* z) const {
    const double* c = lcp.column(p);
    for (Index k = 0; k < m_; ++k) (*z)[k] = c[PositionOf(k)];
    ldlt_.ForwardSolve(z->data());
    return ldlt_.PivotOf(z->data(), lcp.diagonal[p]);
  }
  void Append(Index p, const Eigen::VectorXd& z, double pivot) {
    ldlt_.Append(z.data(), pivot);
    lcp.Swap(p, m_);
    Place(m_, m_);
    ++m_;
  }

  DenseLdlt ldlt_;  // in the order of entering
  Index m_ = 0;
  std::vector<Index> order_;         // row of the factor -> position
  std::vector<Index> slot_;          // position in F -> row of the factor
  std::vector<Index> kept_;          // positions, of the latest Factor
  Eigen::VectorXd df_;               // by position
  Eigen::VectorXd z_, z_other_, x_;  // by row of the factor
};

}  // namespace lcpbench
