#include "solvers/pivoting/complementary_basis.h"

#include <algorithm>

namespace lcpbench {

void ComplementaryBasis::Reserve(Index max_rows) {
  if (max_rows <= df_.size()) return;
  lcp.Reserve(max_rows);
  ldlt_.Reserve(max_rows);
  for (Eigen::VectorXd* v : {&df_, &z_, &z_other_, &x_}) v->setZero(max_rows);
  order_.resize(static_cast<size_t>(max_rows));
  slot_.resize(static_cast<size_t>(max_rows));
  kept_.reserve(static_cast<size_t>(max_rows));
}

void ComplementaryBasis::Reset() {
  ldlt_.Reset(lcp.n);
  m_ = 0;
}

bool ComplementaryBasis::Factor(Index rows, double threshold, const Deadline* deadline) {
  constexpr Index kLanes = DenseLdlt::kLanes;
  m_ = 0;
  kept_.clear();
  constexpr Index kWorkPerClockRead = 1 << 14;  // entries, some 10 us
  Index work = 0;
  for (Index k = 0; k < rows; ++k) {
    work += rows - k;
    if (deadline != nullptr && work > kWorkPerClockRead) {
      work = 0;
      if (deadline->Expired()) return false;
    }
    const double* from = lcp.column(k);
    double* to = ldlt_.column(k);
    // Both have columns of whole lanes.
    for (Index i = k / kLanes * kLanes; i < rows; i += kLanes) std::copy(from + i, from + i + kLanes, to + i);
    for (Index i = rows; i % kLanes != 0; ++i) to[i] = 0;
  }
  if (!ldlt_.Factor(rows, threshold, &kept_, deadline)) return false;
  for (Index k = 0; k < std::ssize(kept_); ++k) {
    order_[static_cast<size_t>(k)] = kept_[static_cast<size_t>(k)];
    slot_[static_cast<size_t>(kept_[static_cast<size_t>(k)])] = k;
  }
  m_ = rows;
  auto kept = kept_.rbegin();
  for (Index p = rows - 1; p >= 0; --p) {
    if (kept != kept_.rend() && *kept == p) {
      ++kept;
    } else if (p != --m_) {
      const Index last = slot_[static_cast<size_t>(m_)];
      slot_[static_cast<size_t>(p)] = last;
      order_[static_cast<size_t>(last)] = p;
      lcp.Swap(p, m_);
    }
  }
  return true;
}

void ComplementaryBasis::Gather(Index p, double* z) const {
  const double* c = lcp.column(p);
  for (Index k = 0; k < m_; ++k) z[k] = c[order_[static_cast<size_t>(k)]];
}

double ComplementaryBasis::SetDriven(Index d) {
  Gather(d, z_.data());
  ldlt_.ForwardSolve(z_.data());
  return ldlt_.PivotOf(z_.data(), lcp.diagonal[d]);
}

double ComplementaryBasis::Direction(Index d) {
  for (Index k = 0; k < m_; ++k) x_[k] = z_[k] * ldlt_.inverse_pivot(k);
  ldlt_.BackSolve(x_.data());
  double norm2 = lcp.diagonal[d];
  for (Index k = 0; k < m_; ++k) {
    const Index p = order_[static_cast<size_t>(k)];
    df_[p] = -x_[k];
    norm2 += lcp.diagonal[p] * x_[k] * x_[k];
  }
  return norm2;
}

void ComplementaryBasis::Append(Index p, const double* z, double pivot) {
  ldlt_.Append(z, pivot);
  lcp.Swap(p, m_);
  order_[static_cast<size_t>(m_)] = m_;
  slot_[static_cast<size_t>(m_)] = m_;
  ++m_;
}

void ComplementaryBasis::EnterDriven(Index d, double s) { Append(d, z_.data(), s); }

double ComplementaryBasis::PivotOf(Index p) {
  Gather(p, z_other_.data());
  ldlt_.ForwardSolve(z_other_.data());
  return ldlt_.PivotOf(z_other_.data(), lcp.diagonal[p]);
}

double ComplementaryBasis::Enter(Index p, double pivot, Index d) {
  // One more step of the forward substitution for the driven row.
  double z_new = lcp.column(d)[p];
  for (Index k = 0; k < m_; ++k) z_new -= z_other_[k] * z_[k] * ldlt_.inverse_pivot(k);
  z_[m_] = z_new;
  Append(p, z_other_.data(), pivot);
  return ldlt_.PivotOf(z_.data(), lcp.diagonal[d]);
}

void ComplementaryBasis::Leave(Index p) {
  const Index k = slot_[static_cast<size_t>(p)];
  ldlt_.Remove(k);
  for (Index j = k; j + 1 < m_; ++j) {
    order_[static_cast<size_t>(j)] = order_[static_cast<size_t>(j + 1)];
    slot_[static_cast<size_t>(order_[static_cast<size_t>(j)])] = j;
  }
  const Index last = m_ - 1;
  if (p != last) {
    slot_[static_cast<size_t>(p)] = slot_[static_cast<size_t>(last)];
    order_[static_cast<size_t>(slot_[static_cast<size_t>(p)])] = p;
    lcp.Swap(p, last);
  }
  --m_;
}

double ComplementaryBasis::SolveForces() {
  lcp.f.head(m_) = -lcp.b.head(m_);
  SolveSystem(lcp.f.data());
  double largest = 0;
  for (Index p = 0; p < m_; ++p) largest = std::max(largest, lcp.diagonal[p] * lcp.f[p] * lcp.f[p]);
  return largest;
}

void ComplementaryBasis::CorrectForces() {
  SolveSystem(lcp.w.data());
  lcp.f.head(m_) -= lcp.w.head(m_);
  lcp.w.head(m_).setZero();
}

void ComplementaryBasis::SolveSystem(double* x) {
  for (Index k = 0; k < m_; ++k) x_[k] = x[order_[static_cast<size_t>(k)]];
  ldlt_.Solve(x_.data());
  for (Index k = 0; k < m_; ++k) x[order_[static_cast<size_t>(k)]] = x_[k];
}

}  // namespace lcpbench
