#include "solvers/rows/profile_factor.h"

#include <algorithm>
#include <utility>

#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/linear_algebra/vector_register.h"
#include "support/array_index.h"

namespace lcpbench {

const RowsKernel& FindRowsKernel(InstructionSet instructions) {
  static constexpr KernelTable<const RowsKernel*> kKernels{&kRowsKernelSse2, &kRowsKernelAvx2, &kRowsKernelAvx512};
  return *FindKernel(kKernels, instructions);
}

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
  const Index room = (max_rows / kRegister + 2) * kRegister;
  for (auto* v : {&floor_, &y_}) v->setZero(room);
  columns_.setZero(kProfilePanel * room);
  first_row_.resize(At(2 * max_rows) + 1);
  sides_.Reserve(max_rows, 2 * max_rows);
}

// For A of n rows, of which row i begins at column first(i) <= i. False if that is more than there is room for.
template <typename First>
bool ProfileFactor::LayOut(Index n, const First& first) {
  n_ = n;
  for (Index i = 0; i < n; ++i) of_A_.first[At(i)] = static_cast<std::int32_t>(first(i));
  const Index size = of_A_.LayOut(n);
  cost_ = 0;
  for (Index j = 0; j < n; ++j) {
    const auto below = static_cast<double>(of_A_.last_below[At(j)] - j);
    cost_ += below * (8 + below / 8) + 40;
  }
  return size <= A_.size();
}

void ProfileFactor::Clear() { std::fill(A_.data(), row(n_ - 1) + (n_ - 1) / kRegister * kRegister + kRegister, 0.0); }

void ProfileFactor::Take(const MatrixArrays& A) {
  const Index width = A.is_dense() ? A.size() / 2 + 1 : A.bandwidth();
  Reserve(A.size(), (width + 2 * kRegister) * A.size());
  LayOut(A.size(), [&](Index i) { return A.first(i); });
  Clear();
  for (Index i = 0; i < n_; ++i) {
    A.ForEntries(i, [i, to = row(i)](Index j, double a) {
      if (j <= i) to[j] = a;
    });
  }
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

ProfileWork ProfileFactor::Work() {
  return {m_,
          L_.data(),
          of_L_.begin.data(),
          of_L_.first.data(),
          of_L_.last_below.data(),
          floor_.data(),
          columns_.data(),
          columns_.size() / kProfilePanel};
}

bool ProfileFactor::Factorize(const unsigned char* is_active, double shift, const double* more) {
  Pack(is_active, shift, more);
  return kernel_.factorize(Work());
}

void ProfileFactor::Solve(double* x) {
  double* const y = y_.data();
  for (Index a = 0; a < m_; ++a) y[a] = x[rows_[At(a)]];
  kernel_.solve(Work(), y);
  for (Index a = 0; a < m_; ++a) x[rows_[At(a)]] = y[a];
}

}  // namespace lcpbench
