#include "solvers/linear_algebra/body_space.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/lcp/in_sequence.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/islands.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr int kAxes = BodySpace::kAxes;

// The first column of a body.
Index First(int body) { return Index{kAxes} * body; }

// x_body += j value, and j.x_body.
void Add(const double* j, double value, double* x, int body) {
  for (Index a = 0; a < kAxes; ++a) x[First(body) + a] += j[a] * value;
}
double Dot(const double* j, const double* x, int body) {
  double sum = 0;
  for (Index a = 0; a < kAxes; ++a) sum += j[a] * x[First(body) + a];
  return sum;
}

using Graph = CholmodFactor::ColumnMatrix;

// Nested dissection takes some hundred times as long as minimum degree and saves a fifth to a third of the work of
// factorizations of this many flop, which a solve pays ten to forty times.
constexpr double kWorthDissection = 4e8;
constexpr double kWorthChange = 0.9;  // its work against that of minimum degree

constexpr int kNone = -1;

// The lower triangle of K, zeros, for the bodies of a graph in the order `nodes`.
Graph PatternOfK(const Graph& graph, const Eigen::VectorXi& nodes) {
  const auto bodies = static_cast<int>(graph.cols());
  std::vector<int> place(At(bodies));
  for (int k = 0; k < bodies; ++k) place[At(nodes[k])] = k;
  std::vector<std::vector<int>> after(At(bodies));  // neighbours that come later
  for (int j = 0; j < bodies; ++j) {
    for (Graph::InnerIterator it(graph, j); it; ++it) {
      const auto [p, q] = std::minmax(place[At(j)], place[At(it.row())]);
      after[At(p)].push_back(q);
    }
  }
  Eigen::VectorXi counts(First(bodies));
  for (int k = 0; k < bodies; ++k) {
    std::sort(after[At(k)].begin(), after[At(k)].end());
    for (int a = 0; a < kAxes; ++a) counts[First(k) + a] = kAxes * static_cast<int>(after[At(k)].size() + 1) - a;
  }
  Graph lower(First(bodies), First(bodies));
  lower.reserve(counts);
  for (int column = 0; column < kAxes * bodies; ++column) {
    const int k = column / kAxes;
    for (int r = column; r < kAxes * (k + 1); ++r) lower.insert(r, column) = 0;
    for (const int other : after[At(k)]) {
      for (int r = 0; r < kAxes; ++r) lower.insert(kAxes * other + r, column) = 0;
    }
  }
  if (bodies > 0) lower.makeCompressed();  // which reads beyond a matrix without columns
  return lower;
}

}  // namespace

// place_ and the analysis, by bodies_of_rows_.
void BodySpace::Order(Index triples) {
  std::vector<int> number(At(triples), kNone);  // in the order of their rows
  std::vector<int> found;
  std::vector<Eigen::Triplet<double, int>> edges;
  edges.reserve(bodies_of_rows_.size());
  const auto number_of = [&](int body) {
    if (number[At(body)] == kNone) {
      number[At(body)] = static_cast<int>(found.size());
      found.push_back(body);
    }
    return number[At(body)];
  };
  for (const auto& [body, other] : bodies_of_rows_) {
    if (body == kNone) continue;
    const int first = number_of(body);
    if (other == kNone) continue;
    const int second = number_of(other);
    edges.emplace_back(std::max(first, second), std::min(first, second), 1.0);
  }
  bodies_ = static_cast<int>(found.size());
  Graph graph(bodies_, bodies_);
  graph.setFromTriplets(edges.begin(), edges.end());

  const auto analyze = [&](const Eigen::VectorXi& nodes) {
    ++analyses_;
    factor_.AnalyzeAsOrdered(PatternOfK(graph, nodes));
    return factor_.flops();
  };
  Eigen::VectorXi nodes = OrderGraph(graph, GraphOrder::kMinimumDegree);
  if (nodes.size() != graph.cols()) throw MemoryRefusal("there is no memory for the order of the bodies");
  const double work = analyze(nodes);
  if (work > kWorthDissection) {
    Eigen::VectorXi dissected = OrderGraph(graph, GraphOrder::kNestedDissection);
    if (dissected.size() == graph.cols()) {
      if (analyze(dissected) < kWorthChange * work) {
        nodes = std::move(dissected);
      } else {
        analyze(nodes);
      }
    }
  }
  place_.assign(At(triples), kNone);
  for (int k = 0; k < bodies_; ++k) place_[At(found[At(nodes[k])])] = k;
}

