// Our direct solvers on problems as they are met: recorded from the paper's own software, the exact systems of the
// oracle data at all three levels, and scenes whose bodies' masses differ by 10^8.

#include "model/contact/assembly.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

constexpr double kTolerance = 1e-9;
// With masses of 10^-4 and 10^4 kg rounding alone makes some b inconsistent by a few 1e-9.
constexpr double kWideMassTolerance = 1e-8;

struct Direct {
  const char* key;
  /// How many of the scenes with wide masses may end without an answer or a proof, saying so; of recorded problems
  /// none.
  int undecided_scenes = 0;
};

constexpr Direct kDirect[] = {{"auto"}, {"dantzig"}, {"lemke"}, {"bpp", 15}, {"semismooth-newton", 15}, {"ipm"}};

// What one solver came to on a set of problems.
struct Tally {
  int verified = 0;
  int proved = 0;
  std::string undecided_ids;
  int undecided = 0;
};

// w of the first solver that was verified stands for the problem's.
struct Given {
  LcpProblem problem;
  std::optional<Eigen::VectorXd> w;
  bool is_proved_unsolvable = false;
};

// In units of row i's own sqrt(A_ii) and of the whole of b.
double ScaledDifference(const LcpProblem& problem, const Eigen::VectorXd& w, const Eigen::VectorXd& other) {
  Eigen::VectorXd scale = problem.DiagonalA().cwiseSqrt();
  for (double& s : scale) s = s > 0 ? s : 1.0;
  const double b = problem.b().cwiseQuotient(scale).norm();
  return (w - other).cwiseQuotient(scale).norm() / (b > 0 ? b : 1.0);
}

Tally SolveAll(const Direct& direct, double tolerance, std::vector<Given>* problems) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver(direct.key);
  Tally tally;
  for (Given& given : *problems) {
    LcpOptions options;
    options.tolerance = tolerance;
    LcpResult result;
    solver->Solve(given.problem, options, &result);
    const Verdict verdict = Verify(given.problem, result, tolerance);
    SCOPED_TRACE(direct.key + (" on " + given.problem.id()));
    EXPECT_FALSE(verdict.false_success) << verdict.reason;
    EXPECT_FALSE(verdict.false_infeasible) << result.detail;
    if (result.status == LcpStatus::kSolved && verdict.passes) {
      ++tally.verified;
      EXPECT_FALSE(given.is_proved_unsolvable);
      if (!given.w) given.w = verdict.metrics.w;
      EXPECT_LE(ScaledDifference(given.problem, verdict.metrics.w, *given.w), 1e4 * tolerance);
    } else if (verdict.farkas.has_value() && verdict.farkas->accepted) {
      ++tally.proved;
      given.is_proved_unsolvable = true;
      EXPECT_FALSE(given.w.has_value());
    } else {
      ++tally.undecided;
      tally.undecided_ids += "\n  " + given.problem.id() + ": " + result.detail;
    }
  }
  return tally;
}

// One tally for every direct solver of this build.
std::vector<std::pair<Direct, Tally>> TalliesOf(double tolerance, std::vector<Given> problems) {
  std::vector<std::pair<Direct, Tally>> tallies;
  for (const Direct& direct : kDirect) {
    if (FindSolver(direct.key).available) tallies.emplace_back(direct, SolveAll(direct, tolerance, &problems));
  }
  return tallies;
}

TEST(GivenProblems, EveryRecordedProblemIsVerifiedOrProvedAndAllAgreeInW) {
  LineReader lines(LCPBENCH_SOURCE_DIR "/tests/data/myphysicslab/contact_problems.jsonl.gz");
  std::vector<Given> problems;
  for (std::string line; lines.Next(&line);) {
    problems.push_back({ParseLcpRecord(line, lines.name()).problem, std::nullopt});
  }
  EXPECT_EQ(problems.size(), 517u);
  for (const auto& [direct, tally] : TalliesOf(kTolerance, problems)) {
    EXPECT_EQ(tally.undecided, 0) << direct.key << tally.undecided_ids;
  }
}

