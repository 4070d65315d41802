// Beads on paths with ends, at both levels: without loads a bead keeps its speed, so that it is at the end of a path
// after the path's length over that speed; at joins it goes on, at kinks the motion ends.

#include "model/contact/path.h"
#include "model/scene_file/scene_file.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

constexpr double kStep = 1e-3;  // of the velocity level

using Path = std::vector<OutlineEdge>;

/// The length of a piece between two parameters, by chords and Richardson's extrapolation.
double LengthOf(const OutlineEdge& piece, double s0, double s1) {
  const auto chords = [&](int count) {
    double sum = 0;
    Vec2 before = CurvePoint(piece.edge, s0);
    for (int k = 1; k <= count; ++k) {
      const Vec2 now = CurvePoint(piece.edge, s0 + (s1 - s0) * k / count);
      sum += Norm(now - before);
      before = now;
    }
    return sum;
  };
  constexpr int kCount = 300;
  return (4 * chords(2 * kCount) - chords(kCount)) / 3;
}

/// The bead's path on the fixed body 0, from a start on one of its pieces.
struct Bead {
  Path path;
  std::size_t piece = 0;
  double share = 0.5;      ///< of the piece, from its begin
  double speed = 1;        ///< < 0 against the path's sense
  bool edge_on_1 = false;  ///< the path is body 1's of the joint
  Vec2 carrier = {};       ///< velocity of the body that has the path
};

double Start(const Bead& bead) {
  const OutlineEdge& piece = bead.path[bead.piece];
  return piece.s_begin + bead.share * (piece.s_end - piece.s_begin);
}

/// From the start to the end that it runs to.
double WayToEnd(const Bead& bead) {
  const bool forward = bead.speed > 0;
  const OutlineEdge& piece = bead.path[bead.piece];
  double way = LengthOf(piece, Start(bead), forward ? piece.s_end : piece.s_begin);
  for (std::size_t k = 0; k < bead.path.size(); ++k) {
    if (forward ? k > bead.piece : k < bead.piece)
      way += LengthOf(bead.path[k], bead.path[k].s_begin, bead.path[k].s_end);
  }
  return way;
}

Vec2 EndOf(const Bead& bead) {
  const OutlineEdge& piece = bead.speed > 0 ? bead.path.back() : bead.path.front();
  return CurvePoint(piece.edge, bead.speed > 0 ? piece.s_end : piece.s_begin);
}

World WorldOf(const Bead& bead, Random* random, Vec2 gravity = {}) {
  Body carrier = Anchor();
  carrier.x = {random->Uniform(-2, 2), random->Uniform(-2, 2)};
  carrier.theta = random->Uniform(-kPi, kPi);
  carrier.v = bead.carrier;
  const OutlineEdge& piece = bead.path[bead.piece];
  const double sense = piece.s_begin < piece.s_end ? 1 : -1;
  const Vec2 direction = sense * Unit(CurveDirection(piece.edge, Start(bead)));
  const Body disc = Movable(Disc(0.05), WorldPoint(carrier, CurvePoint(piece.edge, Start(bead))), 0,
                            carrier.v + bead.speed * Rotate(SinCos(carrier.theta), direction));
  World world = WorldWith("bead", {carrier, disc}, gravity);
  Constraint joint = Joint(ConstraintType::kPathJoint, 1, {}, 0, {});
  joint.feature2 = ToFeature(piece.edge);
  joint.path = bead.path;
  if (bead.edge_on_1) {
    std::swap(joint.body1, joint.body2);
    std::swap(joint.feature1, joint.feature2);
  }
  PutOnPath(world.bodies, &joint);
  world.joints = {joint};
  return world;
}

/// The bead comes to its end at its time and place, at either level, and no further.
void ExpectEnd(const Bead& bead, const std::string& word, Random* random) {
  const World world = WorldOf(bead, random);
  const double speed = std::abs(bead.speed);
  const double due = WayToEnd(bead) / speed;
  for (const MotionLevel level : kBothLevels) {
    SCOPED_TRACE(ToString(level));
    Mover ride(level, world);
    ride->Advance(due + 1);
    EXPECT_EQ(ride->status(), MotionStatus::kPathEnd);
    EXPECT_NE(ride->detail().find(word), std::string::npos) << ride->detail();
    const World& end = ride->world();
    const Vec2 place = WorldPoint(end.bodies[0], EndOf(bead));
    const bool exact = level == MotionLevel::kAcceleration;
    // Stepping in time loses speed on curves, and stops within the step before.
    const double late = exact ? 1e-7 * due + 1e-8 : kStep + 0.01 * due;
    EXPECT_NEAR(ride->time(), due, late);
    EXPECT_LE(Norm(end.bodies[1].x - place), exact ? 1e-6 : 1.5 * kStep * speed + 1e-4);
    EXPECT_NEAR(Norm(end.bodies[1].v - end.bodies[0].v), speed, (exact ? 1e-8 : 0.02) * speed);
    // It stays ended.
    const double time = ride->time();
    ride->Advance(0.1);
    EXPECT_EQ(ride->time(), time);
  }
}

