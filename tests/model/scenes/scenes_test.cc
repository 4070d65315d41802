#include "model/scenes/scene.h"

#include <Eigen/Dense>

#include "model/contact/assembly.h"
#include "model/contact/world.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "tests/model/scenes/scene_checks.h"

namespace lcpbench {

namespace {

using lcpbench::testing::ContactsOfPairs;
using lcpbench::testing::kSceneSize;
using lcpbench::testing::ScaledEigenvalues;
using lcpbench::testing::SeparatingShare;
using lcpbench::testing::Solid;

class Scenes : public ::testing::TestWithParam<SceneFamily> {
 protected:
  static ContactSystem Generate(int rows, std::uint64_t seed) { return GetParam().generate(rows, seed); }
};

TEST_P(Scenes, GiveExactlyTheRowsAskedFor) {
  std::vector<int> sizes;
  for (int rows = 1; rows <= 80; ++rows) sizes.push_back(rows);
  for (const int rows : {127, 300, 1000, 1001, 1002, 1003, 4999}) sizes.push_back(rows);
  for (const int rows : sizes) {
    for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, 3ULL, 12345678901234567ULL, ~0ULL}) {
      if (rows > 1000 && seed > 0 && seed < ~0ULL) continue;
      const ContactSystem system = Generate(rows, seed);
      int count = 0;
      for (const Constraint& constraint : system.constraints) {
        count += constraint.type == ConstraintType::kPin ? 2 : 1;
      }
      ASSERT_EQ(count, rows) << system.name;
    }
    ASSERT_EQ(static_cast<int>(AssembleContactLcp(Generate(rows, 1)).rows.size()), rows);
  }
}

TEST_P(Scenes, AreTheSameBitsForTheSameSeedOnly) {
  for (const int rows : {1, 10, 333}) {
    const auto text = [&] { return FormatLcpRecord(AssembleContactLcp(Generate(rows, 7)).problem, true); };
    EXPECT_EQ(text(), text());
    EXPECT_NE(AssembleContactLcp(Generate(rows, 7)).problem.b(), AssembleContactLcp(Generate(rows, 8)).problem.b());
  }
}

TEST_P(Scenes, HaveLastingContactInEveryRow) {
  for (const int rows : {1, 2, 3, 5, 10, 11, 12, 40, 100, 1000, 10000}) {
    for (std::uint64_t seed = 1; seed <= (rows < 1000 ? 5 : 1); ++seed) {
      const ContactSystem system = Generate(rows, seed);
      double speed = 1;
      for (const Body& body : system.bodies) {
        const double spin = body.omega == 0 ? 0 : std::abs(body.omega) * Solid(body).reach();
        speed = std::max(speed, Norm(body.v) + spin);
      }
      for (const RowInfo& row : AssembleContactLcp(system).rows) {
        ASSERT_LE(std::abs(row.d), 1e-9 * kSceneSize) << system.name;
        ASSERT_LE(std::abs(row.d_dot), 1e-10 * speed) << system.name;
      }
    }
  }
}

// Deeper than polygons miss of round bodies; contact detection sees the rest.
TEST_P(Scenes, DoNotOverlap) {
  for (const int rows : {1, 2, 3, 4, 7, 12, 25, 60, 121}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const ContactSystem system = Generate(rows, seed);
      std::set<std::pair<int, int>> jointed;
      for (const Constraint& c : system.constraints) {
        if (c.type != ConstraintType::kContact) jointed.insert(std::minmax(c.body1, c.body2));
      }
      const std::vector<Solid> solids(system.bodies.begin(), system.bodies.end());
      for (std::size_t i = 0; i < solids.size(); ++i) {
        const Body& body = system.bodies[i];
        // Chains of fixed bodies bound nothing by themselves.
        if (body.fixed) continue;
        for (std::size_t j = 0; j < solids.size(); ++j) {
          const Body& other = system.bodies[j];
          // Bodies that share a joint do not touch: they may lie over each other.
          if (i == j || jointed.contains(std::minmax(static_cast<int>(i), static_cast<int>(j)))) continue;
          if (!other.fixed && Norm(body.x - other.x) > solids[i].reach() + solids[j].reach()) continue;
          for (const std::vector<Vec2>& polygon : solids[j].polygons()) {
            for (const Vec2 p : polygon) {
              ASSERT_FALSE(solids[i].ContainsAround(p, 0.1 * kSceneSize))
                  << system.name << ": " << other.name << " in " << body.name;
            }
          }
        }
      }
    }
  }
}

