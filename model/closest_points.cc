#include "model/closest_points.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <variant>

#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

// The shortest text that reads back as the same double.
std::string Text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string Text(Vec2 p) { return "(" + Text(p.x) + ", " + Text(p.y) + ")"; }

double Length(const StraightEdge& edge) { return Norm(edge.b - edge.a); }

// A vertex or an arc, by its centre of curvature: the world-frame arm U from the body's centre of mass.
struct Round {
  Vec2 U;
  double rho = 0;  // signed radius; 0 for a vertex
  bool is_vertex = false;
  Rotation rotation;

  CurvaturePair curvature() const { return is_vertex ? CurvaturePair{0, 1} : CurvaturePair{1, 1 / rho}; }
};

// A straight edge: the world-frame arm of its start, its direction and outward normal.
struct Line {
  Vec2 A;
  Vec2 direction;
  Vec2 normal;
  double length = 0;
};

using PlacedShape = std::variant<Round, Line>;

PlacedShape Place(const PlacedFeature& placed) {
  const Rotation& rotation = placed.rotation;
  return std::visit(Overloaded{[&](const Vertex& v) -> PlacedShape {
                                 return Round{Rotate(rotation, v.p), 0, true, rotation};
                               },
                               [&](const ArcEdge& arc) -> PlacedShape {
                                 const double rho = arc.side == Side::kConvex ? arc.radius : -arc.radius;
                                 return Round{Rotate(rotation, arc.center), rho, false, rotation};
                               },
                               [&](const StraightEdge& edge) -> PlacedShape {
                                 const double length = Length(edge);
                                 const Vec2 along = edge.b - edge.a;
                                 const Vec2 direction = Rotate(rotation, {along.x / length, along.y / length});
                                 return Line{Rotate(rotation, edge.a), direction, -Perp(direction), length};
                               }},
                    placed.feature);
}

// R x n, by the shorter of the two arms that give it.
double Moment(Vec2 R, Vec2 U, Vec2 n) { return Dot(U, U) <= Dot(R, R) ? Cross(U, n) : Cross(R, n); }

// The angle, in the body frame, at which an arc's point lies in the world direction `outward` from its centre.
std::optional<double> ArcParameter(const Round& round, Vec2 outward) {
  if (round.is_vertex) return std::nullopt;
  const Vec2 u = Rotate({round.rotation.cos, -round.rotation.sin}, outward);
  return std::atan2(u.y, u.x);
}

struct Pair {
  const PlacedFeature& feature1;
  const PlacedFeature& feature2;

  [[noreturn]] void Refuse(const std::string& condition) const {
    throw InputError(condition + "; feature 1: " + Describe(feature1.feature) +
                     "; feature 2: " + Describe(feature2.feature));
  }
};

ClosestPoints Swapped(const ClosestPoints& c) {
  ClosestPoints swapped = c;
  swapped.n = -c.n;
  std::swap(swapped.R1, swapped.R2);
  swapped.moment1 = -c.moment2;
  swapped.moment2 = -c.moment1;
  std::swap(swapped.curvature1, swapped.curvature2);
  swapped.owner = 3 - c.owner;
  std::swap(swapped.s1, swapped.s2);
  return swapped;
}

// All geometry is relative to the centres of mass, dx = x1 - x2, so that nothing is lost far from the world's origin.
ClosestPoints Solve(const Round& round1, const Round& round2, Vec2 dx, const Pair& pair) {
  if (round1.is_vertex && round2.is_vertex) {
    pair.Refuse("vertex against vertex is not a contact: the normal is undefined at d = 0");
  }
  const Vec2 between = dx + (round1.U - round2.U);
  const double distance = Norm(between);
  const double rho_sum = round1.rho + round2.rho;
  if (rho_sum == 0) {
    pair.Refuse("curvature match: a convex and a concave arc of equal radius have no unique contact point");
  }
  if (!(distance > 0)) {
    pair.Refuse(round1.is_vertex || round2.is_vertex ? "vertex at the centre of curvature: the normal is undefined"
                                                     : "the centres of two arcs coincide: the normal is undefined");
  }
  const double sigma = rho_sum > 0 ? 1 : -1;
  ClosestPoints c;
  c.n = {sigma * between.x / distance, sigma * between.y / distance};
  c.d = sigma * distance - rho_sum;
  c.R1 = round1.U - round1.rho * c.n;
  c.R2 = round2.U + round2.rho * c.n;
  c.moment1 = Moment(c.R1, round1.U, c.n);
  c.moment2 = Moment(c.R2, round2.U, c.n);
  c.curvature1 = round1.curvature();
  c.curvature2 = round2.curvature();
  c.owner = round2.is_vertex ? 1 : 2;
  c.s1 = ArcParameter(round1, round1.rho > 0 ? -c.n : c.n);
  c.s2 = ArcParameter(round2, round2.rho > 0 ? c.n : -c.n);
  return c;
}

ClosestPoints Solve(const Round& round1, const Line& line2, Vec2 dx, const Pair& /*pair*/) {
  ClosestPoints c;
  c.n = line2.normal;
  const Vec2 U_from_2 = dx + round1.U;
  c.d = Dot(c.n, U_from_2 - line2.A) - round1.rho;
  c.R1 = round1.U - round1.rho * c.n;
  c.R2 = U_from_2 - (round1.rho + c.d) * c.n;
  c.moment1 = Moment(c.R1, round1.U, c.n);
  c.moment2 = Cross(c.R2, c.n);
  c.curvature1 = round1.curvature();
  c.curvature2 = {1, 0};
  c.owner = 2;
  c.s1 = ArcParameter(round1, round1.rho > 0 ? -c.n : c.n);
  c.s2 = Dot(line2.direction, c.R2 - line2.A) / line2.length;
  return c;
}

ClosestPoints Solve(const Line& line1, const Round& round2, Vec2 dx, const Pair& pair) {
  return Swapped(Solve(round2, line1, -dx, pair));
}

ClosestPoints Solve(const Line& /*line1*/, const Line& /*line2*/, Vec2 /*dx*/, const Pair& pair) {
  pair.Refuse("two straight edges have no unique contact point (D = 0): flush edges are two vertex/straight contacts");
}

void RequireRegular(const ClosestPoints& c, Regularity required, const Pair& pair) {
  // Squares of lengths over- or underflow outside about 1e-150..1e150; the normal shows it.
  constexpr double kUnitTolerance = 1e-12;
  if (!(std::abs(Dot(c.n, c.n) - 1) <= kUnitTolerance)) {
    pair.Refuse("the normal is not a unit vector: a length is too small or too large for double");
  }
  const bool vertex = c.curvature1.is_vertex() || c.curvature2.is_vertex();
  const double threshold = kSingularD * (vertex ? 1 : std::abs(c.curvature1.s) + std::abs(c.curvature2.s));
  const double D = c.D();
  if (D > threshold) return;
  if (D < -threshold && required == Regularity::kNonzeroD) return;
  if (D < -threshold) {
    pair.Refuse("not a contact: the stationary point is no local minimum of the distance (D = " + Text(D) +
                " < 0), as for a disc larger than its track or a straight edge in a concave arc");
  }
  if (std::isnan(D)) pair.Refuse("the closest points are not finite");
  pair.Refuse(std::string(vertex ? "vertex at the centre of curvature" : "curvature match") +
              " (|D| = " + Text(std::abs(D)) + " <= " + Text(threshold) + "): the " +
              (vertex ? "normal is undefined" : "contact point is not unique"));
}

}  // namespace

std::string Describe(const Feature& feature) {
  return std::visit(
      Overloaded{[](const Vertex& v) { return "vertex " + Text(v.p); },
                 [](const StraightEdge& e) { return "straight edge from " + Text(e.a) + " to " + Text(e.b); },
                 [](const ArcEdge& e) {
                   return std::string(e.side == Side::kConvex ? "convex" : "concave") + " arc with center " +
                          Text(e.center) + " and radius " + Text(e.radius);
                 }},
      feature);
}

void RequireValid(const Feature& feature) {
  const auto require = [&](bool holds, const char* condition) {
    if (!holds) throw InputError("invalid geometry, " + std::string(condition) + ": " + Describe(feature));
  };
  std::visit(Overloaded{[&](const Vertex& v) { require(IsFinite(v.p), "a coordinate is not finite"); },
                        [&](const StraightEdge& e) {
                          require(IsFinite(e.a) && IsFinite(e.b), "a coordinate is not finite");
                          const double length = Length(e);
                          require(length > 0, "zero-length edge");
                          require(std::isfinite(length), "the edge's length overflows");
                        },
                        [&](const ArcEdge& e) {
                          require(IsFinite(e.center) && std::isfinite(e.radius), "a number is not finite");
                          require(e.radius > 0, "the radius must be > 0");
                          require(std::isfinite(1 / e.radius), "the curvature 1/radius overflows");
                        }},
             feature);
}

ClosestPoints FindClosestPoints(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                const SearchStart& /*start*/, Regularity required) {
  RequireValid(feature1.feature);
  RequireValid(feature2.feature);
  const Pair pair{feature1, feature2};
  const Vec2 dx = feature1.x - feature2.x;
  const ClosestPoints c =
      std::visit([&](const auto& shape1, const auto& shape2) { return Solve(shape1, shape2, dx, pair); },
                 Place(feature1), Place(feature2));
  RequireRegular(c, required, pair);
  return c;
}

}  // namespace lcpbench