OutlineEdge RandomPiece(int kind, Random* random) {
  const auto point = [random] { return Vec2{random->Uniform(-1, 1), random->Uniform(-1, 1)}; };
  const double begin = random->Uniform(-kPi, kPi);
  const double sweep = random->Uniform(0.3, 6.1);
  const bool left = random->Uniform() < 0.5;
  const Side side = left ? Side::kConvex : Side::kConcave;
  const double end = left ? begin + sweep : begin - sweep;
  const double a = random->Uniform(0.6, 1.5);
  const double b = a * random->Uniform(0.5, 1);
  switch (kind) {
    case 0: {
      const Vec2 from = point();
      return {StraightEdge{from, from + random->Uniform(0.5, 3) * Direction(begin)}, 0, 1};
    }
    case 1:
      return {ArcEdge{point(), a, side}, begin, end};
    case 2:
      return {EllipseEdge{point(), a, b, random->Uniform(-kPi, kPi), side}, begin, end};
    default: {
      const BezierEdge edge{{{{0, 0}, {1, random->Uniform(-0.5, 0.5)}, {2, random->Uniform(-1, 1)}, {3, 0.5}}}};
      return kind == 3 ? OutlineEdge{edge, 0, 1} : OutlineEdge{edge, 0.2, 0.9};
    }
  }
}

/// Pieces that join smoothly: each begins at the end of the one before, along its direction. Lines, arcs either way
/// and Bezier curves.
Path SmoothChain(int count, Random* random) {
  Path path;
  Vec2 at{0.2, -0.3};
  double way = random->Uniform(-kPi, kPi);
  for (int k = 0; k < count; ++k) {
    const Vec2 along = Direction(way);
    if (const int kind = static_cast<int>(random->Uniform(0, 3)); kind == 0) {
      path.push_back({StraightEdge{at, at + random->Uniform(0.2, 1) * along}, 0, 1});
    } else if (kind == 1) {
      const bool left = random->Uniform() < 0.5;
      const double radius = random->Uniform(0.3, 1);
      const double sweep = random->Uniform(0.2, 2.5);
      const Vec2 center = at + (left ? radius : -radius) * Perp(along);
      const double s = way + (left ? -kPi / 2 : kPi / 2);
      path.push_back({ArcEdge{center, radius, left ? Side::kConvex : Side::kConcave}, s, left ? s + sweep : s - sweep});
    } else {
      const double size = random->Uniform(0.3, 0.6);
      const Vec2 last = at + 3 * size * along + random->Uniform(-size, size) * Perp(along);
      path.push_back({BezierEdge{{{at, at + size * along, last - size * along, last}}}, 0, 1});
    }
    const OutlineEdge& piece = path.back();
    at = CurvePoint(piece.edge, piece.s_end);
    way = AngleOf((piece.s_begin < piece.s_end ? 1.0 : -1.0) * CurveDirection(piece.edge, piece.s_end));
  }
  return path;
}

TEST(PathEnds, BeadsStopAtEitherEndOfEveryKindOfEdgeAndOfSmoothChains) {
  Random random(8);
  for (int k = 0; k < 66; ++k) {
    SCOPED_TRACE(k);
    Bead bead;
    bead.path = k < 50 ? Path{RandomPiece(k % 5, &random)} : SmoothChain(2 + k % 4, &random);
    bead.share = random.Uniform(0.05, 0.95);
    bead.speed = (random.Uniform() < 0.5 ? -1 : 1) * random.Uniform(0.5, 3);
    bead.piece = bead.speed > 0 ? 0 : bead.path.size() - 1;
    bead.edge_on_1 = random.Uniform() < 0.5;
    if (random.Uniform() < 0.3) bead.carrier = {0.7, -0.4};
    ExpectEnd(bead, "comes to the end of its path on body 0 'anchor'", &random);
  }
}

