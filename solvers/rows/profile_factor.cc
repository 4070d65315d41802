#include "solvers/rows/profile_factor.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "solvers/pivoting/tableau_rules.h"
#include "solvers/pivoting/vector_register.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

void ProfileFactor::Reserve(Index max_rows, Index profile) {
  if (A_.size() < profile + 4 * kRegister) {
    for (auto* v : {&A_, &L_}) v->setZero(profile + 4 * kRegister);
  }
  if (first_.size() >= At(max_rows)) return;
  const Index n = max_rows;
  const Index most_bodies = 2 * n;
  for (auto* v : {&first_, &last_below_, &active_first_}) v->resize(At(n));
  begin_.resize(At(n));
  for (auto* v : {&column_, &mask_}) v->setZero(n + 2 * kRegister);
  for (auto* v : {&first_row_, &last_side_, &side_before_}) v->resize(At(most_bodies) + 1);
}

bool ProfileFactor::LayOutRows() {
  Index at = 0;
  cost_ = 0;
  for (Index i = 0; i < n_; ++i) {
    const Index begin = first_[At(i)] / kRegister * kRegister;
    begin_[At(i)] = at - begin;
    at += (i / kRegister + 1) * kRegister - begin;
    last_below_[At(i)] = static_cast<std::int32_t>(i);
    last_below_[At(first_[At(i)])] = static_cast<std::int32_t>(i);
  }
  for (Index i = 1; i < n_; ++i) last_below_[At(i)] = std::max(last_below_[At(i)], last_below_[At(i) - 1]);
  for (Index j = 0; j < n_; ++j) {
    const auto below = static_cast<double>(last_below_[At(j)] - j);
    cost_ += below * (8 + below / 8) + 40;
  }
  return at + kRegister <= A_.size();
}

void ProfileFactor::Clear() {
  std::fill_n(A_.data(), begin_[At(n_) - 1] + (n_ - 1) / kRegister * kRegister + kRegister, 0.0);
}

bool ProfileFactor::FindProfile(const ScaledRows& rows) {
  for (Index i = rows.size() - 1; i >= 0; --i) {
    first_row_[At(rows.first_body(i))] = static_cast<std::int32_t>(i);
    if (rows.second_body(i) >= 0) first_row_[At(rows.second_body(i))] = static_cast<std::int32_t>(i);
  }
  return LayOut(rows.size(), [&](Index i) {
    const std::int32_t first = first_row_[At(rows.first_body(i))];
    return rows.second_body(i) < 0 ? first : std::min(first, first_row_[At(rows.second_body(i))]);
  });
}

template <Index p>
void ProfileFactor::AssembleOf(const ScaledRows& rows) {
  Clear();
  std::fill_n(last_side_.begin(), rows.bodies(), -1);
  const auto block = [&](Index side) __attribute__((always_inline)) {
    return BodyPart<p>(Load<BodyLanes<p>>(rows.row(0) + side * kBodyWidth<p>));
  };
  for (Index i = 0; i < n_; ++i) {
    double* const row = A_.data() + begin_[At(i)];
    for (int s = 0; s < 2; ++s) {
      const std::int32_t body = s == 0 ? rows.first_body(i) : rows.second_body(i);
      if (body < 0) continue;
      const auto own = block(2 * i + s);
      for (std::int32_t side = last_side_[At(body)]; side >= 0; side = side_before_[At(side)]) {
        row[side / 2] += Sum(Folded(own * block(side)));
      }
      side_before_[At(2 * i + s)] = std::exchange(last_side_[At(body)], static_cast<std::int32_t>(2 * i + s));
    }
    row[i] = 1;
  }
}

void ProfileFactor::Assemble(const ScaledRows& rows) {
  rows.columns_per_body() == 3 ? AssembleOf<3>(rows) : AssembleOf<6>(rows);
}

// Column by column, each one subtracted from the rows below at once.
bool ProfileFactor::Factorize(const unsigned char* is_active, double shift, const double* more) {
  bool is_whole = true;
  for (Index i = 0; i < n_; ++i) {
    mask_[i] = is_active[i] != 0 ? 1 : 0;
    active_first_[At(i)] = is_active[i] != 0 ? first_[At(i)] : static_cast<std::int32_t>(n_);
  }
  for (Index i = 0; i < n_; ++i) {
    if (is_active[i] == 0) continue;
    const double* from = A_.data() + begin_[At(i)];
    double* to = L_.data() + begin_[At(i)];
    for (Index k = first_[At(i)] / kRegister * kRegister; k <= i; k += kRegister) {
      *AsRegisters(to + k) = *AsRegisters(from + k) * *AsRegisters(mask_.data() + k);
    }
    to[i] += shift + (more != nullptr ? more[i] : 0.0);
  }
  double* const column = column_.data();
  for (Index j = 0; j < n_; ++j) {
    column[j] = 0;
    if (is_active[j] == 0) continue;
    const Index last = last_below_[At(j)];
    double& pivot = L_[begin_[At(j)] + j];
    if (!(pivot > tableau::kLeastPivot * A_[begin_[At(j)] + j])) {
      pivot = std::numeric_limits<double>::infinity();
      is_whole = false;
    }
    const double inverse = 1 / pivot;
    const std::int32_t reached = static_cast<std::int32_t>(j);
    for (Index i = j + 1; i <= last; ++i) {
      column[i] = active_first_[At(i)] <= reached ? L_[begin_[At(i)] + j] : 0.0;
    }
    const Index begin = (j + 1) / kRegister * kRegister;
    for (Index i = j + 1; i <= last; ++i) {
      const double of_row = column[i];
      if (of_row == 0) continue;
      double* const row = L_.data() + begin_[At(i)];
      const double factor = of_row * inverse;
      for (Index k = begin; k <= i; k += kRegister) *AsRegisters(row + k) -= factor * *AsRegisters(column + k);
      row[j] = factor;
    }
    // What lies beyond the diagonal in a register is never read as a number of the row.
  }
  for (Index i = 0; i < n_; ++i) column[i] = 0;
  return is_whole;
}

void ProfileFactor::Solve(double* x) const {
  for (Index i = 0; i < n_; ++i) {
    if (!is_in_factor(i)) continue;
    const double* row = L_.data() + begin_[At(i)];
    const double own = x[i];
    x[i] = 0;
    Register sum = {};
    const Index begin = first_[At(i)] / kRegister * kRegister;
    const Index end = i / kRegister * kRegister;
    for (Index k = begin; k < end; k += kRegister) sum += *AsRegisters(row + k) * *AsRegisters(x + k);
    double rest = Sum(&sum);
    for (Index k = std::max(begin, end); k < i; ++k) rest += row[k] * x[k];
    x[i] = own - rest;
  }
  for (Index i = 0; i < n_; ++i) {
    if (is_in_factor(i)) x[i] /= L_[begin_[At(i)] + i];
  }
  for (Index i = n_ - 1; i >= 0; --i) {
    if (!is_in_factor(i)) continue;
    const double* row = L_.data() + begin_[At(i)];
    const double own = x[i];
    const Index begin = first_[At(i)] / kRegister * kRegister;
    const Index end = i / kRegister * kRegister;
    for (Index k = begin; k < end; k += kRegister) *AsRegisters(x + k) -= own * *AsRegisters(row + k);
    for (Index k = std::max(begin, end); k < i; ++k) x[k] -= own * row[k];
  }
}

}  // namespace lcpbench
