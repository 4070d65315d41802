#include "model/shape/outline.h"

#include "model/shape/shapes.h"
#include "tests/model/shape/random_outlines.h"

namespace lcpbench::testing {
namespace {

// One line that names the outline and holds every one of the texts.
void Refuses(const Outline& outline, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    ExpectRefused([&] { RequireValid(outline); }, text, "outline '" + outline.name + "'");
  }
}

Outline WithHole(Outline outline, Vec2 center, double radius) {
  outline.loops.push_back({Arc(center, radius, 2 * kPi, 0)});
  return outline;
}

TEST(Outline, RandomMixturesOfAllEdgesAreValidWhereverTheyAre) {
  Random random(1);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    const Outline outline = RandomOutline(&random);
    EXPECT_NO_THROW(RequireValid(outline));
    EXPECT_NO_THROW(RequireValid(Transformed(outline, random.Uniform(-3, 3), random.Vector(100))));
    EXPECT_NO_THROW(RequireValid(Scaled(outline, 1e-30)));
    EXPECT_NO_THROW(RequireValid(Scaled(outline, 1e30)));
  }
}

TEST(Outline, PointsAndDirectionsOfCurvesFollowTheirFormulas) {
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    const auto kind = static_cast<EdgeKind>(RandomInteger(kEdgeKinds, &random));
    const OutlinePiece piece = RandomPieceBetween(random.Vector(1), random.Vector(1), kind, &random);
    const double s = piece.s_begin + random.Uniform(0, 1) * (piece.s_end - piece.s_begin);
    const double h = 1e-6;
    const Vec2 difference = CurvePoint(piece.edge, s + h) - CurvePoint(piece.edge, s - h);
    const Vec2 direction = CurveDirection(piece.edge, s);
    EXPECT_NEAR(Cross(difference, direction) / (Norm(difference) * Norm(direction)), 0, 1e-7);
    EXPECT_GT(Dot(difference, direction), 0);
    if (const auto* e = std::get_if<SuperellipseEdge>(&piece.edge)) {
      const Vec2 p = Rotate(SinCos(-e->phi), CurvePoint(piece.edge, s) - e->center);
      EXPECT_NEAR(IntegerPower(p.x / e->a, e->m) + IntegerPower(p.y / e->b, e->m), 1, 1e-12);
      EXPECT_NEAR(Cross(p, Vec2{std::cos(s), std::sin(s)}) / Norm(p), 0, 1e-12);
    }
  }
}

TEST(Outline, BezierPieceIsTheSameCurve) {
  Random random(4);
  for (int k = 0; k < 200; ++k) {
    const BezierEdge edge{{random.Vector(1), random.Vector(1), random.Vector(1), random.Vector(1)}};
    const double s0 = random.Uniform(0, 1);
    const double s1 = random.Uniform(0, 1);
    const BezierEdge piece{BezierPiece(edge, s0, s1)};
    const double t = random.Uniform(0, 1);
    EXPECT_NEAR(Norm(CurvePoint(piece, t) - CurvePoint(edge, s0 + t * (s1 - s0))), 0, 1e-14);
  }
}

TEST(Outline, EnclosuresHoldTheirPieces) {
  Random random(9);
  for (int i = 0; i < 30; ++i) {
    const OutlineLoop loop = RandomOutline(&random).loops[0];
    for (const OutlinePiece& piece : loop) {
      const std::vector<double> cuts = EnclosedCuts(piece);
      ASSERT_GE(cuts.size(), 3U);
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const Vec2 begin = CurvePoint(piece.edge, cuts[k]);
        const Vec2 end = CurvePoint(piece.edge, cuts[k + 1]);
        const double height = Enclose(piece.edge, cuts[k], cuts[k + 1]).height;
        for (const double t : {0.2, 0.4, 0.5, 0.6, 0.8}) {
          const Vec2 p = CurvePoint(piece.edge, cuts[k] + t * (cuts[k + 1] - cuts[k]));
          EXPECT_LE(DistanceToSegment(p, begin, end), height + 1e-14) << Describe(ToFeature(piece.edge));
        }
      }
    }
  }
}

