// Peers that take friction, on the records of the oracle: an adapter refuses by name or answers, and one that changes
// nothing on the way lets the library find what is right.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "solvers/lcp/verify.h"
#include "solvers/peers/peer_table.h"
#include "solvers/registry.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

// The least number of solvable records on which a key is right by Coulomb's law, and by a law of its own: what was
// measured, less a few.
struct Least {
  int right = 0;
  int by_own_law = 0;
};
const std::map<std::string, Least>& LeastRight() {
  static const std::map<std::string, Least> least{{"siconos-fc2d-nsgs", {80}},
                                                  {"siconos-fc2d-cpg", {55}},
                                                  {"siconos-fc2d-lemke", {76}},
                                                  {"siconos-fc2d-enum", {75}},
                                                  {"siconos-fc3d-nsgs", {80}},
                                                  {"siconos-fc3d-nsn-ac", {78}},
                                                  {"siconos-fc3d-admm", {76}},
                                                  {"ode-dantzig", {30, 80}},
                                                  {"ode-dantzig-cfm", {25, 80}},
                                                  {"ode-dantzig-native", {30, 80}},
                                                  {"bullet-dantzig", {30, 80}},
                                                  {"bullet-dantzig-cfm", {25, 80}},
                                                  {"bullet-dantzig-native", {30, 80}},
                                                  {"dart-dantzig", {30, 80}},
                                                  {"dart-dantzig-cfm", {25, 80}},
                                                  {"bullet-pgs", {85}},
                                                  {"bullet-si", {66}},
                                                  {"dart-pgs", {80}},
                                                  {"simbody-pgs", {78}},
                                                  {"simbody-plus", {26}},
                                                  {"siconos-lexicolemke-friction", {76}},
                                                  {"siconos-avi-friction", {76}},
                                                  {"petsc-rsls-direct-friction", {73}},
                                                  {"petsc-ssls-direct-friction", {71}},
                                                  {"tao-asfls-friction", {68}},
                                                  {"ode-dantzig-loop", {76}},
                                                  {"bullet-dantzig-loop", {73}},
                                                  {"dart-dantzig-loop", {73}},
                                                  {"mujoco-newton-relaxed", {0, 58}},
                                                  {"mujoco-cg-relaxed", {0, 62}},
                                                  {"proxqp-relaxed", {0, 74}},
                                                  {"piqp-relaxed", {0, 76}},
                                                  {"daqp-relaxed", {0, 78}},
                                                  {"osqp-relaxed", {0, 75}},
                                                  {"pinocchio-admm", {40}},
                                                  {"pinocchio-pgs", {50}}};
  return least;
}

const PeerEntry& PeerOf(const std::string& key) { return *std::ranges::find(AllPeers(), key, &PeerEntry::key); }

std::string ExpectedRefusal(const PeerEntry& peer, const LcpProblem& problem) {
  if (peer.transformation == Transformation::kLaggedBounds) return "";
  if (!problem.bounded_rows().empty() && !peer.takes_bounded()) return "bounded rows";
  for (const BoundedRow& row : problem.bounded_rows()) {
    if (peer.law == FrictionLaw::kFrozenBounds && (row.lower > 0 || row.upper < 0)) return "bounds that exclude 0";
  }
  bool has_several = false;
  std::map<Index, int> tangents;
  for (const FrictionRow& tangent : problem.friction_rows()) {
    if (tangent.slip != 0) return "sliding rows";
    has_several |= ++tangents[tangent.normal] > 1;
  }
  return has_several && !peer.takes_bounded() ? "several friction rows of a contact" : "";
}

TEST(FrictionPeers, AreTheKnownOnes) {
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kPeer || !entry.takes_friction || entry.library_defaults) continue;
    EXPECT_EQ(LeastRight().count(entry.key), 1U) << entry.key;
  }
}

// What obeys a law of the solver's own only is neither right nor a false success. That law is that of the records'
// model "one-pass", whose w is unique.
void CheckFrozenBounds(const FrictionRecord& record, const LcpResult& result, const Verdict& verdict) {
  ASSERT_EQ(result.friction_bounds.size(), record.problem().size());
  if (!record.json.contains("models") || !record.json["models"].contains("one-pass")) return;
  const auto& known = record.json["models"]["one-pass"];
  EXPECT_LE((verdict.metrics.w - ToVector(known["w_exact"])).cwiseAbs().maxCoeff(),
            1e-6 * (1 + record.problem().b().cwiseAbs().maxCoeff()));
}

TEST(FrictionPeers, AnswerTheRecordsOrRefuseByName) {
  for (const auto& [key, least] : LeastRight()) {
    if (!FindSolver(key).available) continue;
    const auto solver = MakeSolver(key);
    const PeerEntry& peer = PeerOf(key);
    int taken = 0, right = 0, by_own_law = 0;
    for (const FrictionRecord& record : FrictionRecords()) {
      SCOPED_TRACE(key + " " + record.problem().id());
      const LcpResult result = SolveWith(solver.get(), record.problem(), {.tolerance = 1e-6, .time_limit_s = 0.3});
      EXPECT_EQ(result.f.size(), record.problem().size());
      const std::string refusal = ExpectedRefusal(peer, record.problem());
      if (result.detail == "more than 6 contacts") continue;
      if (result.status == LcpStatus::kUnsupported) {
        const bool is_of_bodies = (key == "bullet-si" && !record.problem().has_two_body_rows()) ||
                                  (key.starts_with("mujoco") && !record.problem().has_factors());
        EXPECT_TRUE(is_of_bodies || (!refusal.empty() && result.detail == refusal)) << result.detail;
        continue;
      }
      EXPECT_EQ(refusal, "");
      EXPECT_NE(result.status, LcpStatus::kInfeasible);
      const Verdict verdict = Verify(record.problem(), result, 1e-6);
      const bool obeys = verdict.model_rho >= 0 && verdict.model_rho <= 1e-6;
      EXPECT_FALSE(obeys && verdict.false_success);
      if (obeys && result.model == FrictionModel::kFrozenBounds) CheckFrozenBounds(record, result, verdict);
      if (key.starts_with("siconos-fc2d")) {
        EXPECT_NE(result.status, LcpStatus::kIterationLimit) << "the time limit decides";
      }
      if (!record.is_solved()) continue;
      ++taken;
      right += static_cast<int>(verdict.passes);
      by_own_law += static_cast<int>(obeys);
    }
    EXPECT_GE(right, least.right) << key << " of " << taken;
    EXPECT_GE(by_own_law, least.by_own_law) << key << " of " << taken;
  }
}

// What is eliminated has w = 0 to rounding, whatever the library makes of the rest.
TEST(FrictionPeers, JointsLeaveAndComeBack) {
  for (const auto& [key, least] : LeastRight()) {
    if (!FindSolver(key).available || PeerOf(key).law != FrictionLaw::kCoulomb || !FindSolver(key).takes_plain)
      continue;
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
