#include "solvers/friction/mode_factor.h"

#include <algorithm>
#include <cmath>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// Diagonal pivots, which keep the order, are taken down to this part of the largest in their column.
constexpr double kLeastPivot = 1e-3;
// Below, too many digits are lost through the bodies.
constexpr double kLeastEpsOnBodies = 1e-9;

}  // namespace

void ModeFactor::AddUnknown(Index row) {
  unknown_[At(row)] = static_cast<Index>(equation_.size());
  coefficient_[row] = 1;
  equation_.push_back(row);
}

void ModeFactor::SetModes(const ContactRows& rows, const std::vector<RowMode>& modes) {
  equation_.clear();
  unknown_.assign(At(rows.size()), -1);
  coefficient_.setZero(rows.size());
  fixed_.setZero(rows.size());
  size_t k = 0;
  for (const ContactRows::Contact& contact : rows.contacts()) {
    const RowMode mode = modes[k++];
    if (mode == RowMode::kOpen) continue;
    if (!contact.is_further) AddUnknown(contact.normal);
    if (contact.tangent < 0) continue;
    if (mode == RowMode::kStick) {
      AddUnknown(contact.tangent);
    } else {
      const int slip = mode == RowMode::kUp ? 1 : mode == RowMode::kDown ? -1 : contact.slip;
      unknown_[At(contact.tangent)] = unknown_[At(contact.normal)];
      coefficient_[contact.tangent] = -slip * contact.mu;
    }
  }
  for (const Index row : rows.joints()) AddUnknown(row);
  for (const ContactRows::Bounded& row : rows.bounded()) {
    const RowMode mode = modes[k++];
    if (mode == RowMode::kStick) {
      AddUnknown(row.row);
    } else {
      fixed_[row.row] = mode == RowMode::kUp ? row.lower : row.upper;
    }
  }
}

bool ModeFactor::Solve(const ContactRows& rows, const std::vector<RowMode>& modes, const Eigen::VectorXd& center,
                       double eps, Eigen::VectorXd* phi) {
  SetModes(rows, modes);
  const Index n = rows.size(), m = static_cast<Index>(equation_.size());
  // A correction of what the center gives in these modes: less is lost to rounding.
  const auto expand = [&] {
    for (Index i = 0; i < n; ++i) {
      (*phi)[i] = fixed_[i] + (unknown_[At(i)] < 0 ? 0 : coefficient_[i] * y_[unknown_[At(i)]]);
    }
  };
  if (y_.size() < m) y_.resize(m);
  phi->resize(n);
  for (Index k = 0; k < m; ++k) y_[k] = center[equation_[At(k)]];
  expand();
  for (Index k = 0; k < m; ++k) y_[k] = -rows.Gap(equation_[At(k)], *phi);
  const bool by_bodies = m > kMostDense && eps >= kLeastEpsOnBodies && rows.OnBodies() != nullptr;
  if (m > 0 && !(m <= kMostDense ? SolveDense(rows, eps)
                 : by_bodies     ? SolveOnBodies(rows, eps)
                                 : SolveSparse(rows, eps))) {
    return false;
  }
  if (!y_.head(m).allFinite()) return false;
  for (Index k = 0; k < m; ++k) y_[k] += center[equation_[At(k)]];
  expand();
  return true;
}

// Gaussian elimination with partial pivoting, in place.
bool ModeFactor::SolveDense(const ContactRows& rows, double eps) {
  const Index m = static_cast<Index>(equation_.size());
  if (dense_.rows() < m) {
    const Index room = std::min(kMostDense, 2 * m);
    dense_.resize(room, room);
  }
  auto K = dense_.topLeftCorner(m, m);
  K.setZero();
  for (Index k = 0; k < m; ++k) {
    rows.VisitRow(equation_[At(k)], [&](Index j, double a) {
      if (unknown_[At(j)] >= 0) K(k, unknown_[At(j)]) += a * coefficient_[j];
    });
    K(k, k) += eps;
  }
  double* const y = y_.data();
  const Index stride = dense_.rows();
  for (Index k = 0; k < m; ++k) {
    double* const pivots = dense_.data() + k * stride;
    Index pivot = k;
    for (Index i = k + 1; i < m; ++i) {
      if (std::abs(pivots[i]) > std::abs(pivots[pivot])) pivot = i;
    }
    if (!(std::abs(pivots[pivot]) > 0)) return false;
    std::swap(pivots[k], pivots[pivot]);
    std::swap(y[k], y[pivot]);
    const double inverse = 1 / pivots[k];
    for (Index i = k + 1; i < m; ++i) pivots[i] *= inverse;
    for (Index j = k + 1; j < m; ++j) {
      double* const column = dense_.data() + j * stride;
      std::swap(column[k], column[pivot]);
      const double factor = column[k];
      if (factor == 0) continue;
      for (Index i = k + 1; i < m; ++i) column[i] -= factor * pivots[i];
    }
    for (Index i = k + 1; i < m; ++i) y[i] -= y[k] * pivots[i];
  }
  for (Index k = m - 1; k >= 0; --k) {
    const double* const column = dense_.data() + k * stride;
    y[k] /= column[k];
    for (Index i = 0; i < k; ++i) y[i] -= y[k] * column[i];
  }
  return true;
}

