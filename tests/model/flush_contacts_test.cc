#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/contact/assembly.h"
#include "model/detection/detection.h"
#include "model/geometry/trig.h"
#include "model/shape/shapes.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr double kPi = 3.14159265358979323846;

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

struct Placed {
  Outline outline;
  Vec2 x;
  double theta = 0;
};

ContactSystem Detected(const Placed& first, const Placed& second, double tolerance) {
  ContactSystem system;
  system.name = "pair";
  for (const Placed* placed : {&first, &second}) {
    Body body;
    body.name = placed->outline.name;
    body.x = placed->x;
    body.theta = placed->theta;
    system.bodies.push_back(body);
  }
  const std::vector<Outline> outlines = {first.outline, second.outline};
  system.constraints = DetectContacts(system.bodies, outlines, {.tolerance = tolerance, .penetration = tolerance / 10});
  return system;
}

/// The contacts, assembled, by their places along x; the same for both orders of the bodies.
std::vector<RowInfo> Contacts(const Placed& upper, const Placed& lower, double tolerance) {
  std::vector<RowInfo> rows = AssembleContactLcp(Detected(upper, lower, tolerance)).rows;
  const auto swapped = AssembleContactLcp(Detected(lower, upper, tolerance)).rows;
  EXPECT_EQ(rows.size(), swapped.size());
  std::sort(rows.begin(), rows.end(), [](const RowInfo& a, const RowInfo& b) { return a.p1.x < b.p1.x; });
  return rows;
}

Outline Floor() { return {"floor", {{{StraightEdge{{5, 0}, {-5, 0}}, 0, 1}}}}; }

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
      const auto rows = Contacts(OnFloor(shape.outline, shape.half, tilt, gap), {Floor(), {}, 0}, tolerance);
      ASSERT_EQ(rows.size(), 2u) << shape.outline.name << " " << tilt;
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
      EXPECT_EQ(Contacts(body, {Floor(), {}, 0}, 0.99 * rise).size(), 1u) << shape.outline.name << " " << tilt;
      EXPECT_EQ(Contacts(body, {Floor(), {}, 0}, 1.01 * rise).size(), 2u) << shape.outline.name << " " << tilt;
    }
  }
}

TEST(FlushContacts, ABodyThatHasSunkInTouchesAtBothEnds) {
  for (const Resting& shape : RestingShapes()) {
    for (const double tilt : Tilts(1e-7)) {
      const Placed body = OnFloor(shape.outline, shape.half, tilt, -1e-7);
      EXPECT_EQ(Contacts(body, {Floor(), {}, 0}, 1e-5).size(), 2u) << shape.outline.name << " " << tilt;
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
  for (const double tilt : {0.02, 0.1, 0.5}) {
    const Placed body = OnFloor(Shifted(Box(2, 1), 0.5), 1, tilt, 1e-7);
    EXPECT_EQ(Contacts(body, {Floor(), {}, 0}, 5).size(), 1u) << tilt;
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

// MODEL.md section 5: D = 0 where a superellipse stands exactly on a flat point, which is refused; never lost.
TEST(FlushContacts, ASuperellipseOnItsFlatSideTouchesOnceOrIsRefusedByName) {
  for (const int m : {4, 6, 8, 20, 100}) {
    const Outline outline = Superellipse(1, 0.5, m);
    int refused = 0;
    for (const double tilt : Tilts(1e-4)) {
      const Placed floor{Floor(), {}, 0};
      const Placed body{outline, {0.1, 0.5 + 1e-9}, tilt};
      try {
        const ContactSystem system = Detected(body, floor, 1e-2);
        EXPECT_EQ(system.constraints.size(), 1u) << m << " " << tilt;
        EXPECT_EQ(AssembleContactLcp(system).rows.size(), 1u);
      } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("curvature match"), std::string::npos) << text;
        EXPECT_NE(text.find("straight edge"), std::string::npos) << text;
        EXPECT_NE(text.find("superellipse"), std::string::npos) << text;
        EXPECT_LE(std::abs(tilt), 1e-11) << m << ": " << text;
        ++refused;
      }
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
      const ContactSystem system = Detected({wave, {0, 1e-6}, side * tilt}, {Floor(), {}, 0}, 1e-3);
      EXPECT_EQ(system.constraints.size(), side > 0 ? 1u : 0u) << side * tilt;
    }
  }
}

}  // namespace
}  // namespace lcpbench
