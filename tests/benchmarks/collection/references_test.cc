// The committed answers, judged as any solver's are.

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/plan.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

Eigen::VectorXd Numbers(const nlohmann::json& values) {
  const auto numbers = values.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Index>(numbers.size()));
}

class References : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Tiers, References, testing::Values("smoke", "engine", "standard", "pathological"),
                         [](const auto& test) { return test.param; });

TEST_P(References, SolveTheProblemsOrProveThatNothingDoes) {
  constexpr Index kMostRows = 1000;
  const std::string folder = LCPBENCH_SOURCE_DIR "/data/";
  const Manifest manifest = ReadManifest(folder + GetParam() + ".json");
  std::map<std::string, const ManifestEntry*> entries;
  for (const ManifestEntry& entry : manifest.problems) entries[entry.id] = &entry;
  for (const ManifestEntry& entry : manifest.fill) entries[entry.id] = &entry;

  LineReader lines(folder + manifest.references);
  ProblemSource source(folder);
  std::string line;
  size_t count = 0;
  while (lines.Next(&line)) {
    const nlohmann::json record = nlohmann::json::parse(line);
    const std::string id = record["id"];
    ++count;
    ASSERT_TRUE(entries.count(id) == 1) << id;
    EXPECT_EQ(entries[id]->reference.kind, record["kind"]) << id;
    if (entries[id]->properties.rows > kMostRows) continue;
    const LcpProblem problem = source.Get(*entries[id]);
    if (record["status"] == "infeasible") {
      EXPECT_TRUE(VerifyFarkasRay(problem, Numbers(record["ray"])).accepted) << id;
      continue;
    }
    const Eigen::VectorXd f = Numbers(record.contains("f_minnorm") ? record["f_minnorm"] : record["f"]);
    LcpReference reference;
    reference.status = LcpReference::Status::kSolved;
    reference.w = Numbers(record["w"]);
    const Metrics metrics = ComputeMetrics(problem, f, &reference);
    // Nothing but the rounding of f and w to doubles and, where rows contradict each other by their roundings, what the
    // proof says of the distance to the problem that has a solution.
    const double floor = RoundingFloor(problem, f);
    const Eigen::VectorXd D = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? d : 1.0; });
    const double loads = problem.b().cwiseQuotient(D.cwiseSqrt()).norm();
    const double shift = record.value("energy_shift", 0.0);
    // On rows that contradict each other f and w of the other problem need not be complementary to the last digit; and
    // of one settled wall the floor is estimated too low, by a factor of ten.
    const double rounding = entries[id]->origin == "motion" ? 1e-12 : 1e-15;
    EXPECT_LE(metrics.rho, 2 * floor + rounding + 2 * shift / loads) << id;
    const Eigen::VectorXd error = (metrics.w - *reference.w).cwiseQuotient(D.cwiseSqrt());
    EXPECT_LE(error.norm(), (2 * floor + 1e-15) * loads + 2 * shift) << id;
  }
  size_t expected = manifest.fill.size();
  for (const ManifestEntry& entry : manifest.problems) expected += entry.reference.kind == "none" ? 0 : 1;
  EXPECT_EQ(count, expected);
  EXPECT_GT(count, 0U);
}

}  // namespace
}  // namespace lcpbench