void BodySpace::Prepare(const LcpProblem& problem, const std::vector<char>& taking_part) {
  analyses_ = 0;
  std::vector<std::pair<int, int>> bodies(At(problem.size()), {kNone, kNone});
  for (Index i = 0; i < problem.size(); ++i) {
    if (taking_part.empty() || taking_part[At(i)] != 0) bodies[At(i)] = BodiesOfRow(problem, i);
  }
  if (!InSequence::on() || place_.empty() || bodies != bodies_of_rows_) {
    bodies_of_rows_ = std::move(bodies);
    place_.clear();  // until the analysis has succeeded
    Order((problem.J().cols() + kAxes - 1) / kAxes);
  }
  rows_.assign(bodies_of_rows_.size(), {});
  for (Index i = 0; i < rows(); ++i) {
    const auto [body, other] = bodies_of_rows_[At(i)];
    Row& row = rows_[At(i)];
    if (body == kNone) continue;
    row.first = place_[At(body)];
    if (other == kNone) continue;
    row.second = place_[At(other)];
    if (row.first > row.second) std::swap(row.first, row.second);
    const int* begin = factor_.row_indices() + factor_.column_starts()[First(row.first)] + kAxes;
    const int* end = factor_.row_indices() + factor_.column_starts()[First(row.first) + 1];
    row.below = static_cast<int>(std::lower_bound(begin, end, kAxes * row.second) - begin);
  }
  for (Eigen::VectorXd* v : {&weight_, &product_}) v->setZero(rows());
  for (Eigen::VectorXd* v : {&body_, &image_}) v->setZero(First(bodies_));
}

void BodySpace::Load(const LcpProblem& problem, const Eigen::VectorXd& root) {
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  for (Index i = 0; i < rows(); ++i) {
    Row& row = rows_[static_cast<size_t>(i)];
    if (row.first < 0) continue;
    for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      const bool is_first = place_[At(it.col() / kAxes)] == row.first;
      // Not the choice of arrays itself: with -fsanitize=undefined GCC 12 writes into a copy of it.
      double* entries = is_first ? row.first_j : row.second_j;
      entries[it.col() % kAxes] = it.value() * std::sqrt(inverse_mass[it.col()]) / root[i];
    }
  }
}

void BodySpace::ToBodies(const double* f, Eigen::VectorXd* x) const {
  x->setZero();
  for (const Row& row : rows_) {
    const double value = *f++;
    if (row.first < 0) continue;
    Add(row.first_j, value, x->data(), row.first);
    if (row.second >= 0) Add(row.second_j, value, x->data(), row.second);
  }
}

void BodySpace::ToRows(const Eigen::VectorXd& x, double* w) const {
  for (const Row& row : rows_) {
    double sum = 0;
    if (row.first >= 0) sum += Dot(row.first_j, x.data(), row.first);
    if (row.second >= 0) sum += Dot(row.second_j, x.data(), row.second);
    *w++ = sum;
  }
}

void BodySpace::Multiply(const double* f, double* y) const {
  ToBodies(f, &image_);
  ToRows(image_, y);
}

bool BodySpace::Factorize(const Eigen::VectorXd& theta) {
  double* values = factor_.values();
  const int* starts = factor_.column_starts();
  const Index columns = First(bodies_);
  std::fill(values, values + starts[columns], 0.0);
  for (Index j = 0; j < columns; ++j) values[starts[j]] = 1;
  // The lower triangle of the block of one body.
  const auto add_block = [&](int body, const double* j, double t) {
    for (Index a = 0; a < kAxes; ++a) {
      double* column = values + starts[First(body) + a];
      for (Index r = a; r < kAxes; ++r) column[r - a] += t * j[a] * j[r];
    }
  };
  for (Index i = 0; i < rows(); ++i) {
    const Row& row = rows_[static_cast<size_t>(i)];
    const double t = weight_[i] = row.first >= 0 && theta[i] < kOut ? 1 / theta[i] : 0.0;
    if (t == 0) continue;
    add_block(row.first, row.first_j, t);
    if (row.second < 0) continue;
    add_block(row.second, row.second_j, t);
    for (Index a = 0; a < kAxes; ++a) {
      double* block = values + starts[First(row.first) + a] + (kAxes - a) + row.below;
      for (Index r = 0; r < kAxes; ++r) block[r] += t * row.first_j[a] * row.second_j[r];
    }
  }
  return factor_.Factorize();
}

void BodySpace::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  product_ = weight_.cwiseProduct(r);
  ToBodies(product_.data(), &body_);
  factor_.Solve(body_, &body_);
  ToRows(body_, product_.data());
  *x = weight_.cwiseProduct(r - product_);
}

}  // namespace lcpbench
