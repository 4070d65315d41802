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
#include <utility>
#include <variant>
#include <vector>

#include "model/assembly.h"
#include "model/scenes/parts.h"
#include "model/scenes/picture.h"
#include "model/scenes/random.h"
#include "model/trig.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/json_lines.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {

/// The key alone: test listings would show raw bytes.
static void PrintTo(const SceneFamily& scene, std::ostream* out) { *out << scene.key; }

namespace {

/// The smallest radius or half-width of any body in any family [m]: what gaps are compared with.
constexpr double kSize = 0.02;

class Scenes : public testing::TestWithParam<SceneFamily> {
 protected:
  static ContactSystem Generate(int rows, std::uint64_t seed) { return GetParam().generate(rows, seed); }
};

std::string ParamName(const testing::TestParamInfo<SceneFamily>& info) {
  std::string name(info.param.key);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

Vec2 ToWorld(const Body& body, Vec2 p) { return body.x + Rotate(SinCos(body.theta), p); }

/// World points along a body's outline, ends of pieces included.
std::vector<Vec2> OutlinePoints(const Body& body) {
  constexpr int kSamples = 120;
  std::vector<Vec2> points;
  for (const OutlineEdge& piece : body.outline) {
    for (int k = 0; k <= kSamples; ++k) {
      const double s = piece.s_begin + (piece.s_end - piece.s_begin) * k / kSamples;
      if (const auto* line = std::get_if<StraightEdge>(&piece.edge)) {
        points.push_back(ToWorld(body, line->a + s * (line->b - line->a)));
      } else {
        const auto& arc = std::get<ArcEdge>(piece.edge);
        const Rotation direction = SinCos(s);
        points.push_back(ToWorld(body, arc.center + arc.radius * Vec2{direction.cos, direction.sin}));
      }
    }
  }
  return points;
}

/// How far inside an outline piece's material side the world point p lies.
double DepthBehind(const Body& body, const OutlineEdge& piece, Vec2 p) {
  if (const auto* line = std::get_if<StraightEdge>(&piece.edge)) {
    const Vec2 a = ToWorld(body, line->a);
    const Vec2 along = ToWorld(body, line->b) - a;
    return Cross(along, p - a) / Norm(along);
  }
  const auto& arc = std::get<ArcEdge>(piece.edge);
  const double inside = arc.radius - Norm(p - ToWorld(body, arc.center));
  return arc.side == Side::kConvex ? inside : -inside;
}

/// How deep p lies inside the body. Movable bodies of the scenes are convex, an intersection of discs and half-planes;
/// a fixed body's material is the union of what lies behind its edges.
double Depth(const Body& body, Vec2 p) {
  double depth = body.fixed ? -1e300 : 1e300;
  for (const OutlineEdge& piece : body.outline) {
    const double behind = DepthBehind(body, piece, p);
    depth = body.fixed ? std::max(depth, behind) : std::min(depth, behind);
  }
  return depth;
}

TEST_P(Scenes, GiveExactlyTheRowsAskedFor) {
  std::vector<int> sizes;
  for (int rows = 1; rows <= 80; ++rows) sizes.push_back(rows);
  for (const int rows : {127, 300, 1000, 1001, 1002, 1003, 4999}) sizes.push_back(rows);
  for (const int rows : sizes) {
    for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, 3ULL, 12345678901234567ULL, ~0ULL}) {
      const ContactSystem system = Generate(rows, seed);
      ASSERT_EQ(static_cast<int>(system.constraints.size()), rows) << system.name;
      for (const Constraint& constraint : system.constraints) {
        ASSERT_EQ(constraint.type, ConstraintType::kContact) << system.name;
      }
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
  for (const int rows : {1, 2, 3, 5, 10, 40, 100, 1000, 10000}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const ContactSystem system = Generate(rows, seed);
      double speed = 1;
      for (const Body& body : system.bodies) speed = std::max(speed, Norm(body.v));
      for (const RowInfo& row : AssembleContactLcp(system).rows) {
        ASSERT_LE(std::abs(row.d), 1e-9 * kSize) << system.name;
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
      for (const Constraint& c : system.constraints) listed.insert(std::minmax(c.body1, c.body2));
      std::vector<std::vector<Vec2>> points;
      for (const Body& body : system.bodies) points.push_back(OutlinePoints(body));
      const int count = static_cast<int>(system.bodies.size());
      for (int i = 0; i < count; ++i) {
        const Body& body = system.bodies[static_cast<std::size_t>(i)];
        if (body.fixed) continue;
        for (int j = 0; j < count; ++j) {
          if (i == j) continue;
          const Body& other = system.bodies[static_cast<std::size_t>(j)];
          const double allowed = listed.contains(std::minmax(i, j)) ? 1e-9 * kSize : -1e-6 * kSize;
          for (const Vec2 p : points[static_cast<std::size_t>(i)]) {
            ASSERT_LE(Depth(other, p), allowed) << system.name << ": " << body.name << " in " << other.name;
          }
        }
      }
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
      double reach = 0;
      for (const Vec2 p : OutlinePoints(body)) reach = std::max(reach, Norm(p - body.x));
      EXPECT_LT(body.inertia, body.mass * reach * reach) << body.name << ": mass outside its outline";
      EXPECT_GT(Depth(body, body.x), 0) << body.name << ": centre of mass outside its outline";
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
      const LcpProblem problem = AssembleContactLcp(system).problem;
      LcpResult result;
      solver->Solve(problem, {}, &result);
      const Verdict verdict = Verify(problem, result, 1e-9);
      ASSERT_TRUE(verdict.passes) << system.name << ": " << result.detail << ' ' << verdict.reason;
      const Eigen::ArrayXd root = problem.DiagonalA().array().sqrt();
      const double scale = (problem.b().array() / root).matrix().norm() / std::sqrt(rows);
      const auto separating = (verdict.metrics.w.array() / root > 1e-7 * scale).count();
      EXPECT_GE(separating, 0.05 * rows) << system.name;
      EXPECT_LE(separating, 0.80 * rows) << system.name;
    }
  }
}

TEST_P(Scenes, DrawEveryBodyInWellFormedSvg) {
  for (const int rows : {1, 12, 150, 400}) {
    const ContactSystem system = Generate(rows, 2);
    const AssembledLcp lcp = AssembleContactLcp(system);
    const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(rows, 0, 1);
    const Eigen::VectorXd w = Eigen::VectorXd::Zero(rows);
    for (const bool solved : {false, true}) {
      const std::string svg = RenderSvg(system, lcp, solved ? &f : nullptr, solved ? &w : nullptr);
      // Every '<' opens a tag, a closing tag matches the last open one, and none stays open.
      std::vector<std::string> open;
      for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
        const std::size_t end = svg.find('>', at);
        ASSERT_NE(end, std::string::npos);
        const std::string tag = svg.substr(at + 1, end - at - 1);
        ASSERT_EQ(tag.find('<'), std::string::npos) << tag;
        ASSERT_EQ(std::count(tag.begin(), tag.end(), '"') % 2, 0) << tag;
        const std::string name = tag.substr(0, tag.find(' '));
        if (tag.front() == '/') {
          ASSERT_FALSE(open.empty());
          ASSERT_EQ(open.back(), name.substr(1));
          open.pop_back();
        } else if (tag.back() != '/') {
          open.push_back(name);
        }
      }
      EXPECT_TRUE(open.empty());
      EXPECT_EQ(svg.find("nan"), std::string::npos);
      EXPECT_EQ(svg.find("inf"), std::string::npos);
      for (const Body& body : system.bodies) {
        EXPECT_NE(svg.find("<title>" + body.name + ","), std::string::npos) << body.name;
      }
    }
    const Eigen::VectorXd wrong = Eigen::VectorXd::Zero(rows + 1);
    EXPECT_THROW(RenderSvg(system, lcp, &wrong, nullptr), InputError);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Scenes, testing::ValuesIn(AllScenes().begin(), AllScenes().end()), ParamName);

/// Rank of the Jacobi-scaled A.
Index RankOf(const LcpProblem& problem) {
  const Eigen::VectorXd root = problem.DiagonalA().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = root.asDiagonal() * problem.DenseA() * root.asDiagonal();
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
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
      {"discs-in-v", 0x1fa96ae0ff329304U},      {"disc-pile", 0x964df322121427d4U}, {"disc-track", 0x746837131367549dU},
      {"boxes-and-discs", 0x782512c0e1e6ed53U}, {"rockers", 0x866c51ff35fd232dU},
  };
  for (const auto& [key, expected] : kHashes) {
    // FNV-1a over the problem's text, whose numbers read back to the same doubles.
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : FormatLcpRecord(AssembleContactLcp(GenerateScene(key, 60, 5)).problem, true)) {
      hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    EXPECT_EQ(hash, expected) << key << ": 0x" << std::hex << hash;
  }
}

TEST(SceneTable, FindsByKeyAndRefusesTheRest) {
  EXPECT_EQ(AllScenes().size(), 5U);
  for (const SceneFamily& scene : AllScenes()) {
    EXPECT_EQ(FindScene(scene.key).generate, scene.generate);
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
