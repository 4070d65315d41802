// Peers that take friction, on the records of the oracle: an adapter refuses by name or answers, and one that changes
// nothing on the way lets the library find what is right.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

// Of the solvable records that a key takes (87) so many at least: what was measured, less a few.
const std::map<std::string, int>& LeastRight() {
  static const std::map<std::string, int> least{
      {"siconos-fc2d-nsgs", 80}, {"siconos-fc2d-cpg", 55},  {"siconos-fc2d-lemke", 76},
      {"siconos-fc2d-enum", 70}, {"siconos-fc3d-nsgs", 65}, {"siconos-fc3d-nsn-ac", 50},
      {"siconos-fc3d-admm", 55}, {"pinocchio-admm", 40},    {"pinocchio-pgs", 50}};
  return least;
}

std::string ExpectedRefusal(const LcpProblem& problem) {
  if (!problem.bounded_rows().empty()) return "bounded rows";
  std::map<Index, int> tangents;
  for (const FrictionRow& tangent : problem.friction_rows()) {
    if (tangent.slip != 0) return "sliding rows";
    if (++tangents[tangent.normal] > 1) return "several friction rows of a contact";
  }
  return "";
}

TEST(FrictionPeers, AreTheKnownOnes) {
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kPeer || !entry.takes_friction || entry.library_defaults) continue;
    EXPECT_EQ(LeastRight().count(entry.key), 1U) << entry.key;
  }
}

TEST(FrictionPeers, AnswerTheRecordsOrRefuseByName) {
  for (const auto& [key, least_right] : LeastRight()) {
    if (!FindSolver(key).available) continue;
    const auto solver = MakeSolver(key);
    int taken = 0, right = 0;
    for (const FrictionRecord& record : FrictionRecords()) {
      SCOPED_TRACE(key + " " + record.problem().id());
      const LcpResult result = SolveWith(solver.get(), record.problem(), {.tolerance = 1e-6, .time_limit_s = 1});
      EXPECT_EQ(result.f.size(), record.problem().size());
      const std::string refusal = ExpectedRefusal(record.problem());
      if (result.detail == "more than 6 contacts") continue;
      if (result.status == LcpStatus::kUnsupported) {
        EXPECT_TRUE(!refusal.empty() && result.detail == refusal) << result.detail;
        continue;
      }
      EXPECT_EQ(refusal, "");
      EXPECT_NE(result.status, LcpStatus::kInfeasible);
      if (!key.starts_with("pinocchio")) {
        EXPECT_NE(result.status, LcpStatus::kIterationLimit) << "the time limit decides";
      }
      if (!record.is_solved()) continue;
      ++taken;
      if (Verify(record.problem(), result, 1e-6).passes) ++right;
    }
    EXPECT_GE(right, least_right) << key << " of " << taken;
  }
}

// What is eliminated has w = 0 to rounding, whatever the library makes of the rest.
TEST(FrictionPeers, JointsLeaveAndComeBack) {
  for (const auto& [key, least_right] : LeastRight()) {
    if (!FindSolver(key).available || key.starts_with("pinocchio")) continue;  // which iterates on joints
    const auto solver = MakeSolver(key);
    int joints = 0;
    for (const FrictionRecord& record : FrictionRecords()) {
      if (!record.is_solved() || record.problem().bilateral_rows().empty()) continue;
      const LcpResult result = SolveWith(solver.get(), record.problem(), {.tolerance = 1e-9, .time_limit_s = 1});
      if (result.status == LcpStatus::kUnsupported || !result.f.allFinite()) continue;
      ++joints;
      const Eigen::VectorXd w = ComputeMetrics(record.problem(), result.f).w;
      for (const Index row : record.problem().bilateral_rows()) {
        EXPECT_LE(std::abs(w[row]), 1e-11 * (1 + record.problem().b().cwiseAbs().maxCoeff())) << record.problem().id();
      }
    }
    EXPECT_GE(joints, 3) << key;
  }
}

}  // namespace
}  // namespace lcpbench
