#include "model/detection/detection.h"

#include "model/contact/assembly.h"
#include "model/detection/narrow_phase.h"
#include "model/shape/shapes.h"
#include "tests/model/shape/random_outlines.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using testing::kPi;

struct Placed {
  Outline outline;
  Vec2 x;
  double theta = 0;
  bool fixed = false;
};

// Bodies with outlines whose frames are their centres of mass.
class Workshop {
 public:
  Workshop(std::initializer_list<Placed> placed) {
    for (const Placed& p : placed) Add(p);
  }
  void Add(const Placed& placed) {
    Body body;
    body.name = placed.outline.name;
    body.x = placed.x;
    body.theta = placed.theta;
    body.fixed = placed.fixed;
    bodies_.push_back(body);
    outlines_.push_back(placed.outline);
  }

  std::vector<Constraint> Detect(
      double tolerance = 1e-6, double penetration = 1e-6, const StopCheck& check = [] {}) const {
    return DetectContacts(bodies_, outlines_, {.tolerance = tolerance, .penetration = penetration, .check = &check});
  }

  /// The contacts' geometry, from the assembly: every detected constraint must give a row.
  std::vector<RowInfo> Rows(double tolerance = 1e-6) const {
    return AssembleContactLcp({"workshop", bodies_, Detect(tolerance, tolerance / 10)}).rows;
  }

 private:
  std::vector<Body> bodies_;
  std::vector<Outline> outlines_;
};

Placed Floor() { return {{"floor", {{{StraightEdge{{5, 0}, {-5, 0}}, 0, 1}}}}, {}, 0, true}; }

TEST(Detection, EqualFlushBoxesInOneStackTouchAtTwoCorners) {
  for (const double theta : {0.0, 0.3, -1.1, 2.0}) {
    Workshop shop({});
    const Rotation r = SinCos(theta);
    for (int k = 0; k < 5; ++k) shop.Add({Box(2, 1), Rotate(r, {0, static_cast<double>(k)}), theta});
    EXPECT_EQ(shop.Rows().size(), 8u) << theta;
  }
}

TEST(Detection, ABodyInAHoleOfItsOwnShapeIsRefusedNamingBothEdges) {
  Outline elliptic_hole = Box(4, 4);
  elliptic_hole.loops.push_back({{EllipseEdge{{}, 1, 0.6, 0, Side::kConcave}, 2 * kPi, 0}});
  for (const char* arc : {"convex arc", "concave arc"}) {
    ExpectRefused([] { Workshop({{Ring(2, 1), {}}, {Disc(1), {}}}).Detect(); }, arc);
  }
  ExpectRefused([&] { Workshop({{elliptic_hole, {}}, {Ellipse(1, 0.6), {}}}).Detect(); }, "ellipse");
}

TEST(Detection, ABallAtTheSmoothJoinOfAStraightAndAnArcTouchesOnce) {
  // A floor from the left that turns up into a quarter pipe at the origin.
  const Outline pipe{"quarter pipe",
                     {{{ArcEdge{{0, 1}, 1, Side::kConcave}, 0, -kPi / 2}, {StraightEdge{{0, 0}, {-3, 0}}, 0, 1}}}};
  for (const double x : {0.0, 1e-13, -1e-13, 1e-10, -1e-10, 1e-8, -1e-8}) {
    EXPECT_EQ(Workshop({{pipe, {}, 0, true}, {Disc(0.25), {x, 0.25}}}).Detect().size(), 1u) << x;
  }
}