TEST(PathEnds, BeadsOnSmoothChainsKeepTheirEnergyUnderGravity) {
  Random random(10);
  int passages = 0;
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(k);
    Bead bead;
    bead.path = SmoothChain(5, &random);
    bead.piece = 2;
    bead.speed = random.Uniform(-1, 1);
    const World world = WorldOf(bead, &random, {0, -kG});
    Mover ride(MotionLevel::kAcceleration, world);
    std::size_t piece = bead.piece;
    const double energy = Energy(world);
    for (int frame = 0; frame < 60 && ride->status() == MotionStatus::kMoving; ++frame) {
      ride->Advance(0.02);
      const World& now = ride->world();
      EXPECT_NEAR(Energy(now), energy, 1e-8 * world.bodies[1].mass * kG);
      passages += now.joints[0].piece == piece ? 0 : 1;
      piece = now.joints[0].piece;
    }
    EXPECT_NE(ride->status(), MotionStatus::kStalled) << ride->detail();
    EXPECT_LE(ride->statistics().worst_joint_error, 1e-6);
  }
  EXPECT_GE(passages, 20);
}

/// Two lines and two half circles, either way round.
Path Slot(double length, double radius, bool left) {
  const double half = length / 2;
  const double r = left ? radius : -radius;
  const Side side = left ? Side::kConvex : Side::kConcave;
  const double turn = left ? kPi : -kPi;
  return {{StraightEdge{{-half, -r}, {half, -r}}, 0, 1},
          {ArcEdge{{half, 0}, radius, side}, -turn / 2, turn / 2},
          {StraightEdge{{half, r}, {-half, r}}, 0, 1},
          {ArcEdge{{-half, 0}, radius, side}, turn / 2, 3 * turn / 2}};
}

Vec2 PlaceInSlot(const Path& slot, double way) {
  for (std::size_t k = 0;; k = (k + 1) % slot.size()) {
    const OutlineEdge& piece = slot[k];
    const auto* arc = std::get_if<ArcEdge>(&piece.edge);
    const double length =
        arc != nullptr ? kPi * arc->radius : Norm(CurvePoint(piece.edge, 1) - CurvePoint(piece.edge, 0));
    if (way <= length) return CurvePoint(piece.edge, piece.s_begin + way / length * (piece.s_end - piece.s_begin));
    way -= length;
  }
}

TEST(PathEnds, ABeadRunsRoundAndRoundInASlot) {
  Random random(11);
  for (int k = 0; k < 4; ++k) {
    SCOPED_TRACE(k);
    const double length = random.Uniform(0.5, 2);
    const double radius = random.Uniform(0.3, 1);
    const double around = 2 * length + 2 * kPi * radius;
    Bead bead;
    bead.path = Slot(length, radius, k % 2 == 0);
    bead.speed = (k % 4 < 2 ? 1 : -1) * random.Uniform(1, 3);
    bead.share = random.Uniform(0.2, 0.8);
    const World world = WorldOf(bead, &random);
    for (const MotionLevel level : kBothLevels) {
      SCOPED_TRACE(ToString(level));
      Mover ride(level, world);
      const double speed = std::abs(bead.speed);
      for (int frame = 1; frame <= 10; ++frame) {
        ride.KeepMoving(0.25 * around / speed);
        const double way = std::fmod(bead.share * length + bead.speed * ride->time() + 3 * around, around);
        const Vec2 place = WorldPoint(world.bodies[0], PlaceInSlot(bead.path, way));
        const double tolerance =
            level == MotionLevel::kVelocity ? 0.05 * frame * around * kStep * speed / radius : 1e-6;
        EXPECT_LE(Norm(ride.body(1).x - place), tolerance + (level == MotionLevel::kVelocity ? 1e-2 : 0));
      }
    }
  }
}

TEST(PathEnds, AKinkEndsTheMotionAndATurnBelowItDoesNot) {
  Random random(12);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(k);
    const double kink = (random.Uniform() < 0.5 ? -1 : 1) * std::pow(10, random.Uniform(-4, 0.4));
    Bead bead;
    bead.path = {{StraightEdge{{-1, 0}, {0, 0}}, 0, 1}, {StraightEdge{{0, 0}, Direction(kink)}, 0, 1}};
    bead.piece = k % 2 == 0 ? 0 : 1;
    bead.speed = k % 2 == 0 ? 1.5 : -1.5;
    Bead first = bead;
    first.path = {bead.path[bead.piece]};
    first.piece = 0;
    const double due = WayToEnd(first) / 1.5;
    const World world = WorldOf(bead, &random);
    for (const MotionLevel level : kBothLevels) {
      SCOPED_TRACE(ToString(level));
      Mover ride(level, world);
      ride->Advance(2);
      EXPECT_EQ(ride->status(), MotionStatus::kPathEnd);
      EXPECT_NE(ride->detail().find("comes to a kink of "), std::string::npos) << ride->detail();
      EXPECT_NEAR(ride->time(), due, level == MotionLevel::kVelocity ? 1.5 * kStep : 1e-7);
      EXPECT_LE(Norm(ride.body(1).x - world.bodies[0].x), 2 * kStep);
    }
    bead.path[1] = {StraightEdge{{0, 0}, Direction(1e-7)}, 0, 1};
    Mover ride(MotionLevel::kAcceleration, WorldOf(bead, &random));
    ride.KeepMoving(0.9);
    EXPECT_NE(ride->world().joints[0].piece, bead.piece);
  }
}

