#include "model/detection/narrow_phase.h"

#include "model/shape/shapes.h"
#include "tests/model/detection/gap_sampling.h"
#include "tests/support/cases.h"

namespace lcpbench {
namespace {

using namespace testing;

// Configurations of each ordered pair of kinds beside each other, and as many of one inside the other: so that every
// pair of kinds, of equal ones too, gets at least twice as many. `make test-long` has 200; the comparison of 10^4 and
// more per pair takes LCPBENCH_DETECTION_CASES=5500.
int CasesPerPair() { return Cases("LCPBENCH_DETECTION_CASES", 50); }

struct Tally {
  int configurations = 0;
  int overlapping = 0;  // left out
  int minima = 0;
  int undecided = 0;  // descents that did not converge
};

// Two outlines that keep apart: one beside the other, or one inside the other's boundary.
struct Configuration {
  Outline outline1;
  Outline outline2;
  Pose pose1;
  Pose pose2;
  double reach = 0;
};

constexpr int kSamplesOfLoop = 320;

SampledLoop Sampled(const Outline& outline, const Pose& pose) {
  const OutlineLoop& loop = outline.loops[0];
  return {loop, pose, kSamplesOfLoop / static_cast<int>(loop.size())};
}

// Moves body 2 along a direction until the outlines are `gap` apart: never by more than the distance that is left.
void Approach(Configuration* c, Vec2 direction, double gap) {
  const SampledLoop loop1 = Sampled(c->outline1, c->pose1);
  SampledLoop loop2 = Sampled(c->outline2, c->pose2);
  constexpr int kMostMoves = 200;
  for (int i = 0; i < kMostMoves; ++i) {
    const double left = SmallestDistance(loop1, loop2) - gap;
    if (left < 0.1 * gap) break;
    loop2.Move(left * direction);
  }
  c->pose2 = loop2.pose();
}

Configuration RandomConfiguration(EdgeKind kind1, EdgeKind kind2, bool inside, Random* random) {
  Configuration c;
  c.outline1 = {"first", {RandomLoopOfKind(kind1, inside ? 2.0 : 1.0, !inside, random)}};
  c.outline2 = {"second", {RandomLoopOfKind(kind2, inside ? random->Uniform(0.2, 0.6) : 1.0, true, random)}};
  c.pose1 = {random->Vector(3), random->Uniform(-3, 3)};
  const Vec2 direction = UnitVector(random->Uniform(-3.14, 3.14));
  c.pose2 = {c.pose1.x - (inside ? 0.0 : 4.0) * direction, random->Uniform(-3, 3)};
  const double gap = 0.02 * random->Uniform(0.2, 1);
  c.reach = random->Uniform(0.02, 0.4);
  Approach(&c, direction, gap);
  return c;
}

class Comparison {
 public:
  Comparison(const Configuration& c, std::string name)
      : c_(c), name_(std::move(name)), loop1_(Sampled(c.outline1, c.pose1)), loop2_(Sampled(c.outline2, c.pose2)) {}

  void Run(Tally* tally) {
    const PlacedOutline placed1 = PlaceOutline(c_.outline1, c_.pose1.x, c_.pose1.theta);
    const PlacedOutline placed2 = PlaceOutline(c_.outline2, c_.pose2.x, c_.pose2.theta);
    std::vector<GapMinimum> detected;
    try {
      detected = FindGapMinima(placed1, placed2, {c_.reach, 0});
    } catch (const InputError& error) {
      ADD_FAILURE() << name_ << ": " << error.what();
      return;
    }
    const std::vector<SampledMinimum> sampled = SampledMinima(loop1_, loop2_, c_.reach, &tally->undecided);
    ++tally->configurations;
    // Sharp bends between samples can have let the outlines overlap, where distances are no gaps.
    constexpr double kOverlap = 1e-9;
    if (std::any_of(sampled.begin(), sampled.end(), [](const SampledMinimum& m) { return m.d < kOverlap; })) {
      ++tally->overlapping;
      return;
    }
    std::vector<bool> used(detected.size(), false);
    for (const SampledMinimum& m : sampled) {
      if (m.at_vertex1 && m.at_vertex2) continue;
      // On the edge of the range rounding decides.
      if (m.d > c_.reach * (1 - 1e-9)) continue;
      ++tally->minima;
      bool found = false;
      for (std::size_t k = 0; k < detected.size(); ++k) {
        const ClosestPoints& closest = detected[k].closest;
        if (detected[k].is_flush_end) continue;
        if (!IsSame(m, c_.pose1.x + closest.R1, c_.pose2.x + closest.R2, kSamePlace)) continue;
        EXPECT_FALSE(found) << name_ << ": reported twice";
        found = true;
        used[k] = true;
        EXPECT_LE(std::abs(closest.d - m.d), 1e-9) << name_;
      }
      EXPECT_TRUE(found) << name_ << ": missed d = " << m.d << " at (" << m.p1.x << ", " << m.p1.y << "), vertices "
                         << m.at_vertex1 << m.at_vertex2 << ", reach " << c_.reach;
    }
    for (std::size_t k = 0; k < detected.size(); ++k) {
      EXPECT_LE(detected[k].closest.d, c_.reach) << name_;
      for (std::size_t i = 0; i < k; ++i)
        EXPECT_FALSE(AreSame(detected[i], detected[k])) << name_ << ": reported twice";
      if (used[k] || detected[k].is_flush_end || detected[k].closest.d > c_.reach * (1 - 1e-9)) continue;
      EXPECT_TRUE(IsMinimum(detected[k].closest))
          << name_ << ": spurious d = " << detected[k].closest.d << ", D = " << detected[k].closest.D();
    }
  }