// Long outlines are searched by a tree: it leaves out what holds no minimum, and nothing else.
TEST(Detection, LongOutlinesTouchWhereAllPairsOfTheirSpansDo) {
  testing::Random random(5);
  std::size_t found = 0;
  for (int k = 0; k < 300; ++k) {
    const auto polygon = [&](int most, bool round) {
      const int count = 10 + testing::RandomInteger(most, &random);
      return testing::Polygon(testing::RandomCorners(count, {}, round ? 1 : 0.85, true, 0, round ? 0 : 0.17, &random));
    };
    GearShape shape;
    shape.teeth = 5 + testing::RandomInteger(40, &random);
    const Outline outline1 = k % 3 == 0 ? Gear(shape) : polygon(80, k % 3 == 1);
    const Outline outline2 = k % 5 == 0 ? Box(1.5, 1.5) : polygon(60, k % 2 == 0);
    const double turned = k % 7 == 0 ? 0 : random.Uniform(0, 6);
    PlacedOutline placed1 = PlaceOutline(outline1, {}, 0);
    PlacedOutline placed2 = PlaceOutline(outline2, {random.Uniform(1.6, 2), random.Uniform(-0.3, 0.3)}, turned);
    const GapRange range{random.Uniform(0, 0.2), random.Uniform(0, 0.2)};
    const auto by_tree = FindGapMinima(placed1, placed2, range);
    const auto turned_round = FindGapMinima(placed2, placed1, range);
    placed1.tree.reset();
    placed2.tree.reset();
    const auto same = [](const std::vector<GapMinimum>& a, const std::vector<GapMinimum>& b) {
      return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const GapMinimum& p, const GapMinimum& q) {
        return p.span1 == q.span1 && p.span2 == q.span2 && p.closest.d == q.closest.d;
      });
    };
    EXPECT_TRUE(same(by_tree, FindGapMinima(placed1, placed2, range))) << k;
    EXPECT_TRUE(same(turned_round, FindGapMinima(placed2, placed1, range))) << k;
    found += by_tree.size();
  }
  EXPECT_GT(found, 300u);
}

// All pairs of these spans would take hours.
TEST(Detection, OutlinesOfManyVerticesTouchSoon) {
  constexpr int kCorners = 40'000;
  testing::Random random(1);
  const Outline outline = testing::Polygon(testing::RandomCorners(kCorners, {}, 1, true, 0, 0, &random));
  // With the ends of edges that are nearly flush.
  const std::size_t found = Workshop({{outline, {}}, {outline, {2 + 1e-7, 0}, kPi / kCorners}}).Detect(0.5, 0.5).size();
  EXPECT_GE(found, 1u);
  EXPECT_LT(found, 500u);
}

// Counted, as a clock is not to be trusted: the check is called for every span of a long outline that is looked at.
TEST(Detection, ManyBodiesAlongALongOutlineLookAtWhatIsNear) {
  constexpr int kCount = 4000;
  Placed floor{{"floor", {{}}}, {}, 0, true};
  for (int k = kCount; k > 0; --k) floor.outline.loops[0].push_back(testing::Line({1.0 * k, 0}, {k - 1.0, 0}));
  for (const bool floor_first : {true, false}) {
    Workshop shop({});
    if (floor_first) shop.Add(floor);
    for (int k = 0; k < kCount; ++k) shop.Add({Disc(0.3), {k + 0.5, 0.3}});
    if (!floor_first) shop.Add(floor);
    std::int64_t calls = 0;
    EXPECT_EQ(shop.Detect(1e-6, 1e-6, [&] { ++calls; }).size(), kCount + 0u);
    EXPECT_LT(calls, 30 * kCount) << floor_first;
  }
}

TEST(Detection, ManyBodiesInOneTrackTouchItOnceEach) {
  Workshop shop({{Ring(6, 5), {}, 0, true}});
  const int count = 40;
  for (int k = 0; k < count; ++k) {
    // Ellipses standing with their tips on the track, discs between them.
    const double angle = 2 * kPi * k / count;
    const double a = k % 2 == 0 ? 0.3 : 0.2;
    shop.Add({k % 2 == 0 ? Ellipse(a, 0.2) : Disc(a), (5 - a - 1e-7) * testing::UnitVector(angle), angle});
  }
  const auto contacts = shop.Detect();
  ASSERT_EQ(contacts.size(), static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    EXPECT_EQ(contacts[static_cast<std::size_t>(k)].body2, k + 1);
    EXPECT_NEAR(contacts[static_cast<std::size_t>(k)].nominal_gap, 1e-7, 1e-14);
  }
}

