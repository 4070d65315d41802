#include "benchmarks/drawing/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <string>
#include <variant>
#include <vector>

#include "benchmarks/drawing/picture_outline.h"
#include "benchmarks/drawing/picture_style.h"
#include "model/geometry/feature.h"
#include "model/scenes/parts.h"
#include "model/shape/mass_properties.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

std::vector<Outline> Shapes() {
  return {Disc(1),           Box(2, 1),        RoundedBox(2, 1, 0.2),
          Ring(1, 0.5),      Ellipse(1, 0.4),  Superellipse(1, 0.6, 8),
          Gear(GearShape{}), Cam(1, 0.4, 1.2), Bowl(1, 0.8, 1)};
}

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(PieceFlattening, StaysWithinItsToleranceOfTheCurve) {
  for (const double flatness : {1e-2, 1e-4}) {
    for (const Outline& outline : Shapes()) {
      for (const OutlinePiece& piece : AllPieces(outline)) {
        const std::vector<double> s = FlatParameters(piece, flatness);
        ASSERT_EQ(s.front(), piece.s_begin);
        ASSERT_EQ(s.back(), piece.s_end);
        for (std::size_t k = 1; k < s.size(); ++k) {
          const Vec2 a = CurvePoint(piece.edge, s[k - 1]);
          const Vec2 chord = CurvePoint(piece.edge, s[k]) - a;
          for (int i = 1; i < 16; ++i) {
            const Vec2 p = CurvePoint(piece.edge, s[k - 1] + (s[k] - s[k - 1]) * i / 16) - a;
            EXPECT_LE(std::abs(Cross(chord, p)), 1.5 * flatness * Norm(chord)) << outline.name;
          }
        }
      }
    }
  }
}

TEST(PiecePath, EndsWhereThePieceEndsOnThePage) {
  const PageMap map{{100, 50}, 20, SinCos(0.7), 0.7, true};
  for (const Outline& outline : Shapes()) {
    for (const OutlinePiece& piece : AllPieces(outline)) {
      const std::string path = PiecePath(piece, map, "M");
      const Vec2 end = map(CurvePoint(piece.edge, piece.s_end));
      const std::regex numbers("(-?[0-9.]+) (-?[0-9.]+)$");
      std::smatch match;
      ASSERT_TRUE(std::regex_search(path, match, numbers)) << path;
      EXPECT_NEAR(std::stod(match[1]), end.x, 0.006) << path;
      EXPECT_NEAR(std::stod(match[2]), end.y, 0.006) << path;
    }
  }
}

TEST(PageMap, TurnsAndMirrorsBodyFramePoints) {
  const PageMap map{{10, 20}, 2, SinCos(kPi / 2), kPi / 2, true};
  const Vec2 p = map({3, 0});  // three metres up, that is six pixels towards smaller y
  EXPECT_NEAR(p.x, 10, 1e-12);
  EXPECT_NEAR(p.y, 14, 1e-12);
}

TEST(Outlines, AreBoundedUnlessTheMaterialLiesOutside) {
  for (const Outline& outline : Shapes()) EXPECT_TRUE(IsBounded(outline)) << outline.name;
  EXPECT_FALSE(IsBounded({"track", {{FullCircle({}, 1, Side::kConcave)}}}));
  EXPECT_FALSE(IsBounded({"floor", {{WholeEdge({1, 0}, {-1, 0})}}}));
  EXPECT_FALSE(IsBounded({}));
}

TEST(EdgeStyles, HaveColoursOfTheirOwn) {
  for (std::size_t i = 0; i < kEdgeStyles.size(); ++i) {
    EXPECT_NE(kEdgeStyles[i].color, kForceColor);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(kEdgeStyles[i].color, kEdgeStyles[j].color);
  }
}

