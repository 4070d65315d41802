#include "solvers/rows/scaled_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lcpbench {
namespace {

constexpr Index kMostWidth = kBodyWidth<6>;

}  // namespace

void ScaledRows::Reserve(Index max_rows, Index max_bodies) {
  if (number_.size() < At(max_bodies)) number_.resize(At(max_bodies), -1);
  if (given_.size() >= At(max_rows)) return;
  const Index n = max_rows;
  const Index most_bodies = 2 * n;
  for (auto* v : {&given_, &first_, &second_, &part_first_, &part_second_, &order_}) v->resize(At(n));
  is_joint_.resize(At(n));
  G_.setZero(2 * kMostWidth * n);
  for (auto* v : {&b_, &scale_}) v->setZero(n);
  for (auto* v : {&body_of_number_, &place_, &queue_, &rows_of_body_, &rows_begin_, &rows_end_, &order_end_}) {
    v->resize(At(most_bodies) + 1);
  }
  root_mass_.setZero(most_bodies * kMostWidth);
}

// Bodies that can move, as the rows name them; the first one of a row is always such a body.
bool ScaledRows::NumberBodies(const StepRows& all, std::span<const std::int32_t> part) {
  const Index p = all.columns_per_body;
  const auto number = [&](std::int32_t body) -> std::int32_t {
    if (body < 0) return -1;
    std::int32_t& known = number_[At(body)];
    if (known >= 0) return known;
    double sum = 0;
    for (Index c = 0; c < p; ++c) sum += all.inverse_mass[body * p + c];
    if (sum == 0) return -1;
    body_of_number_[At(bodies_)] = body;
    known = static_cast<std::int32_t>(bodies_++);
    return known;
  };
  bodies_ = 0;
  bool all_move = true;
  for (Index i = 0; i < n_ && all_move; ++i) {
    const Index row = part[At(i)];
    std::int32_t first = number(all.body[2 * row]);
    std::int32_t second = number(all.body[2 * row + 1]);
    if (first < 0) std::swap(first, second);
    if (second == first) second = -1;
    part_first_[At(i)] = first;
    part_second_[At(i)] = second;
    all_move = first >= 0;
  }
  for (Index k = 0; k < bodies_; ++k) number_[At(body_of_number_[At(k)])] = -1;
  return all_move;
}

void ScaledRows::ListRowsOfBodies() {
  std::fill_n(rows_begin_.begin(), bodies_ + 1, 0);
  for (Index i = 0; i < n_; ++i) {
    ++rows_begin_[At(part_first_[At(i)]) + 1];
    if (part_second_[At(i)] >= 0) ++rows_begin_[At(part_second_[At(i)]) + 1];
  }
  for (Index k = 0; k < bodies_; ++k) rows_begin_[At(k) + 1] += rows_begin_[At(k)];
  std::copy_n(rows_begin_.begin(), bodies_, rows_end_.begin());
  for (Index i = 0; i < n_; ++i) {
    rows_of_body_[At(rows_end_[At(part_first_[At(i)])]++)] = static_cast<std::int32_t>(i);
    if (part_second_[At(i)] >= 0) {
      rows_of_body_[At(rows_end_[At(part_second_[At(i)])]++)] = static_cast<std::int32_t>(i);
    }
  }
}

// Breadth-first from the first body, by the rows that bodies share; then from where that ends. What is not connected
// with it comes behind.
void ScaledRows::OrderBodies() {
  std::int32_t start = 0;
  for (int round = 0; round < 2; ++round) {
    std::fill_n(place_.begin(), bodies_, -1);
    std::int32_t count = 0;
    std::int32_t unplaced = 0;
    queue_[0] = start;
    place_[At(start)] = count++;
    for (std::int32_t head = 0; head < count; ++head) {
      const std::int32_t body = queue_[At(head)];
      for (std::int32_t e = rows_begin_[At(body)]; e < rows_end_[At(body)]; ++e) {
        const std::int32_t row = rows_of_body_[At(e)];
        const std::int32_t other = part_first_[At(row)] == body ? part_second_[At(row)] : part_first_[At(row)];
        if (other < 0 || place_[At(other)] >= 0) continue;
        place_[At(other)] = count;
        queue_[At(count++)] = other;
      }
      if (head + 1 < count || count == bodies_) continue;
      while (place_[At(unplaced)] >= 0) ++unplaced;
      place_[At(unplaced)] = count;
      queue_[At(count++)] = unplaced;
    }
    start = queue_[At(count - 1)];
  }
}