TEST(Detection, FixedBodiesDoNotTouchEachOther) {
  EXPECT_TRUE(Workshop({{Box(2, 1), {0, 0}, 0, true}, {Box(2, 1), {0.5, 1}, 0, true}}).Detect().empty());
}

TEST(Detection, RefusesBadInputNamingBodyAndEdge) {
  Outline box = Box(2, 1);
  std::get<StraightEdge>(box.loops[0][2].edge).b = std::get<StraightEdge>(box.loops[0][2].edge).a;
  const Placed valid{Box(1, 1), {0, 1}};
  for (const std::string& words : {"body '" + box.name + "'", std::string("edge 2")}) {
    ExpectRefused([&] { Workshop({{box, {}}, valid}).Detect(); }, words);
  }
  EXPECT_THROW(Workshop({valid}).Detect(0, 0), InputError);
  EXPECT_THROW(Workshop({valid}).Detect(1e-6, -1), InputError);
}

// Flush contacts: edges that lie on each other, or nearly.

/// Angles about zero, both ways, from below rounding to where edges no longer lie on each other.
std::vector<double> Tilts(double largest) {
  std::vector<double> tilts = {0};
  for (double tilt = 1e-17; tilt <= largest; tilt *= 10) {
    for (const double factor : {1.0, 3.0}) {
      tilts.push_back(factor * tilt);
      tilts.push_back(-factor * tilt);
    }
  }
  return tilts;
}

/// The contacts, assembled, by their places along x; as many for the other order of the bodies.
std::vector<RowInfo> Contacts(const Placed& upper, const Placed& lower, double tolerance) {
  std::vector<RowInfo> rows = Workshop({upper, lower}).Rows(tolerance);
  EXPECT_EQ(rows.size(), Workshop({lower, upper}).Rows(tolerance).size());
  std::sort(rows.begin(), rows.end(), [](const RowInfo& a, const RowInfo& b) { return a.p1.x < b.p1.x; });
  return rows;
}

/// A body whose flat side runs from (-half, 0) to (half, 0), tilted about the end that is nearer to the floor then.
Placed OnFloor(const Outline& outline, double half, double tilt, double gap) {
  const Rotation r = SinCos(tilt);
  const Vec2 foot = Rotate(r, {tilt > 0 ? -half : half, 0});
  return {outline, {-foot.x, gap - foot.y}, tilt};
}

Outline Shifted(const Outline& outline, double rise) { return Transformed(outline, 0, {0, rise}); }

/// The flat side goes over into curves of vanishing curvature: Bezier curves that begin straight ...
Outline Blended() {
  return {"blended",
          {{{StraightEdge{{-1, 0}, {1, 0}}, 0, 1},
            {BezierEdge{{Vec2{1, 0}, Vec2{1.3, 0}, Vec2{1.6, 0}, Vec2{1.9, 1}}}, 0, 1},
            {StraightEdge{{1.9, 1}, {-1.9, 1}}, 0, 1},
            {BezierEdge{{Vec2{-1.9, 1}, Vec2{-1.6, 0}, Vec2{-1.3, 0}, Vec2{-1, 0}}}, 0, 1}}}};
}
/// ... and quarters of superellipses.
Outline SuperellipticCorners() {
  const auto corner = [](double x, double begin) {
    return OutlinePiece{SuperellipseEdge{{x, 0.5}, 0.5, 0.5, 4, 0, Side::kConvex}, begin, begin + kPi / 2};
  };
  return {"superelliptic corners",
          {{{StraightEdge{{-1, 0}, {1, 0}}, 0, 1},
            corner(1, -kPi / 2),
            {StraightEdge{{1.5, 0.5}, {-1.5, 0.5}}, 0, 1},
            corner(-1, kPi)}}};
}

struct Resting {
  Outline outline;
  double half;        // of the flat side
  bool flat = false;  // goes over into curves without curvature
};