TEST(OutlineChecks, RefuseNumbersThatMakeNoEdgeAndOutlinesWithoutAny) {
  const auto with = [](const OutlinePiece& piece) {
    Outline outline = Polygon({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
    outline.loops[0][2] = piece;
    return outline;
  };
  const std::string edge = "outer boundary, edge 2";
  // What RequireValid refuses of a curve (curve_test.cc, closest_points_test.cc) is refused of a piece.
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    Refuses(with(Line({bad, 2}, {0, 2})), {edge, "straight edge", "not finite"});
    Refuses(with({StraightEdge{{2, 2}, {0, 2}}, 0, bad}), {edge, "not finite"});
    Refuses(with(Arc({0, 0}, bad, 0, 1)), {edge, "arc"});
  }
  for (const int m : {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    Refuses(with({SuperellipseEdge{{}, 1, 1, m, 0, Side::kConvex}, 0, 1}), {edge, "exponent", "even"});
  }
  Refuses(with({StraightEdge{{2, 2}, {0, 2}}, 0.5, 0.5}), {edge, "zero-length"});
  Refuses(with({StraightEdge{{2, 2}, {0, 2}}, 1, 0}), {edge, "s_begin < s_end"});
  Refuses(with({StraightEdge{{2, 2}, {0, 2}}, 0, 1.5}), {edge, "0..1"});
  Refuses(with({ArcEdge{{}, 1, Side::kConvex}, 1, 0}), {edge, "counter-clockwise"});
  Refuses(with({ArcEdge{{}, 1, Side::kConcave}, 0, 1}), {edge, "clockwise"});
  Refuses(with(Arc({}, 1, 0, 7)), {edge, "full turn"});
  Refuses(with(Arc({}, 1, 1e9, 1e9 + 1)), {edge, "1000 rad"});
  Refuses({"empty", {}}, {"no outer boundary"});
  Refuses({"empty", {{}}}, {"outer boundary", "no edges"});
  Outline hole = Disc(1);
  hole.loops.emplace_back();
  Refuses(hole, {"hole 1", "no edges"});
}

TEST(OutlineChecks, RefuseOpenOutlinesBeyondTheToleranceAndLengthsWithoutDigits) {
  const auto gap = [](double size) {
    return Outline{"gap",
                   {{Line({0, 0}, {1, 0}), Line({1, 0}, {1, 1}), Line({1, 1}, {0, 1 + size}), Line({0, 1}, {0, 0})}}};
  };
  EXPECT_NO_THROW(RequireValid(gap(1e-10)));
  Refuses(gap(1e-8), {"edge 2", "open outline", "edge 3"});
  Refuses({"line", {{Line({0, 0}, {1, 0})}}}, {"edge 0", "open outline"});
  Refuses({"arc", {{Arc({}, 1, 0, 6)}}}, {"edge 0", "open outline"});
  Refuses(Scaled(Polygon({{0, 0}, {1, 0}, {0, 1}}), 1e-61), {"lengths must be above 1e-60"});
}

TEST(OutlineChecks, RefuseSelfIntersections) {
  Refuses(Polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), {"self-intersecting", "edge 0", "edge 2"});
  // A vertex on an edge, an edge run twice, a spike.
  Refuses(Polygon({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}}), {"self-intersecting", "edge 0"});
  Refuses(Polygon({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}), {"self-intersecting"});
  Refuses(Polygon({{0, 0}, {2, 0}, {2, 2}, {2, 3}, {2, 2}, {0, 2}}), {"self-intersecting"});
  // A line through an arc; an arc bulging through the opposite side.
  Refuses({"cut", {{Arc({}, 1, 0, kPi), Line({-1, 0}, {0, 2}), Line({0, 2}, {1, 0})}}}, {"self-intersecting"});
  const double R = 1.02;
  const double h = std::sqrt(R * R - 1);
  Outline bulge{"bulge",
                {{Line({-1, -0.1}, {1, -0.1}), Line({1, -0.1}, {1, 0}),
                  Arc({0, h}, R, 2 * kPi - std::atan2(h, 1.0), kPi + std::atan2(h, 1.0)), Line({-1, 0}, {-1, -0.1})}}};
  Refuses(bulge, {"self-intersecting", "edge 0", "edge 2"});
  // One Bezier edge with a loop.
  Refuses({"loop",
           {{{BezierEdge{{Vec2{0, 0}, Vec2{4, 3}, Vec2{-2, 3}, Vec2{2, 0}}}, 0, 1},
             Line({2, 0}, {3, -1}),
             Line({3, -1}, {-1, -1}),
             Line({-1, -1}, {0, 0})}}},
          {"self-intersecting", "itself"});
  // A crescent of two circles that touch from inside.
  Refuses({"crescent", {{Arc({}, 1, 0, 2 * kPi), Arc({0.5, 0}, 0.5, 2 * kPi, 0)}}}, {"self-intersecting"});
  // A small angle is allowed.
  EXPECT_NO_THROW(RequireValid(Polygon({{0, 0}, {1, -1e-4}, {1, 1e-4}})));
}