// K = G_E H^T with H = B^T G, so (K + eps)^-1 r = (r - G_E v) / eps with (eps + H^T G_E) v = H^T r: a matrix of the
// bodies' graph, however many rows act on them. What is lost in the difference, u / eps, corrections bring back.
bool ModeFactor::SolveOnBodies(const ContactRows& rows, double eps) {
  constexpr int kCorrections = 3;
  constexpr double kFine = 1e-15;
  const SparseMatrix& G = *rows.OnBodies();
  const auto m = static_cast<Index>(equation_.size());
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index row = 0; row < rows.size(); ++row) {
    if (unknown_[At(row)] < 0) continue;
    const Index equation = equation_[At(unknown_[At(row)])];
    for (SparseMatrix::InnerIterator h(G, row); h; ++h) {
      for (SparseMatrix::InnerIterator g(G, equation); g; ++g) {
        entries.emplace_back(static_cast<int>(h.col()), static_cast<int>(g.col()),
                             coefficient_[row] * h.value() * g.value());
      }
    }
  }
  for (int k = 0; k < G.cols(); ++k) entries.emplace_back(k, k, eps);
  sparse_.resize(G.cols(), G.cols());
  sparse_.setFromTriplets(entries.begin(), entries.end());
  lu_.setPivotThreshold(kLeastPivot);
  lu_.compute(sparse_);
  if (lu_.info() != Eigen::Success) return false;
  const Eigen::VectorXd wanted = y_.head(m);
  Eigen::VectorXd rest = wanted, y = Eigen::VectorXd::Zero(m), forces(rows.size()), v;
  const auto to_bodies = [&](const Eigen::VectorXd& unknowns) {
    for (Index row = 0; row < rows.size(); ++row) {
      forces[row] = unknown_[At(row)] < 0 ? 0 : coefficient_[row] * unknowns[unknown_[At(row)]];
    }
    v.noalias() = G.transpose() * forces;
  };
  const auto subtract = [&](const Eigen::VectorXd& at, Eigen::VectorXd* from) {
    const Eigen::VectorXd gaps = G * at;
    for (Index k = 0; k < m; ++k) (*from)[k] -= gaps[equation_[At(k)]];
  };
  for (int k = 0; k < kCorrections; ++k) {
    to_bodies(rest);
    v = lu_.solve(v);
    subtract(v, &rest);
    y += rest / eps;
    to_bodies(y);
    rest = wanted - eps * y;
    subtract(v, &rest);
    if (!(rest.lpNorm<Eigen::Infinity>() > kFine * wanted.lpNorm<Eigen::Infinity>())) break;
  }
  y_.head(m) = y;
  return true;
}

bool ModeFactor::SolveSparse(const ContactRows& rows, double eps) {
  const Index m = static_cast<Index>(equation_.size());
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index k = 0; k < m; ++k) {
    const int row = static_cast<int>(k);
    rows.VisitRow(equation_[At(k)], [&](Index j, double a) {
      if (unknown_[At(j)] >= 0) entries.emplace_back(row, static_cast<int>(unknown_[At(j)]), a * coefficient_[j]);
    });
    entries.emplace_back(row, row, eps);
  }
  sparse_.resize(m, m);
  sparse_.setFromTriplets(entries.begin(), entries.end());
  lu_.setPivotThreshold(kLeastPivot);
  lu_.compute(sparse_);
  if (lu_.info() != Eigen::Success) return false;
  y_.head(m) = lu_.solve(Eigen::VectorXd(y_.head(m)));
  return true;
}

}  // namespace lcpbench
