#include "model/motion/impact.h"

#include "model/contact/loads.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "solvers/registry.h"
#include "tests/model/contact/momenta.h"

namespace lcpbench {
namespace {

constexpr int kCases = 100;

// Solves with one solver; counts what was not solved.
struct Answerer {
  std::unique_ptr<LcpSolver> solver = MakeSolver("dantzig");
  int solves = 0;
  int failures = 0;

  ImpulseSolver Impulses() {
    return [this](const ContactSystem&, const std::vector<RowInfo>&, const LcpProblem& problem, LcpResult* result) {
      solver->Solve(problem, {}, result);
      ++solves;
      if (result->status != LcpStatus::kSolved) ++failures;
    };
  }
};

// A chain of touching discs in random directions, with random masses and velocities, closed to a redundant triangle
// where it happens to be one, and without anything fixed.
ContactSystem Cluster(Random* random) {
  ContactSystem system = EmptyScene("cluster", 6, 1);
  constexpr double kRadius = 0.5;
  const std::vector<Vec2> places = {
      {0, 0}, {1, 0}, {0.5, std::sqrt(0.75)}, {1.5, std::sqrt(0.75)}, {2, 0}, {1, 2 * std::sqrt(0.75)}};
  for (const Vec2 place : places) {
    Body disc = MakeDisc(place, kRadius, random->Uniform(0.5, 3));
    disc.v = 2 * random->InUnitDisc();
    disc.omega = random->Uniform(-1, 1);
    AddBody(&system, "disc", disc);
  }
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      const Vec2 between = places[static_cast<std::size_t>(i)] - places[static_cast<std::size_t>(j)];
      if (Norm(between) < 1.001) AddContact(&system, i, Circle(kRadius), j, Circle(kRadius));
    }
  }
  return system;
}

TEST(Impact, KeepsMomentaAndItsLawAndDoesNotGainEnergy) {
  Random random(11);
  Answerer answerer;
  for (int k = 0; k < kCases; ++k) {
    const ContactSystem before = Cluster(&random);
    for (const ImpactLaw law : {ImpactLaw::kNewton, ImpactLaw::kPoisson}) {
      const double e = k % 3 == 0 ? 1.0 : k % 3 == 1 ? 0.0 : random.Uniform();
      ImpactOptions options;
      options.law = law;
      options.restitution = e;
      ContactSystem after = before;
      ResolveImpact(options, answerer.Impulses(), &after);
      EXPECT_NEAR(Norm(Momentum(after.bodies) - Momentum(before.bodies)), 0, 1e-12);
      EXPECT_NEAR(AngularMomentum(after.bodies), AngularMomentum(before.bodies), 1e-12);
      const double energy = KineticEnergy(before.bodies);
      EXPECT_LE(KineticEnergy(after.bodies), energy * (1 + 1e-12));
      const auto rows_before = AssembleContactLcp(before).rows;
      const auto rows_after = AssembleContactLcp(after).rows;
      bool approached = false;
      for (std::size_t i = 0; i < rows_before.size(); ++i) {
        // Rows that separate are no part of the impact.
        if (rows_before[i].d_dot > options.velocity_tolerance) continue;
        approached = true;
        const double least = law == ImpactLaw::kNewton ? -e * rows_before[i].d_dot : 0;
        EXPECT_GE(rows_after[i].d_dot, least - 1e-10);
      }
      if (approached && law == ImpactLaw::kNewton && e == 1) {
        EXPECT_NEAR(KineticEnergy(after.bodies), energy, 1e-11 * energy);
      }
      if (approached && e == 0) {
        EXPECT_LT(KineticEnergy(after.bodies), energy);
      }
    }
  }
  EXPECT_EQ(answerer.failures, 0);
}

// Two walls, a disc that moves from one towards the other.
ContactSystem BetweenWalls(Vec2 velocity) {
  ContactSystem system = EmptyScene("walls", 2, 1);
  Body disc = MakeDisc({0, 0}, 1, 1);
  disc.v = velocity;
  AddBody(&system, "disc", disc);
  AddBody(&system, "wall", MakeFixed("left"));
  AddBody(&system, "wall", MakeFixed("right"));
  AddContact(&system, 0, Circle(1), 1, StraightEdge{{-1, -1}, {-1, 1}});
  AddContact(&system, 0, Circle(1), 2, StraightEdge{{1, 1}, {1, -1}});
  return system;
}

TEST(Impact, PoissonTakesWhatComesBackBetweenTwoWalls) {
  Answerer answerer;
  ImpactOptions options;
  options.law = ImpactLaw::kPoisson;
  options.restitution = 0.5;
  ContactSystem system = BetweenWalls({-1, 0});
  // The right wall's row separates; as part of the impact it could not move away from both.
  ResolveImpact(options, answerer.Impulses(), &system);
  EXPECT_EQ(answerer.failures, 0);
  EXPECT_EQ(answerer.solves, 2);
  EXPECT_NEAR(system.bodies[0].v.x, 0.5, 1e-12);
  ResolveImpact(options, answerer.Impulses(), &system);
  EXPECT_NEAR(system.bodies[0].v.x, -0.25, 1e-12);
}

TEST(Impact, SlowApproachIsStoppedAndSeparationStopsWhereItIsToldTo) {
  Answerer answerer;
  ImpactOptions options;
  options.restitution = 1;
  ContactSystem slow = BetweenWalls({-5e-5, 0.3});
  ResolveImpact(options, answerer.Impulses(), &slow);
  EXPECT_NEAR(slow.bodies[0].v.x, 0, 1e-15);
  EXPECT_DOUBLE_EQ(slow.bodies[0].v.y, 0.3);
  ContactSystem apart = BetweenWalls({1e-7, 0.3});
  apart.constraints.resize(1);
  StopSeparation(options, answerer.Impulses(), &apart);
  EXPECT_NEAR(apart.bodies[0].v.x, 0, 1e-15);
  EXPECT_DOUBLE_EQ(apart.bodies[0].v.y, 0.3);
}

// The velocity after StopApproach is the nearest one in the kinetic metric: no other admissible one is nearer.
TEST(Impact, StopApproachIsTheProjectionInTheKineticMetric) {
  Random random(12);
  Answerer answerer;
  for (int k = 0; k < kCases; ++k) {
    const ContactSystem before = Cluster(&random);
    ContactSystem after = before;
    ImpactOptions options;
    // Above all separating speeds: every row takes part.
    options.velocity_tolerance = 100;
    StopApproach(options, answerer.Impulses(), &after);
    EXPECT_LE(WorstViolation(AssembleContactLcp(after).rows, &RowInfo::d_dot), 1e-12);
    // (v - v+) M (v' - v+) <= 0 for every admissible v': also for v' = 0 and v' = 2 v+, so it is 0 there.
    double product = 0;
    for (std::size_t i = 0; i < before.bodies.size(); ++i) {
      const Body& b = before.bodies[i];
      const Body& a = after.bodies[i];
      product += b.mass * Dot(b.v - a.v, a.v) + b.inertia * (b.omega - a.omega) * a.omega;
    }
    EXPECT_NEAR(product, 0, 1e-11);
  }
}

TEST(Projection, MovesBodiesOntoTheirConstraintsAndLeavesTheCentreOfMass) {
  Random random(13);
  Answerer answerer;
  for (int k = 0; k < kCases; ++k) {
    ContactSystem system = Cluster(&random);
    for (Body& body : system.bodies) body.x = body.x + 1e-4 * random.InUnitDisc();
    // Some of the contacts as rods: bilateral.
    for (std::size_t i = 0; i < system.constraints.size(); i += 3) {
      const Constraint& c = system.constraints[i];
      system.constraints[i] = {ConstraintType::kRod, c.body1, c.body2, Vertex{}, Vertex{}, {}, {}, 0, 1};
    }
    const ContactSystem before = system;
    const double violation = WorstViolation(AssembleContactLcp(system).rows);
    ASSERT_GT(violation, 1e-6);
    const double left = ProjectPositions(1e-12, answerer.Impulses(), &system);
    EXPECT_LE(left, 1e-12);
    EXPECT_EQ(left, WorstViolation(AssembleContactLcp(system).rows));
    Vec2 moved;
    double longest = 0;
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
      const Vec2 shift = system.bodies[i].x - before.bodies[i].x;
      moved = moved + system.bodies[i].mass * shift;
      longest = std::max(longest, Norm(shift));
    }
    EXPECT_NEAR(Norm(moved), 0, 1e-14);
    EXPECT_LT(longest, 20 * violation);
  }
  EXPECT_EQ(answerer.failures, 0);
}

TEST(Projection, WhatCannotBeMetIsNotMadeWorse) {
  Answerer answerer;
  ContactSystem system = BetweenWalls({});
  std::get<StraightEdge>(system.constraints[0].feature2) = {{-0.999, -1}, {-0.999, 1}};
  std::get<StraightEdge>(system.constraints[1].feature2) = {{0.998, 1}, {0.998, -1}};
  const double left = ProjectPositions(1e-12, answerer.Impulses(), &system);
  EXPECT_LE(left, 2e-3 + 1e-12);
  EXPECT_GE(left, 1.5e-3 - 1e-12);
}

}  // namespace
}  // namespace lcpbench