TEST(OutlineChecks, RefuseTheWrongSenseOfTravel) {
  Refuses(Polygon({{0, 0}, {0, 1}, {1, 1}, {1, 0}}), {"outer boundary", "edge 0", "clockwise"});
  Refuses({"inside out", {{Arc({}, 1, 2 * kPi, 0)}}}, {"outer boundary", "clockwise"});
  Outline ring = Disc(2);
  ring.loops.push_back({Arc({}, 1, 0, 2 * kPi)});
  Refuses(ring, {"hole 1", "counter-clockwise"});
}

TEST(OutlineChecks, RefuseHolesThatAreNotWithinTheMaterial) {
  Refuses(WithHole(Disc(1), {3, 0}, 0.5), {"hole 1", "outside"});
  Refuses(WithHole(Disc(1), {}, 2), {"hole 1", "outside"});
  Refuses(WithHole(Disc(1), {1, 0}, 0.5), {"self-intersecting", "hole 1"});
  Refuses(WithHole(WithHole(Disc(4), {}, 2), {0.5, 0}, 1), {"hole 2", "inside hole 1"});
  Refuses(WithHole(Bowl(2, 1.5, 1), {}, 0.3), {"hole 1", "outside"});
}

TEST(OutlineChecks, AcceptThinGapsAndNearlyStraightArcs) {
  EXPECT_NO_THROW(RequireValid(Ring(1, 1 - 1e-8)));
  Refuses(WithHole(Disc(1), {}, 1 - 1e-11), {"hole 1"});
  for (const double R : {1e3, 1e6, 1e9}) {
    const double alpha = std::asin(1 / R);
    const double drop = std::sqrt((R - 1) * (R + 1));
    for (const bool convex : {true, false}) {
      const OutlinePiece top = convex ? Arc({0, -drop}, R, kPi / 2 - alpha, kPi / 2 + alpha)
                                      : Arc({0, drop}, R, -kPi / 2 + alpha, -kPi / 2 - alpha);
      EXPECT_NO_THROW(
          RequireValid({"box", {{Line({-1, -3}, {1, -3}), Line({1, -3}, {1, 0}), top, Line({-1, 0}, {-1, -3})}}}))
          << R;
    }
  }
}

// Every pair of holes, or of edges, would take minutes.
TEST(OutlineChecks, TakeLittleTimeForManyHolesOrTooMuchAtOnePlace) {
  constexpr int kSide = 100;
  Outline sieve = Box(kSide + 1, kSide + 1);
  for (int k = 0; k < kSide * kSide; ++k) {
    sieve = WithHole(std::move(sieve), {k % kSide - (kSide - 1) / 2.0, k / kSide - (kSide - 1) / 2.0}, 0.4);
  }
  EXPECT_NO_THROW(RequireValid(sieve));
  Refuses(WithHole(sieve, {0.5, 0.5}, 0.1), {"hole 10001", "inside hole"});
  // Spikes around one centre: their boxes overlap nearly all.
  std::vector<Vec2> corners;
  constexpr int kSpikes = 40'000;
  for (int k = 0; k < kSpikes; ++k) {
    corners.push_back((k % 2 == 0 ? 1 : 1e-2) * UnitVector(2 * kPi * k / kSpikes));
  }
  Refuses(Polygon(corners), {"too much lies at one place"});
}

std::vector<double*> NumbersIn(OutlineCurve* curve) {
  std::vector<double*> numbers;
  ForEachPoint(*curve, [&](Vec2& p) { numbers.insert(numbers.end(), {&p.x, &p.y}); });
  std::visit(
      [&](auto& e) {
        if constexpr (requires { e.radius; }) numbers.push_back(&e.radius);
        if constexpr (requires { e.phi; }) numbers.insert(numbers.end(), {&e.a, &e.b, &e.phi});
      },
      *curve);
  return numbers;
}

// What a reader of files could be handed: valid outlines with numbers, kinds or order spoilt.
OutlinePiece RandomPiece(Random* random) {
  const auto length = [random] {
    const double special[] = {0, -1, 1, kNaN, kInfinity, -kInfinity, 1e-300, 1e300, 1e-320, 5e-324};
    const int choice = RandomInteger(30, random);
    return choice < 10 ? special[choice] : random->Uniform(-3, 3);
  };
  const OutlineCurve kinds[] = {StraightEdge{}, ArcEdge{}, EllipseEdge{}, SuperellipseEdge{}, BezierEdge{}};
  OutlinePiece piece{kinds[RandomInteger(kEdgeKinds, random)]};
  for (double* number : NumbersIn(&piece.edge)) *number = length();
  std::visit(
      [&](auto& e) {
        if constexpr (requires { e.side; }) e.side = random->Uniform(0, 1) < 0.5 ? Side::kConvex : Side::kConcave;
        if constexpr (requires { e.m; }) e.m = RandomInteger(12, random) - 2;
      },
      piece.edge);
  piece.s_begin = RandomInteger(2, random) == 0 ? 0 : length();
  piece.s_end = RandomInteger(2, random) == 0 ? 1 : length();
  return piece;
}