 private:
  static constexpr double kSamePlace = 1e-5;

  static bool AreSame(const GapMinimum& a, const GapMinimum& b) {
    return Norm(a.closest.R1 - b.closest.R1) + Norm(a.closest.R2 - b.closest.R2) + Norm(a.closest.n - b.closest.n) <
           kSamePlace;
  }

  // For minima in valleys narrower than the samples.
  bool IsMinimum(const ClosestPoints& c) const {
    const Vec2 p1 = c_.pose1.x + c.R1;
    const Vec2 p2 = c_.pose2.x + c.R2;
    const LoopPlace place1 = loop1_.Nearest(p1);
    const LoopPlace place2 = loop2_.Nearest(p2);
    EXPECT_LE(Norm(loop1_.At(place1).c - p1) + Norm(loop2_.At(place2).c - p2), 1e-8)
        << name_ << ": not on the outlines";
    return IsLocalMinimum(loop1_, place1, loop2_, place2);
  }

  const Configuration& c_;
  std::string name_;
  SampledLoop loop1_;
  SampledLoop loop2_;
};

const char* NameOf(EdgeKind kind) {
  constexpr const char* kNames[] = {"Straight", "Arc", "Ellipse", "Superellipse", "Bezier"};
  return kNames[static_cast<int>(kind)];
}

using Kinds = std::tuple<int, int, bool>;

class NarrowPhase : public ::testing::TestWithParam<Kinds> {};

TEST_P(NarrowPhase, FindsTheMinimaThatDenseSamplingFinds) {
  const auto [first, second, inside] = GetParam();
  const auto kind1 = static_cast<EdgeKind>(first);
  const auto kind2 = static_cast<EdgeKind>(second);
  Random random(1000 + static_cast<unsigned>(100 * first + 10 * second + (inside ? 1 : 0)));
  Tally tally;
  const int cases = CasesPerPair();
  for (int k = 0; k < cases; ++k) {
    const Configuration c = RandomConfiguration(kind1, kind2, inside, &random);
    Comparison(c, "case " + std::to_string(k)).Run(&tally);
  }
  EXPECT_EQ(tally.configurations, cases);
  // A descent that ends nowhere could hide a minimum.
  EXPECT_EQ(tally.undecided, 0);
  EXPECT_LE(tally.overlapping, 1 + cases / 100);
  EXPECT_GE(tally.minima, cases / 4);
}

std::string CaseName(const ::testing::TestParamInfo<Kinds>& info) {
  const auto [first, second, inside] = info.param;
  return std::string(NameOf(static_cast<EdgeKind>(first))) + (inside ? "Around" : "Beside") +
         NameOf(static_cast<EdgeKind>(second));
}

INSTANTIATE_TEST_SUITE_P(AllKinds, NarrowPhase,
                         ::testing::Combine(::testing::Range(0, kEdgeKinds), ::testing::Range(0, kEdgeKinds),
                                            ::testing::Bool()),
                         CaseName);

// Outlines of several kinds of edges, most of them joined smoothly.
std::vector<Outline> ReadyMadeShapes() {
  return {Gear({}),
          Cam(0.6, 0.2, 0.9),
          Capsule(1.5, 0.4),
          DShape(0.7, 0.8),
          RoundedBox(1.6, 0.9, 0.25),
          Bowl(1.2, 0.9, 0.8),
          HalfDisc(0.9),
          Box(1.5, 0.8),
          Ellipse(1.2, 0.2),
          Superellipse(1, 0.7, 6)};
}

TEST(NarrowPhaseOfShapes, FindsTheMinimaThatDenseSamplingFinds) {
  Random random(77);
  Tally tally;
  const std::vector<Outline> shapes = ReadyMadeShapes();
  const int cases = CasesPerPair() / 20;
  for (const Outline& shape1 : shapes) {
    for (const Outline& shape2 : shapes) {
      for (int k = 0; k < cases; ++k) {
        Configuration c{shape1, shape2, {random.Vector(3), random.Uniform(-3, 3)}, {}, random.Uniform(0.02, 0.4)};
        const Vec2 direction = UnitVector(random.Uniform(-3.14, 3.14));
        c.pose2 = {c.pose1.x - 5.0 * direction, random.Uniform(-3, 3)};
        Approach(&c, direction, 0.01);
        Comparison(c, shape1.name + " and " + shape2.name + ", case " + std::to_string(k)).Run(&tally);
      }
    }
  }
  EXPECT_LE(tally.overlapping, tally.configurations / 100);
}

// Ovals in holes of nearly their own shape: curvatures nearly match, D is small and changes its sign several times.
TEST(NarrowPhaseOfShapes, FindsTheMinimaOfSnugOvals) {
  Random random(9);
  Tally tally;
  const double turn = 2 * std::numbers::pi;
  const int cases = CasesPerPair();
  for (int k = 0; k < cases; ++k) {
    const double a = 1;
    const double b = random.Uniform(0.5, 1);
    const double play = random.Uniform(0.01, 0.1);
    const double phi = random.Uniform(-3, 3);
    const int m = 2 + 2 * RandomInteger(2, &random);
    const double slimmer = random.Uniform(0, 0.5) * play;
    Configuration c;
    c.outline1 = {"hole", {{{SuperellipseEdge{{}, a, b, m, phi, Side::kConcave}, turn, 0}}}};
    c.outline2 = {"oval", {{{SuperellipseEdge{{}, a - play, b - play - slimmer, m, phi, Side::kConvex}, 0, turn}}}};
    c.pose2 = {random.Vector(0.3 * play), random.Uniform(-0.1, 0.1) * play};
    c.reach = 3 * play;
    Comparison(c, "case " + std::to_string(k)).Run(&tally);
  }
  EXPECT_LE(tally.overlapping, tally.configurations / 10);
}

std::vector<GapMinimum> Detect(const Configuration& c, double penetration = 0) {
  return FindGapMinima(PlaceOutline(c.outline1, c.pose1.x, c.pose1.theta),
                       PlaceOutline(c.outline2, c.pose2.x, c.pose2.theta), {c.reach, penetration});
}

Configuration AnyConfiguration(Random* random) {
  const auto kind1 = static_cast<EdgeKind>(RandomInteger(kEdgeKinds, random));
  const auto kind2 = static_cast<EdgeKind>(RandomInteger(kEdgeKinds, random));
  return RandomConfiguration(kind1, kind2, random->Uniform(0, 1) < 0.5, random);
}

// Small overlaps: pushed into each other along a contact's normal, the bodies still have that contact, as deep.
TEST(NarrowPhaseOfShapes, FollowsAContactIntoPenetration) {
  Random random(6);
  int followed = 0;
  for (int k = 0; k < 300; ++k) {
    Configuration c = AnyConfiguration(&random);
    const std::vector<GapMinimum> minima = Detect(c);
    if (minima.empty()) continue;
    const auto nearest = std::min_element(minima.begin(), minima.end(),
                                          [](const auto& a, const auto& b) { return a.closest.d < b.closest.d; });
    // A minimum persists along its own normal: the feet stay where they are, only D changes with d.
    const double depth = 1e-6;
    c.pose2.x = c.pose2.x + (nearest->closest.d + depth) * nearest->closest.n;
    const auto pushed = Detect(c, 1e-3);
    const auto& before = nearest->closest;
    const auto found = std::find_if(pushed.begin(), pushed.end(), [&](const GapMinimum& m) {
      return Norm(m.closest.R1 - before.R1) <= 1e-6 && Norm(m.closest.R2 - before.R2) <= 1e-6;
    });
    ASSERT_NE(found, pushed.end()) << k;
    EXPECT_NEAR(found->closest.d, -depth, 1e-12) << k;
    ++followed;
  }
  EXPECT_GE(followed, 250);
}

TEST(NarrowPhaseOfShapes, IsTheSameFarFromTheOriginAndAtAnyScale) {
  Random random(7);
  for (int k = 0; k < 200; ++k) {
    const Configuration c = AnyConfiguration(&random);
    const std::vector<GapMinimum> minima = Detect(c);
    for (const double scale : {1e-6, 1.0, 1e6}) {
      const Vec2 shift = scale == 1 ? Vec2{0x1p20, -0x1p21} : Vec2{};
      const Configuration moved{Scaled(c.outline1, scale),
                                Scaled(c.outline2, scale),
                                {scale * c.pose1.x + shift, c.pose1.theta},
                                {scale * c.pose2.x + shift, c.pose2.theta},
                                scale * c.reach};
      const std::vector<GapMinimum> others = Detect(moved);
      ASSERT_EQ(minima.size(), others.size()) << k << " " << scale;
      for (std::size_t i = 0; i < minima.size(); ++i) {
        // Positions at 1e6 m are known to 1e-10 m.
        EXPECT_NEAR(others[i].closest.d / scale, minima[i].closest.d, 1e-8) << k << " " << scale;
      }
    }
  }
}

// A ball rolled over the joins of straight edges and arcs touches a convex outline once, wherever it is.
TEST(NarrowPhaseOfShapes, ABallOnAConvexOutlineTouchesItOnceAtJoinsAndVertices) {
  Random random(8);
  const double radius = 0.3;
  for (const Outline& shape :
       {RoundedBox(2, 1, 0.2), Capsule(1, 0.5), Cam(0.6, 0.2, 0.9), Box(2, 1), DShape(1, 0.7), HalfDisc(1)}) {
    const double theta = random.Uniform(-3, 3);
    const Rotation r = SinCos(theta);
    for (const OutlinePiece& piece : shape.loops[0]) {
      const Vec2 end = CurvePoint(piece.edge, piece.s_end);
      const Vec2 along = CurveDirection(piece.edge, piece.s_end);
      const Vec2 t = (1 / Norm(along)) * along;
      for (const double beyond : {0.0, 1e-16, -1e-16, 1e-13, -1e-13, 1e-11, -1e-11, 1e-10, -1e-10, 3e-10, -3e-10, 1e-9,
                                  -1e-9, 1e-8, -1e-8, 1e-6, -1e-6, 1e-3, -1e-3}) {
        const Vec2 center = end + beyond * t - radius * Perp(t);
        const Configuration c{shape, Disc(radius), {{}, theta}, {Rotate(r, center), 0}, 1e-3};
        EXPECT_EQ(Detect(c, 1e-3).size(), 1u) << shape.name << " " << beyond;
      }
    }
  }
}

// Slender ellipses: tip to flat side, by the closed form at the axes.
TEST(NarrowPhaseOfShapes, SlenderEllipsesTouchAtTheirAxes) {
  for (const double b : {1e-2, 1e-4, 1e-6}) {
    const Configuration tip_on_side{
        Ellipse(1, b), Ellipse(1, b), {{0, 0}, 0}, {{0.25, 1 + b + 1e-9}, 1.5707963267948966}, 1e-3};
    const auto minima = Detect(tip_on_side);
    ASSERT_EQ(minima.size(), 1u) << b;
    EXPECT_NEAR(minima[0].closest.R1.x, 0.25, 1e-3) << b;
    const Configuration tip_on_tip{Ellipse(1, b), Ellipse(1, b), {{0, 0}, 0}, {{2 + 1e-9, 0}, 0}, 1e-3};
    ASSERT_EQ(Detect(tip_on_tip).size(), 1u) << b;
    EXPECT_NEAR(Detect(tip_on_tip)[0].closest.d, 1e-9, 1e-15) << b;
  }
}

// A floor that is an arc of a radius up to 1e9 times the ball's.
TEST(NarrowPhaseOfShapes, ABallOnANearlyStraightArcTouchesIt) {
  for (const double radius : {1e3, 1e6, 1e9}) {
    for (const Side side : {Side::kConvex, Side::kConcave}) {
      const bool convex = side == Side::kConvex;
      // The arc's top or bottom is the origin; half a width of 2 m to either side.
      const double half = 2 / radius;
      const double middle = convex ? 1.5707963267948966 : -1.5707963267948966;
      const Outline floor{"floor",
                          {{{ArcEdge{{0, convex ? -radius : radius}, radius, side},
                             convex ? middle - half : middle + half, convex ? middle + half : middle - half}}}};
      for (const double x : {-1.5, 0.0, 1.0, 1.9, 2.1}) {
        const double rise = x * x / (2 * radius) * (convex ? -1 : 1);
        const Configuration c{floor, Disc(0.5), {}, {{x, 0.5 + rise}, 0.3}, 1e-5 * (1 + 1e3 / radius)};
        EXPECT_EQ(Detect(c, 1e-5 * (1 + 1e3 / radius)).size(), x < 2 ? 1u : 0u) << radius << " " << x;
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench
