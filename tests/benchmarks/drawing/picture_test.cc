#include "benchmarks/drawing/picture.h"

#include <gtest/gtest.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/drawing/drawn_scene.h"
#include "benchmarks/drawing/outline_path.h"
#include "model/geometry/feature.h"
#include "model/scenes/parts.h"
#include "model/scenes/scene.h"
#include "model/shape/shapes.h"
#include "support/input_error.h"

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

TEST(PiecePath, EndsWhereThePieceEnds) {
  constexpr double kUnit = 20;
  for (const Outline& outline : Shapes()) {
    for (const OutlinePiece& piece : AllPieces(outline)) {
      const std::string path = PiecePath(piece, kUnit, "M");
      const Vec2 end = kUnit * CurvePoint(piece.edge, piece.s_end);
      const std::regex numbers("(-?[0-9.]+) (-?[0-9.]+)$");
      std::smatch match;
      ASSERT_TRUE(std::regex_search(path, match, numbers)) << path;
      EXPECT_NEAR(std::stod(match[1]), end.x, 0.006) << path;
      EXPECT_NEAR(std::stod(match[2]), end.y, 0.006) << path;
    }
  }
}

// Arcs turn the way that the parameter goes: counter-clockwise in a frame with y up.
TEST(PiecePath, TurnsArcsTheWayOfTravel) {
  EXPECT_NE(PiecePath({Circle(1), 0, 1}, 10, "M").find("A10 10 0 0 1 "), std::string::npos);
  EXPECT_NE(PiecePath({Circle(1), 1, 0}, 10, "M").find("A10 10 0 0 0 "), std::string::npos);
}

TEST(Pictures, TurnBodiesAndMirrorTheirFrames) {
  ContactSystem system;
  system.name = "turned";
  system.bodies = {MakeBox({}, 2, 1, 1)};
  system.bodies[0].theta = kPi / 6;
  const std::string svg = RenderSvg(system, AssembleContactLcp(system), nullptr, nullptr);
  // A point (1, 0) of the body lies right of its centre and, y pointing down on the page, above.
  EXPECT_NE(svg.find("transform=\"matrix(0.866025 -0.500000 -0.500000 -0.866025 "), std::string::npos);
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

TEST(ForcesOf, ActOnBodyOneOrOnTheOneThatCanMoveAndJoinTheRowsOfAPin) {
  ContactSystem system;
  system.bodies = {MakeFixed("ground"), MakeDisc({}, 1, 1), MakeDisc({2, 0}, 1, 1)};
  system.constraints = {{ConstraintType::kPin, 1, 2, {}, {}, {}, {}}, {ConstraintType::kRod, 0, 1, {}, {}, {}, {}}};
  std::vector<RowInfo> rows(4);
  rows[0] = {0, 'x', true, {1, 0}, {1, 0}, {1, 0}};
  rows[1] = {0, 'y', true, {1, 0}, {1, 0}, {0, 1}};
  rows[2] = {1, 'n', true, {5, 5}, {0, 3}, {0, 1}};
  rows[3] = rows[2];
  const std::vector<DrawnForce> forces = ForcesOf(system, rows, Eigen::Vector4d(3, 4, 7, 0));
  ASSERT_EQ(forces.size(), 2U);
  EXPECT_EQ(forces[0].force, (Vec2{3, 4}));
  EXPECT_EQ(forces[0].at, (Vec2{1, 0}));
  EXPECT_EQ(forces[1].force, (Vec2{0, -7}));
  EXPECT_EQ(forces[1].at, (Vec2{0, 3}));
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

TEST(RenderSvg, DrawsEveryBodyOfEveryFamilyInWellFormedSvg) {
  for (const SceneFamily& family : AllScenes()) {
    for (const int rows : {1, 12, 150, 400}) {
      const ContactSystem system = family.generate(rows, 2);
      const AssembledLcp lcp = AssembleContactLcp(system);
      const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(rows, 0, 1);
      const Eigen::VectorXd w = Eigen::VectorXd::Zero(rows);
      for (const bool solved : {false, true}) {
        const std::string svg = RenderSvg(system, lcp, solved ? &f : nullptr, solved ? &w : nullptr);
        std::istringstream text(svg);
        boost::property_tree::ptree tree;
        EXPECT_NO_THROW(boost::property_tree::read_xml(text, tree)) << family.key;
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
}

}  // namespace
}  // namespace lcpbench
