#include "benchmarks/recommend/features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "support/input_error.h"

namespace lcpbench {
namespace {

using Member = std::optional<double> (*)(const ProblemFeatures&);

struct NamedFeature {
  const char* name;
  Member value;
};

constexpr NamedFeature kFeatures[] = {
    {"rows", [](const ProblemFeatures& f) -> std::optional<double> { return f.rows; }},
    {"bilateral", [](const ProblemFeatures& f) -> std::optional<double> { return f.bilateral; }},
    {"couplings", [](const ProblemFeatures& f) -> std::optional<double> { return f.couplings; }},
    {"diagonal_spread", [](const ProblemFeatures& f) -> std::optional<double> { return f.diagonal_spread; }},
    {"islands", [](const ProblemFeatures& f) -> std::optional<double> { return f.islands; }},
    {"largest_island", [](const ProblemFeatures& f) -> std::optional<double> { return f.largest_island; }},
    {"mass_spread", [](const ProblemFeatures& f) { return f.mass_spread; }},
    {"redundancy", [](const ProblemFeatures& f) { return f.redundancy; }},
};

// A column of J counts in a row where it contributes more than this to the diagonal entry of A: a normal through the
// centre of mass leaves an arm of rounding errors.
constexpr double kCarriesShare = 1e-20;

constexpr Index kBodyColumns = 3;

// The island of every row, numbered from 0 on in the order of their first rows.
std::vector<int> FindIslands(const SparseMatrix& A, int* count) {
  const Index n = A.rows();
  std::vector<int> island(static_cast<size_t>(n), -1);
  std::vector<Index> open;
  *count = 0;
  for (Index first = 0; first < n; ++first) {
    if (island[static_cast<size_t>(first)] >= 0) continue;
    island[static_cast<size_t>(first)] = *count;
    open.push_back(first);
    while (!open.empty()) {
      const Index row = open.back();
      open.pop_back();
      for (SparseMatrix::InnerIterator entry(A, row); entry; ++entry) {
        int& other = island[static_cast<size_t>(entry.col())];
        if (entry.value() == 0 || other >= 0) continue;
        other = *count;
        open.push_back(entry.col());
      }
    }
    ++*count;
  }
  return island;
}

double SpreadOf(const Eigen::VectorXd& values) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const double value : values) {
    if (value <= 0) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return most > 0 ? most / least : 1;
}

void MeasureFactors(const LcpProblem& problem, const std::vector<int>& island, int islands, ProblemFeatures* features) {
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const Eigen::VectorXd& D = problem.DiagonalA();
  std::vector<double> surplus(static_cast<size_t>(islands), 0.0);  // rows without columns of their own
  std::vector<bool> seen(static_cast<size_t>(J.cols()), false);
  std::vector<double> masses;
  for (Index row = 0; row < J.rows(); ++row) {
    double& of_island = surplus[static_cast<size_t>(island[static_cast<size_t>(row)])];
    of_island += 1;
    for (SparseMatrix::InnerIterator entry(J, row); entry; ++entry) {
      const Index column = entry.col();
      const double contributes = entry.value() * entry.value() * inverse_mass[column];
      if (seen[static_cast<size_t>(column)] || !(contributes > kCarriesShare * D[row])) continue;
      seen[static_cast<size_t>(column)] = true;
      of_island -= 1;
      // The first two columns of a body are its centre of mass, the third one is its turning.
      if (column % kBodyColumns != kBodyColumns - 1) masses.push_back(1 / inverse_mass[column]);
    }
  }
  double redundant = 0;
  for (const double rows : surplus) redundant += std::max(0.0, rows);
  features->redundancy = redundant / features->rows;
  if (masses.empty()) return;
  const auto [least, most] = std::minmax_element(masses.begin(), masses.end());
  features->mass_spread = *most / *least;
}

}  // namespace

ProblemFeatures MeasureFeatures(const LcpProblem& problem) {
  ProblemFeatures features;
  const Index n = problem.size();
  features.rows = static_cast<double>(n);
  if (n == 0) return features;
  features.bilateral = static_cast<double>(problem.bilateral_rows().size()) / features.rows;
  const SparseMatrix& A = problem.SparseA();
  features.couplings = static_cast<double>(A.nonZeros()) / features.rows;
  features.diagonal_spread = SpreadOf(problem.DiagonalA());
  int islands = 0;
  const std::vector<int> island = FindIslands(A, &islands);
  features.islands = islands;
  std::vector<int> sizes(static_cast<size_t>(islands), 0);
  for (const int of_row : island) ++sizes[static_cast<size_t>(of_row)];
  features.largest_island = *std::max_element(sizes.begin(), sizes.end()) / features.rows;
  if (problem.has_factors()) {
    MeasureFactors(problem, island, islands, &features);
  } else if (problem.facts().rank) {
    features.redundancy = 1 - static_cast<double>(*problem.facts().rank) / features.rows;
  }
  return features;
}

const std::vector<std::string>& FeatureNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const NamedFeature& feature : kFeatures) all.emplace_back(feature.name);
    return all;
  }();
  return names;
}

std::optional<double> FeatureNamed(const ProblemFeatures& features, const std::string& name) {
  std::string known;
  for (const NamedFeature& feature : kFeatures) {
    if (name == feature.name) return feature.value(features);
    known += (known.empty() ? "" : ", ") + std::string(feature.name);
  }
  throw InputError("expected a feature of " + known + ", found '" + name + "'");
}

nlohmann::ordered_json Describe(const ProblemFeatures& features) {
  nlohmann::ordered_json json;
  for (const NamedFeature& feature : kFeatures) {
    const std::optional<double> value = feature.value(features);
    json[feature.name] = value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  }
  return json;
}

}  // namespace lcpbench
