#include "solvers/linear_algebra/islands.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "support/array_index.h"

namespace lcpbench {

void IdleRows::Prepare(const LcpProblem& problem) {
  const SparseMatrix& A = problem.SparseA();
  const Eigen::VectorXd& d = problem.DiagonalA();
  const size_t n = At(problem.size());
  keep_.assign(n, 1);
  has_twin_.assign(n, 0);
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
      const Index j = it.col();
      if (j != i && it.value() != 0 && it.value() == d[i] && it.value() == d[j]) has_twin_[At(i)] = 1;
    }
  }
}

bool IdleRows::IsIdle(const LcpProblem& problem, Index i) const {
  if (problem.is_bilateral(i)) return false;
  const Eigen::VectorXd& b = problem.b();
  bool pushed_down = b[i] < 0;
  if (pushed_down && has_twin_[At(i)] == 0) return false;
  const Eigen::VectorXd& d = problem.DiagonalA();
  for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
    const Index j = it.col();
    const double a = it.value();
    if (a == 0 || j == i || keep_[At(j)] == 0) continue;
    if (problem.is_bilateral(j) || a < 0) {
      pushed_down = true;
      if (has_twin_[At(i)] == 0) return false;
    } else if (a == d[i] && a == d[j] && (b[i] > b[j] || (b[i] == b[j] && i > j))) {
      return true;
    }
  }
  return !pushed_down;
}

Index IdleRows::Find(const LcpProblem& problem) {
  std::fill(keep_.begin(), keep_.end(), 1);
  Index idle = 0;
  // One pass is enough: A is symmetric, so a row left out for having no negative entries was none in any other row, and
  // a row left out as a twin leaves its twin.
  for (Index i = 0; i < problem.size(); ++i) {
    if (!IsIdle(problem, i)) continue;
    keep_[At(i)] = 0;
    ++idle;
  }
  return idle;
}

void DisjointSets::Reset(Index n) {
  parent_.resize(At(n));
  std::iota(parent_.begin(), parent_.end(), 0);
  sets_ = n;
}

Index DisjointSets::Root(Index i) {
  while (parent_[At(i)] != i) {
    parent_[At(i)] = parent_[At(parent_[At(i)])];
    i = parent_[At(i)];
  }
  return i;
}

bool DisjointSets::Join(Index i, Index j) {
  const Index a = Root(i);
  const Index b = Root(j);
  parent_[At(std::max(a, b))] = static_cast<std::int32_t>(std::min(a, b));
  sets_ -= a != b ? 1 : 0;
  return a != b;
}

template <typename Row>
void BasicIslands<Row>::Reserve(Index max_rows, Index max_bodies) {
  if (last_row_.size() < At(max_bodies)) last_row_.resize(At(max_bodies), -1);
  if (island_.capacity() > At(max_rows)) return;
  joined_.Reset(max_rows);
  for (std::vector<Row>* v : {&island_, &order_, &begin_, &filled_}) v->reserve(At(max_rows) + 1);
}

template <typename Row>
void BasicIslands<Row>::Join(std::span<const FrictionRow> friction) {
  for (const FrictionRow& row : friction) joined_.Join(row.row, row.normal);
}

template <typename Row>
void BasicIslands<Row>::Find(const SparseMatrix& A, const std::vector<char>& keep,
                             std::span<const FrictionRow> friction) {
  const Index n = A.rows();
  joined_.Reset(n);
  for (Index i = 0; i < n; ++i) {
    if (keep[At(i)] == 0) continue;
    for (SparseMatrix::InnerIterator it(A, i); it && it.col() < i; ++it) {
      if (it.value() != 0 && keep[At(it.col())] != 0) joined_.Join(it.col(), i);
    }
  }
  Join(friction);
  Collect(n, &keep);
}

template <typename Row>
void BasicIslands<Row>::FindByColumns(const SparseMatrix& J, const Eigen::VectorXd& inverse_mass,
                                      std::span<const FrictionRow> friction) {
  const Index n = J.rows();
  joined_.Reset(n);
  std::vector<Index> last_row(At(J.cols()), -1);
  for (Index i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      Index& last = last_row[At(it.col())];
      if (last >= 0) joined_.Join(last, i);
      last = i;
    }
  }
  Join(friction);
  Collect(n, nullptr);
}

template <typename Row>
void BasicIslands<Row>::Find(const StepRows& rows) {
  const Index p = rows.columns_per_body;
  const Index sides = 2 * rows.rows;
  joined_.Reset(rows.rows);
  for (Index side = 0; side < sides; ++side) {
    const std::int32_t body = rows.body[side];
    if (body < 0) continue;
    const double* const mass = rows.inverse_mass + body * p;
    double sum = 0;
    for (Index c = 0; c < p; ++c) sum += mass[c];
    if (!(sum > 0)) continue;
    std::int32_t& last = last_row_[At(body)];
    const auto row = static_cast<std::int32_t>(side / 2);
    if (last >= 0 && last != row) joined_.Join(last, row);
    last = row;
  }
  for (Index side = 0; side < sides; ++side) {
    if (rows.body[side] >= 0) last_row_[At(rows.body[side])] = -1;
  }
  Join(rows.friction);
  Collect(rows.rows, nullptr);
}

