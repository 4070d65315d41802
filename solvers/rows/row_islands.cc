#include "solvers/rows/row_islands.h"

#include <algorithm>
#include <utility>

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

void RowIslands::Reserve(Index max_rows, Index max_bodies) {
  for (auto known = static_cast<std::int32_t>(parent_.size()); known < max_bodies; ++known) {
    parent_.push_back(known);
    of_body_.push_back(-1);
  }
  if (of_row_.size() >= At(max_rows)) return;
  of_row_.resize(At(max_rows));
  order_.resize(At(max_rows));
  begin_.resize(At(max_rows) + 2);
}

std::int32_t RowIslands::Root(std::int32_t body) {
  while (parent_[At(body)] != body) {
    parent_[At(body)] = parent_[At(parent_[At(body)])];
    body = parent_[At(body)];
  }
  return body;
}

void RowIslands::Find(const StepRows& all) {
  const Index p = all.columns_per_body;
  const auto moves = [&](std::int32_t body) {
    if (body < 0) return false;
    const double* mass = all.inverse_mass + body * p;
    double sum = 0;
    for (Index c = 0; c < p; ++c) sum += mass[c];
    return sum > 0;
  };
  // of_row_ first holds a body of the row's that moves.
  for (Index i = 0; i < all.rows; ++i) {
    std::int32_t first = all.body[2 * i];
    std::int32_t second = all.body[2 * i + 1];
    if (!moves(first)) first = -1;
    if (!moves(second)) second = -1;
    of_row_[At(i)] = first >= 0 ? first : second;
    if (first < 0 || second < 0) continue;
    first = Root(first);
    second = Root(second);
    parent_[At(std::max(first, second))] = std::min(first, second);
  }
  count_ = 0;
  std::fill_n(begin_.begin(), At(all.rows) + 2, 0);
  for (Index i = 0; i < all.rows; ++i) {
    std::int32_t island = -1;
    if (of_row_[At(i)] >= 0) {
      std::int32_t& of_root = of_body_[At(Root(of_row_[At(i)]))];
      if (of_root < 0) of_root = static_cast<std::int32_t>(count_++);
      island = of_root;
    } else {
      island = static_cast<std::int32_t>(count_++);  // nothing that it moves
    }
    of_row_[At(i)] = island;
    ++begin_[At(island) + 2];
  }
  for (Index k = 2; k <= count_; ++k) begin_[At(k) + 1] += begin_[At(k)];
  for (Index i = 0; i < all.rows; ++i) {
    order_[At(begin_[At(of_row_[At(i)]) + 1]++)] = static_cast<std::int32_t>(i);
    for (const std::int32_t body : {all.body[2 * i], all.body[2 * i + 1]}) {
      if (body < 0) continue;
      parent_[At(body)] = body;
      of_body_[At(body)] = -1;
    }
  }
}

}  // namespace lcpbench