TEST(Pictures, FillHolesByTheEvenOddRuleAndColourEveryKindOfEdge) {
  ContactSystem system;
  system.name = "shapes";
  double x = 0;
  for (const Outline& outline : Shapes()) {
    Body body = MakeBody(outline, 1);
    body.x = {x += 3, 0};
    system.bodies.push_back(body);
  }
  Body curve;
  curve.name = "leaf";
  curve.outline = {{BezierEdge{{{{0, 0}, {1, -1}, {2, -1}, {3, 0}}}}, 0, 1},
                   {BezierEdge{{{{3, 0}, {2, 1}, {1, 1}, {0, 0}}}}, 0, 1}};
  system.bodies.push_back(curve);
  const std::string svg = RenderSvg(system, AssembleContactLcp(system), nullptr, nullptr);
  EXPECT_EQ(Count(svg, "fill-rule=\"evenodd\""), static_cast<int>(system.bodies.size()));
  for (const EdgeStyle& style : kEdgeStyles) {
    EXPECT_NE(svg.find("stroke=\"" + std::string(style.color) + "\""), std::string::npos) << style.name;
    EXPECT_NE(svg.find(">" + std::string(style.name) + "<"), std::string::npos) << style.name;
  }
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Pictures, DrawJointsSpringsDampersAndDrivenBodies) {
  ContactSystem system;
  system.name = "joints";
  for (int i = 0; i < 5; ++i) {
    Body body = MakeDisc({2.0 * i, 0}, 0.5, 1);
    body.name = "disc " + std::to_string(i);
    system.bodies.push_back(body);
  }
  Body drum = MakeFixed("drum");
  drum.outline = AllPieces(Ring(0.7, 0.6));
  drum.omega = 2;
  system.bodies.push_back(drum);
  const auto joint = [&](ConstraintType type, int body1, Vec2 point1, int body2, const Feature& feature2) {
    system.constraints.push_back({type, body1, body2, Vertex{point1}, feature2, {}, {}, 0, 1.5});
  };
  joint(ConstraintType::kPin, 0, {1, 0}, 1, Vertex{{-1, 0}});
  joint(ConstraintType::kRod, 1, {0.4, 0}, 2, Vertex{{-0.1, 0}});
  joint(ConstraintType::kRope, 2, {0.4, 0}, 3, Vertex{{-0.4, 0}});
  joint(ConstraintType::kPathJoint, 4, {0, 0}, 3, ArcEdge{{}, 2, Side::kConvex});
  Loads loads;
  loads.gravity = {0, -kGravity};
  loads.springs.push_back({{0, {}}, {4, {}}, 1, 1});
  loads.dampers.push_back({{4, {}}, {0, {}}, 1});
  const std::string svg = RenderSvg(system, AssembleContactLcp(system), nullptr, nullptr, {&loads, "some words"});
  for (const char* item : {"pin (1)", "rod (1)", "rope (1)", "path joint (1)", "spring (1)", "damper (1)", "driven",
                           "gravity 9.81 m/s\u00B2"}) {
    EXPECT_NE(svg.find(std::string(">") + item + "<"), std::string::npos) << item;
  }
  EXPECT_NE(svg.find("some words"), std::string::npos);
  EXPECT_NE(svg.find("<title>drum, driven, "), std::string::npos);
  EXPECT_EQ(svg.find(">fixed<"), std::string::npos);
}

// A disc of 2 kg on a floor bears its weight.
TEST(Pictures, LabelForcesWhereThereIsRoomOnly) {
  ContactSystem system;
  system.name = "rest";
  Body floor = MakeFixed("floor");
  floor.outline = {WholeEdge({50, 0}, {-50, 0})};
  AddBody(&system, "floor", floor);
  Eigen::VectorXd f(1);
  for (int count : {1, 400}) {
    while (static_cast<int>(system.constraints.size()) < count) {
      const int disc =
          AddBody(&system, "disc", MakeDisc({0.1 * static_cast<double>(system.constraints.size()), 0.04}, 0.04, 1));
      AddContact(&system, disc, Circle(0.04), 0, StraightEdge{{50, 0}, {-50, 0}});
    }
    f = Eigen::VectorXd::Constant(count, 19.62);
    const Eigen::VectorXd w = Eigen::VectorXd::Zero(count);
    const std::string svg = RenderSvg(system, AssembleContactLcp(system), &f, &w);
    EXPECT_EQ(Count(svg, ">19.6 N<"), count == 1 ? 1 : 0);
    EXPECT_NE(svg.find("active, f &gt; 0 (" + std::to_string(count) + ")"), std::string::npos);
  }
}

}  // namespace
}  // namespace lcpbench
