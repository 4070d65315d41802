#include "solvers/rows/profile_factor.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/linear_algebra/vector_register.h"
#include "support/array_index.h"

namespace lcpbench {
void ProfileFactor::Profile::Reserve(Index max_rows) {
  for (auto* v : {&first, &last_below}) v->resize(At(max_rows));
  begin.resize(At(max_rows));
}

// From `first` of n rows. Returns how many numbers it takes.
Index ProfileFactor::Profile::LayOut(Index n) {
  Index at = 0;
  for (Index i = 0; i < n; ++i) {
    const Index from = first[At(i)] / kRegister * kRegister;
    begin[At(i)] = at - from;
    at += (i / kRegister + 1) * kRegister - from;
    last_below[At(i)] = static_cast<std::int32_t>(i);
    last_below[At(first[At(i)])] = static_cast<std::int32_t>(i);
  }
  for (Index i = 1; i < n; ++i) last_below[At(i)] = std::max(last_below[At(i)], last_below[At(i) - 1]);
  return at;
}

void ProfileFactor::Reserve(Index max_rows, Index profile) {
  // Not a page is touched before it is needed.
  if (A_.size() < profile) A_.resize(profile);
  // Packed rows may begin in one register more.
  if (L_.size() < A_.size() + kRegister * max_rows) L_.resize(A_.size() + kRegister * max_rows);
  if (rows_.size() >= At(max_rows)) return;
  of_A_.Reserve(max_rows);
  of_L_.Reserve(max_rows);
  for (auto* v : {&rows_, &place_}) v->resize(At(max_rows));
  for (auto* v : {&floor_, &y_}) v->setZero(max_rows + 2 * kRegister);
  columns_.setZero(kPanel * (max_rows + 2 * kRegister));
  first_row_.resize(At(2 * max_rows) + 1);
  sides_.Reserve(max_rows, 2 * max_rows);
}

bool ProfileFactor::LayOutRows() {
  const Index size = of_A_.LayOut(n_);
  cost_ = 0;
  for (Index j = 0; j < n_; ++j) {
    const auto below = static_cast<double>(of_A_.last_below[At(j)] - j);
    cost_ += below * (8 + below / 8) + 40;
  }
  return size <= A_.size();
}

void ProfileFactor::Clear() { std::fill(A_.data(), row(n_ - 1) + (n_ - 1) / kRegister * kRegister + kRegister, 0.0); }

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
  for (Index body = 0; body < rows.bodies(); ++body) sides_.Forget(body);
  const auto block = [&](Index side) __attribute__((always_inline)) {
    return BodyPart<p>(Load<BodyLanes<p>>(rows.row(0) + side * kBodyWidth<p>));
  };
  for (Index i = 0; i < n_; ++i) {
    double* const row_i = row(i);
    for (int s = 0; s < 2; ++s) {
      const std::int32_t body = s == 0 ? rows.first_body(i) : rows.second_body(i);
      if (body < 0) continue;
      const auto own = block(2 * i + s);
      sides_.ForEach(
          body, [&](std::int32_t side)
                    __attribute__((always_inline)) { row_i[side / 2] += Sum(Folded(own * block(side))); });
      sides_.Add(body, static_cast<std::int32_t>(2 * i + s));
    }
    row_i[i] = 1;
  }
}

void ProfileFactor::Assemble(const ScaledRows& rows) {
  rows.columns_per_body() == 3 ? AssembleOf<3>(rows) : AssembleOf<6>(rows);
}

// A_FF into L_, by the places that the rows of F have among themselves.
void ProfileFactor::Pack(const unsigned char* is_active, double shift, const double* more) {
  m_ = 0;
  for (Index i = 0; i < n_; ++i) {
    place_[At(i)] = static_cast<std::int32_t>(m_);
    rows_[At(m_)] = static_cast<std::int32_t>(i);
    m_ += is_active[i] != 0 ? 1 : 0;
  }
  for (Index a = 0; a < m_; ++a) of_L_.first[At(a)] = place_[At(of_A_.first[At(rows_[At(a)])])];
  of_L_.LayOut(m_);
  for (Index a = 0; a < m_; ++a) {
    const Index i = rows_[At(a)];
    const double* const from = row(i);
    double* const to = row_of_L(a);
    const Index first = of_L_.first[At(a)];
    for (Index k = first / kRegister * kRegister; k < first; ++k) to[k] = 0;
    if (m_ == n_) {
      std::copy(from + first, from + i, to + first);
    } else {
      Index at = first;
      for (Index k = of_A_.first[At(i)]; k < i; ++k) {
        to[at] = from[k];  // the next active one takes the place of one that is not
        at += is_active[k];
      }
    }
    to[a] = from[i] + shift + (more != nullptr ? more[i] : 0.0);
    floor_[a] = tableau::kLeastPivot * from[i];
  }
}