TEST_P(Scenes, ShowTheirListedContactsToDetection) {
  for (const int rows : {1, 2, 5, 12, 60, 301, 2000}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const ContactSystem system = Generate(rows, seed);
      const World world = WorldOf(system);
      // Less than what bodies that do not touch are apart; overlaps by up to half of the smallest body.
      const auto found = ContactFinder(world).Find(world.bodies, 0.5e-6 * kSceneSize, kSceneSize / 2);
      ASSERT_EQ(ContactsOfPairs(found), ContactsOfPairs(system.constraints)) << system.name;
    }
  }
}

std::vector<double> NumbersOf(const Body& body) {
  return {body.x.x, body.x.y, body.theta, body.v.x, body.v.y, body.omega, body.mass, body.inertia};
}

TEST_P(Scenes, StartAsWorldsOfTheSameBodies) {
  for (const int rows : {1, 2, 10, 150}) {
    const ContactSystem system = Generate(rows, 4);
    const World world = GetParam().start(rows, 4);
    const World again = GetParam().start(rows, 4);
    ASSERT_NO_THROW(RequireValid(world));
    ASSERT_EQ(world.bodies.size(), system.bodies.size());
    bool same_place = true;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      EXPECT_EQ(body.name, system.bodies[i].name);
      EXPECT_EQ(body.fixed, system.bodies[i].fixed);
      // Only the cradle starts with other balls than its single problems have: equal ones, as cradles are built.
      if (GetParam().key != "newtons-cradle") {
        EXPECT_EQ(body.mass, system.bodies[i].mass);
      }
      EXPECT_EQ(NumbersOf(body), NumbersOf(again.bodies[i])) << body.name;
      same_place = same_place && Norm(body.x - system.bodies[i].x) == 0 && body.theta == system.bodies[i].theta;
    }
    constexpr double kTolerance = 0.5e-6 * kSceneSize;
    const auto found = ContactFinder(world).Find(world.bodies, kTolerance, kTolerance);
    for (const RowInfo& row : AssembleContactLcp(InstantOf(world, found)).rows) {
      EXPECT_LE(std::abs(row.d), row.bilateral ? 1e-9 * kSceneSize : kTolerance);
    }
    if (same_place) {
      EXPECT_EQ(ContactsOfPairs(found), ContactsOfPairs(system.constraints)) << world.name;
    }
  }
}

TEST_P(Scenes, HaveSoundBodies) {
  for (const int rows : {1, 9, 200}) {
    const ContactSystem system = Generate(rows, 3);
    std::set<std::string> names;
    std::set<int> touching;
    for (const Constraint& c : system.constraints) {
      ASSERT_NE(c.body1, c.body2);
      touching.insert({c.body1, c.body2});
      ASSERT_FALSE(system.bodies[static_cast<std::size_t>(c.body1)].fixed &&
                   system.bodies[static_cast<std::size_t>(c.body2)].fixed);
    }
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
      const Body& body = system.bodies[i];
      EXPECT_TRUE(names.insert(body.name).second) << body.name;
      EXPECT_FALSE(body.outline.empty()) << body.name;
      if (body.fixed) continue;
      EXPECT_TRUE(touching.contains(static_cast<int>(i))) << body.name;
      EXPECT_GT(body.mass, 0);
      EXPECT_GT(body.inertia, 0);
      const Solid solid(body);
      EXPECT_LT(body.inertia, body.mass * solid.reach() * solid.reach()) << body.name << ": mass outside its outline";
      if (solid.polygons().size() == 1) {
        EXPECT_TRUE(solid.Contains(body.x)) << body.name << ": centre of mass outside its outline";
      }
      EXPECT_GT(Norm(body.force), 0);
    }
  }
}