// Rows by the later one of their bodies, by counting.
void ScaledRows::OrderRows() {
  const auto later_place = [&](Index i) {
    const std::int32_t first = place_[At(part_first_[At(i)])];
    return part_second_[At(i)] < 0 ? first : std::max(first, place_[At(part_second_[At(i)])]);
  };
  std::fill_n(order_end_.begin(), bodies_ + 1, 0);
  for (Index i = 0; i < n_; ++i) ++order_end_[At(later_place(i)) + 1];
  for (Index k = 0; k < bodies_; ++k) order_end_[At(k) + 1] += order_end_[At(k)];
  for (Index i = 0; i < n_; ++i) order_[At(order_end_[At(later_place(i))]++)] = static_cast<std::int32_t>(i);
}

template <Index p, typename Real>
bool ScaledRows::ScaleRows(const StepRows& all, const Real* J, std::span<const std::int32_t> part) {
  constexpr Index width = kBodyWidth<p>;
  for (Index k = 0; k < bodies_; ++k) {
    double* root = root_mass_.data() + place_[At(k)] * width;
    const double* inverse_mass = all.inverse_mass + Index{body_of_number_[At(k)]} * p;
    for (int c = 0; c < p; ++c) root[c] = std::sqrt(inverse_mass[c]);
    for (int c = p; c < width; ++c) root[c] = 0;
  }
  double b_square = 0;
  for (Index i = 0; i < n_; ++i) {
    const Index from = order_[At(i)];
    const Index row = part[At(from)];
    given_[At(i)] = static_cast<std::int32_t>(row);
    first_[At(i)] = place_[At(part_first_[At(from)])];
    second_[At(i)] = part_second_[At(from)] < 0 ? -1 : place_[At(part_second_[At(from)])];
    const std::int32_t* body = all.body + 2 * row;
    const bool is_joined = body[0] == body[1];
    const bool swapped = body[0] < 0 || body_of_number_[At(part_first_[At(from)])] != body[0];
    const Real* j = J + row * 2 * p;
    double* G = G_.data() + i * 2 * width;
    double d = 0;
    for (int s = 0; s < 2; ++s) {
      const std::int32_t of = s == 0 ? first_[At(i)] : second_[At(i)];
      double* side = G + s * width;
      for (int c = 0; c < width; ++c) side[c] = 0;
      if (of < 0) continue;
      const double* root = root_mass_.data() + of * width;
      const Real* numbers = j + ((s == 1) != swapped ? p : 0);
      for (int c = 0; c < p; ++c) {
        const double sum =
            is_joined ? static_cast<double>(j[c]) + static_cast<double>(j[p + c]) : static_cast<double>(numbers[c]);
        side[c] = sum * root[c];
        d += side[c] * side[c];
      }
    }
    if (!(d > 0)) return false;
    const double s = 1 / std::sqrt(d);
    for (int c = 0; c < 2 * width; ++c) G[c] *= s;
    scale_[i] = s;
    b_[i] = all.b[row] * s;
    b_square += b_[i] * b_[i];
    is_joint_[At(i)] = all.bilateral != nullptr && all.bilateral[row] != 0 ? 1 : 0;
  }
  b_norm_ = b_square > 0 ? std::sqrt(b_square) : 1;
  return true;
}

bool ScaledRows::Load(const StepRows& all, std::span<const std::int32_t> part) {
  n_ = static_cast<Index>(part.size());
  bool loaded = NumberBodies(all, part);
  if (loaded) {
    ListRowsOfBodies();
    OrderBodies();
    OrderRows();
    const auto scale = [&](const auto* J) {
      return all.columns_per_body == 3 ? ScaleRows<3>(all, J, part) : ScaleRows<6>(all, J, part);
    };
    loaded = all.J != nullptr ? scale(all.J) : scale(all.J_single);
  }
  if (!loaded) n_ = 0;
  return loaded;
}

}  // namespace lcpbench
