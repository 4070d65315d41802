#include "solvers/body_space.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lcpbench {
namespace {

using ColumnMatrix = CholmodFactor::ColumnMatrix;

// Nested dissection takes some hundred times as long as minimum degree and saves a fifth to a third of the work of
// factorisations of this many flop, which a solve pays ten to forty times.
constexpr double kWorthDissection = 4e8;
constexpr double kWorthChange = 0.9;  // its work against that of minimum degree

constexpr int kAxes = 3;

// The first column of a body.
Index At(int body) { return Index{kAxes} * body; }

}  // namespace

void BodySpace::ReadRows(const LcpProblem& problem, const Eigen::VectorXd& root, const std::vector<char>& taking_part) {
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  std::vector<int> body_of(static_cast<size_t>((J.cols() + kAxes - 1) / kAxes), -1);
  rows_.assign(static_cast<size_t>(problem.size()), {});
  bodies_ = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    if (taking_part[static_cast<size_t>(i)] == 0) continue;
    Row& row = rows_[static_cast<size_t>(i)];
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      int& body = body_of[static_cast<size_t>(it.col() / kAxes)];
      if (body < 0) body = bodies_++;
      const bool is_first = row.first < 0 || row.first == body;
      (is_first ? row.first : row.second) = body;
      (is_first ? row.first_j : row.second_j)[it.col() % kAxes] =
          it.value() * std::sqrt(inverse_mass[it.col()]) / root[i];
    }
  }
}

ColumnMatrix BodySpace::Graph() const {
  std::vector<Eigen::Triplet<double, int>> edges;
  edges.reserve(rows_.size());
  for (const Row& row : rows_) {
    if (row.second >= 0) edges.emplace_back(std::max(row.first, row.second), std::min(row.first, row.second), 1.0);
  }
  ColumnMatrix graph(bodies_, bodies_);
  graph.setFromTriplets(edges.begin(), edges.end());
  return graph;
}

void BodySpace::Relabel(const Eigen::VectorXi& nodes) {
  std::vector<int> place(static_cast<size_t>(bodies_));
  for (int k = 0; k < bodies_; ++k) place[static_cast<size_t>(nodes[k])] = k;
  for (Row& row : rows_) {
    if (row.first >= 0) row.first = place[static_cast<size_t>(row.first)];
    if (row.second < 0) continue;
    row.second = place[static_cast<size_t>(row.second)];
    if (row.first > row.second) {
      std::swap(row.first, row.second);
      std::swap(row.first_j, row.second_j);
    }
  }
}

void BodySpace::Analyze(const ColumnMatrix& graph, GraphOrder order, const Eigen::VectorXi& nodes) {
  order_ = order;
  ++analyses_;
  std::vector<int> place(static_cast<size_t>(bodies_));
  for (int k = 0; k < bodies_; ++k) place[static_cast<size_t>(nodes[k])] = k;
  // Neighbours of a body that come after it, in elimination order.
  std::vector<std::vector<int>> after(static_cast<size_t>(bodies_));
  for (int j = 0; j < bodies_; ++j) {
    for (ColumnMatrix::InnerIterator it(graph, j); it; ++it) {
      const int p = place[static_cast<size_t>(j)];
      const int q = place[static_cast<size_t>(it.row())];
      after[static_cast<size_t>(std::min(p, q))].push_back(std::max(p, q));
    }
  }
  Eigen::VectorXi counts(kAxes * bodies_);
  for (int k = 0; k < bodies_; ++k) {
    std::vector<int>& neighbours = after[static_cast<size_t>(k)];
    std::sort(neighbours.begin(), neighbours.end());
    for (int a = 0; a < kAxes; ++a) {
      counts[kAxes * k + a] = kAxes - a + kAxes * static_cast<int>(neighbours.size());
    }
  }
  ColumnMatrix lower(At(bodies_), At(bodies_));
  lower.reserve(counts);
  for (int k = 0; k < bodies_; ++k) {
    for (int a = 0; a < kAxes; ++a) {
      const int column = kAxes * k + a;
      for (int r = a; r < kAxes; ++r) lower.insert(kAxes * k + r, column) = 0;
      for (const int other : after[static_cast<size_t>(k)]) {
        for (int r = 0; r < kAxes; ++r) lower.insert(kAxes * other + r, column) = 0;
      }
    }
  }
  lower.makeCompressed();
  factor_.AnalyzeAsOrdered(lower);
}

bool BodySpace::JoinsAsBefore() {
  const auto same = [](const Row& row, const std::pair<int, int>& pair) {
    return row.first == pair.first && row.second == pair.second;
  };
  if (factor_.size() == At(bodies_) && nodes_.size() == bodies_ &&
      std::equal(rows_.begin(), rows_.end(), joined_.begin(), joined_.end(), same)) {
    return true;
  }
  joined_.resize(rows_.size());
  std::transform(rows_.begin(), rows_.end(), joined_.begin(),
                 [](const Row& row) { return std::make_pair(row.first, row.second); });
  return false;
}