TEST_P(Scenes, MixActiveAndSeparatingRows) {
  const auto solver = MakeSolver("dantzig");
  for (const int rows : {10, 30, 100, 300, 1000}) {
    for (std::uint64_t seed = 1; seed <= (rows < 1000 ? 5 : 1); ++seed) {
      const ContactSystem system = Generate(rows, seed);
      const double share = SeparatingShare(system, solver.get());
      EXPECT_GE(share, 0.05) << system.name;
      EXPECT_LE(share, 0.80) << system.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Scenes, ::testing::ValuesIn(AllScenes().begin(), AllScenes().end()),
                         [](const auto& of) { return lcpbench::testing::TestNameOf(of.param.key); });

// The shares of the rows that are independent, from and to.
TEST(SceneRanks, AreAsTheFamiliesSay) {
  constexpr double kZero = 1e-11;
  const std::pair<const char*, Range> shares[] = {{"discs-in-v", {0.5, 0.9}},
                                                  {"disc-pile", {1, 1}},
                                                  {"disc-track", {1, 1}},
                                                  {"boxes-and-discs", {0.5, 0.9}},
                                                  {"rockers", {1, 1}},
                                                  {"gear-train", {1, 1}},
                                                  {"cam-follower", {1, 1}},
                                                  {"newtons-cradle", {1, 1}},
                                                  {"chain-of-links", {1, 1}},
                                                  {"spinning-drum", {1, 1}},
                                                  {"oval-train", {1, 1}},
                                                  {"ovals-in-bowl", {1, 1}},
                                                  {"roller-bearing", {0.75, 0.9}},
                                                  {"rounded-wall", {0.45, 0.65}},
                                                  {"tall-stacks", {0.95, 0.995}},
                                                  {"billiards-break", {0.65, 0.8}}};
  ASSERT_EQ(std::size(shares), AllScenes().size());
  for (const auto& [key, share] : shares) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      // Mechanisms are farther from singular.
      const double zero = share.low == 1 ? 1e-10 : kZero;
      constexpr int kRows = 300;
      const Eigen::VectorXd values = ScaledEigenvalues(AssembleContactLcp(GenerateScene(key, kRows, seed)).problem);
      const auto rank = (values.array() > zero * values.maxCoeff()).count();
      EXPECT_GE(static_cast<double>(rank), share.low * kRows) << key;
      EXPECT_LE(static_cast<double>(rank), share.high * kRows) << key;
      if (std::string_view(key) == "tall-stacks") {
        EXPECT_GE(values.maxCoeff() / values[kRows - rank], 1e6);
      }
    }
  }
}

TEST(SceneTable, FindsByKeyAndRefusesTheRest) {
  std::set<std::string_view> keys;
  for (const SceneFamily& scene : AllScenes()) {
    EXPECT_TRUE(keys.insert(scene.key).second) << scene.key;
    EXPECT_EQ(scene.key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string_view::npos);
    EXPECT_EQ(FindScene(scene.key).make, scene.make);
    EXPECT_FALSE(scene.title.empty());
    EXPECT_FALSE(scene.purpose.empty());
    EXPECT_THROW(GenerateScene(scene.key, 0, 1), InputError);
    EXPECT_THROW(GenerateScene(scene.key, -5, 1), InputError);
  }
  EXPECT_THROW(FindScene("no-such-scene"), InputError);
}

// Reference values of SplitMix64, seed 1234567 [Vigna's public-domain reference program].
TEST(SceneRandom, IsSplitMix64) {
  Random random(1234567);
  EXPECT_EQ(random.Bits(), 6457827717110365317ULL);
  EXPECT_EQ(random.Bits(), 3203168211198807973ULL);
  EXPECT_EQ(random.Bits(), 9817491932198370423ULL);
  double sum = 0;
  for (int k = 0; k < 10000; ++k) {
    const double u = random.Uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    sum += u;
    ASSERT_LE(Norm(random.InUnitDisc()), 1);
    ASSERT_NEAR(Norm(random.UnitVector()), 1, 1e-15);
  }
  EXPECT_NEAR(sum / 10000, 0.5, 0.02);
}

// Scaled or kept, velocities that hold every contact hold it still.
TEST(SceneStarts, KeepEveryContactWhereTheProblemDoes) {
  for (const char* key : {"disc-track", "rockers"}) {
    for (const int rows : {1, 12, 60}) {
      const World world = StartScene(key, rows, 2);
      const auto found = ContactFinder(world).Find(world.bodies, 1e-8, 1e-8);
      EXPECT_EQ(found.size(), static_cast<std::size_t>(rows));
      double speed = 0;
      for (const Body& body : world.bodies) speed = std::max(speed, Norm(body.v));
      EXPECT_GT(speed, 0.01);
      for (const RowInfo& row : AssembleContactLcp(InstantOf(world, found)).rows) {
        EXPECT_LE(std::abs(row.d_dot), 1e-10 * std::max(speed, 1.0)) << key;
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench
