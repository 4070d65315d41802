#include "model/contact/contact_travel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "model/contact/contact_row.h"
#include "model/geometry/trig.h"
#include "support/input_error.h"
#include "tests/model/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kCases = 60;

// The bodies after time t at constant velocities.
ContactCase After(const ContactCase& c, double t) {
  ContactCase moved = c;
  for (Body* body : {&moved.body1, &moved.body2}) {
    body->x = body->x + t * body->v;
    body->theta += t * body->omega;
  }
  return moved;
}

class EveryTravel : public ::testing::TestWithParam<PairKind> {};

TEST_P(EveryTravel, SpeedsAreThoseOfTheClosestPointsInTheirBodies) {
  Random random(1);
  for (int i = 0; i < kCases; ++i) {
    const ContactCase c = RandomContact(GetParam(), &random);
    const ClosestPoints p = c.Closest();
    const double h = 1e-5;
    const ContactCase next = After(c, h);
    const ContactCase last = After(c, -h);
    const ClosestPoints q = next.Closest();
    const ClosestPoints o = last.Closest();
    // Fixed in the body, the velocity of the contact point is that of its coordinates there.
    const auto speed = [&](const Body& body, const Body& after, Vec2 R_after, const Body& before, Vec2 R_before) {
      const Vec2 velocity = (1 / (2 * h)) * (ToBody(after, after.x + R_after) - ToBody(before, before.x + R_before));
      return Dot(Perp(p.n), Rotate(SinCos(body.theta), velocity));
    };
    const ContactTravel travel = ComputeContactTravel(p, c.body1, c.body2);
    const double sigma1 = speed(c.body1, next.body1, q.R1, last.body1, o.R1);
    const double sigma2 = speed(c.body2, next.body2, q.R2, last.body2, o.R2);
    EXPECT_NEAR(travel.sigma_dot1, sigma1, 1e-5 * (1 + std::abs(sigma1)));
    EXPECT_NEAR(travel.sigma_dot2, sigma2, 1e-5 * (1 + std::abs(sigma2)));
  }
}

INSTANTIATE_TEST_SUITE_P(Law, EveryTravel, ::testing::ValuesIn(AllPairKinds()),
                         [](const auto& kind) { return kind.param.name; });

// Body 2 is an outline of two arcs, or of an arc and a straight edge, that join at p2 with the normal n.
struct Join {
  ContactCase along;    // with the edge on the side of +t
  ContactCase against;  // with the edge on the side of -t
  JoinCurvatures curvatures;
};

double KappaOf(Shape shape, double radius) {
  if (shape == Shape::kStraight) return 0;
  return shape == Shape::kConvexArc ? 1 / radius : -1 / radius;
}

Join RandomJoin(Shape shape1, Shape along, Shape against, Random* random) {
  Join join;
  join.along = RandomContact({"", shape1, along}, random->Uniform(-0.1, 0.1), random);
  join.against = join.along;
  const double radius_along = random->Uniform(1.5, 4);
  const double radius_against = random->Uniform(1.5, 4);
  const ContactCase& c = join.along;
  join.along.feature2 = FeatureThrough(along, c.body2, c.p2, c.n, radius_along, random);
  join.against.feature2 = FeatureThrough(against, c.body2, c.p2, c.n, radius_against, random);
  join.curvatures = {KappaOf(along, radius_along), KappaOf(against, radius_against)};
  return join;
}

// After a short time the closest points are on the edge they moved into; there the gap's second derivative is that of
// this edge alone. Before, it was the other's.
TEST(OneSidedCurvature, GivesTheSecondDerivativeOfTheGapToTheWholeOutline) {
  Random random(2);
  const std::vector<std::pair<Shape, Shape>> joins = {{Shape::kConvexArc, Shape::kStraight},
                                                      {Shape::kStraight, Shape::kConvexArc},
                                                      {Shape::kConvexArc, Shape::kConvexArc},
                                                      {Shape::kConcaveArc, Shape::kStraight},
                                                      {Shape::kConcaveArc, Shape::kConvexArc}};
  int moved_along = 0;
  int moved_against = 0;
  for (const Shape shape1 : {Shape::kVertex, Shape::kConvexArc, Shape::kConvexEllipse}) {
    for (const auto& [along, against] : joins) {
      for (int i = 0; i < kCases; ++i) {
        const Join join = RandomJoin(shape1, along, against, &random);
        const ClosestPoints at = join.along.Closest();
        const Body& body1 = join.along.body1;
        const Body& body2 = join.along.body2;
        const ClosestPoints one_sided = WithOneSidedCurvature(at, {}, join.curvatures, body1, body2);
        if (std::abs(ComputeContactTravel(one_sided, body1, body2).sigma_dot2) < 0.1) continue;
        // The whole outline's gap a little later: which edge the closest point is on, found by where the edges' own
        // closest points have got to along t.
        const double t = 1e-4;
        const ContactCase along_later = After(join.along, t);
        const ContactCase against_later = After(join.against, t);
        const auto travelled = [&](const ContactCase& later) {
          const Vec2 step = ToBody(later.body2, later.body2.x + later.Closest().R2) - ToBody(body2, join.along.p2);
          return Dot(Perp(at.n), Rotate(SinCos(body2.theta), step));
        };
        const bool on_along = travelled(along_later) > 0;
        ASSERT_EQ(on_along, travelled(against_later) > 0) << "one edge, and one only, holds the closest point";
        EXPECT_EQ(one_sided.curvature2.s, on_along ? join.curvatures.along_t : join.curvatures.against_t);
        const ContactCase& later = on_along ? along_later : against_later;
        const ClosestPoints own = (on_along ? join.along : join.against).Closest();
        const double gamma = ComputeContactRow(one_sided, body1, body2).gamma;
        const double own_gamma = ComputeContactRow(own, body1, body2).gamma;
        EXPECT_NEAR(gamma, own_gamma, 1e-10 * (1 + std::abs(own_gamma)));
        // d(t) = d + d' t + d'' t^2/2 + O(t^3), of the edge that the outline consists of there.
        const double d_dot = ComputeContactRow(own, body1, body2).d_dot;
        const double d_ddot = 2 * (later.Closest().d - own.d - t * d_dot) / (t * t);
        EXPECT_NEAR(d_ddot, gamma, 0.05 * (1 + std::abs(gamma)));
        ++(on_along ? moved_along : moved_against);
      }
    }
  }
  EXPECT_GT(moved_along, 100);
  EXPECT_GT(moved_against, 100);
}