// The problem of one level of an oracle system, from its exact J and the level's right-hand side.
LcpProblem OracleProblem(const nlohmann::json& record, const std::string& level) {
  const nlohmann::json& expect = record.at("expect");
  const auto n = static_cast<Index>(expect.at("rows").size());
  const auto columns = static_cast<Index>(3 * record.at("bodies").size());
  const std::vector<double> q = expect.at(level).at("q");
  Eigen::MatrixXd J(n, columns);
  std::vector<Index> bilateral;
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<size_t>(i);
    for (Index k = 0; k < columns; ++k) J(i, k) = expect.at("J")[row][static_cast<size_t>(k)];
    if (expect.at("rows")[row].at("bilateral")) bilateral.push_back(i);
  }
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Zero(columns);
  for (Index k = 0; k < columns / 3; ++k) {
    const nlohmann::json& body = record.at("bodies")[static_cast<size_t>(k)];
    if (body.at("fixed")) continue;
    const double mass = body.at("mass");
    const double inertia = body.at("inertia");
    inverse_mass.segment<3>(3 * k) << 1 / mass, 1 / mass, 1 / inertia;
  }
  return LcpProblem::FromFactors(record.at("id").get<std::string>() + "-" + level, J.sparseView(), inverse_mass,
                                 Eigen::Map<const Eigen::VectorXd>(q.data(), n),
                                 RowBounds::WithBilateralRows(n, bilateral));
}

TEST(GivenProblems, OracleSystemsAreSolvedExactlyOrProvedAtEveryLevel) {
  std::ifstream file(LCPBENCH_SOURCE_DIR "/tests/data/oracle/systems.jsonl");
  std::vector<Given> problems;
  int unsolvable = 0;
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json record = nlohmann::json::parse(line);
    for (const char* level : {"acceleration", "impact", "step"}) {
      const nlohmann::json& known = record.at("expect").at(level);
      Given given{OracleProblem(record, level), std::nullopt};
      if (known.at("status") == "solved") {
        const std::vector<double> w = known.at("w");
        given.w = Eigen::Map<const Eigen::VectorXd>(w.data(), static_cast<Index>(w.size()));
      } else {
        given.is_proved_unsolvable = true;
        ++unsolvable;
      }
      problems.push_back(given);
    }
  }
  EXPECT_EQ(problems.size(), 78u);
  for (const auto& [direct, tally] : TalliesOf(kTolerance, problems)) {
    EXPECT_EQ(tally.undecided, 0) << direct.key << tally.undecided_ids;
    EXPECT_EQ(tally.proved, unsolvable) << direct.key;
  }
}

// Their matrix is copositive and not symmetric: outside every guaranteed class.
TEST(GivenProblems, FrictionProblemsAreRefusedOrAnsweredRightly) {
  std::ifstream file(LCPBENCH_SOURCE_DIR "/tests/data/oracle/friction_lcp.jsonl");
  int refused = 0;
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json record = nlohmann::json::parse(line);
    const nlohmann::json as_lcp = {{"id", record.at("id")}, {"A", record.at("M")}, {"b", record.at("q")}};
    const LcpProblem problem = ParseLcpRecord(as_lcp.dump(), "friction").problem;
    for (const SolverEntry& entry : AllSolvers()) {
      if (entry.origin != SolverOrigin::kOwn || !entry.available) continue;
      EXPECT_NE(entry.why_not_guaranteed(problem, kTolerance), "") << entry.key;
      LcpResult result;
      entry.make({})->Solve(problem, {}, &result);
      const Verdict verdict = Verify(problem, result, kTolerance);
      EXPECT_FALSE(verdict.false_success) << entry.key << " on " << problem.id() << ": " << verdict.reason;
      EXPECT_NE(result.status, LcpStatus::kInfeasible) << entry.key << " on " << problem.id();
      if (result.status == LcpStatus::kUnsupported) ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

// Masses of 10^-4 and 10^4 kg, by turns for seed 1 and at random else, under the same accelerations; inertias as before
// in proportion to them.
LcpProblem WithWideMasses(const SceneFamily& family, int rows, std::uint64_t seed) {
  ContactSystem system = family.generate(rows, seed);
  Random random(seed);
  bool is_heavy = false;
  for (Body& body : system.bodies) {
    if (body.fixed) continue;
    is_heavy = seed == 1 ? !is_heavy : random.Uniform() < 0.5;
    const double factor = (is_heavy ? 1e4 : 1e-4) / body.mass;
    body.mass *= factor;
    body.inertia *= factor;
    body.force = factor * body.force;
    body.torque *= factor;
  }
  return AssembleContactLcp(system).problem;
}

TEST(GivenProblems, ScenesWhoseMassesDifferByTenToTheEightAreVerifiedOrProved) {
  std::vector<Given> problems;
  for (const SceneFamily& family : AllScenes()) {
    for (const int rows : {3, 10, 30, 100}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        problems.push_back({WithWideMasses(family, rows, seed), std::nullopt});
      }
    }
  }
  for (const auto& [direct, tally] : TalliesOf(kWideMassTolerance, problems)) {
    EXPECT_LE(tally.undecided, direct.undecided_scenes) << direct.key << tally.undecided_ids;
    EXPECT_GE(tally.verified, static_cast<int>(problems.size()) * 9 / 10) << direct.key;
  }
}

}  // namespace
}  // namespace lcpbench
