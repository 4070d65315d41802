#include "model/scenes/scene.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/world.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "tests/model/scene_checks.h"

namespace lcpbench {

/// The key alone: test listings would show raw bytes.
static void PrintTo(const SceneFamily& scene, std::ostream* out) { *out << scene.key; }

namespace {

using lcpbench::testing::ContactsOfPairs;
using lcpbench::testing::HashOf;
using lcpbench::testing::kSceneSize;
using lcpbench::testing::Solid;

class Scenes : public ::testing::TestWithParam<SceneFamily> {
 protected:
  static ContactSystem Generate(int rows, std::uint64_t seed) { return GetParam().generate(rows, seed); }
};

std::string ParamName(const ::testing::TestParamInfo<SceneFamily>& info) {
  std::string name(info.param.key);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

TEST_P(Scenes, GiveExactlyTheRowsAskedFor) {
  std::vector<int> sizes;
  for (int rows = 1; rows <= 80; ++rows) sizes.push_back(rows);
  for (const int rows : {127, 300, 1000, 1001, 1002, 1003, 4999}) sizes.push_back(rows);
  for (const int rows : sizes) {
    for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, 3ULL, 12345678901234567ULL, ~0ULL}) {
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
    const AssembledLcp first = AssembleContactLcp(Generate(rows, 7));
    const AssembledLcp again = AssembleContactLcp(Generate(rows, 7));
    const AssembledLcp other = AssembleContactLcp(Generate(rows, 8));
    for (Index i = 0; i < rows; ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(first.problem.b()[i]), std::bit_cast<std::uint64_t>(again.problem.b()[i]));
    }
    ASSERT_EQ(first.problem.J().nonZeros(), again.problem.J().nonZeros());
    for (Index k = 0; k < first.problem.J().nonZeros(); ++k) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(first.problem.J().valuePtr()[k]),
                std::bit_cast<std::uint64_t>(again.problem.J().valuePtr()[k]));
    }
    EXPECT_NE(first.problem.b(), other.problem.b());
  }
}

