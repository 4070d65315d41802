#include "solvers/rows/row_islands.h"

#include <algorithm>
#include <utility>

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }
// A body of the step that has no island yet; bodies that no row names have -1.
constexpr std::int32_t kNamed = -2;

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
  // of_row_ first holds a body of the row's that moves. of_body_ is kNamed where a row has named it.
  Index trees = 0;
  for (Index i = 0; i < all.rows; ++i) {
    std::int32_t first = all.body[2 * i];
    std::int32_t second = all.body[2 * i + 1];
    if (!moves(first)) first = -1;
    if (!moves(second)) second = -1;
    of_row_[At(i)] = first >= 0 ? first : second;
    for (const std::int32_t body : {first, second}) {
      if (body < 0 || of_body_[At(body)] == kNamed) continue;
      of_body_[At(body)] = kNamed;
      ++trees;
    }
    if (first < 0 && second < 0) ++trees;
    if (first < 0 || second < 0) continue;
    first = Root(first);
    second = Root(second);
    if (first == second) continue;
    parent_[At(std::max(first, second))] = std::min(first, second);
    --trees;
  }
  if (trees == 1) {  // as most scenes are
    count_ = 1;
    begin_[0] = 0;
    begin_[1] = static_cast<std::int32_t>(all.rows);
    for (Index i = 0; i < all.rows; ++i) order_[At(i)] = static_cast<std::int32_t>(i);
    Forget(all);
    return;
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
  }
  Forget(all);
}

void RowIslands::Forget(const StepRows& all) {
  for (Index i = 0; i < all.rows; ++i) {
    for (const std::int32_t body : {all.body[2 * i], all.body[2 * i + 1]}) {
      if (body < 0) continue;
      parent_[At(body)] = body;
      of_body_[At(body)] = -1;
    }
  }
}

}  // namespace lcpbench
