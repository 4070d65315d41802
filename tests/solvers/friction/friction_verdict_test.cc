// The verdict of problems with friction, sliding and bounded rows: docs/friction.md sections 4 and 11.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "solvers/lcp/law_metrics.h"
#include "solvers/lcp/range_scaling.h"
#include "solvers/lcp/verify.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

// Beside the rounding floor of the right answer.
Metrics MetricsOf(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& right) {
  LcpReference reference;
  reference.floor = RoundingFloor(problem, right);
  return ComputeMetrics(problem, f, &reference);
}

TEST(FrictionVerdict, ExactAnswersPassEveryTier) {
  int judged = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    for (const Eigen::VectorXd& f : KnownSolutions(record)) {
      SCOPED_TRACE(record.problem().id());
      const Metrics m = MetricsOf(record.problem(), f, f);
      for (const double tier : kTiers) EXPECT_TRUE(PassesTier(m, tier)) << m.rho << " " << m.backward_error;
      ++judged;
    }
  }
  EXPECT_GE(judged, 250);
}

// By hand: the normal force without friction is 1, so that friction is at most 0.3 then, and 0.6 / 2.3 by Coulomb's
// law.
TEST(FrictionVerdict, AnswersOfFrozenBoundsAreJudgedInTheirModel) {
  RowBounds bounds;
  bounds.friction = {{.row = 1, .normal = 0, .mu = 0.3}};
  const LcpProblem problem = LcpProblem::FromDense("frozen", (Eigen::Matrix2d() << 1, 0.5, 0.5, 1).finished(),
                                                   Eigen::Vector2d(-1, -2), bounds);
  LcpResult result;
  result.status = LcpStatus::kSolved;
  result.f = Eigen::Vector2d(0.85, 0.3);
  EXPECT_TRUE(Verify(problem, result, 1e-6).false_success);
  result.model = FrictionModel::kFrozenBounds;
  for (const Eigen::VectorXd& wrong :
       {Eigen::VectorXd(), Eigen::VectorXd(Eigen::Vector2d(0, 0.31)), Eigen::VectorXd(Eigen::Vector2d(0, -0.3))}) {
    result.friction_bounds = wrong;
    const Verdict verdict = Verify(problem, result, 1e-6);
    EXPECT_TRUE(verdict.false_success && verdict.model_rho > 1e-3) << verdict.model_rho;
  }
  result.friction_bounds = Eigen::Vector2d(0, 0.3);
  const Verdict verdict = Verify(problem, result, 1e-6);
  EXPECT_LE(verdict.model_rho, 1e-15);
  EXPECT_FALSE(verdict.passes || verdict.false_success);
}

// f times -1, f = 0, and without tangential forces; answers of other models.
TEST(FrictionVerdict, WrongAnswersPassNoTier) {
  int refused = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.is_solved() || !record.json.contains("f_exact")) continue;
    SCOPED_TRACE(record.problem().id());
    const Eigen::VectorXd right = ToVector(record.json["f_exact"]);
    Eigen::VectorXd without_friction = right;
    for (const FrictionRow& row : record.problem().friction_rows()) without_friction[row.row] = 0;
    std::vector<Eigen::VectorXd> wrong = {-right, 0 * right, without_friction};
    if (record.json.contains("models")) {
      for (const auto& [name, model] : record.json["models"].items()) wrong.push_back(ToVector(model["f_exact"]));
    }
    for (const Eigen::VectorXd& f : wrong) {
      const Metrics m = MetricsOf(record.problem(), f, right);
      if (m.rho <= 1e-3) continue;
      ++refused;
      for (const double tier : kTiers) EXPECT_FALSE(PassesTier(m, tier));
    }
  }
  EXPECT_GE(refused, 200);
}

// Records have them computed from the definitions in doubles, by another program.
TEST(FrictionVerdict, RhoAndPartsOfOtherModelsAreThoseOfTheRecords) {
  int compared = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.json.contains("models")) continue;
    for (const auto& [name, model] : record.json["models"].items()) {
      SCOPED_TRACE(record.problem().id() + " " + name);
      const Metrics m = ComputeMetrics(record.problem(), ToVector(model["f_exact"]));
      EXPECT_NEAR(m.rho, model["rho"].get<double>(), 1e-9);
      const nlohmann::json& parts = model["parts"];
      for (const auto& [key, part] : {std::pair{"penetration", m.penetration},
                                      {"adhesion", m.adhesion},
                                      {"separation", m.separation},
                                      {"cone", m.cone},
                                      {"dissipation", m.dissipation},
                                      {"joints", m.joints}}) {
        EXPECT_NEAR(part, parts[key].get<double>(), 1e-9) << key;
      }
      ++compared;
    }
  }
  EXPECT_GE(compared, 110);
}

