#include "solvers/linear_algebra/kept_order.h"

#include <algorithm>

namespace lcpbench {
namespace {

constexpr int kNone = -1;
constexpr int kCountBits = 16;
constexpr int kBodyBits = 24;

size_t At(Index i) { return static_cast<size_t>(i); }

}  // namespace

void KeptOrder::Keep(const std::vector<Name>& names, const Eigen::VectorXi& order, double work) {
  known_.resize(names.size());
  work_ = work;
  if (names.empty()) return;
  for (int k = 0; k < static_cast<int>(order.size()); ++k) known_[At(k)] = {names[At(order[k])], k};
  std::sort(known_.begin(), known_.end());
}

Eigen::VectorXi KeptOrder::Find(const std::vector<Name>& names, const int* starts, const int* indices) {
  if (known_.empty() || names.empty()) return {};
  if (pause_ > 0) {
    --pause_;
    return {};
  }
  const auto n = static_cast<int>(names.size());
  std::vector<std::pair<Name, int>> sought(names.size());
  for (int i = 0; i < n; ++i) sought[At(i)] = {names[At(i)], i};
  std::sort(sought.begin(), sought.end());
  std::vector<int> place(names.size(), kNone);
  int fresh = 0;
  auto known = known_.begin();
  for (const auto& [name, node] : sought) {
    while (known != known_.end() && known->first < name) ++known;
    if (known != known_.end() && known->first == name) {
      place[At(node)] = known->second;
    } else {
      ++fresh;
    }
  }
  if (fresh > kMostNew * n) return {};
  std::vector<std::pair<int, int>> order(names.size());  // a known node: twice its place; a new one: odd, after another
  for (int i = 0; i < n; ++i) order[At(i)] = {2 * place[At(i)], i};
  for (int j = 0; fresh > 0 && j < n; ++j) {
    for (int p = starts[j]; p < starts[j + 1]; ++p) {
      const int i = indices[p];
      if (place[At(i)] == kNone) order[At(i)].first = std::max(order[At(i)].first, 2 * place[At(j)] + 1);
      if (place[At(j)] == kNone) order[At(j)].first = std::max(order[At(j)].first, 2 * place[At(i)] + 1);
    }
  }
  std::sort(order.begin(), order.end());
  Eigen::VectorXi nodes(n);
  for (int k = 0; k < n; ++k) nodes[k] = order[At(k)].second;
  return nodes;
}

std::pair<int, int> BodiesOfRow(const LcpProblem& problem, Index row) {
  std::pair<int, int> bodies = {kNone, kNone};
  for (SparseMatrix::InnerIterator it(problem.J(), row); it; ++it) {
    if (it.value() == 0 || problem.inverse_mass()[it.col()] == 0) continue;
    const int body = static_cast<int>(it.col() / problem.columns_per_body());
    (bodies.first == kNone || bodies.first == body ? bodies.first : bodies.second) = body;
  }
  return bodies;
}

KeptOrder::Name NameOfPair(int body, int other) {
  const auto low = static_cast<KeptOrder::Name>(std::min(body, other)) + 1;
  const auto high = static_cast<KeptOrder::Name>(std::max(body, other)) + 1;
  return (low << kBodyBits) | high;
}

std::vector<KeptOrder::Name> NamesOfRows(const LcpProblem& problem) {
  if (problem.size() < KeptOrder::kLeastRows || !problem.has_factors() || !problem.has_two_body_rows()) return {};
  const SparseMatrix& J = problem.J();
  if (J.cols() / problem.columns_per_body() + 1 >= Index{1} << kBodyBits) return {};
  std::vector<std::pair<KeptOrder::Name, int>> rows(At(problem.size()));
  for (Index i = 0; i < problem.size(); ++i) {
    const auto [first, second] = BodiesOfRow(problem, i);
    rows[At(i)] = {NameOfPair(first, second), static_cast<int>(i)};
  }
  std::sort(rows.begin(), rows.end());
  std::vector<KeptOrder::Name> names(rows.size());
  KeptOrder::Name count = 0;
  for (size_t k = 0; k < rows.size(); ++k) {
    count = k > 0 && rows[k].first == rows[k - 1].first ? count + 1 : 0;
    if (count >= KeptOrder::Name{1} << kCountBits) return {};
    names[At(rows[k].second)] = (rows[k].first << kCountBits) | count;
  }
  return names;
}

}  // namespace lcpbench
