#include "solvers/linear_algebra/body_graph.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "solvers/lcp/in_sequence.h"
#include "solvers/linear_algebra/islands.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

using Graph = CholmodFactor::ColumnMatrix;

// Nested dissection takes some hundred times as long as minimum degree and saves a fifth to a third of the work of
// factorizations of this many flop, which a solve pays ten to forty times.
constexpr double kWorthDissection = 4e8;
constexpr double kWorthChange = 0.9;  // its work against that of minimum degree

constexpr int kAxes = 3;
constexpr int kNone = -1;

// The first column of a body.
Index First(int body) { return Index{kAxes} * body; }

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

// place_ and the analysis, by ends_ in triples of columns of J.
void BodyGraph::Order(Index triples, bool will_update, CholmodFactor* factor) {
  std::vector<int> number(At(triples), kNone);  // in the order of their rows
  std::vector<int> found;
  std::vector<Eigen::Triplet<double, int>> edges;
  edges.reserve(ends_.size());
  const auto number_of = [&](int body) {
    if (number[At(body)] == kNone) {
      number[At(body)] = static_cast<int>(found.size());
      found.push_back(body);
    }
    return number[At(body)];
  };
  for (const Ends& ends : ends_) {
    if (ends.first == kNone) continue;
    const int first = number_of(ends.first);
    if (ends.second == kNone) continue;
    const int second = number_of(ends.second);
    edges.emplace_back(std::max(first, second), std::min(first, second), 1.0);
  }
  bodies_ = static_cast<int>(found.size());
  Graph graph(bodies_, bodies_);
  graph.setFromTriplets(edges.begin(), edges.end());

  const auto analyze = [&](const Eigen::VectorXi& nodes) {
    ++analyses_;
    factor->AnalyzeAsOrdered(PatternOfK(graph, nodes), will_update);
    return factor->flops();
  };
  Eigen::VectorXi nodes = OrderGraph(graph, GraphOrder::kMinimumDegree);
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

void BodyGraph::Prepare(const LcpProblem& problem, const std::vector<char>& taking_part, bool will_update,
                        CholmodFactor* factor) {
  analyses_ = 0;
  ends_.assign(At(problem.size()), {});
  for (Index i = 0; i < problem.size(); ++i) {
    if (!taking_part.empty() && taking_part[At(i)] == 0) continue;
    std::tie(ends_[At(i)].first, ends_[At(i)].second) = BodiesOfRow(problem, i);
  }
  if (!InSequence::on() || ends_ != ends_before_) {
    ends_before_.clear();  // until the analysis has succeeded
    Order((problem.J().cols() + kAxes - 1) / kAxes, will_update, factor);
    ends_before_ = ends_;
  }
  const int* starts = factor->column_starts();
  const int* indices = factor->row_indices();
  for (Ends& ends : ends_) {
    if (ends.first == kNone) continue;
    ends.first = place_[At(ends.first)];
    if (ends.second == kNone) continue;
    ends.second = place_[At(ends.second)];
    if (ends.first > ends.second) std::swap(ends.first, ends.second);
    const int* begin = indices + starts[First(ends.first)] + kAxes;
    const int* end = indices + starts[First(ends.first) + 1];
    ends.below = static_cast<int>(std::lower_bound(begin, end, kAxes * ends.second) - begin);
  }
}

}  // namespace lcpbench
