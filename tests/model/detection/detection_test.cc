#include "model/detection/detection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/detection/narrow_phase.h"
#include "model/scenes/scene.h"
#include "model/shape/shapes.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Bodies with outlines whose frames are their centres of mass.
class Workshop {
 public:
  int Add(const Outline& outline, Vec2 x, double theta = 0, bool fixed = false) {
    Body body;
    body.name = outline.name;
    body.x = x;
    body.theta = theta;
    body.fixed = fixed;
    bodies_.push_back(body);
    outlines_.push_back(outline);
    return static_cast<int>(bodies_.size()) - 1;
  }

  std::vector<Constraint> Detect(double tolerance = 1e-6, double penetration = 1e-6) const {
    return DetectContacts(bodies_, outlines_, {.tolerance = tolerance, .penetration = penetration});
  }

  /// The contacts' geometry, from the assembly: every detected constraint must give a row.
  std::vector<RowInfo> Rows(double tolerance = 1e-6) const {
    return AssembleContactLcp({"workshop", bodies_, Detect(tolerance)}).rows;
  }

 private:
  std::vector<Body> bodies_;
  std::vector<Outline> outlines_;
};

Outline Floor(double half_width) { return {"floor", {{{StraightEdge{{half_width, 0}, {-half_width, 0}}, 0, 1}}}}; }

bool HasFootAt(const std::vector<RowInfo>& rows, Vec2 p) {
  return std::any_of(rows.begin(), rows.end(), [&](const RowInfo& row) { return Norm(row.p1 - p) < 1e-6; });
}

TEST(Detection, ARoundedBoxLyingOnAFloorTouchesItAtTheEndsOfItsFlatSide) {
  Workshop shop;
  shop.Add(Floor(5), {}, 0, true);
  shop.Add(RoundedBox(2, 1, 0.2), {0.3, 0.5 + 1e-8});
  const auto rows = shop.Rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(HasFootAt(rows, {0.3 - 0.8, 0}));
  EXPECT_TRUE(HasFootAt(rows, {0.3 + 0.8, 0}));
  for (const RowInfo& row : rows) EXPECT_NEAR(row.d, 1e-8, 1e-14);
}

TEST(Detection, FlushBoxesTouchAtTheEndsOfTheOverlap) {
  Workshop shop;
  shop.Add(Box(2, 1), {0, 0});
  shop.Add(Box(2, 1), {0.5, 1});
  const auto rows = shop.Rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(HasFootAt(rows, {-0.5, 0.5}));
  EXPECT_TRUE(HasFootAt(rows, {1, 0.5}));
}

TEST(Detection, EqualFlushBoxesInOneStackTouchAtTwoCorners) {
  for (const double theta : {0.0, 0.3, -1.1, 2.0}) {
    Workshop shop;
    const Rotation r = SinCos(theta);
    for (int k = 0; k < 5; ++k) shop.Add(Box(2, 1), Rotate(r, {0, static_cast<double>(k)}), theta);
    EXPECT_EQ(shop.Rows().size(), 8u) << theta;
  }
}

TEST(Detection, ABoxStandingOnACornerTouchesOnce) {
  Workshop shop;
  shop.Add(Floor(5), {}, 0, true);
  shop.Add(Box(1, 1), {0, std::sqrt(0.5)}, kPi / 4);
  EXPECT_EQ(shop.Rows().size(), 1u);
}

// The normal at (a cos s, -b sin s) meets the ellipse's axis x = 0 at the height c^2 sin s / b, c^2 = a^2 - b^2, at the
// distance sqrt(a^2 + (a/b)^2 c^2 sin^2 s): the radius of the bowl that touches there, about that centre.
TEST(Detection, AnEllipseInABowlTouchesItAtTwoPoints) {
  const double a = 0.9;
  const double b = 0.5;
  const Rotation at = SinCos(0.7);
  const double c2 = a * a - b * b;
  const double radius = std::sqrt(a * a + a * a * c2 / (b * b) * at.sin * at.sin);
  Workshop shop;
  shop.Add(Bowl(1.5 * radius, radius, 1), {}, 0, true);
  shop.Add(Ellipse(a, b), {0, -c2 * at.sin / b});
  const auto rows = shop.Rows();
  ASSERT_EQ(rows.size(), 2u);
  const double y = -b * at.sin - c2 * at.sin / b;
  EXPECT_TRUE(HasFootAt(rows, {a * at.cos, y}));
  EXPECT_TRUE(HasFootAt(rows, {-a * at.cos, y}));
}

TEST(Detection, ADiscInARingTouchesItOnce) {
  Workshop shop;
  shop.Add(Ring(2, 1), {}, 0.4);
  shop.Add(Disc(0.3), {0.7 * 0.6, 0.7 * 0.8}, 1.0);
  const auto rows = shop.Rows();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_TRUE(HasFootAt(rows, {0.6, 0.8}));
}

TEST(Detection, ADiscInAHoleOfEqualRadiusIsRefusedNamingBothArcs) {
  Workshop shop;
  shop.Add(Ring(2, 1), {});
  shop.Add(Disc(1), {});
  try {
    shop.Detect();
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("convex arc"), std::string::npos) << text;
    EXPECT_NE(text.find("concave arc"), std::string::npos) << text;
    EXPECT_NE(text.find('\n'), 0u);
  }
}