std::vector<Resting> RestingShapes() {
  return {{Shifted(Box(2, 1), 0.5), 1},
          {Shifted(RoundedBox(2, 1, 0.2), 0.5), 0.8},
          {Shifted(RoundedBox(2, 1, 1e-3), 0.5), 0.999},
          {Shifted(Capsule(2, 0.5), 0.5), 1},
          {Transformed(DShape(2, 0.7), 0, {1, 0.7}), 1},
          {Blended(), 1, true},
          {SuperellipticCorners(), 1, true}};
}

// However little it is tilted, also by less than rounding: no contact is lost, none found twice.
TEST(FlushContacts, ABodyOnItsFlatSideTouchesAtBothEndsOfIt) {
  const double gap = 1e-7;
  const double tolerance = 1e-3;
  for (const Resting& shape : RestingShapes()) {
    for (const double tilt : Tilts(1e-4)) {
      const auto rows = Contacts(OnFloor(shape.outline, shape.half, tilt, gap), Floor(), tolerance);
      ASSERT_EQ(rows.size(), 2u) << shape.outline.name << " " << tilt;
      if (std::abs(tilt) < 4e-7) {  // as it does where it has sunk in
        const Placed sunk = OnFloor(shape.outline, shape.half, tilt, -gap);
        EXPECT_EQ(Contacts(sunk, Floor(), 1e-5).size(), 2u) << shape.outline.name << " " << tilt;
      }
      const double rise = 2 * shape.half * std::sin(std::abs(tilt));
      const RowInfo& near = rows[tilt > 0 ? 0 : 1];
      const RowInfo& far = rows[tilt > 0 ? 1 : 0];
      // Where the side goes over into a curve, the nearest point is on the curve: less far away, by the tilt's square
      // at an arc, by its power 3/2 or 4/3 at a flat beginning.
      EXPECT_LE(near.d, gap + 1e-15) << shape.outline.name << " " << tilt;
      EXPECT_GE(near.d, gap - 2 * std::pow(std::abs(tilt), 4.0 / 3) - 1e-15) << shape.outline.name << " " << tilt;
      EXPECT_NEAR(far.d, gap + rise, 1e-15) << shape.outline.name << " " << tilt;
      EXPECT_NEAR(far.p1.x - near.p1.x, (tilt > 0 ? 2 : -2) * shape.half, 2 * std::cbrt(std::abs(tilt)) + 1e-7)
          << shape.outline.name << " " << tilt;
    }
  }
}

TEST(FlushContacts, ABodyTiltedOutOfTheToleranceTouchesAtOneEnd) {
  for (const Resting& shape : RestingShapes()) {
    for (const double tilt : {1e-8, -1e-8, 1e-5, -1e-5, 1e-3, -1e-3}) {
      const double rise = 2 * shape.half * std::abs(tilt);
      const Placed body = OnFloor(shape.outline, shape.half, tilt, 1e-10);
      EXPECT_EQ(Contacts(body, Floor(), 0.99 * rise).size(), 1u) << shape.outline.name << " " << tilt;
      EXPECT_EQ(Contacts(body, Floor(), 1.01 * rise).size(), 2u) << shape.outline.name << " " << tilt;
    }
  }
}

