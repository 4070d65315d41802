#include "solvers/linear_algebra/body_graph.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "solvers/lcp/in_sequence.h"
#include "solvers/lcp/memory_budget.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// Nested dissection takes some hundred times as long as minimum degree and saves a fifth to a third of the work of
// factorizations of this many flop, which a solve pays ten to forty times.
constexpr double kWorthDissection = 4e8;
constexpr double kWorthChange = 0.9;  // its work against that of minimum degree

// An analysis is kept while the problem has this part of its bodies and of its pairs of bodies.
constexpr double kLeastLeft = 0.8;

constexpr int kAxes = 3;
constexpr int kNone = -1;

// The first column of a body.
Index First(int body) { return Index{kAxes} * body; }

// Names of a graph's edges, ascending, by the names of its nodes.
std::vector<KeptOrder::Name> PairsOf(const CholmodFactor::ColumnMatrix& graph, const std::vector<int>& names) {
  std::vector<KeptOrder::Name> pairs;
  pairs.reserve(At(graph.nonZeros()));
  for (int j = 0; j < graph.cols(); ++j) {
    for (CholmodFactor::ColumnMatrix::InnerIterator it(graph, j); it; ++it) {
      pairs.push_back(NameOfPair(names[At(j)], names[At(it.row())]));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

// The rows' bodies by their triples of columns of J.
void BodyGraph::ReadRows(const LcpProblem& problem, const std::vector<char>& taking_part) {
  const SparseMatrix& J = problem.J();
  ends_.assign(At(problem.size()), {});
  for (Index i = 0; i < problem.size(); ++i) {
    if (!taking_part.empty() && taking_part[At(i)] == 0) continue;
    std::tie(ends_[At(i)].first, ends_[At(i)].second) = BodiesOfRow(problem, i);
  }
  found_.clear();
  seen_.assign(At((J.cols() + kAxes - 1) / kAxes), 0);
  for (const Ends& ends : ends_) {
    for (const int body : {ends.first, ends.second}) {
      if (body == kNone || std::exchange(seen_[At(body)], 1) != 0) continue;
      found_.push_back(body);
    }
  }
}

// Where every pair is in the pattern that is analysed, and most of the pattern is in use.
bool BodyGraph::KeepAnalysis() {
  const auto known = [this](int body) { return At(body) < place_.size() && place_[At(body)] != kNone; };
  if (!analysed_ || static_cast<double>(found_.size()) < kLeastLeft * static_cast<double>(bodies_) ||
      !std::all_of(found_.begin(), found_.end(), known)) {
    return false;
  }
  const int* starts = factor_->column_starts();
  const int* indices = factor_->row_indices();
  const auto place_of_block = [&](int first, int second) {
    const int* end = indices + starts[First(first) + 1];
    const int* at = std::lower_bound(indices + starts[First(first)] + kAxes, end, kAxes * second);
    return at != end && *at == kAxes * second ? static_cast<int>(at - indices) : kNone;
  };
  std::vector<char> used(At(starts[First(bodies_)]), 0);
  Index blocks = 0;
  for (const Ends& ends : ends_) {
    if (ends.second == kNone) continue;
    const auto [first, second] = std::minmax(place_[At(ends.first)], place_[At(ends.second)]);
    const int at = place_of_block(first, second);
    if (at == kNone) return false;
    if (std::exchange(used[At(at)], 1) == 0) ++blocks;
  }
  return static_cast<double>(blocks) >= kLeastLeft * static_cast<double>(blocks_);
}

// The graph of bodies, numbered as they appear in found_.
BodyGraph::Graph BodyGraph::NumberBodies() {
  std::vector<int> number(seen_.size(), kNone);
  for (size_t k = 0; k < found_.size(); ++k) number[At(found_[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double, int>> edges;
  edges.reserve(ends_.size());
  for (const Ends& ends : ends_) {
    if (ends.second == kNone) continue;
    const auto [low, high] = std::minmax(number[At(ends.first)], number[At(ends.second)]);
    edges.emplace_back(high, low, 1.0);
  }
  const auto bodies = static_cast<Index>(found_.size());
  Graph graph(bodies, bodies);
  graph.setFromTriplets(edges.begin(), edges.end());
  return graph;
}

void BodyGraph::Analyze(const Graph& graph, const Eigen::VectorXi& nodes) {
  ++analyses_;
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
  factor_->AnalyzeAsOrdered(lower, will_update_);
}

bool BodyGraph::KeepOrder(const Graph& graph) {
  const std::vector<KeptOrder::Name> names(found_.begin(), found_.end());
  const Eigen::VectorXi found = kept_.Find(names, graph.outerIndexPtr(), graph.innerIndexPtr());
  if (found.size() == 0) return false;
  const std::vector<KeptOrder::Name> pairs = PairsOf(graph, found_);
  std::vector<KeptOrder::Name> fresh;
  std::set_difference(pairs.begin(), pairs.end(), kept_pairs_.begin(), kept_pairs_.end(), std::back_inserter(fresh));
  if (static_cast<double>(fresh.size()) > KeptOrder::kMostNew * static_cast<double>(pairs.size())) return false;
  const Eigen::VectorXi nodes = Postordered(graph, found);
  if (nodes.size() != graph.cols()) return false;
  try {
    Analyze(graph, nodes);
  } catch (const MemoryRefusal&) {
    return false;  // a new order may need less
  }
  if (!kept_.Serves(factor_->flops())) return false;
  TakeOrder(nodes);
  return true;
}

void BodyGraph::OrderAnew(const Graph& graph) {
  kept_.Clear();
  Eigen::VectorXi nodes = OrderGraph(graph, GraphOrder::kMinimumDegree);
  Analyze(graph, nodes);
  order_ = GraphOrder::kMinimumDegree;
  const double work = factor_->flops();
  if (work > kWorthDissection) {
    const Eigen::VectorXi dissected = OrderGraph(graph, GraphOrder::kNestedDissection);
    if (dissected.size() == graph.cols()) {
      Analyze(graph, dissected);
      if (factor_->flops() < kWorthChange * work) {
        nodes = dissected;
        order_ = GraphOrder::kNestedDissection;
      } else {
        Analyze(graph, nodes);
      }
    }
  }
  if (InSequence::on()) {
    kept_.Keep({found_.begin(), found_.end()}, nodes, factor_->flops());
    kept_pairs_ = PairsOf(graph, found_);
  }
  TakeOrder(nodes);
}

void BodyGraph::TakeOrder(const Eigen::VectorXi& nodes) {
  bodies_ = static_cast<int>(nodes.size());
  place_.assign(seen_.size(), kNone);
  for (int k = 0; k < bodies_; ++k) place_[At(found_[At(nodes[k])])] = k;
  analysed_ = true;
}

void BodyGraph::Prepare(const LcpProblem& problem, const std::vector<char>& taking_part, bool will_update,
                        CholmodFactor* factor) {
  factor_ = factor;
  will_update_ = will_update;
  analyses_ = 0;
  ReadRows(problem, taking_part);
  const bool small = problem.size() < KeptOrder::kLeastRows;
  const bool in_sequence = InSequence::on();
  if (!in_sequence) {
    analysed_ = false;
    kept_.Clear();
  }
  if (small ? !analysed_ || ends_ != ends_before_ : !KeepAnalysis()) {
    analysed_ = false;  // until it has succeeded
    const Graph graph = NumberBodies();
    if (small || !KeepOrder(graph)) OrderAnew(graph);
    blocks_ = graph.nonZeros();
    ends_before_.clear();
    if (small) ends_before_ = ends_;
  }
  if (place_.size() < seen_.size()) place_.resize(seen_.size(), kNone);
  const int* starts = factor_->column_starts();
  const int* indices = factor_->row_indices();
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