// Forces near and far from every known solution.
template <typename Visit>
void ForEachDisturbed(const Visit& visit) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const FrictionRecord& record : FrictionRecords()) {
    for (const Eigen::VectorXd& solution : KnownSolutions(record)) {
      for (const double size : {1e-8, 1e-3, 1.0}) {
        Eigen::VectorXd f = solution;
        for (double& x : f) x += size * normal(random) * (1 + std::abs(x));
        visit(record.problem(), f);
      }
    }
  }
}

TEST(FrictionVerdict, PartsMakeUpRho) {
  ForEachDisturbed([](const LcpProblem& problem, const Eigen::VectorXd& f) {
    const Metrics m = ComputeMetrics(problem, f);
    double squares = 0;
    for (const double part :
         {m.penetration, m.adhesion, m.separation, m.cone, m.dissipation, m.joints, m.beyond_bounds}) {
      squares += part * part;
    }
    const double rho = m.rho * m.rho;
    EXPECT_LE(rho / 2, squares * (1 + 1e-12)) << problem.id();
    EXPECT_LE(squares, 2 * rho * (1 + 1e-12)) << problem.id();
  });
}

// b.f + f.A f / 2 <= 0 and f_t w_t = -mu f_n |w_t| for every solution.
TEST(FrictionVerdict, SolutionsLoseEnergy) {
  int judged = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpProblem& problem = record.problem();
    for (const Eigen::VectorXd& f : KnownSolutions(record)) {
      const Metrics m = ComputeMetrics(problem, f);
      if (m.energy == -1) continue;
      SCOPED_TRACE(problem.id());
      // Powers are rounded by the terms of w; where loads are small beside these, S is too.
      const Eigen::VectorXd terms = problem.DenseA().cwiseAbs() * f.cwiseAbs() + problem.b().cwiseAbs();
      const ExtendedVector root =
          problem.DenseA().diagonal().unaryExpr([](double d) { return d == 0 ? 1 : std::sqrt(d); }).cast<long double>();
      const long double S = LoadScale(problem, root);
      const double rounding = 1e-14 * f.cwiseAbs().dot(terms) / (S == 0 ? 1 : static_cast<double>(S * S));
      EXPECT_LE(m.energy, rounding);
      EXPECT_LE(m.created, rounding);
      double power = 0, scale = 0;
      for (const FrictionRow& row : problem.friction_rows()) {
        power -= row.mu * f[row.normal] * std::abs(m.w[row.row]);
        scale += row.mu * std::abs(f[row.normal]) * problem.b().cwiseAbs().maxCoeff();
      }
      double by_rows = 0;
      for (const FrictionRow& row : problem.friction_rows()) by_rows += f[row.row] * m.w[row.row];
      EXPECT_NEAR(by_rows, power, 1e-9 * (scale + std::abs(power)));
      ++judged;
    }
  }
  EXPECT_GE(judged, 200);
}

TEST(FrictionVerdict, UnitsDoNotMatter) {
  std::mt19937 random(7);
  ForEachDisturbed([&random](const LcpProblem& problem, const Eigen::VectorXd& f) {
    Eigen::VectorXd row(f.size());
    for (double& x : row) x = std::ldexp(1.0, static_cast<int>(random() % 9) - 4);
    const double mass = 64;
    // Rows whose A_ii is 0 have the unit that they are given in, and rho is absolute where b is 0.
    if ((problem.DiagonalA().array() == 0).any() || problem.b().isZero(0)) return;
    const Metrics before = ComputeMetrics(problem, f);
    const Metrics after = ComputeMetrics(ScaleRows(problem, row, 1 / mass), mass * f.cwiseQuotient(row));
    EXPECT_NEAR(after.rho, before.rho, 1e-12 * before.rho) << problem.id();
    EXPECT_NEAR(after.backward_error, before.backward_error, 1e-12 * before.backward_error) << problem.id();
    EXPECT_NEAR(after.dissipation, before.dissipation, 1e-12 * before.dissipation) << problem.id();
    EXPECT_NEAR(after.energy, before.energy, 1e-12 * std::abs(before.energy)) << problem.id();
  });
}

