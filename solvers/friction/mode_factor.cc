#include "solvers/friction/mode_factor.h"

#include <algorithm>
#include <cmath>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// Below, too many digits are lost through the bodies.
constexpr double kLeastEpsOnBodies = 1e-9;
// Solves through the bodies are corrected until this part of the right-hand side is left: for solutions, and for
// directions of paths.
constexpr double kFine = 1e-15, kFineOfDirections = 1e-11;

}  // namespace

void ModeFactor::Reserve(Index max_rows) {
  of_.Reserve(max_rows);
  before_.reserve(At(max_rows) + 1);
  for (PaddedVector* const numbers : {&y_, &refined_, &gaps_}) numbers->Lengthen(max_rows);
  dense_.Reserve(std::min(max_rows, kMostDense));
}

// phi of the unknowns y_.
void ModeFactor::Expand(Index n, PaddedVector* phi) const {
  for (Index i = 0; i < n; ++i) (*phi)[i] = of_.ForceOf(i, y_);
}

// From center, brought into these modes, by the factor at hand.
bool ModeFactor::Correct(const ContactRows& rows, const PaddedVector& center, PaddedVector* phi) {
  const Index n = rows.size(), m = size();
  for (Index k = 0; k < m; ++k) y_[k] = center[of_.equation[At(k)]];
  Expand(n, phi);
  // A correction of what the center gives in these modes: less is lost to rounding.
  rows.ComputeGaps(*phi, &gaps_);
  for (Index k = 0; k < m; ++k) y_[k] = -gaps_[of_.equation[At(k)]];
  SolveFactor(rows, kFine);
  if (!y_.head(m).allFinite()) return false;
  for (Index k = 0; k < m; ++k) y_[k] += (*phi)[of_.equation[At(k)]];
  Expand(n, phi);
  return true;
}

// y_ of the right-hand side in it.
void ModeFactor::SolveFactor(const ContactRows& rows, double fine) {
  const Index m = size();
  if (on_bodies_ != nullptr) {
    SolveOnBodies(rows, fine);
  } else if (m > kMostDense) {
    y_.head(m) = lu_.Solve(y_.head(m));
  } else {
    dense_.Solve(y_.data());
  }
}

void ModeFactor::SolveEquations(const ContactRows& rows, const PaddedVector& right, PaddedVector* phi) {
  for (Index k = 0; k < size(); ++k) y_[k] = right[of_.equation[At(k)]];
  SolveFactor(rows, kFineOfDirections);
  for (Index i = 0; i < rows.size(); ++i) {
    (*phi)[i] = of_.unknown[At(i)] < 0 ? 0 : of_.coefficient[At(i)] * y_[of_.unknown[At(i)]];
  }
}

bool ModeFactor::Solve(const ContactRows& rows, const std::vector<RangeSide>& sides, const PaddedVector& center,
                       double eps, PaddedVector* phi) {
  phi->Lengthen(rows.size());
  return Factorize(rows, sides, eps) && Correct(rows, center, phi);
}

bool ModeFactor::Factorize(const ContactRows& rows, const std::vector<RangeSide>& sides, double eps) {
  of_.Set(sides, rows.laws().friction, rows.laws().bounded);
  y_.Lengthen(size());
  on_bodies_ = size() > kMostDense && eps >= kLeastEpsOnBodies ? rows.OnBodies() : nullptr;
  return size() <= kMostDense    ? FactorizeDense(rows, eps)
         : on_bodies_ != nullptr ? FactorizeOnBodies(rows, eps)
                                 : FactorizeSparse(rows, eps);
}

void ModeFactor::Refine(const ContactRows& rows, PaddedVector* phi) {
  refined_.Lengthen(rows.size());
  if (Correct(rows, *phi, &refined_)) phi->swap(refined_);
}

// Adds the columns of K where A is dense. A is symmetric: its rows are read as columns, and have the same profile.
void ModeFactor::AddDenseColumns(const ContactRows& rows) {
  before_.resize(At(rows.size()) + 1);
  for (Index i = 0, k = 0; i <= rows.size(); ++i) {
    before_[At(i)] = k;
    k += k < size() && of_.equation[At(k)] == i ? 1 : 0;  // without a branch: sides are hard to predict
  }
  Index last_unknown = -1;
  for (Index j = 0; j < rows.size(); ++j) {
    const Index unknown = of_.unknown[At(j)];
    if (unknown < 0) continue;
    const Index begin = before_[At(rows.start(j))], end = before_[At(rows.end(j))];
    const double* const entry = rows.DenseRow(j);
    const double coefficient = of_.coefficient[At(j)];
    double* const column = dense_.column(unknown);
    for (Index k = begin; k < end; ++k) column[k] += coefficient * entry[of_.equation[At(k)]];
    if (begin < end) dense_.Reach(unknown, end - 1);
  }
  for (Index k = 0, j = 0; k < size(); ++k) {
    for (const Index end = rows.end(of_.equation[At(k)]); j < end; ++j)
      last_unknown = std::max(last_unknown, of_.unknown[At(j)]);
    dense_.ReachOfRow(k, last_unknown);
  }
}