Outline EllipticHole(double a, double b) {
  Outline outline = Box(4 * a, 4 * a);
  outline.name = "elliptic hole";
  outline.loops.push_back({{EllipseEdge{{}, a, b, 0, Side::kConcave}, 2 * kPi, 0}});
  return outline;
}

TEST(Detection, AnEllipseInAHoleOfItsOwnShapeIsRefused) {
  Workshop shop;
  shop.Add(EllipticHole(1, 0.6), {});
  shop.Add(Ellipse(1, 0.6), {});
  EXPECT_THROW(shop.Detect(), InputError);
}

TEST(Detection, ABallAtTheSmoothJoinOfAStraightAndAnArcTouchesOnce) {
  // A floor from the left that turns up into a quarter pipe at the origin.
  const Outline pipe{"quarter pipe",
                     {{{ArcEdge{{0, 1}, 1, Side::kConcave}, 0, -kPi / 2}, {StraightEdge{{0, 0}, {-3, 0}}, 0, 1}}}};
  for (const double x : {0.0, 1e-13, -1e-13, 1e-10, -1e-10, 1e-8, -1e-8}) {
    Workshop shop;
    shop.Add(pipe, {}, 0, true);
    shop.Add(Disc(0.25), {x, 0.25});
    EXPECT_EQ(shop.Detect().size(), 1u) << x;
  }
}

// Gears have more spans than kManySpans, so that every one has a box of its own; the narrow phase alone must agree.
TEST(Detection, GearsTouchWhereTheirTeethDo) {
  const GearShape shape;
  std::size_t found = 0;
  for (const double turned : {0.0, 0.1, 0.2, 0.35}) {
    Workshop shop;
    shop.Add(Gear(shape), {});
    shop.Add(Gear(shape), {1.85, 0}, turned);
    const auto contacts = shop.Detect(0.05, 0.05);
    const auto minima =
        FindGapMinima(PlaceOutline(Gear(shape), {}, 0), PlaceOutline(Gear(shape), {1.85, 0}, turned), {0.05, 0.05});
    ASSERT_EQ(contacts.size(), minima.size()) << turned;
    found += contacts.size();
    for (std::size_t k = 0; k < minima.size(); ++k) EXPECT_EQ(contacts[k].nominal_gap, minima[k].closest.d) << turned;
  }
  EXPECT_GE(found, 2u);
}

TEST(Detection, ManyBodiesInOneTrackTouchItOnceEach) {
  Workshop shop;
  shop.Add(Ring(6, 5), {}, 0, true);
  const int count = 40;
  for (int k = 0; k < count; ++k) {
    // Ellipses standing with their tips on the track, discs between them.
    const double angle = 2 * kPi * k / count;
    const Rotation u = SinCos(angle);
    const double a = k % 2 == 0 ? 0.3 : 0.2;
    shop.Add(k % 2 == 0 ? Ellipse(a, 0.2) : Disc(a), (5 - a - 1e-7) * Vec2{u.cos, u.sin}, angle);
  }
  const auto contacts = shop.Detect();
  ASSERT_EQ(contacts.size(), static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    EXPECT_EQ(contacts[static_cast<std::size_t>(k)].body2, k + 1);
    EXPECT_NEAR(contacts[static_cast<std::size_t>(k)].nominal_gap, 1e-7, 1e-14);
  }
}

TEST(Detection, FixedBodiesDoNotTouchEachOther) {
  Workshop shop;
  shop.Add(Box(2, 1), {0, 0}, 0, true);
  shop.Add(Box(2, 1), {0.5, 1}, 0, true);
  EXPECT_TRUE(shop.Detect().empty());
}

TEST(Detection, RefusesBadInputNamingBodyAndEdge) {
  Workshop shop;
  Outline box = Box(2, 1);
  std::get<StraightEdge>(box.loops[0][2].edge).b = std::get<StraightEdge>(box.loops[0][2].edge).a;
  shop.Add(box, {0, 0});
  shop.Add(Box(1, 1), {0, 1});
  try {
    shop.Detect();
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("body '" + box.name + "'"), std::string::npos) << text;
    EXPECT_NE(text.find("edge 2"), std::string::npos) << text;
  }
  Workshop valid;
  valid.Add(Box(1, 1), {0, 1});
  EXPECT_THROW(valid.Detect(0, 0), InputError);
  EXPECT_THROW(valid.Detect(1e-6, -1), InputError);
}

std::multiset<std::pair<int, int>> BodyPairs(const std::vector<Constraint>& contacts) {
  std::multiset<std::pair<int, int>> pairs;
  for (const Constraint& c : contacts) pairs.insert(std::minmax(c.body1, c.body2));
  return pairs;
}

TEST(Detection, FindsTheListedContactsOfTheScenesOfDiscs) {
  for (const char* key : {"discs-in-v", "disc-pile", "disc-track", "boxes-and-discs"}) {
    // With one row, a scene may leave contacts out.
    for (const int rows : {2, 7, 60, 301}) {
      const ContactSystem system = GenerateScene(key, rows, 5);
      std::vector<Outline> outlines;
      for (const Body& body : system.bodies) outlines.push_back(OutlineOf(body));
      const auto contacts = DetectContacts(system.bodies, outlines, {.tolerance = 1e-9, .penetration = 1e-9});
      EXPECT_EQ(BodyPairs(contacts), BodyPairs(system.constraints)) << key << " " << rows;
    }
  }
}

}  // namespace
}  // namespace lcpbench