// Tangents turned round: the same contact seen in a mirror, or with its bodies swapped.
TEST(FrictionVerdict, MirrorAndOrderDoNotMatter) {
  std::mt19937 random(9);
  ForEachDisturbed([&random](const LcpProblem& problem, const Eigen::VectorXd& f) {
    const LcpProblem same = InForm(problem, MatrixForm::kDense);
    std::vector<Index> order = EveryRow(f.size());
    std::ranges::shuffle(order, random);
    Eigen::VectorXd sign = Eigen::VectorXd::Ones(f.size());
    for (const FrictionRow& row : problem.friction_rows()) sign[row.row] = -1;
    const Eigen::VectorXd signs = sign(order);
    const Metrics before = ComputeMetrics(same, f);
    const Metrics after = ComputeMetrics(RowsOf(same, order, signs), signs.cwiseProduct(f(order)));
    // Sums in another order round otherwise.
    EXPECT_NEAR(after.rho, before.rho, 1e-12 * before.rho + 1e-17) << problem.id();
    EXPECT_NEAR(after.backward_error, before.backward_error, 1e-12 * before.backward_error + 1e-17) << problem.id();
    EXPECT_NEAR(after.cone, before.cone, 1e-12 * before.cone + 1e-17) << problem.id();
  });
}

// A problem without friction rows but with empty laws is plain; with a bounded row [0, inf) it is not, and a solution
// of one is a solution of the other.
TEST(FrictionVerdict, UnilateralAndBoundedRowsHaveTheSameSolutions) {
  std::mt19937_64 random(3);
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const LcpProblem plain = PlantedProblem(1 + seed % 6, 6, seed, 0, 0).problem;
    const Eigen::VectorXd f = SolveBy("dantzig", plain).f;
    RowBounds bounds;
    for (Index i = 0; i < f.size(); ++i) bounds.bounded.push_back({i, 0, std::numeric_limits<double>::infinity()});
    const LcpProblem bounded = plain.WithBounds(bounds);
    for (const double disturbance : {0.0, 1e-2, 1.0}) {
      Eigen::VectorXd g = f;
      for (double& x : g) x += disturbance * Uniform(&random, -1, 1);
      // S is |D^-1/2 b| for both: bounds that are infinite do not limit what counts of b.
      EXPECT_NEAR(ComputeMetrics(bounded, g).rho, ComputeMetrics(plain, g).rho, 1e-14);
    }
  }
}

TEST(FrictionVerdict, RaysProveOnlyWhereFrictionIsNotInThem) {
  int proofs = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    SCOPED_TRACE(record.problem().id());
    if (record.json.contains("ray_exact")) {
      const Eigen::VectorXd ray = ToVector(record.json["ray_exact"]);
      EXPECT_TRUE(VerifyFarkasRay(record.problem(), ray).accepted) << VerifyFarkasRay(record.problem(), ray).reason;
      for (const FrictionRow& row : record.problem().friction_rows()) {
        Eigen::VectorXd other = ray;
        other[row.row] = 0.5;
        EXPECT_FALSE(VerifyFarkasRay(record.problem(), other).accepted);
      }
      ++proofs;
    }
    // Where Lemke's path ends: as a rule it proves nothing.
    if (record.json.contains("lemke_ray") && !record.json.contains("ray_exact")) {
      EXPECT_FALSE(VerifyFarkasRay(record.problem(), ToVector(record.json["lemke_ray"])).accepted);
    }
  }
  EXPECT_GE(proofs, 1);
  for (const char* id : {"ce06-bounded-ray", "ce07-bounded-ray-friction", "ce12-joint-drift"}) {
    const auto& all = FrictionRecords();
    const auto found = std::ranges::find_if(all, [id](const FrictionRecord& r) { return r.problem().id() == id; });
    ASSERT_NE(found, all.end());
    Eigen::VectorXd y = Eigen::VectorXd::Ones(found->problem().size());
    for (const FrictionRow& row : found->problem().friction_rows()) y[row.row] = 0;
    EXPECT_TRUE(VerifyFarkasRay(found->problem(), y).proved) << id;
  }
}

TEST(FrictionVerdict, InfeasibleNeedsARay) {
  for (const FrictionRecord& record : FrictionRecords()) {
    LcpResult claim = Claim(Eigen::VectorXd::Zero(record.problem().size()), LcpStatus::kInfeasible);
    EXPECT_TRUE(Verify(record.problem(), claim, 1e-6, &record.parsed.reference).false_infeasible)
        << record.problem().id();
    if (!record.json.contains("ray_exact")) continue;
    claim.farkas_ray = ToVector(record.json["ray_exact"]);
    EXPECT_FALSE(Verify(record.problem(), claim, 1e-6, &record.parsed.reference).false_infeasible);
    LcpReference solvable = record.parsed.reference;
    solvable.solvable = true;
    EXPECT_TRUE(Verify(record.problem(), claim, 1e-6, &solvable).false_infeasible);
  }
}

// Two contacts in place of one, each with half of the force.
TEST(FrictionVerdict, ASplitContactKeepsItsAnswer) {
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpProblem& problem = record.problem();
    if (!problem.has_factors() || problem.friction_rows().empty()) continue;
    const FrictionRow row = problem.friction_rows().front();
    if (std::ranges::count(problem.friction_rows(), row.normal, &FrictionRow::normal) > 1) continue;
    std::vector<Index> rows = EveryRow(problem.size());
    rows.insert(rows.end(), {row.normal, row.row});
    const LcpProblem split = RowsOf(problem, rows);
    for (const Eigen::VectorXd& f : KnownSolutions(record)) {
      Eigen::VectorXd halves = f(rows);
      for (const Index i : {row.normal, row.row}) halves[i] /= 2;
      halves.tail(2) /= 2;
      EXPECT_TRUE(PassesTier(MetricsOf(split, halves, halves), 1e-9)) << problem.id();
    }
  }
}

TEST(FrictionRows, FilesAndArraysReturnTheSameProblem) {
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpProblem& problem = record.problem();
    EXPECT_EQ(DifferenceOfProblems(ParseLcpRecord(FormatLcpRecord(problem), "again").problem, problem), "");
    EXPECT_EQ(DifferenceOfProblems(LcpProblem::FromArrays(ProblemArrays::Of(problem)), problem), "");
  }
}

// Rows and loads of any magnitude: what solves the scaled problem solves the given one.
TEST(FrictionRows, ScalingOfRangeTakesLawsAlong) {
  std::mt19937 random(11);
  int solved = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    const std::vector<Eigen::VectorXd> solutions = KnownSolutions(record);
    if (solutions.empty() || (record.problem().DiagonalA().array() == 0).any()) continue;
    Eigen::VectorXd row(record.problem().size());
    for (double& x : row) x = std::ldexp(1.0, static_cast<int>(random() % 200) - 100);
    const double mass = std::ldexp(1.0, 220);
    const LcpProblem extreme = ScaleRows(record.problem(), row, 1 / mass);
    const RangeScaling scaling(extreme);
    LcpResult result;
    LcpOptions options;
    scaling.SolveScaled(
        extreme, options, &result, [&](const LcpProblem& scaled, const LcpOptions& /*options*/, LcpResult* found) {
          // f~ = f D^1/2 D~^-1/2 times one unit: b~ says which.
          Index largest = 0;
          extreme.b().cwiseAbs().maxCoeff(&largest);
          const Eigen::VectorXd f = mass * solutions.front().cwiseQuotient(row);
          const Eigen::VectorXd s = (scaled.DiagonalA().array() / extreme.DiagonalA().array()).sqrt().matrix();
          const double unit = extreme.b()[largest] == 0 ? 1 : scaled.b()[largest] / (extreme.b()[largest] * s[largest]);
          found->f = unit * f.cwiseQuotient(s);
          found->status = LcpStatus::kSolved;
          EXPECT_TRUE(PassesTier(MetricsOf(scaled, found->f, found->f), 1e-9)) << record.problem().id();
        });
    solved += result.status == LcpStatus::kSolved ? 1 : 0;
  }
  EXPECT_GE(solved, 80);
}

}  // namespace
}  // namespace lcpbench