bool ModeFactor::FactorizeDense(const ContactRows& rows, double eps) {
  dense_.Start(size());
  if (rows.is_dense()) AddDenseColumns(rows);
  for (Index k = 0; k < size(); ++k) {
    if (!rows.is_dense()) {
      rows.VisitRow(of_.equation[At(k)], [&](Index j, double a) {
        if (of_.unknown[At(j)] >= 0 && a != 0) dense_.Add(k, of_.unknown[At(j)], a * of_.coefficient[At(j)]);
      });
    }
    dense_.Add(k, k, eps);
  }
  return dense_.Factorize();
}

// K = G_E H^T with H = B^T G, so (K + eps)^-1 r = (r - G_E v) / eps with (eps + H^T G_E) v = H^T r: a matrix of the
// bodies' graph, however many rows act on them. What is lost in the difference, u / eps, corrections bring back.
bool ModeFactor::FactorizeOnBodies(const ContactRows& rows, double eps) {
  const SparseMatrix& G = *on_bodies_;
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index row = 0; row < rows.size(); ++row) {
    if (of_.unknown[At(row)] < 0) continue;
    const Index equation = of_.equation[At(of_.unknown[At(row)])];
    for (SparseMatrix::InnerIterator h(G, row); h; ++h) {
      for (SparseMatrix::InnerIterator g(G, equation); g; ++g) {
        entries.emplace_back(static_cast<int>(h.col()), static_cast<int>(g.col()),
                             of_.coefficient[At(row)] * h.value() * g.value());
      }
    }
  }
  for (int k = 0; k < G.cols(); ++k) entries.emplace_back(k, k, eps);
  sparse_.resize(G.cols(), G.cols());
  sparse_.setFromTriplets(entries.begin(), entries.end());
  eps_ = eps;
  return lu_.Factorize(sparse_);
}

void ModeFactor::SolveOnBodies(const ContactRows& rows, double fine) {
  constexpr int kCorrections = 3;
  const SparseMatrix& G = *on_bodies_;
  const Index m = size();
  const Eigen::VectorXd wanted = y_.head(m);
  Eigen::VectorXd rest = wanted, y = Eigen::VectorXd::Zero(m), forces(rows.size()), v;
  const auto to_bodies = [&](const Eigen::VectorXd& unknowns) {
    for (Index row = 0; row < rows.size(); ++row) {
      forces[row] = of_.unknown[At(row)] < 0 ? 0 : of_.coefficient[At(row)] * unknowns[of_.unknown[At(row)]];
    }
    v.noalias() = G.transpose() * forces;
  };
  const auto subtract = [&](const Eigen::VectorXd& at, Eigen::VectorXd* from) {
    const Eigen::VectorXd gaps = G * at;
    for (Index k = 0; k < m; ++k) (*from)[k] -= gaps[of_.equation[At(k)]];
  };
  for (int k = 0; k < kCorrections; ++k) {
    to_bodies(rest);
    v = lu_.Solve(v);
    subtract(v, &rest);
    y += rest / eps_;
    to_bodies(y);
    rest = wanted - eps_ * y;
    subtract(v, &rest);
    if (!(rest.lpNorm<Eigen::Infinity>() > fine * wanted.lpNorm<Eigen::Infinity>())) break;
  }
  y_.head(m) = y;
}

bool ModeFactor::FactorizeSparse(const ContactRows& rows, double eps) {
  const Index m = size();
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index k = 0; k < m; ++k) {
    const int row = static_cast<int>(k);
    rows.VisitRow(of_.equation[At(k)], [&](Index j, double a) {
      if (of_.unknown[At(j)] >= 0)
        entries.emplace_back(row, static_cast<int>(of_.unknown[At(j)]), a * of_.coefficient[At(j)]);
    });
    entries.emplace_back(row, row, eps);
  }
  sparse_.resize(m, m);
  sparse_.setFromTriplets(entries.begin(), entries.end());
  return lu_.Factorize(sparse_);
}

}  // namespace lcpbench
