#include "solvers/friction/mode_factor.h"

#include <algorithm>
#include <cmath>

#include "support/array_index.h"

namespace lcpbench {

void ModeFactor::AddUnknown(Index row) {
  unknown_[At(row)] = static_cast<Index>(equation_.size());
  coefficient_[row] = 1;
  equation_.push_back(row);
}

void ModeFactor::SetModes(const ContactRows& rows, const std::vector<RowMode>& modes) {
  equation_.clear();
  unknown_.assign(At(rows.size()), -1);
  for (Eigen::VectorXd* const numbers : {&coefficient_, &fixed_}) {
    ContactRows::Lengthen(rows.size(), numbers);
    numbers->head(rows.size()).setZero();
  }
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

void ModeFactor::Reserve(Index max_rows) {
  for (std::vector<Index>* const numbers : {&equation_, &unknown_}) numbers->reserve(At(max_rows));
  for (Eigen::VectorXd* const numbers : {&coefficient_, &fixed_, &y_, &refined_})
    ContactRows::Lengthen(max_rows, numbers);
  dense_.Reserve(std::min(max_rows, kMostDense));
}

// phi of the unknowns y_.
void ModeFactor::Expand(Index n, Eigen::VectorXd* phi) const {
  for (Index i = 0; i < n; ++i) {
    (*phi)[i] = fixed_[i] + (unknown_[At(i)] < 0 ? 0 : coefficient_[i] * y_[unknown_[At(i)]]);
  }
}

// From center, brought into these modes, by the factor at hand.
bool ModeFactor::Correct(const ContactRows& rows, const Eigen::VectorXd& center, Eigen::VectorXd* phi) {
  const Index n = rows.size(), m = size();
  for (Index k = 0; k < m; ++k) y_[k] = center[equation_[At(k)]];
  Expand(n, phi);
  // A correction of what the center gives in these modes: less is lost to rounding.
  for (Index k = 0; k < m; ++k) y_[k] = -rows.Gap(equation_[At(k)], *phi);
  if (m > kMostDense) {
    y_.head(m) = lu_.solve(Eigen::VectorXd(y_.head(m)));
  } else {
    dense_.Solve(y_.data());
  }
  if (!y_.head(m).allFinite()) return false;
  for (Index k = 0; k < m; ++k) y_[k] += (*phi)[equation_[At(k)]];
  Expand(n, phi);
  return true;
}

bool ModeFactor::Solve(const ContactRows& rows, const std::vector<RowMode>& modes, const Eigen::VectorXd& center,
                       double eps, Eigen::VectorXd* phi) {
  SetModes(rows, modes);
  ContactRows::Lengthen(size(), &y_);
  ContactRows::Lengthen(rows.size(), phi);
  if (!(size() > kMostDense ? FactorizeSparse(rows, eps) : FactorizeDense(rows, eps))) return false;
  return Correct(rows, center, phi);
}

void ModeFactor::Refine(const ContactRows& rows, Eigen::VectorXd* phi) {
  ContactRows::Lengthen(rows.size(), &refined_);
  if (Correct(rows, *phi, &refined_)) phi->swap(refined_);
}

bool ModeFactor::FactorizeDense(const ContactRows& rows, double eps) {
  dense_.Start(size());
  for (Index k = 0; k < size(); ++k) {
    rows.VisitRow(equation_[At(k)], [&](Index j, double a) {
      if (unknown_[At(j)] >= 0 && a != 0) dense_.Add(k, unknown_[At(j)], a * coefficient_[j]);
    });
    dense_.Add(k, k, eps);
  }
  return dense_.Factorize();
}

bool ModeFactor::FactorizeSparse(const ContactRows& rows, double eps) {
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
  lu_.compute(sparse_);
  return lu_.info() == Eigen::Success;
}

}  // namespace lcpbench