// Numbers the islands of the rows with (*keep)[i] != 0, and sorts their rows.
template <typename Row>
void BasicIslands<Row>::Collect(Index n, const std::vector<char>* keep) {
  const auto left_out = [keep](Index i) { return keep != nullptr && (*keep)[At(i)] == 0; };
  if (keep == nullptr && joined_.sets() == 1) {  // as most scenes are
    island_.assign(At(n), 0);
    begin_.assign({0, static_cast<Row>(n)});
    order_.resize(At(n));
    std::iota(order_.begin(), order_.end(), Row{0});
    largest_ = n;
    return;
  }
  island_.assign(At(n), -1);
  Row count = 0;
  begin_.assign(1, 0);
  for (Index i = 0; i < n; ++i) {
    if (left_out(i)) continue;
    const Index root = joined_.Root(i);
    if (root == i) {
      island_[At(i)] = count++;
      begin_.push_back(0);
    }
    island_[At(i)] = island_[At(root)];
    ++begin_[At(island_[At(i)]) + 1];
  }
  Row largest = 0;
  for (Row k = 0; k < count; ++k) {
    largest = std::max(largest, begin_[At(k) + 1]);
    begin_[At(k) + 1] += begin_[At(k)];
  }
  largest_ = largest;
  order_.resize(At(begin_.back()));
  filled_.assign(begin_.begin(), begin_.end() - 1);
  for (Index i = 0; i < n; ++i) {
    if (!left_out(i)) order_[At(filled_[At(island_[At(i)])]++)] = static_cast<Row>(i);
  }
}

template class BasicIslands<Index>;
template class BasicIslands<std::int32_t>;

std::pair<int, int> BodiesOfRow(const LcpProblem& problem, Index row) {
  std::pair<int, int> bodies = {-1, -1};
  for (SparseMatrix::InnerIterator it(problem.J(), row); it; ++it) {
    if (it.value() == 0 || problem.inverse_mass()[it.col()] == 0) continue;
    const int body = static_cast<int>(it.col() / problem.columns_per_body());
    (bodies.first < 0 || bodies.first == body ? bodies.first : bodies.second) = body;
  }
  return bodies;
}

RowBounds BoundsOfRows(const LcpProblem& problem, std::span<const Index> rows) {
  RowBounds bounds;
  const auto place = [&](Index row) { return std::ranges::lower_bound(rows, row) - rows.begin(); };
  for (const Index row : rows) bounds.bilateral.push_back(problem.is_bilateral(row) ? 1 : 0);
  for (FrictionRow row : problem.friction_rows()) {
    if (!std::ranges::binary_search(rows, row.row)) continue;
    row.row = place(row.row);
    if (std::ranges::binary_search(rows, row.normal)) {
      row.normal = place(row.normal);
      bounds.friction.push_back(row);
    } else {
      bounds.bounded.push_back({row.row, 0, 0});  // without its contact
    }
  }
  for (BoundedRow row : problem.bounded_rows()) {
    if (!std::ranges::binary_search(rows, row.row)) continue;
    row.row = place(row.row);
    bounds.bounded.push_back(row);
  }
  return bounds;
}

LcpProblem Subproblem(const LcpProblem& problem, std::span<const Index> rows) {
  const auto m = static_cast<Index>(rows.size());
  Eigen::VectorXd b(m);
  for (Index k = 0; k < m; ++k) b[k] = problem.b()[rows[At(k)]];
  const std::string id = problem.id() + " (" + std::to_string(m) + " rows)";
  RowBounds bounds = BoundsOfRows(problem, rows);
  MatrixFacts facts;
  facts.symmetric = problem.facts().symmetric;
  facts.positive_semidefinite = problem.facts().positive_semidefinite;
  const bool has_factors = problem.has_factors();
  if (has_factors) facts.columns_per_body = problem.columns_per_body();
  const SparseMatrix& given = has_factors ? problem.J() : problem.SparseA();
  // Bodies and, where A is given, rows: numbered without gaps as the rows name them; -1 for what is left out.
  const Index width = has_factors ? facts.columns_per_body : 1;
  std::vector<Index> number(At((given.cols() + width - 1) / width), -1);
  Index count = has_factors ? 0 : m;
  for (Index k = 0; k < m; ++k) {
    if (!has_factors) number[At(rows[At(k)])] = k;
    for (SparseMatrix::InnerIterator it(given, rows[At(k)]); it && has_factors; ++it) {
      Index& body = number[At(it.col() / width)];
      if (body < 0) body = count++;
    }
  }
  const auto place = [&](Index column) {
    const Index block = number[At(column / width)];
    return block < 0 ? -1 : width * block + column % width;
  };
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index k = 0; k < m; ++k) {
    for (SparseMatrix::InnerIterator it(given, rows[At(k)]); it; ++it) {
      const auto column = static_cast<int>(place(it.col()));
      if (column >= 0) entries.emplace_back(static_cast<int>(k), column, it.value());
    }
  }
  SparseMatrix part(m, width * count);
  part.setFromTriplets(entries.begin(), entries.end());
  if (!has_factors) return LcpProblem::FromSparse(id, part, std::move(b), bounds, facts);
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Zero(part.cols());
  for (Index column = 0; column < given.cols(); ++column) {
    if (place(column) >= 0) inverse_mass[place(column)] = problem.inverse_mass()[column];
  }
  return LcpProblem::FromFactors(id, part, std::move(inverse_mass), std::move(b), bounds, facts);
}

}  // namespace lcpbench
