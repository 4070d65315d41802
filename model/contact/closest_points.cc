#include "model/contact/closest_points.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "model/contact/closest_search.h"
#include "model/geometry/double_double.h"
#include "model/geometry/placed_shapes.h"
#include "model/geometry/smooth_curve.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct Pair {
  const PlacedFeature& feature1;
  const PlacedFeature& feature2;

  [[noreturn]] void Refuse(const std::string& condition) const {
    throw InputError(condition + "; feature 1: " + Describe(feature1.feature) +
                     "; feature 2: " + Describe(feature2.feature));
  }
};

// All geometry is relative to the centres of mass, dx = x1 - x2, so that nothing is lost far from the world's origin.
template <class T>
ClosestPoints Solve(const Round<T>& round1, const Round<T>& round2, VecOf<T> dx, const Pair& pair) {
  if (round1.is_vertex && round2.is_vertex) {
    pair.Refuse("vertex against vertex is not a contact: the normal is undefined at d = 0");
  }
  const VecOf<T> between = dx + (round1.U - round2.U);
  const T distance = Norm(between);
  const T rho_sum = T(round1.rho) + T(round2.rho);
  if (ToDouble(rho_sum) == 0) {
    pair.Refuse("curvature match: a convex and a concave arc of equal radius have no unique contact point");
  }
  if (!(ToDouble(distance) > 0)) {
    pair.Refuse(round1.is_vertex || round2.is_vertex ? "vertex at the centre of curvature: the normal is undefined"
                                                     : "the centres of two arcs coincide: the normal is undefined");
  }
  const T sigma(ToDouble(rho_sum) > 0 ? 1.0 : -1.0);
  const VecOf<T> n = {sigma * between.x / distance, sigma * between.y / distance};
  const VecOf<T> R1 = round1.U - T(round1.rho) * n;
  const VecOf<T> R2 = round2.U + T(round2.rho) * n;
  ClosestPoints c;
  c.n = ToVec2(n);
  c.d = ToDouble(sigma * distance - rho_sum);
  c.R1 = ToVec2(R1);
  c.R2 = ToVec2(R2);
  c.moment1 = Moment(R1, round1.U, n);
  c.moment2 = Moment(R2, round2.U, n);
  c.curvature1 = round1.curvature();
  c.curvature2 = round2.curvature();
  c.owner = round2.is_vertex ? 1 : 2;
  c.s1 = round1.Parameter(-c.n);
  c.s2 = round2.Parameter(c.n);
  return c;
}

template <class T>
ClosestPoints Solve(const Round<T>& round1, const Line<T>& line2, VecOf<T> dx) {
  const VecOf<T> n = line2.normal;
  const VecOf<T> U_from_2 = dx + round1.U;
  const T rho(round1.rho);
  const T d = Dot(n, U_from_2 - line2.A) - rho;
  const VecOf<T> R1 = round1.U - rho * n;
  const VecOf<T> R2 = U_from_2 - (rho + d) * n;
  ClosestPoints c;
  c.n = ToVec2(n);
  c.d = ToDouble(d);
  c.R1 = ToVec2(R1);
  c.R2 = ToVec2(R2);
  c.moment1 = Moment(R1, round1.U, n);
  c.moment2 = ToDouble(Cross(R2, n));
  c.curvature1 = round1.curvature();
  c.curvature2 = {1, 0};
  c.owner = 2;
  c.s1 = round1.Parameter(-c.n);
  c.s2 = ToDouble(Dot(line2.direction, R2 - line2.A) / line2.length);
  return c;
}

template <class T>
ClosestPoints SolveClosedForm(const Pair& pair, Angles angles) {
  const auto& [feature1, feature2] = pair;
  const VecOf<T> dx = Difference<T>(feature1.x, feature2.x);
  const auto* line1 = std::get_if<StraightEdge>(&feature1.feature);
  const auto* line2 = std::get_if<StraightEdge>(&feature2.feature);
  if (line1 != nullptr && line2 != nullptr) {
    pair.Refuse(
        "two straight edges have no unique contact point (D = 0): flush edges are two vertex/straight contacts");
  }
  if (line1 != nullptr) {
    return Swapped(Solve(PlaceRound<T>(feature2, angles), PlaceLine<T>(feature1, angles), -dx));
  }
  const Round<T> round1 = PlaceRound<T>(feature1, angles);
  if (line2 != nullptr) return Solve(round1, PlaceLine<T>(feature2, angles), dx);
  return Solve(round1, PlaceRound<T>(feature2, angles), dx, pair);
}

// How far away an arc's centre is, by its radius and from the centre of mass; 0 for other features.
double CenterDistance(const Feature& feature) {
  const auto* arc = std::get_if<ArcEdge>(&feature);
  return arc == nullptr ? 0 : arc->radius + Norm(arc->center);
}

double ContactArms(const ClosestPoints& c) { return Norm(c.R1) + Norm(c.R2) + std::abs(c.d); }

// Turning one of two edges by e moves their contact point by about e/D; the arms show whether that matters.
bool DependsStronglyOnAngles(const ClosestPoints& c) {
  return !c.curvature1.is_vertex() && !c.curvature2.is_vertex() && std::abs(c.D()) * ContactArms(c) * kFarCenter < 1;
}

ClosestPoints SolveClosedForm(const Pair& pair) {
  const ClosestPoints c = SolveClosedForm<double>(pair, Angles::kRounded);
  if (DependsStronglyOnAngles(c)) return SolveClosedForm<DoubleDouble>(pair, Angles::kExact);
  const double far = std::max(CenterDistance(pair.feature1.feature), CenterDistance(pair.feature2.feature));
  if (far > kFarCenter * ContactArms(c)) return SolveClosedForm<DoubleDouble>(pair, Angles::kRounded);
  return c;
}

bool HasVertex(const ClosestPoints& c) { return c.curvature1.is_vertex() || c.curvature2.is_vertex(); }

double SingularThreshold(const ClosestPoints& c) {
  const double scale = std::abs(c.curvature1.s) + std::abs(c.curvature2.s) + c.curvature_floor;
  return kSingularD * (HasVertex(c) ? 1 : scale);
}

bool IsRegular(const ClosestPoints& c, Regularity required) {
  const double threshold = SingularThreshold(c);
  return c.D() > threshold || (c.D() < -threshold && required == Regularity::kNonzeroD);
}

void RequireRegular(const ClosestPoints& c, Regularity required, const Pair& pair) {
  // Squares of lengths over- or underflow outside about 1e-150..1e150; the normal shows it.
  constexpr double kUnitTolerance = 1e-12;
  if (!(std::abs(Dot(c.n, c.n) - 1) <= kUnitTolerance)) {
    pair.Refuse("the normal is not a unit vector: a length is too small or too large for double");
  }
  const bool vertex = HasVertex(c);
  const double threshold = SingularThreshold(c);
  const double D = c.D();
  if (IsRegular(c, required)) return;
  if (D < -threshold) {
    pair.Refuse("not a contact: the stationary point is no local minimum of the distance (D = " + NumberText(D) +
                " < 0), as for a disc larger than its track or a straight edge in a concave arc");
  }
  if (std::isnan(D)) pair.Refuse("the closest points are not finite");
  pair.Refuse(std::string(vertex ? "vertex at the centre of curvature" : "curvature match") +
              " (|D| = " + NumberText(std::abs(D)) + " <= " + NumberText(threshold) + "): the " +
              (vertex ? "normal is undefined" : "contact point is not unique"));
}

// Of the stationary points, the regular one whose gap is closest to the nominal one; of irregular ones if need be, so
// that the refusal can say what is wrong with it.
ClosestPoints SolveBySearch(const Pair& pair, const SearchStart& start, Regularity required, Angles angles) {
  const StationaryPoints found = SearchStationaryPoints(pair.feature1, pair.feature2, start, angles);
  if (found.points.empty()) pair.Refuse(found.failure_text);
  const auto is_better = [&](const ClosestPoints& a, const ClosestPoints& b) {
    const bool a_regular = IsRegular(a, required);
    if (a_regular != IsRegular(b, required)) return a_regular;
    return std::abs(a.d - start.nominal_gap) < std::abs(b.d - start.nominal_gap);
  };
  return *std::min_element(found.points.begin(), found.points.end(), is_better);
}

ClosestPoints SolveBySearch(const Pair& pair, const SearchStart& start, Regularity required) {
  const ClosestPoints c = SolveBySearch(pair, start, required, Angles::kRounded);
  if (!DependsStronglyOnAngles(c) || !IsRegular(c, required)) return c;
  return SolveBySearch(pair, {c.s1, c.s2, c.d}, required, Angles::kExact);
}

}  // namespace

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

ClosestPoints FindClosestPoints(const PlacedFeature& feature1, const PlacedFeature& feature2, const SearchStart& start,
                                Regularity required) {
  RequireValid(feature1.feature);
  RequireValid(feature2.feature);
  const Pair pair{feature1, feature2};
  const bool search = SmoothCurve::Holds(feature1.feature) || SmoothCurve::Holds(feature2.feature);
  const ClosestPoints c = search ? SolveBySearch(pair, start, required) : SolveClosedForm(pair);
  RequireRegular(c, required, pair);
  return c;
}

}  // namespace lcpbench
