// Families with friction: the fact of each, on both sides of its threshold. docs/friction.md section 8.

#include <Eigen/LU>

#include "model/contact/assembly.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/friction/machines.h"
#include "model/scenes/friction/piles.h"
#include "model/scenes/friction/slopes.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "solvers/exact/modes/mode_search.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/model/scenes/scene_checks.h"

namespace lcpbench {
namespace {

constexpr double kStep = 0.01;
constexpr double kMargin = 0.02;  ///< of mu or a load beside its threshold, relative

Eigen::VectorXd Solve(const std::string& key, const LcpProblem& problem) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
  LcpOptions options;
  options.tolerance = 1e-10;  // above the rounding floors of these scenes
  LcpResult result;
  solver->Solve(problem, options, &result);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << " " << key << " " << result.detail;
  return result.f;
}

// A solution of Coulomb's law with w = 0 solves the relaxation, whose w is unique; and where that is 0 it is one of
// Coulomb's law. So the relaxation decides whether a scene at rest can stay there, of whatever size.
bool CanRest(const ContactSystem& system) {
  const LcpProblem problem = AssembleStepLcp(system, kStep).problem;
  const Eigen::VectorXd f = Solve("relaxation", problem);
  Eigen::VectorXd w;
  problem.ComputeW(f, &w);
  const Eigen::VectorXd root = problem.DiagonalA().cwiseSqrt();
  return w.cwiseQuotient(root).norm() <= 1e-7 * problem.b().cwiseQuotient(root).norm();
}

/// A step's answer by Coulomb's law, passed by the verifier.
struct Answer {
  AssembledLcp lcp;
  Eigen::VectorXd f;
  Eigen::VectorXd w;
  Eigen::VectorXd v;  ///< after the step, three numbers a body

  /// Sums of forces over rows of that axis [N].
  double Sum(char axis) const {
    double sum = 0;
    for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
      if (lcp.rows[i].axis == axis) sum += f[static_cast<Index>(i)] / kStep;
    }
    return sum;
  }
};

Answer Answered(AssembledLcp lcp, const Eigen::VectorXd& v_free) {
  Answer answer{std::move(lcp), {}, {}, v_free};
  const LcpProblem& problem = answer.lcp.problem;
  LcpResult result;
  result.f = answer.f = Solve("auto", problem);
  result.status = LcpStatus::kSolved;
  EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << problem.id();
  problem.ComputeW(answer.f, &answer.w);
  answer.v += problem.inverse_mass().asDiagonal() * (problem.J().transpose() * answer.f);
  return answer;
}

Answer StepOf(const ContactSystem& system) {
  return Answered(AssembleStepLcp(system, kStep), FreeVelocity(system.bodies, kStep));
}

// All solutions of a problem of up to six contacts.
ExactAnswer AllSolutions(const LcpProblem& problem) {
  const ExactAnswer answer = SolveByModes(ExactFrom(problem), {});
  EXPECT_TRUE(answer.complete);
  return answer;
}

TEST(SlopeStacks, RestIfFrictionAndWidthHoldThem) {
  for (const int boxes : {1, 2, 5, 10}) {
    for (const double slope : {0.1, 0.3, 0.6}) {
      const double tangent = std::tan(slope);
      for (const double mu : {1 - kMargin, 1 + kMargin}) {
        for (const double width : {1 - kMargin, 1 + kMargin}) {
          EXPECT_EQ(CanRest(SlopeStacks(1, boxes, slope, mu * tangent, width * boxes * tangent, 1)),
                    mu > 1 && width > 1)
              << boxes << " " << slope << " " << mu << " " << width;
        }
      }
    }
  }
}

TEST(SlopeStacks, OfOneBoxRestSlideOrTopple) {
  for (const double slope : {0.1, 0.3, 0.6}) {
    const double tangent = std::tan(slope);
    const auto answer = [&](double mu, double width) { return StepOf(SlopeStacks(1, 1, slope, mu, width, 1)); };
    for (const double mu : {1.2 * tangent, 0.8 * tangent}) {
      const Answer upright = answer(mu, 3);
      const double weight = kGravity / upright.lcp.problem.inverse_mass()[3];
      EXPECT_NEAR(upright.Sum('n'), weight * std::cos(slope), 1e-7 * weight);
      EXPECT_NEAR(std::abs(upright.Sum('t')), weight * std::min(std::sin(slope), mu * std::cos(slope)), 1e-7 * weight);
      EXPECT_NEAR(upright.v[5], 0, 1e-7);
    }
    EXPECT_LT(answer(2 * tangent, 0.8 * tangent).v[5], -1e-4);
  }
}

