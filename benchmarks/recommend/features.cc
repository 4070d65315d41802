#include "benchmarks/recommend/features.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "solvers/linear_algebra/islands.h"

namespace lcpbench {
namespace {

constexpr NamedFeature kFeatures[] = {
    {"rows", &ProblemFeatures::rows},
    {"bilateral", &ProblemFeatures::bilateral},
    {"couplings", &ProblemFeatures::couplings},
    {"diagonal_spread", &ProblemFeatures::diagonal_spread},
    {"islands", &ProblemFeatures::islands},
    {"largest_island", &ProblemFeatures::largest_island},
    {"mass_spread", &ProblemFeatures::mass_spread},
    {"redundancy", &ProblemFeatures::redundancy},
};

// A column of J counts in a row where it contributes more than this to the diagonal entry of A: a normal through the
// centre of mass leaves an arm of rounding errors.
constexpr double kCarriesShare = 1e-20;

constexpr Index kBodyColumns = 3;

template <typename Values>
double SpreadOf(const Values& values) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const double value : values) {
    if (value <= 0) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return most > 0 ? most / least : 1;
}

void MeasureFactors(const LcpProblem& problem, const Islands& islands, ProblemFeatures* features) {
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const Eigen::VectorXd& D = problem.DiagonalA();
  std::vector<bool> seen(static_cast<size_t>(J.cols()), false);
  std::vector<double> masses;
  Index redundant = 0;
  for (Index island = 0; island < islands.count(); ++island) {
    auto surplus = static_cast<Index>(islands.rows(island).size());  // rows without columns of their own
    for (const Index row : islands.rows(island)) {
      for (SparseMatrix::InnerIterator entry(J, row); entry; ++entry) {
        const Index column = entry.col();
        const double contributes = entry.value() * entry.value() * inverse_mass[column];
        if (seen[static_cast<size_t>(column)] || !(contributes > kCarriesShare * D[row])) continue;
        seen[static_cast<size_t>(column)] = true;
        --surplus;
        // The first two columns of a body are its centre of mass, the third one is its turning.
        if (column % kBodyColumns != kBodyColumns - 1) masses.push_back(1 / inverse_mass[column]);
      }
    }
    redundant += std::max<Index>(0, surplus);
  }
  features->redundancy = static_cast<double>(redundant) / static_cast<double>(J.rows());
  if (!masses.empty()) features->mass_spread = SpreadOf(masses);
}

}  // namespace

ProblemFeatures MeasureFeatures(const LcpProblem& problem) {
  ProblemFeatures features;
  const auto n = static_cast<double>(problem.size());
  features.rows = n;
  if (n == 0) return features;
  features.bilateral = static_cast<double>(problem.bilateral_rows().size()) / n;
  const SparseMatrix& A = problem.SparseA();
  features.couplings = static_cast<double>(A.nonZeros()) / n;
  features.diagonal_spread = SpreadOf(problem.DiagonalA());
  Islands islands;
  islands.Find(A, std::vector<char>(static_cast<size_t>(problem.size()), 1));
  features.islands = static_cast<double>(islands.count());
  features.largest_island = static_cast<double>(islands.largest()) / n;
  if (problem.has_factors()) {
    MeasureFactors(problem, islands, &features);
  } else if (problem.facts().rank) {
    features.redundancy = 1 - static_cast<double>(*problem.facts().rank) / n;
  }
  return features;
}

std::span<const NamedFeature> AllFeatures() { return kFeatures; }

nlohmann::ordered_json Describe(const ProblemFeatures& features) {
  nlohmann::ordered_json json;
  for (const NamedFeature& feature : kFeatures) {
    const std::optional<double> value = features.*feature.value;
    json[feature.name] = value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  }
  return json;
}

}  // namespace lcpbench