// The diagonal block at column j; false if a row is left out.
bool ProfileFactor::FactorizeBlock(Index j, Panel* panel) {
  bool is_whole = true;
  auto& [block, inverse] = *panel;
  for (Index r = 0; r < std::min(kPanel, m_ - j); ++r) {
    double* const own = row_of_L(j + r) + j;
    for (Index c = 0; c <= r; ++c) {
      block[r][c] = own[c];
      for (Index k = 0; k < c; ++k) block[r][c] -= own[k] * block[c][k];
      if (c < r) own[c] = block[r][c] * inverse[c];
    }
    own[r] = block[r][r];
    if (!(own[r] > floor_[j + r])) {
      own[r] = std::numeric_limits<double>::infinity();
      is_whole = false;
    }
    inverse[r] = 1 / own[r];
  }
  return is_whole;
}

// The panel's columns below its block, to row `last`: into columns_ as they are, into L over their pivots.
void ProfileFactor::DivideBelow(Index j, Index last, const Panel& panel) {
  const Panel own = panel;  // a copy, so that it stays in registers
  const auto& [block, inverse] = own;
  const Index stride = columns_.size() / kPanel;
  double* const column[kPanel] = {columns_.data(), columns_.data() + stride, columns_.data() + 2 * stride,
                                  columns_.data() + 3 * stride};
  for (double* const c : column) std::fill_n(c + j, kPanel, 0.0);
  for (Index i = j + kPanel; i <= last; ++i) {
    double v[kPanel] = {};
    if (of_L_.first[At(i)] < j + kPanel) {
      double* const row = row_of_L(i) + j;
      v[0] = row[0];
      const double f0 = v[0] * inverse[0];
      v[1] = row[1] - f0 * block[1][0];
      const double f1 = v[1] * inverse[1];
      v[2] = row[2] - f0 * block[2][0] - f1 * block[2][1];
      const double f2 = v[2] * inverse[2];
      v[3] = row[3] - f0 * block[3][0] - f1 * block[3][1] - f2 * block[3][2];
      row[0] = f0;
      row[1] = f1;
      row[2] = f2;
      row[3] = v[3] * inverse[3];
    }
    for (int c = 0; c < kPanel; ++c) column[c][i] = v[c];
  }
}

// What the panel takes from the rows below it.
void ProfileFactor::SubtractBelow(Index j, Index last) {
  const Index stride = columns_.size() / kPanel;
  const double* const column = columns_.data();
  const Index begin = (j + kPanel) / kRegister * kRegister;
  for (Index i = j + kPanel; i <= last; ++i) {
    if (of_L_.first[At(i)] >= j + kPanel) continue;
    double* const own = row_of_L(i);
    const std::array<double, kPanel> factor = {own[j], own[j + 1], own[j + 2], own[j + 3]};
    // What lies beyond the diagonal in a register is never read as a number of the row.
    for (Index k = begin; k <= i; k += kRegister) {
      Register rest = *AsRegisters(own + k);
      for (std::size_t c = 0; c < factor.size(); ++c) {
        rest -= factor[c] * *AsRegisters(column + static_cast<Index>(c) * stride + k);
      }
      *AsRegisters(own + k) = rest;
    }
  }
}

// Panel by panel, each one subtracted from the rows below at once.
bool ProfileFactor::Factorize(const unsigned char* is_active, double shift, const double* more) {
  Pack(is_active, shift, more);
  bool is_whole = true;
  Panel panel;
  for (Index j = 0; j < m_; j += kPanel) {
    is_whole = FactorizeBlock(j, &panel) && is_whole;
    if (j + kPanel >= m_) break;
    const Index last = of_L_.last_below[At(j + kPanel - 1)];
    DivideBelow(j, last, panel);
    SubtractBelow(j, last);
  }
  return is_whole;
}

void ProfileFactor::Solve(double* x) {
  double* const y = y_.data();
  for (Index a = 0; a < m_; ++a) y[a] = x[rows_[At(a)]];
  for (Index a = 0; a < m_; ++a) {
    const double* const row = row_of_L(a);
    Register sum = {};
    const Index begin = of_L_.first[At(a)] / kRegister * kRegister;
    const Index end = a / kRegister * kRegister;
    for (Index k = begin; k < end; k += kRegister) sum += *AsRegisters(row + k) * *AsRegisters(y + k);
    double rest = Sum(&sum);
    for (Index k = std::max(begin, end); k < a; ++k) rest += row[k] * y[k];
    y[a] -= rest;
  }
  for (Index a = 0; a < m_; ++a) y[a] /= row_of_L(a)[a];
  for (Index a = m_ - 1; a >= 0; --a) {
    const double* const row = row_of_L(a);
    const double own = y[a];
    const Index begin = of_L_.first[At(a)] / kRegister * kRegister;
    const Index end = a / kRegister * kRegister;
    for (Index k = begin; k < end; k += kRegister) *AsRegisters(y + k) -= own * *AsRegisters(row + k);
    for (Index k = std::max(begin, end); k < a; ++k) y[k] -= own * row[k];
    x[rows_[At(a)]] = own;
  }
}

}  // namespace lcpbench