TEST(RollingDiscs, RollUpToTheirThreshold) {
  for (const double hole : {0.0, 0.5, 0.9}) {
    const double beta = (1 + hole * hole) / 2;
    for (const double slope : {0.1, 0.3, 0.6}) {
      const double least = std::tan(slope) / (1 + 1 / beta);
      const Answer rolls = StepOf(DiscsOnSlope(3, slope, (1 + kMargin) * least, hole));
      const double weight = 3 * kGravity / rolls.lcp.problem.inverse_mass()[3];
      EXPECT_NEAR(std::abs(rolls.Sum('t')), weight * std::sin(slope) * beta / (1 + beta), 1e-8 * weight);
      EXPECT_LT(rolls.w.cwiseAbs().maxCoeff(), 1e-9);
      const Answer slides = StepOf(DiscsOnSlope(3, slope, (1 - kMargin) * least, hole));
      EXPECT_NEAR(std::abs(slides.Sum('t')), (1 - kMargin) * least * weight * std::cos(slope), 1e-8 * weight);
      EXPECT_GT(slides.w.cwiseAbs().maxCoeff(), 1e-4);
    }
  }
}

TEST(RollingDiscs, FeelTheCurvatureOfTheGround) {
  for (const Side side : {Side::kConvex, Side::kConcave}) {
    for (const double angle : {-0.4, 0.0, 0.7}) {
      for (const double v : {0.0, 1.0, -2.0}) {
        const double rho = 3;
        const double r = 0.5;
        const ContactSystem system = DiscOnArc(side, rho, r, angle, v, 10);
        const Body& disc = system.bodies[1];
        const AssembledLcp lcp = AssembleContactLcp(system, Friction::kRows);
        EXPECT_NEAR(lcp.rows[1].d_dot, 0, 1e-12);
        const Answer rolls = Answered(lcp, FreeVelocity(system.bodies, 0));
        const double curved = side == Side::kConvex ? -v * v / (rho + r) : v * v / (rho - r);
        EXPECT_NEAR(rolls.f[0], disc.mass * (kGravity * std::cos(angle) + curved), 1e-8 * disc.mass * kGravity);
        EXPECT_NEAR(std::abs(rolls.f[1]), disc.mass * kGravity * std::abs(std::sin(angle)) / 3,
                    1e-8 * disc.mass * kGravity);
      }
    }
  }
}

TEST(Ladders, StandIfBothEndsHold) {
  for (const double mu : {0.1, 0.3, 0.6, 0.9}) {
    const double least = std::atan((1 - mu * mu) / (2 * mu));
    EXPECT_TRUE(CanRest(Ladders(3, (1 + kMargin) * least, mu))) << mu;
    EXPECT_FALSE(CanRest(Ladders(3, (1 - kMargin) * least, mu))) << mu;
  }
}

// The floor's contact opens and the edge sticks: modes O o C S.
TEST(WheelsAtStep, AreLiftedByTheLeastForce) {
  for (const double step : {0.2, 0.5, 0.8}) {
    const double mass = 1 / AssembleStepLcp(WheelsAtStep(1, 1, step, 0, 0.5), kStep).problem.inverse_mass()[3];
    const double least = mass * kGravity * std::sqrt(2 * step - step * step) / (1 - step);
    for (const double mu : {0.3, 1.0, 2.0}) {
      for (const double force : {1 - kMargin, 1 + kMargin}) {
        const ExactAnswer answer =
            AllSolutions(AssembleStepLcp(WheelsAtStep(1, 1, step, force * least, mu), kStep).problem);
        const bool lifts = std::any_of(answer.pieces.begin(), answer.pieces.end(),
                                       [](const ModePiece& piece) { return piece.modes == "OoCS"; });
        EXPECT_EQ(lifts, force > 1) << step << " " << mu << " " << answer.modes;
        if (force > 1 && mu <= std::sqrt(2 / step - 1)) {
          EXPECT_TRUE(answer.f_unique.value()) << step << " " << mu;
        }
      }
    }
  }
}