/// A bead at x on a path joint to an edge of an anchor, with the path or without one.
World OnEdge(const Feature& edge, const Path& path, Vec2 x = {}, Vec2 gravity = {}) {
  World world = WorldWith("on an edge", {Anchor(), Movable(Disc(0.05), x)}, gravity);
  world.joints = {Joint(ConstraintType::kPathJoint, 1, {}, 0, {})};
  world.joints[0].feature2 = edge;
  world.joints[0].path = path;
  return world;
}

const StraightEdge kUpwards{{0, -1}, {0, 1}};

// Thrown up a slope, a bead turns a little before the end or a little behind it; a step may span both passages.
TEST(PathEnds, ABeadThatTurnsBehindTheEndDoesNotComeBack) {
  for (const double height : {-1e-2, -1e-4, -1e-6, 1e-6, 1e-4, 1e-2}) {
    SCOPED_TRACE(height);
    World world = OnEdge(kUpwards, {{kUpwards, 0, 1}}, {}, {0, -kG});
    const double speed = std::sqrt(2 * kG * (1 + height));
    world.bodies[1].v = {0, speed};
    Mover ride(MotionLevel::kAcceleration, world);
    ride->Advance(2 * speed / kG);
    if (height > 0) {
      EXPECT_EQ(ride->status(), MotionStatus::kPathEnd);
      EXPECT_NEAR(ride.body(1).x.y, 1, 1e-8);
    } else {
      EXPECT_EQ(ride->status(), MotionStatus::kMoving) << ride->detail();
      EXPECT_NEAR(ride.body(1).x.y, 0, 1e-9);
    }
  }
}

TEST(PathEnds, ABezierCurveWithoutAPathHasItsOwnEnds) {
  const BezierEdge bezier{{{{0, 0}, {1, 0}, {2, 1}, {3, 1}}}};
  World world = OnEdge(bezier, {}, bezier.Point(0.5));
  world.bodies[1].v = 2 * Unit(bezier.Direction(0.5));
  const double due = LengthOf({bezier, 0, 1}, 0.5, 1) / 2;
  for (const MotionLevel level : kBothLevels) {
    Mover ride(level, world);
    ride->Advance(2 * due);
    EXPECT_EQ(ride->status(), MotionStatus::kPathEnd);
    EXPECT_NEAR(ride->time(), due, level == MotionLevel::kVelocity ? 0.01 : 1e-7);
  }
}

TEST(PathEnds, AStartBeyondAnEndIsRefused) {
  World world = OnEdge(kUpwards, {{kUpwards, 0, 1}}, {0, 2});
  for (const MotionLevel level : kBothLevels) EXPECT_THROW(Mover(level, world), InputError);
  // At the very end it may start.
  world.bodies[1].x = {0, 1};
  world.bodies[1].v = {0, -1};
  for (const MotionLevel level : kBothLevels) {
    Mover ride(level, world);
    ride.KeepMoving(1);
    EXPECT_NEAR(ride.body(1).x.y, 0, 1e-9);
  }
}

TEST(PathEnds, InvalidPathsAreRefused) {
  const World world = OnEdge(kUpwards, {{kUpwards, 0, 1}, {StraightEdge{{0, 1}, {1, 1}}, 0, 1}});
  EXPECT_NO_THROW(RequireValid(world));
  const std::vector<std::pair<std::string, std::function<void(Constraint*)>>> changes = {
      {"only a path joint", [](Constraint* c) { c->type = ConstraintType::kRod; }},
      {"does not exist", [](Constraint* c) { c->piece = 2; }},
      {"is not the piece", [](Constraint* c) { c->piece = 1; }},
      {"one vertex and one edge", [](Constraint* c) { c->feature2 = Vertex{}; }},
      {"edge 1 of its path: ", [](Constraint* c) { c->path[1].s_end = 2; }},
      {"edge 1 of its path does not begin where", [](Constraint* c) { c->path[1].s_begin = 1e-3; }}};
  for (const auto& [words, change] : changes) {
    World changed = world;
    change(&changed.joints[0]);
    ExpectRefused([&] { RequireValid(changed); }, words);
  }
}

}  // namespace
}  // namespace lcpbench