TEST(OneSidedCurvature, SwappingBodiesSwapsTheChoice) {
  Random random(3);
  for (int i = 0; i < kCases; ++i) {
    const ContactCase c = RandomContact(ClosedPairKinds()[4], &random);
    const ContactCase swapped = c.Swapped();
    const JoinCurvatures join = {random.Uniform(0.1, 2), random.Uniform(0.1, 2)};
    const ClosestPoints p = WithOneSidedCurvature(c.Closest(), {}, join, c.body1, c.body2);
    // t turns round with n.
    const ClosestPoints q = WithOneSidedCurvature(swapped.Closest(), JoinCurvatures{join.against_t, join.along_t}, {},
                                                  swapped.body1, swapped.body2);
    EXPECT_EQ(p.curvature2.s, q.curvature1.s);
  }
}

TEST(OneSidedCurvature, RestingPointGivesOneAndTheSameAcceleration) {
  Random random(4);
  for (int i = 0; i < kCases; ++i) {
    ContactCase c = RandomContact(ClosedPairKinds()[4], &random);
    // The closest point rests on body 2 if body 1 turns with it about the same instantaneous motion.
    c.body1.omega = c.body2.omega;
    c.body1.v = c.body2.v + c.body2.omega * Perp(c.body1.x - c.body2.x);
    ClosestPoints p = c.Closest();
    EXPECT_NEAR(ComputeContactTravel(p, c.body1, c.body2).sigma_dot2, 0, 1e-13);
    const double gamma = ComputeContactRow(p, c.body1, c.body2).gamma;
    p.curvature2.s *= 3;
    EXPECT_NEAR(ComputeContactRow(p, c.body1, c.body2).gamma, gamma, 1e-12 * (1 + std::abs(gamma)));
  }
}

TEST(OneSidedCurvature, TwoJoinsHaveOneConsistentChoice) {
  Random random(5);
  for (int i = 0; i < 20 * kCases; ++i) {
    const ContactCase c = RandomContact(ClosedPairKinds()[4], &random);
    const JoinCurvatures join1 = {random.Uniform(0, 2), random.Uniform(0, 2)};
    const JoinCurvatures join2 = {random.Uniform(0.1, 2), random.Uniform(0.1, 2)};
    const ClosestPoints closest = c.Closest();
    int consistent = 0;
    for (const double kappa1 : {join1.along_t, join1.against_t}) {
      for (const double kappa2 : {join2.along_t, join2.against_t}) {
        ClosestPoints p = closest;
        p.curvature1.s = kappa1;
        p.curvature2.s = kappa2;
        const ContactTravel travel = ComputeContactTravel(p, c.body1, c.body2);
        if ((travel.sigma_dot1 > 0) != (kappa1 == join1.along_t)) continue;
        if ((travel.sigma_dot2 > 0) != (kappa2 == join2.along_t)) continue;
        ++consistent;
        const ClosestPoints chosen = WithOneSidedCurvature(closest, join1, join2, c.body1, c.body2);
        EXPECT_EQ(chosen.curvature1.s, kappa1);
        EXPECT_EQ(chosen.curvature2.s, kappa2);
      }
    }
    EXPECT_EQ(consistent, 1);
  }
}

TEST(OneSidedCurvature, RefusesVerticesAndJoinsThatAreNoContactOnEitherSide) {
  Random random(6);
  const ContactCase vertex = RandomContact(ClosedPairKinds()[1], &random);
  EXPECT_THROW(WithOneSidedCurvature(vertex.Closest(), JoinCurvatures{1, 2}, {}, vertex.body1, vertex.body2),
               InputError);
  const ContactCase arcs = RandomContact(ClosedPairKinds()[4], 0, &random);
  EXPECT_THROW(WithOneSidedCurvature(arcs.Closest(), {}, JoinCurvatures{-50, -50}, arcs.body1, arcs.body2), InputError);
}

}  // namespace
}  // namespace lcpbench::testing
