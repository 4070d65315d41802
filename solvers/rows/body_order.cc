#include "solvers/rows/body_order.h"

#include <algorithm>
#include <utility>

#include "support/array_index.h"

namespace lcpbench {
void BodyOrder::Reserve(Index max_rows, Index max_bodies) {
  if (number_.size() < At(max_bodies)) number_.resize(At(max_bodies), -1);
  if (first_.size() >= At(max_rows)) return;
  for (auto* v : {&first_, &second_}) v->resize(At(max_rows));
  for (auto* v : {&body_, &place_, &queue_, &order_end_}) v->resize(At(2 * max_rows) + 1);
  sides_.Reserve(max_rows, 2 * max_rows);
}

// Bodies that can move, as the rows name them; the first one of a row is always such a body.
bool BodyOrder::NumberBodies(const StepRows& all, std::span<const std::int32_t> part) {
  const Index p = all.columns_per_body;
  const auto number = [&](std::int32_t body) -> std::int32_t {
    if (body < 0) return -1;
    std::int32_t& known = number_[At(body)];
    if (known >= 0) return known;
    double sum = 0;
    for (Index c = 0; c < p; ++c) sum += all.inverse_mass[body * p + c];
    if (sum == 0) return -1;
    body_[At(count_)] = body;
    known = static_cast<std::int32_t>(count_++);
    return known;
  };
  for (Index k = 0; k < count_; ++k) number_[At(body_[At(k)])] = -1;  // of the island before
  n_ = static_cast<Index>(part.size());
  count_ = 0;
  for (Index i = 0; i < n_; ++i) {
    const Index row = part[At(i)];
    std::int32_t first = number(all.body[2 * row]);
    std::int32_t second = number(all.body[2 * row + 1]);
    if (first < 0) std::swap(first, second);
    if (second == first) second = -1;
    if (first < 0) return false;
    first_[At(i)] = first;
    second_[At(i)] = second;
  }
  for (Index k = 0; k < count_; ++k) sides_.Forget(k);
  for (std::int32_t side = 0; side < 2 * n_; ++side) {
    if (body_of_side(side) >= 0) sides_.Add(body_of_side(side), side);
  }
  return true;
}

// Breadth-first from the first body, by the rows that bodies share; then from where that ends. What is not connected
// with it comes behind.
void BodyOrder::OrderBodies() {
  std::int32_t start = 0;
  for (int round = 0; round < 2; ++round) {
    std::fill_n(place_.begin(), count_, -1);
    std::int32_t count = 0;
    std::int32_t unplaced = 0;
    queue_[0] = start;
    place_[At(start)] = count++;
    for (std::int32_t head = 0; head < count; ++head) {
      const std::int32_t body = queue_[At(head)];
      sides_.ForEach(body, [&](std::int32_t side) {
        const std::int32_t other = body_of_side(side ^ 1);
        if (other < 0 || place_[At(other)] >= 0) return;
        place_[At(other)] = count;
        queue_[At(count++)] = other;
      });
      if (head + 1 < count || count == count_) continue;
      while (place_[At(unplaced)] >= 0) ++unplaced;
      place_[At(unplaced)] = count;
      queue_[At(count++)] = unplaced;
    }
    start = queue_[At(count - 1)];
  }
}

// Rows by the later one of their bodies, by counting.
void BodyOrder::OrderRows(std::span<const std::int32_t> part, std::vector<Index>* order) {
  const auto later_place = [&](Index i) {
    const std::int32_t first = place_[At(first_[At(i)])];
    return second_[At(i)] < 0 ? first : std::max(first, place_[At(second_[At(i)])]);
  };
  std::fill_n(order_end_.begin(), count_ + 1, 0);
  for (Index i = 0; i < n_; ++i) ++order_end_[At(later_place(i)) + 1];
  for (Index k = 0; k < count_; ++k) order_end_[At(k) + 1] += order_end_[At(k)];
  order->resize(At(n_));
  for (Index i = 0; i < n_; ++i) (*order)[At(order_end_[At(later_place(i))]++)] = part[At(i)];
}

bool BodyOrder::Find(const StepRows& all, std::span<const std::int32_t> part, std::vector<Index>* order) {
  if (!NumberBodies(all, part)) return false;
  OrderBodies();
  OrderRows(part, order);
  // From here on the numbers are places; the queue has bodies in that order.
  for (Index k = 0; k < count_; ++k) queue_[At(k)] = body_[At(queue_[At(k)])];
  std::swap(queue_, body_);
  for (Index k = 0; k < count_; ++k) number_[At(body_[At(k)])] = static_cast<std::int32_t>(k);
  return true;
}

}  // namespace lcpbench