// Rolling takes as much friction as the forces without slip need.
TEST(RollingOvals, KeepTheEnergyLawWhileTheyRoll) {
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const double a = random.Uniform(1.05, 2);
    const double angle = random.Uniform(-3, 3);
    const double omega = random.Uniform(-1, 1);
    const auto ovals = [&](double mu) { return RollingOvals(1, a, 1, angle, omega, mu); };
    const LcpProblem any = AssembleStepLcp(ovals(1), kStep).problem;
    const Eigen::Vector2d stick = -any.DenseA().inverse() * any.b();
    if (stick[0] <= 0 || std::abs(stick[1]) < 1e-3 * stick[0]) continue;
    const double least = std::abs(stick[1]) / stick[0];
    const Answer slides = StepOf(ovals((1 - kMargin) * least));
    // A floor under weights alone has no load along itself: slip is what the missing friction leaves.
    EXPECT_GT(std::abs(slides.w[1]), 1e-4 * any.DenseA()(1, 1) * std::abs(stick[1]));
    const ContactSystem system = ovals((1 + kMargin) * least);
    const Answer rolls = StepOf(system);
    EXPECT_NEAR(rolls.w[1], 0, 1e-10);
    const Eigen::VectorXd free = FreeVelocity(system.bodies, kStep);
    const auto energy = [&](const Eigen::VectorXd& v) {
      const Body& oval = system.bodies[1];
      return (oval.mass * v.segment<2>(3).squaredNorm() + oval.inertia * v[5] * v[5]) / 2;
    };
    const double quadratic = rolls.f.dot(rolls.lcp.problem.DenseA() * rolls.f) / 2;
    const double depth = rolls.f.dot(rolls.lcp.problem.b() - rolls.lcp.problem.J() * free);
    EXPECT_NEAR(energy(free) - energy(rolls.v), quadratic + depth, 1e-10 * energy(free) + 1e-12);
  }
}

// A direction in which forces grow without end: one of self-stresses in the friction cones, which loads do not change.
TEST(Wedges, HaveUnboundedForcesIfTheyJam) {
  for (const double alpha : {0.15, 0.3, 0.5}) {
    for (const int layers : {1, 2}) {
      for (const double mu : {1 - kMargin, 1 + kMargin}) {
        const LcpProblem loaded = AssembleStepLcp(Wedges(1, layers, alpha, mu * std::tan(alpha)), kStep).problem;
        const ExactAnswer answer = AllSolutions(loaded.WithB(Eigen::VectorXd::Zero(loaded.size())));
        const bool unbounded = std::any_of(answer.pieces.begin(), answer.pieces.end(),
                                           [](const ModePiece& piece) { return !piece.f.rays.empty(); });
        EXPECT_EQ(unbounded, mu > 1) << alpha << " " << layers;
      }
    }
  }
}

TEST(ThreeDiscs, StandIfBothKindsOfContactsHold) {
  for (const double phi : {kPi / 6, 0.8, 1.2}) {
    const double least = std::tan(phi / 2);
    for (const double top : {1 - kMargin, 1 + kMargin}) {
      for (const double ground : {1 - kMargin, 1 + kMargin}) {
        EXPECT_EQ(CanRest(ThreeDiscs(phi, top * least, ground * least / 3)), top > 1 && ground > 1)
            << phi << " " << top << " " << ground;
      }
    }
  }
}

TEST(Pyramids, StandFromTheirLeastFrictionOn) {
  const double least[] = {std::tan(kPi / 12), 0.434, 0.473, 0.498, 0.513};
  for (int base = 2; base <= 6; ++base) {
    EXPECT_TRUE(CanRest(Pyramids(2, base, least[base - 2] + 0.002))) << base;
    EXPECT_FALSE(CanRest(Pyramids(2, base, least[base - 2] - 0.002))) << base;
  }
}

TEST(CardHouse, NeedsTheFrictionOfItsHighestPair) {
  for (const double angle : {0.2, 0.35, 0.5}) {
    const double least = LeastCardFriction(angle);
    EXPECT_TRUE(CanRest(CardHouse(1, angle, (1 + kMargin) * least))) << angle;
    for (const int levels : {1, 2, 3, 5}) {
      EXPECT_FALSE(CanRest(CardHouse(levels, angle, (1 - kMargin) * least))) << angle << " " << levels;
      EXPECT_TRUE(CanRest(CardHouse(levels, angle, 3 * least))) << angle << " " << levels;
    }
  }
}

TEST(Arches, StandIfTheyAreThickAndRough) {
  for (const int stones : {5, 7, 15, 24}) {
    EXPECT_TRUE(CanRest(Arches(1, stones, 0.8, 0.5))) << stones;
    EXPECT_TRUE(CanRest(Arches(1, stones, 0.7, 0.7))) << stones;
    for (const double mu : {0.5, 1.0, 10.0}) EXPECT_FALSE(CanRest(Arches(1, stones, 0.95, mu))) << stones << " " << mu;
  }
}