TEST_P(Scenes, HaveLastingContactInEveryRow) {
  for (const int rows : {1, 2, 3, 5, 10, 11, 12, 40, 100, 1000, 10000}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
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

TEST_P(Scenes, DoNotOverlapAndTouchOnlyWhereListed) {
  for (const int rows : {1, 2, 3, 4, 7, 12, 25, 60, 121}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const ContactSystem system = Generate(rows, seed);
      std::set<std::pair<int, int>> listed;
      std::set<std::pair<int, int>> jointed;
      for (const Constraint& c : system.constraints) {
        (c.type == ConstraintType::kContact ? listed : jointed).insert(std::minmax(c.body1, c.body2));
      }
      std::vector<Solid> solids;
      for (const Body& body : system.bodies) solids.emplace_back(body);
      const int count = static_cast<int>(system.bodies.size());
      for (int i = 0; i < count; ++i) {
        const Body& body = system.bodies[static_cast<std::size_t>(i)];
        const std::vector<Vec2> points = solids[static_cast<std::size_t>(i)].Points();
        for (int j = 0; j < count; ++j) {
          const Body& other = system.bodies[static_cast<std::size_t>(j)];
          // Bodies that share a joint do not touch: they may lie over each other.
          if (i == j || jointed.contains(std::minmax(i, j)) || (body.fixed && other.fixed)) continue;
          const Solid& solid = solids[static_cast<std::size_t>(j)];
          const bool touching = listed.contains(std::minmax(i, j));
          if (!other.fixed && !touching &&
              Norm(body.x - other.x) > solids[static_cast<std::size_t>(i)].reach() + solid.reach() + kSceneSize) {
            continue;
          }
          const double allowed = touching ? 1e-9 * kSceneSize : -1e-6 * kSceneSize;
          for (const Vec2 p : points) {
            ASSERT_LE(solid.Depth(p), allowed) << system.name << ": " << body.name << " in " << other.name;
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
      // Less than what bodies that do not touch are apart.
      constexpr double kTolerance = 0.5e-6 * kSceneSize;
      const auto found = ContactFinder(world).Find(world.bodies, kTolerance, kTolerance);
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
      if (!solid.has_hole()) {
        EXPECT_GT(solid.Depth(body.x), 0) << body.name << ": centre of mass outside its outline";
      }
      EXPECT_GT(Norm(body.force), 0);
    }
  }
}

// "Unilateral rows with w > 0" are counted where w_i / sqrt(A_ii) is above 1e-7 of its root mean square at zero force.
TEST_P(Scenes, MixActiveAndSeparatingRows) {
  const auto solver = MakeSolver("dantzig");
  for (const int rows : {10, 30, 100, 300, 1000}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const ContactSystem system = Generate(rows, seed);
      const AssembledLcp lcp = AssembleContactLcp(system);
      const LcpProblem& problem = lcp.problem;
      LcpResult result;
      solver->Solve(problem, {}, &result);
      const Verdict verdict = Verify(problem, result, 1e-9);
      ASSERT_TRUE(verdict.passes) << system.name << ": " << result.detail << ' ' << verdict.reason;
      const Eigen::ArrayXd root = problem.DiagonalA().array().sqrt();
      const double scale = (problem.b().array() / root).matrix().norm() / std::sqrt(rows);
      int unilateral = 0;
      int separating = 0;
      for (Index i = 0; i < rows; ++i) {
        if (lcp.rows[static_cast<std::size_t>(i)].bilateral) continue;
        ++unilateral;
        if (verdict.metrics.w[i] / root[i] > 1e-7 * scale) ++separating;
      }
      EXPECT_GE(separating, 0.05 * unilateral) << system.name;
      EXPECT_LE(separating, 0.80 * unilateral) << system.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Scenes, ::testing::ValuesIn(AllScenes().begin(), AllScenes().end()), ParamName);

Index RankOf(const LcpProblem& problem) {
  const Eigen::VectorXd values = lcpbench::testing::ScaledEigenvalues(problem);
  return (values.array() > 1e-11 * values.maxCoeff()).count();
}

TEST(SceneRanks, AreFullWhereContactsAreIsostaticAndDeficientInStacks) {
  for (const int rows : {40, 200}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      for (const char* key : {"disc-pile", "disc-track", "rockers"}) {
        EXPECT_EQ(RankOf(AssembleContactLcp(GenerateScene(key, rows, seed)).problem), rows) << key;
      }
      for (const char* key : {"discs-in-v", "boxes-and-discs"}) {
        EXPECT_LE(static_cast<double>(RankOf(AssembleContactLcp(GenerateScene(key, rows, seed)).problem)), 0.9 * rows)
            << key;
      }
    }
  }
}

TEST(DiscPile, HasNoOverlapWhateverTheSeed) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const ContactSystem system = GenerateScene("disc-pile", 601, seed);
    const double right = std::get<StraightEdge>(system.bodies[0].outline[0].edge).a.x;
    std::set<std::pair<int, int>> listed;
    for (const Constraint& c : system.constraints) listed.insert(std::minmax(c.body1, c.body2));
    const auto radius = [](const Body& body) { return std::get<ArcEdge>(body.outline[0].edge).radius; };
    for (std::size_t i = 1; i < system.bodies.size(); ++i) {
      const Body& body = system.bodies[i];
      const double r = radius(body);
      ASSERT_GE(std::min({body.x.x, right - body.x.x, body.x.y}), r * (1 - 1e-12)) << system.name;
      for (std::size_t j = 1; j < i; ++j) {
        const Body& other = system.bodies[j];
        const bool touching = listed.contains({static_cast<int>(j), static_cast<int>(i)});
        const double gap = Norm(body.x - other.x) - r - radius(other);
        ASSERT_GE(gap, touching ? -1e-14 : 1e-9) << system.name;
      }
    }
  }
}

TEST(SceneCurvature, EntersBWhereBodiesMove) {
  for (const char* key : {"disc-track", "rockers"}) {
    const AssembledLcp lcp = AssembleContactLcp(GenerateScene(key, 200, 1));
    const auto curved = std::count_if(lcp.rows.begin(), lcp.rows.end(),
                                      [](const RowInfo& row) { return std::abs(row.gamma) > 1e-3 * kGravity; });
    EXPECT_GE(curved, 100) << key;
  }
}

// The bits are the same whatever the compiler's flags: these hashes were made by the release build and hold under the
// sanitizers as well. They change only when a family is changed on purpose.
TEST(SceneBits, AreTheSameInEveryBuild) {
  constexpr std::pair<const char*, std::uint64_t> kHashes[] = {
      {"discs-in-v", 0x1fa96ae0ff329304U},     {"disc-pile", 0x964df322121427d4U},
      {"disc-track", 0x746837131367549dU},     {"boxes-and-discs", 0x782512c0e1e6ed53U},
      {"rockers", 0x866c51ff35fd232dU},        {"gear-train", 0xf2575fbc4f9fdf69U},
      {"cam-follower", 0x6c1283daf4c1348eU},   {"newtons-cradle", 0x7a44b5a50bd63deeU},
      {"chain-of-links", 0x37e32774ea00c571U}, {"spinning-drum", 0x2ad60bd510411c12U},
      {"oval-train", 0xf7b261fde833db2fU},     {"ovals-in-bowl", 0x38eb736fa9b35dfeU},
      {"roller-bearing", 0xe1f331c3999e1155U}, {"rounded-wall", 0x46a1ad4bae996c12U},
      {"tall-stacks", 0xc6580d27ae6c7df6U},    {"billiards-break", 0xa4f31903312b05bfU},
  };
  for (const auto& [key, expected] : kHashes) {
    const std::uint64_t hash = HashOf(GenerateScene(key, 60, 5));
    EXPECT_EQ(hash, expected) << key << ": 0x" << std::hex << hash;
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

TEST(SceneParts, HaveTheMassAndInertiaOfPlates) {
  const Body disc = MakeDisc({1, 2}, 0.3, 5);
  EXPECT_DOUBLE_EQ(disc.mass, kPi * 0.09 * 5);
  EXPECT_DOUBLE_EQ(disc.inertia, disc.mass * 0.09 / 2);
  const Body box = MakeBox({1, 2}, 0.4, 0.3, 5);
  EXPECT_DOUBLE_EQ(box.mass, 0.6);
  EXPECT_DOUBLE_EQ(box.inertia, 0.6 * 0.25 / 12);
}

}  // namespace
}  // namespace lcpbench