// The ends of the overlap are ends of either body.
TEST(FlushContacts, StackedBodiesTouchAtTheEndsOfTheirOverlap) {
  for (const Resting& shape : RestingShapes()) {
    for (const double offset : {0.0, 1e-12, 1e-9, 3e-9, 1e-8, 1e-5, 0.3, -0.3, 1.1, -1.7}) {
      for (const double tilt : Tilts(1e-6)) {
        Placed body = OnFloor(shape.outline, shape.half, tilt, 1e-7);
        body.x.x += offset * shape.half + (tilt > 0 ? -shape.half : shape.half);
        const Placed base{Box(2 * shape.half, 1), {0, -0.5}, 0};
        const auto rows = Contacts(body, base, 1e-4);
        const std::string where = shape.outline.name + " " + std::to_string(offset) + " " + std::to_string(tilt * 1e9);
        // A corner under the flat beginning of a curve, flush within NormalSpan::kSlack, counts beside the join's end.
        ASSERT_GE(rows.size(), 2u) << where;
        ASSERT_LE(rows.size(), shape.flat ? 3u : 2u) << where;
        const double begin = shape.half * std::max(-1.0, offset - 1);
        const double end = shape.half * std::min(1.0, offset + 1);
        const double near = 2 * std::cbrt(std::abs(tilt)) + (shape.flat ? 2e-5 : 1e-7);
        EXPECT_NEAR(rows.front().p1.x, begin, near) << where;
        EXPECT_NEAR(rows.back().p1.x, end, near) << where;
        for (const RowInfo& row : rows) {
          EXPECT_LE(std::min(std::abs(row.p1.x - begin), std::abs(row.p1.x - end)), near) << where;
        }
      }
    }
  }
}

TEST(FlushContacts, ACornerAtASteeperAngleTouchesOnce) {
  for (const double tilt : {0.02, 0.1, 0.5, kPi / 4}) {
    const Placed body = OnFloor(Shifted(Box(2, 1), 0.5), 1, tilt, 1e-7);
    EXPECT_EQ(Contacts(body, Floor(), 5).size(), 1u) << tilt;
  }
}

// A joint of a floor's own segments is no end of a flush edge, nor is the floor's own end.
TEST(FlushContacts, AFloorOfManySegmentsTouchesAtTheEndsOfTheBodyOnly) {
  Outline floor{"floor", {{}}};
  for (int k = 5; k > -5; --k) {
    const auto x = static_cast<double>(k);
    floor.loops[0].push_back({StraightEdge{{x, 0}, {x - 1, 0}}, 0, 1});
  }
  for (const double tilt : Tilts(1e-5)) {
    Placed body = OnFloor(Shifted(Box(2.5, 1), 0.5), 1.25, tilt, 1e-7);
    body.x.x += 0.4;
    EXPECT_EQ(Contacts(body, {floor, {}, 0}, 1e-3).size(), 2u) << tilt;
  }
}

// docs/model.md section 5: D = 0 where a superellipse stands exactly on a flat point, which is refused; never lost.
TEST(FlushContacts, ASuperellipseOnItsFlatSideTouchesOnceOrIsRefusedByName) {
  for (const int m : {4, 6, 8, 20, 100}) {
    int refused = 0;
    for (const double tilt : Tilts(1e-4)) {
      const Workshop shop({{Superellipse(1, 0.5, m), {0.1, 0.5 + 1e-9}, tilt}, Floor()});
      std::size_t contacts = 1;
      const auto find = [&] { contacts = shop.Rows(1e-2).size(); };
      if (RefusalOf(find).empty()) {
        EXPECT_EQ(contacts, 1u) << m << " " << tilt;
        continue;
      }
      for (const char* words : {"curvature match", "straight edge", "superellipse"}) ExpectRefused(find, words);
      EXPECT_LE(std::abs(tilt), 1e-11) << m;
      ++refused;
    }
    EXPECT_GE(refused, 1) << m;
  }
}

// Next to an inflection the normal turns back: tilted one way a curve has a minimum and a maximum there, the other way
// nothing. Neither is an error.
TEST(FlushContacts, AnInflectionThatLiesFlushOnAFloorTouchesOnOneSideOnly) {
  const Outline wave{"wave", {{{BezierEdge{{Vec2{-1, 0.2}, Vec2{-0.5, -0.2}, Vec2{0.5, 0.2}, Vec2{1, -0.2}}}, 0, 1}}}};
  for (double tilt = 1e-11; tilt < 1e-3; tilt *= 3) {
    for (const double side : {1.0, -1.0}) {
      const Workshop shop({{wave, {0, 1e-6}, side * tilt}, Floor()});
      EXPECT_EQ(shop.Detect(1e-3, 1e-4).size(), side > 0 ? 1u : 0u) << side * tilt;
    }
  }
}

}  // namespace
}  // namespace lcpbench