// The largest inner radius of arches with a joint at the crown [Couplet 1730; Heyman 1969]: the line of thrust leaves
// the floor and passes the crown at the outer corners, and must pass every joint beyond its inner one.
double LargestInnerRadius(int stones) {
  const auto stands = [&](double inner) {
    // The weight of the stones between the crown and a joint, and its moment about the centre.
    const auto weight = [&](double angle) { return (1 - inner * inner) / 2 * angle; };
    const auto moment = [&](double angle) { return (1 - inner * inner * inner) / 3 * (1 - std::cos(angle)); };
    const double thrust = weight(kPi / 2) - moment(kPi / 2);
    for (int k = 1; 2 * k <= stones; ++k) {
      const double angle = kPi * k / stones;
      const double needed = weight(angle) * inner * std::sin(angle) - moment(angle);
      if (thrust * (1 - inner * std::cos(angle)) < needed) return false;
    }
    return true;
  };
  double low = 0.5;
  double high = 1;
  while (high - low > 1e-9) (stands((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

TEST(Arches, StandFromTheirLeastThicknessOn) {
  for (const int stones : {6, 8, 16, 24}) {
    const double least = 1 - LargestInnerRadius(stones);
    EXPECT_TRUE(CanRest(Arches(1, stones, 1 - (1 + kMargin) * least, 1))) << stones;
    EXPECT_FALSE(CanRest(Arches(1, stones, 1 - (1 - kMargin) * least, 1))) << stones;
  }
}

TEST(Capstans, HoldUpToTheRatioOfTensions) {
  for (const int beads : {1, 3, 8}) {
    for (const double mu : {0.2, 0.5, 1.0}) {
      const double delta = 0.1;
      const double ratio = CapstanRatio(beads, delta, mu);
      EXPECT_TRUE(CanRest(Capstans(2, beads, delta, (1 - kMargin) * ratio, mu))) << beads;
      EXPECT_FALSE(CanRest(Capstans(2, beads, delta, (1 + kMargin) * ratio, mu))) << beads;
      EXPECT_TRUE(CanRest(Capstans(2, beads, delta, (1 + kMargin) / ratio, mu))) << beads;
      EXPECT_FALSE(CanRest(Capstans(2, beads, delta, (1 - kMargin) / ratio, mu))) << beads;
    }
  }
}

TEST(PulledChains, SlideIfPulledByMoreThanTheirFriction) {
  for (const int boxes : {1, 2, 5, 20}) {
    for (const double mu : {0.2, 0.6}) {
      EXPECT_TRUE(CanRest(PulledChains(2, boxes, 1 - kMargin, mu))) << boxes;
      EXPECT_FALSE(CanRest(PulledChains(2, boxes, 1 + kMargin, mu))) << boxes;
      if (boxes > 5) continue;
      // All slide together: what is left of the pull accelerates the whole.
      const ContactSystem system = PulledChains(1, boxes, 1.5, mu);
      const Answer slides = StepOf(system);
      for (int i = 1; i <= boxes; ++i) EXPECT_NEAR(slides.v[3 * i], -0.5 * mu * kGravity * kStep, 1e-7);
    }
  }
}

TEST(FrictionDrives, StandUpToTheTorqueThatFrictionBears) {
  for (const double mu : {0.2, 0.6, 2.0}) {
    EXPECT_TRUE(CanRest(FrictionDrives(2, 1 - kMargin, mu))) << mu;
    EXPECT_FALSE(CanRest(FrictionDrives(2, 1 + kMargin, mu))) << mu;
  }
}

TEST(LockedCams, HoldAnyTorqueFromTheirLeastFrictionOn) {
  for (const double lean : {0.2, 0.5, 0.8}) {
    const double locks = CamLockFriction(lean);
    EXPECT_TRUE(CanRest(LockedCams(2, lean, 1e4, (1 + kMargin) * locks))) << lean;
    EXPECT_FALSE(CanRest(LockedCams(2, lean, 1e4, (1 - kMargin) * locks))) << lean;
    for (const double mu : {0.3 * locks, 0.9 * locks}) {
      EXPECT_TRUE(CanRest(LockedCams(2, lean, (1 - kMargin) * CamHolds(lean, mu), mu))) << lean;
      EXPECT_FALSE(CanRest(LockedCams(2, lean, (1 + kMargin) * CamHolds(lean, mu), mu))) << lean;
    }
  }
}

// A disc at rest at the bottom of a turning drum: within a step friction takes it along without slip if and only if
// |omega| R <= 3 mu g h; else it bears all it can, in the direction of the turn, however fast the wall is.
TEST(Drum, TakesADiscAlongUpToItsThreshold) {
  const double mu = 0.4;
  const double R = 3;
  ContactSystem system = DiscOnArc(Side::kConcave, R, 0.5, 0, 0, mu);
  for (const double speed : {1 - kMargin, 1 + kMargin, 1e6}) {
    for (const double turn : {-1.0, 1.0}) {
      system.bodies[0].omega = turn * speed * 3 * mu * kGravity * kStep / R;
      const Answer answer = StepOf(system);
      const double weight = kGravity * system.bodies[1].mass;
      EXPECT_NEAR(answer.Sum('n'), weight, 1e-8 * weight);
      EXPECT_NEAR(answer.v[3], turn * mu * kGravity * kStep * std::min(speed, 1.0), 1e-9) << speed;
      EXPECT_EQ(std::abs(answer.w[1]) < 1e-9, speed < 1) << speed;
      LcpResult nothing;
      nothing.f = Eigen::VectorXd::Zero(2);
      EXPECT_GT(Verify(answer.lcp.problem, nothing, 1e-3).metrics.rho, 0.5);
    }
  }
}

// Nothing passes for the lack of a load, and contacts slip in both directions.
TEST(Drum, IsFarFromAnAnswerAtZero) {
  int forward = 0;
  int backward = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const AssembledLcp lcp = AssembleStepLcp(GenerateScene("drum", 60, seed), kStep);
    LcpResult nothing;
    nothing.f = Eigen::VectorXd::Zero(lcp.problem.size());
    nothing.status = LcpStatus::kSolved;
    EXPECT_GT(Verify(lcp.problem, nothing, 1e-3).metrics.rho, 0.1);
    for (const RowInfo& row : lcp.rows) {
      if (row.axis == 't') ++(row.d_dot > 0 ? forward : backward);
    }
  }
  EXPECT_GT(forward, 200);
  EXPECT_GT(backward, 200);
}

class FrictionFamilies : public ::testing::TestWithParam<SceneFamily> {};

TEST_P(FrictionFamilies, AreTheSameBitsForTheSameSeedAndAboutAsLargeAsAsked) {
  for (const int rows : {1, 10, 100, 600}) {
    const auto problem = [&](std::uint64_t seed) {
      return AssembleInstant(GetParam().generate(rows, seed), GetParam().step).problem;
    };
    const LcpProblem first = problem(7);
    EXPECT_EQ(first.b(), problem(7).b());
    EXPECT_EQ(first.bounds().friction, problem(7).bounds().friction);
    EXPECT_FALSE(first.friction_rows().empty());
    constexpr Index kMostOfTheLeast = 24;  // an arch of five stones
    EXPECT_LE(first.size(), std::max<Index>(rows, kMostOfTheLeast)) << rows;
    if (rows >= 100 && GetParam().key != "three-discs") {
      EXPECT_GE(3 * first.size(), rows) << rows;
    }
    EXPECT_NE(first.bounds().friction, problem(8).bounds().friction);
  }
}

// Gaps are closed, so that every step has a solution.
TEST_P(FrictionFamilies, TouchInEveryContact) {
  for (const int rows : {1, 20, 200}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      for (const RowInfo& row : AssembleContactLcp(GetParam().generate(rows, seed), Friction::kRows).rows) {
        EXPECT_NEAR(row.d, 0, 1e-9) << seed;
      }
    }
  }
}

// Pairs of bodies that are listed touch by their outlines too, with the friction that is listed.
TEST_P(FrictionFamilies, ShowTheirContactsToDetection) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ContactSystem system = GetParam().generate(60, seed);
    const World world = GetParam().start(60, seed);
    const auto pairs = [](const ContactSystem& all) {
      std::set<std::tuple<int, int, double>> found;
      for (const Constraint& contact : all.constraints) {
        if (contact.type != ConstraintType::kContact) continue;
        const auto [first, second] = std::minmax(contact.body1, contact.body2);
        found.emplace(first, second, contact.friction);
      }
      return found;
    };
    const ContactSystem instant = InstantOf(world, ContactFinder(world).Find(world.bodies, 1e-6, 1e-3));
    EXPECT_EQ(pairs(instant), pairs(system)) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, FrictionFamilies, ::testing::ValuesIn(FrictionScenes().begin(), FrictionScenes().end()),
                         [](const auto& of) { return testing::TestNameOf(of.param.key); });

}  // namespace
}  // namespace lcpbench