void BodySpace::Order() {
  nodes_.resize(0);  // until the analysis has succeeded
  const ColumnMatrix graph = Graph();
  Eigen::VectorXi nodes = OrderGraph(graph, GraphOrder::kMinimumDegree);
  Analyze(graph, GraphOrder::kMinimumDegree, nodes);
  const double work = factor_.flops();
  if (work > kWorthDissection) {
    const Eigen::VectorXi dissected = OrderGraph(graph, GraphOrder::kNestedDissection);
    if (dissected.size() == bodies_) {
      Analyze(graph, GraphOrder::kNestedDissection, dissected);
      if (factor_.flops() < kWorthChange * work) {
        nodes = dissected;
      } else {
        Analyze(graph, GraphOrder::kMinimumDegree, nodes);
      }
    }
  }
  nodes_ = nodes;
}

void BodySpace::Prepare(const LcpProblem& problem, const Eigen::VectorXd& root, const std::vector<char>& taking_part) {
  ReadRows(problem, root, taking_part);
  analyses_ = 0;
  if (!JoinsAsBefore()) Order();
  Relabel(nodes_);
  // The place of a row's block within the columns of its first body.
  const int* starts = factor_.column_starts();
  const int* indices = factor_.row_indices();
  for (Row& row : rows_) {
    if (row.second < 0) continue;
    const int* begin = indices + starts[At(row.first)] + kAxes;
    const int* end = indices + starts[At(row.first) + 1];
    row.below = static_cast<int>(std::lower_bound(begin, end, kAxes * row.second) - begin);
  }
  weight_.setZero(rows());
  product_.setZero(rows());
  body_.setZero(At(bodies_));
  image_.setZero(At(bodies_));
}

void BodySpace::ToBodies(const Eigen::VectorXd& f, Eigen::VectorXd* x) const {
  x->setZero(At(bodies_));
  double* out = x->data();
  const double* force = f.data();
  for (const Row& row : rows_) {
    const double value = *force++;
    if (row.first < 0) continue;
    double* first = out + At(row.first);
    for (int a = 0; a < kAxes; ++a) first[a] += row.first_j[a] * value;
    if (row.second < 0) continue;
    double* second = out + At(row.second);
    for (int a = 0; a < kAxes; ++a) second[a] += row.second_j[a] * value;
  }
}

void BodySpace::ToRows(const Eigen::VectorXd& x, Eigen::VectorXd* w) const {
  w->resize(rows());
  const double* in = x.data();
  double* out = w->data();
  for (const Row& row : rows_) {
    double sum = 0;
    if (row.first >= 0) {
      const double* first = in + At(row.first);
      for (int a = 0; a < kAxes; ++a) sum += row.first_j[a] * first[a];
    }
    if (row.second >= 0) {
      const double* second = in + At(row.second);
      for (int a = 0; a < kAxes; ++a) sum += row.second_j[a] * second[a];
    }
    *out++ = sum;
  }
}

void BodySpace::Multiply(const Eigen::VectorXd& f, Eigen::VectorXd* y) const {
  ToBodies(f, &image_);
  ToRows(image_, y);
}

bool BodySpace::Factorize(const Eigen::VectorXd& theta) {
  double* values = factor_.values();
  const int* starts = factor_.column_starts();
  std::fill(values, values + starts[At(bodies_)], 0.0);
  for (int j = 0; j < kAxes * bodies_; ++j) values[starts[j]] = 1;
  Index i = 0;
  for (const Row& row : rows_) {
    const double t = row.first >= 0 && theta[i] < kOut ? 1 / theta[i] : 0.0;
    weight_[i++] = t;
    if (t == 0) continue;
    const int p = row.first;
    for (int a = 0; a < kAxes; ++a) {
      double* column = values + starts[kAxes * p + a];
      const double scaled = t * row.first_j[a];
      for (int r = a; r < kAxes; ++r) column[r - a] += scaled * row.first_j[r];
      if (row.second < 0) continue;
      double* block = column + (kAxes - a) + row.below;
      for (int r = 0; r < kAxes; ++r) block[r] += scaled * row.second_j[r];
    }
    if (row.second < 0) continue;
    const int q = row.second;
    for (int a = 0; a < kAxes; ++a) {
      double* column = values + starts[kAxes * q + a];
      const double scaled = t * row.second_j[a];
      for (int r = a; r < kAxes; ++r) column[r - a] += scaled * row.second_j[r];
    }
  }
  return factor_.Factorize();
}

void BodySpace::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  product_ = weight_.cwiseProduct(r);
  ToBodies(product_, &body_);
  factor_.Solve(body_, &body_);
  ToRows(body_, &product_);
  *x = weight_.cwiseProduct(r - product_);
}

}  // namespace lcpbench