double* RandomNumber(OutlinePiece* piece, Random* random) {
  std::vector<double*> numbers = NumbersIn(&piece->edge);
  numbers.insert(numbers.end(), {&piece->s_begin, &piece->s_end});
  return numbers[static_cast<std::size_t>(RandomInteger(static_cast<int>(numbers.size()), random))];
}

void Spoil(Outline* outline, Random* random) {
  OutlineLoop& loop =
      outline->loops[static_cast<std::size_t>(RandomInteger(static_cast<int>(outline->loops.size()), random))];
  const auto at = [&] { return static_cast<std::size_t>(RandomInteger(static_cast<int>(loop.size()), random)); };
  if (loop.empty()) return;
  switch (RandomInteger(8, random)) {
    case 0:
      loop[at()] = RandomPiece(random);
      break;
    case 1:
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(at()));
      break;
    case 2:
      std::swap(loop[at()], loop[at()]);
      break;
    case 3:
      loop.push_back(loop[at()]);
      break;
    case 4:
      outline->loops.push_back(loop);
      break;
    case 5:
      *RandomNumber(&loop[at()], random) *= 1 + random->Uniform(-1, 1) * std::pow(10, random->Uniform(-12, 0));
      break;
    case 6:
      *RandomNumber(&loop[at()], random) *= std::pow(10, random->Uniform(-300, 300));
      break;
    default: {
      const double special[] = {0, -1, kNaN, kInfinity, std::numeric_limits<double>::max(), 5e-324};
      *RandomNumber(&loop[at()], random) = special[RandomInteger(6, random)];
    }
  }
}

TEST(OutlineChecks, MalformedOutlinesAreRefusedOrHaveFiniteProperties) {
  Random random(7);
  int refused = 0;
  int accepted = 0;
  const auto judge = [&](const Outline& outline) {
    try {
      const Body body = MakeBody(outline, 1);
      ++accepted;
      EXPECT_TRUE(std::isfinite(body.mass) && body.mass > 0);
      EXPECT_TRUE(std::isfinite(body.inertia) && body.inertia > 0);
      EXPECT_TRUE(IsFinite(body.x));
    } catch (const InputError& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("outline '"), std::string::npos) << error.what();
    }
  };
  for (int k = 0; k < 3000; ++k) {
    SCOPED_TRACE(k);
    Outline outline = RandomOutline(&random);
    const int faults = 1 + RandomInteger(2, &random);
    for (int i = 0; i < faults; ++i) Spoil(&outline, &random);
    judge(outline);
  }
  for (int k = 0; k < 3000; ++k) {
    SCOPED_TRACE(k);
    Outline outline{"scrap", {}};
    const int loops = RandomInteger(3, &random);
    for (int i = 0; i < loops; ++i) {
      outline.loops.emplace_back();
      const int pieces = RandomInteger(4, &random);
      for (int j = 0; j < pieces; ++j) outline.loops.back().push_back(RandomPiece(&random));
    }
    judge(outline);
  }
  EXPECT_GT(refused, 4000);
  EXPECT_GT(accepted, 50);
}

TEST(OutlineChecks, RandomPolygonsAreRefusedExactlyIfTheyCrossThemselvesOrRunClockwise) {
  Random random(8);
  int simple = 0;
  for (int k = 0; k < 5000; ++k) {
    SCOPED_TRACE(k);
    const int n = 3 + RandomInteger(4, &random);
    std::vector<Vec2> corners;
    corners.reserve(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) corners.push_back(random.Vector(1));
    const auto corner = [&](int i) { return corners[static_cast<std::size_t>(i % n)]; };
    bool crosses = false;
    double area = 0;
    for (int i = 0; i < n; ++i) {
      area += Cross(corner(i), corner(i + 1)) / 2;
      for (int j = i + 2; j < n && j + 1 < i + n; ++j) {
        const auto side = [&](int p, int q) { return Cross(corner(p + 1) - corner(p), corner(q) - corner(p)) > 0; };
        crosses = crosses || (side(i, j) != side(i, j + 1) && side(j, i) != side(j, i + 1));
      }
    }
    const bool valid = !crosses && area > 0;
    simple += valid ? 1 : 0;
    if (valid) {
      EXPECT_NO_THROW(RequireValid(Polygon(corners)));
    } else {
      EXPECT_THROW(RequireValid(Polygon(corners)), InputError);
    }
  }
  EXPECT_GT(simple, 500);
}

}  // namespace
}  // namespace lcpbench::testing
