#include "benchmarks/drawing/picture.h"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <regex>

#include "benchmarks/drawing/drawn_scene.h"
#include "benchmarks/drawing/svg.h"
#include "model/geometry/feature.h"
#include "model/scenes/parts.h"
#include "model/scenes/scene.h"
#include "model/shape/shapes.h"
#include "support/input_error.h"
#include "tests/benchmarks/drawing/free_flight.h"

namespace lcpbench {
namespace {

std::vector<Outline> Shapes() {
  return {Disc(1),           Box(2, 1),        RoundedBox(2, 1, 0.2),
          Ring(1, 0.5),      Ellipse(1, 0.4),  Superellipse(1, 0.6, 8),
          Gear(GearShape{}), Cam(1, 0.4, 1.2), Bowl(1, 0.8, 1)};
}

std::vector<OutlinePiece> Pieces() {
  std::vector<OutlinePiece> pieces;
  for (const Outline& outline : Shapes()) {
    for (const OutlinePiece& piece : AllPieces(outline)) pieces.push_back(piece);
  }
  return pieces;
}

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

void ExpectWellFormed(const std::string& svg) {
  std::istringstream text(svg);
  boost::property_tree::ptree tree;
  EXPECT_NO_THROW(boost::property_tree::read_xml(text, tree));
  for (const char* bad : {"nan", "inf"}) EXPECT_EQ(svg.find(bad), std::string::npos);
}

std::string Drawn(const ContactSystem& system, const PictureExtras& extras = {}) {
  std::string svg = RenderSvg(system, AssembleContactLcp(system), nullptr, nullptr, extras);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  return svg;
}

TEST(PieceFlattening, StaysWithinItsToleranceOfTheCurve) {
  for (const double flatness : {1e-2, 1e-4}) {
    for (const OutlinePiece& piece : Pieces()) {
      const std::vector<double> s = FlatParameters(piece, flatness);
      ASSERT_EQ(s.front(), piece.s_begin);
      ASSERT_EQ(s.back(), piece.s_end);
      for (std::size_t k = 1; k < s.size(); ++k) {
        const Vec2 a = CurvePoint(piece.edge, s[k - 1]);
        const Vec2 chord = CurvePoint(piece.edge, s[k]) - a;
        for (int i = 1; i < 16; ++i) {
          const Vec2 p = CurvePoint(piece.edge, s[k - 1] + (s[k] - s[k - 1]) * i / 16) - a;
          EXPECT_LE(std::abs(Cross(chord, p)), 1.5 * flatness * Norm(chord)) << piece.edge.index();
        }
      }
    }
  }
}

TEST(PiecePath, EndsWhereThePieceEnds) {
  constexpr double kUnit = 20;
  const std::regex numbers("(-?[0-9.]+) (-?[0-9.]+)$");
  for (const OutlinePiece& piece : Pieces()) {
    const std::string path = PiecePath(piece, kUnit, "M");
    const Vec2 end = kUnit * CurvePoint(piece.edge, piece.s_end);
    std::smatch match;
    ASSERT_TRUE(std::regex_search(path, match, numbers)) << path;
    EXPECT_NEAR(std::stod(match[1]), end.x, 0.006) << path;
    EXPECT_NEAR(std::stod(match[2]), end.y, 0.006) << path;
  }
}

TEST(Pictures, FillHolesColourEveryKindOfEdgeAndDrawJointsLoadsAndDrivenBodies) {
  World world = Exhibition();
  world.bodies[0].v = {1, 0};  // so that no body is at rest
  const std::string svg = Drawn({"exhibition", world.bodies, world.joints}, {&world.loads, "some words"});
  const auto has_outline = [](const Body& body) { return !body.outline.empty(); };
  EXPECT_EQ(Count(svg, "fill-rule=\"evenodd\""), std::count_if(world.bodies.begin(), world.bodies.end(), has_outline));
  for (const EdgeStyle& style : kEdgeStyles) {
    EXPECT_NE(svg.find("stroke=\"" + std::string(style.color) + "\""), std::string::npos) << style.name;
    EXPECT_NE(svg.find(">" + std::string(style.name) + "<"), std::string::npos) << style.name;
  }
  for (const char* part : {">pin (1)<", ">rod (1)<", ">rope (1)<", ">path joint (1)<", ">spring (1)<", ">damper (1)<",
                           ">driven<", ">gravity 9.81 m/s\u00B2<", "some words", "<title>drum, driven, "}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
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

// A force on the edge of its cone sticks where w is 0.
TEST(ForcesOf, TellContactsThatSlideFromThoseThatStick) {
  const ContactSystem system = GenerateScene("three-discs", 10, 1);
  const AssembledLcp lcp = AssembleInstant(system, 0.01);
  ASSERT_EQ(lcp.rows.size(), 8U);
  const double mu = system.constraints[0].friction;
  Eigen::VectorXd f(8);
  f << 1, mu, 2, mu, 3, -3 * system.constraints[2].friction, 0, 0;
  Eigen::VectorXd w = Eigen::VectorXd::Zero(8);
  w[1] = -0.1;
  w[3] = 1e-12;
  const std::vector<DrawnForce> forces = ForcesOf(system, lcp.rows, f, SlidingRows(lcp.problem, f, w));
  ASSERT_EQ(forces.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(forces[i].slides, i == 0) << i;
  EXPECT_EQ(forces[0].force, lcp.rows[0].n + mu * lcp.rows[1].n);
  EXPECT_EQ(forces[1].force, 2 * lcp.rows[2].n + mu * lcp.rows[3].n);
  const auto cones = ConesOf(system, lcp.rows, f);
  ASSERT_EQ(cones.size(), 3U);
  EXPECT_EQ(cones[0].sides[0], forces[0].force);
}

TEST(RenderSvg, ShowsConesAndWhatSlides) {
  for (const SceneFamily& family : FrictionScenes()) {
    const ContactSystem system = family.generate(40, 2);
    const AssembledLcp lcp = AssembleInstant(system, family.step);
    const Eigen::VectorXd f = Eigen::VectorXd::Ones(lcp.problem.size());
    const Eigen::VectorXd w = Eigen::VectorXd::Zero(lcp.problem.size());
    const std::string svg = RenderSvg(system, lcp, &f, &w);
    SCOPED_TRACE(family.key);
    ExpectWellFormed(svg);
    EXPECT_NE(svg.find(">friction cone<"), std::string::npos) << family.key;
  }
}

// y points down on the page.
TEST(Pictures, TurnBodiesAndMirrorTheirFramesAndVectors) {
  ContactSystem system;
  system.name = "turned";
  system.bodies = {MakeBox({}, 2, 1, 1), MakeFixed("lift")};
  system.bodies[0].theta = kPi / 6;
  system.bodies[1].v = {0, 1};
  const std::string svg = Drawn(system);
  // A point (1, 0) of the body lies right of its centre and above.
  EXPECT_NE(svg.find("transform=\"matrix(0.866025 -0.500000 -0.500000 -0.866025 "), std::string::npos);
  const std::regex arrow("M[-0-9.]+ ([-0-9.]+)L[-0-9.]+ ([-0-9.]+)\" fill=\"none\" stroke=\"" +
                         std::string(kDrivenFill[1]) + "\"");
  std::smatch up;
  ASSERT_TRUE(std::regex_search(svg, up, arrow)) << svg;
  EXPECT_GT(std::stod(up[1]), std::stod(up[2]));
}

// A disc of 2 kg on a floor bears its weight.
TEST(Pictures, LabelForcesWhereThereIsRoomOnly) {
  ContactSystem system;
  system.name = "rest";
  Body floor = MakeFixed("floor");
  floor.outline = {WholeEdge({50, 0}, {-50, 0})};
  AddBody(&system, "floor", floor);
  for (int count : {1, 400}) {
    while (static_cast<int>(system.constraints.size()) < count) {
      const int disc =
          AddBody(&system, "disc", MakeDisc({0.1 * static_cast<double>(system.constraints.size()), 0.04}, 0.04, 1));
      AddContact(&system, disc, Circle(0.04), 0, StraightEdge{{50, 0}, {-50, 0}});
    }
    const Eigen::VectorXd f = Eigen::VectorXd::Constant(count, 19.62);
    const Eigen::VectorXd w = Eigen::VectorXd::Zero(count);
    const std::string svg = RenderSvg(system, AssembleContactLcp(system), &f, &w);
    EXPECT_EQ(Count(svg, ">19.6 N<"), count == 1 ? 1 : 0);
    EXPECT_NE(svg.find("active, f &gt; 0 (" + std::to_string(count) + ")"), std::string::npos);
  }
}

TEST(RenderSvg, IsNoLongerForBodiesThatAreFarApart) {
  for (double far = 1; far < 1e31; far *= 1e3) {
    Body left = MakeBody(Disc(1), 1);
    Body right = left;
    right.x = {far, 0};
    EXPECT_LT(Drawn({"far", {left, right}, {}}).size(), 500'000u) << far;
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
        SCOPED_TRACE(family.key);
        ExpectWellFormed(svg);
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
