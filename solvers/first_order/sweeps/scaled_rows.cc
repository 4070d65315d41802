#include "solvers/first_order/sweeps/scaled_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// Where fewer rows than this share of all go by fours, looking for sets costs more than they save.
constexpr double kLeastShareInFours = 0.5;

void Grow(Index size, Array* array) {
  if (array->size() < size) array->resize(size);
}

}  // namespace

void ScaledProblem::Reserve(Index max_rows) {
  order.reserve(At(max_rows));
  for (Array* array : {&b, &unit, &inverse_root, &floor, &gain}) Grow(max_rows, array);
}

void ScaledProblem::Reset(const LcpProblem& problem, std::vector<Index> new_order) {
  size = problem.size();
  order = std::move(new_order);
  const Eigen::VectorXd& D = problem.DiagonalA();
  for (Array* array : {&b, &unit, &inverse_root}) Grow(size, array);
  for (Index k = 0; k < size; ++k) inverse_root[k] = D[Given(k)] == 0 ? 1.0 : 1.0 / std::sqrt(D[Given(k)]);
  has_idle = (D.array() == 0).any();
  mixed = has_idle || !problem.bilateral_rows().empty();
  if (!mixed) return;
  for (Array* array : {&floor, &gain}) Grow(size, array);
  for (Index k = 0; k < size; ++k) {
    floor[k] = problem.is_bilateral(Given(k)) ? -std::numeric_limits<double>::infinity() : 0.0;
    gain[k] = D[Given(k)] == 0 ? 0.0 : 1.0;
  }
}

void ScaledProblem::Take(const StepRows& rows) {
  size = static_cast<Index>(order.size());
  mixed = has_idle = false;
  for (Index k = 0; k < size && rows.bilateral != nullptr; ++k) {
    const bool is_joint = rows.bilateral[Given(k)] != 0;
    floor[k] = is_joint ? -std::numeric_limits<double>::infinity() : 0.0;
    gain[k] = 1;
    mixed = mixed || is_joint;
  }
}

void ScaledProblem::SetB(const double* given_b) {
  long double b_squared = 0;  // its exponent range holds the square of every double
  for (Index k = 0; k < size; ++k) {
    b[k] = given_b[Given(k)] * inverse_root[k];
    b_squared += static_cast<long double>(b[k]) * b[k];
  }
  const long double norm = std::sqrt(b_squared);
  const double scale = norm > 0 ? std::ldexp(1.0, std::ilogb(norm)) : 1.0;
  b_norm = norm > 0 ? static_cast<double>(norm / scale) : 1.0;
  b.head(size) /= scale;
  unit.head(size) = inverse_root.head(size) * scale;
}

void ScaledProblem::Start(const double* given, Array* f) const {
  Grow(size, f);
  f->head(size).setZero();
  for (Index k = 0; k < size && given != nullptr; ++k) {
    if (has_idle && gain[k] == 0) continue;
    const double start = given[Given(k)] / unit[k];
    (*f)[k] = IsFree(k) ? start : std::max(start, 0.0);
  }
}

void ScaledProblem::ToGiven(const Array& f, double* given) const {
  for (Index k = 0; k < size; ++k) given[Given(k)] = f[k] * unit[k];
}

void ScaledRows::Reserve(Index max_rows, Index max_bodies) {
  Grow(max_rows * 2 * kBodyWidth<6>, &rows_);
  Grow(max_bodies * 6, &root_mass_);
}

void ScaledRows::LayOut(Index p, Index size, Index bodies) {
  p_ = p;
  size_ = size;
  bodies_ = bodies;
  Grow(size * 2 * width(), &rows_);
  Grow(bodies * p, &root_mass_);
}

// @param first, second  < 0: none
void ScaledRows::PlaceBodies(Index k, Index first, Index second) {
  if (first < 0) first = bodies_ + k % kSpares;
  if (second < 0) second = bodies_ + (k + kSpares / 2) % kSpares;
  const std::array<int, 2> offsets = {static_cast<int>(first * width()), static_cast<int>(second * width())};
  std::memcpy(row(k) + width() + p_, &offsets, sizeof offsets);
}

template <Index p, typename Real>
bool ScaledRows::TakeOf(const StepRows& step, const Real* J, const std::int32_t* place, ScaledProblem* scaled) {
  constexpr Index kWidth = kBodyWidth<p>;
  for (Index k = 0; k < size_; ++k) {
    const Index given = scaled->Given(k);
    const Real* first = J + 2 * p * given;
    const Real* second = first + p;
    const auto place_of = [&](Index side) { return step.body[side] < 0 ? -1 : place[step.body[side]]; };
    std::int32_t at = place_of(2 * given);
    std::int32_t other = place_of(2 * given + 1);
    if (at < 0) {
      std::swap(first, second);
      std::swap(at, other);
    }
    if (at < 0) return false;
    double s[2 * kWidth] = {};
    double d = 0;
    const bool is_joined = other == at;  // both sides on one body
    const double* const root = root_mass_.data() + at * p;
    const double* const other_root = root_mass_.data() + std::max(other, 0) * p;
    if (is_joined) other = -1;
    for (Index c = 0; c < p; ++c) {
      s[c] = (static_cast<double>(first[c]) + (is_joined ? static_cast<double>(second[c]) : 0.0)) * root[c];
      s[kWidth + c] = other < 0 ? 0.0 : static_cast<double>(second[c]) * other_root[c];
      d += s[c] * s[c] + s[kWidth + c] * s[kWidth + c];
    }
    if (!(d > 0)) return false;
    const double inverse = 1 / std::sqrt(d);
    double* const to_row = rows_.data() + k * 2 * kWidth;
    for (Index c = 0; c < 2 * kWidth; ++c) to_row[c] = s[c] * inverse;
    scaled->inverse_root[k] = inverse;
    PlaceBodies(k, at, other);
  }
  return true;
}

bool ScaledRows::Take(const StepRows& step, std::span<const std::int32_t> given, const std::int32_t* place,
                      ScaledProblem* scaled) {
  const Index p = step.columns_per_body;
  LayOut(p, scaled->size, static_cast<Index>(given.size()));
  for (Index k = 0; k < bodies_; ++k) {
    for (Index c = 0; c < p; ++c) root_mass_[k * p + c] = std::sqrt(step.inverse_mass[Index{given[At(k)]} * p + c]);
  }
  return WithNumbers(step, [&](const auto* J, auto width) { return TakeOf<width>(step, J, place, scaled); });
}

void ScaledRows::FindSets() {
  set_end_.clear();
  if (size_ < kLanes) return;
  last_set_.assign(At(image_size() / width()), -1);
  Index set = 0;
  Index length = 0;
  Index in_fours = 0;
  const auto close = [&](Index end) {
    set_end_.push_back(end);
    in_fours += length - length % kLanes;
    length = 0;
    ++set;
  };
  for (Index k = 0; k < size_; ++k) {
    const std::array<int, 2> offsets = p_ == 3 ? Offsets<3>(row(k)) : Offsets<6>(row(k));
    const auto last = [&](int offset) -> Index& { return last_set_[At(offset / width())]; };
    const auto taken = [&](int offset) { return !is_spare(offset) && last(offset) == set; };
    if (taken(offsets[0]) || taken(offsets[1])) close(k);
    for (const int offset : offsets) last(offset) = set;
    ++length;
  }
  close(size_);
  if (static_cast<double>(in_fours) < kLeastShareInFours * static_cast<double>(size_)) set_end_.clear();
}

}  // namespace lcpbench
