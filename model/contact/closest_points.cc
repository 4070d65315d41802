#include "model/contact/closest_points.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <variant>

#include "model/geometry/smooth_curve.h"
#include "support/input_error.h"
#include "support/number_text.h"

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

// A vertex or an arc, by its centre of curvature: the world-frame arm U from the body's centre of mass. T is double,
// or DoubleDouble where lengths cancel.
template <class T>
struct Round {
  VecOf<T> U;
  double rho = 0;  // signed radius; 0 for a vertex
  bool is_vertex = false;
  Rotation rotation;

  CurvaturePair curvature() const { return is_vertex ? CurvaturePair{0, 1} : CurvaturePair{1, 1 / rho}; }
  // The angle, in the body frame, of the point with the world-frame outward normal N; none for a vertex.
  std::optional<double> Parameter(Vec2 N) const {
    if (is_vertex) return std::nullopt;
    const Vec2 u = RotateBack(rotation, rho > 0 ? N : -N);
    return std::atan2(u.y, u.x);
  }
};

// A straight edge: the world-frame arm of its start, its direction and outward normal.
template <class T>
struct Line {
  VecOf<T> A;
  VecOf<T> direction;
  VecOf<T> normal;
  T length{};
};

template <class T>
Round<T> PlaceRound(const PlacedFeature& placed, Angles angles) {
  const VecOf<T> turn = TurnOf<T>(placed.rotation, placed.theta, angles);
  if (const auto* vertex = std::get_if<Vertex>(&placed.feature)) {
    return {Turn(turn, Lift<T>(vertex->p)), 0, true, placed.rotation};
  }
  const auto& arc = std::get<ArcEdge>(placed.feature);
  const double rho = SignOf(arc.side) * arc.radius;
  return {Turn(turn, Lift<T>(arc.center)), rho, false, placed.rotation};
}

template <class T>
Line<T> PlaceLine(const PlacedFeature& placed, Angles angles) {
  const auto& edge = std::get<StraightEdge>(placed.feature);
  const VecOf<T> turn = TurnOf<T>(placed.rotation, placed.theta, angles);
  const VecOf<T> along = Lift<T>(edge.b) - Lift<T>(edge.a);
  const VecOf<T> direction = Turn(turn, Unit(along));
  return {Turn(turn, Lift<T>(edge.a)), direction, -Perp(direction), Norm(along)};
}

// x1 - x2, without rounding where T has room for it.
template <class T>
VecOf<T> Difference(Vec2 x1, Vec2 x2) {
  return {T(x1.x) - T(x2.x), T(x1.y) - T(x2.y)};
}

// R x n, by the shorter of the two arms that give it.
template <class T>
double Moment(VecOf<T> R, VecOf<T> U, VecOf<T> n) {
  return ToDouble(Dot(U, U) > Dot(R, R) ? Cross(R, n) : Cross(U, n));
}

// One body's closest point.
template <class T>
struct End {
  VecOf<T> R;
  double moment = 0;
  CurvaturePair curvature;
  std::optional<double> s;
};

// N: the outward normal of that body.
template <class T>
End<T> EndOf(const Round<T>& round, VecOf<T> N, VecOf<T> n) {
  const VecOf<T> R = round.U + T(round.rho) * N;
  return {R, Moment(R, round.U, n), round.curvature(), round.Parameter(ToVec2(N))};
}

template <class T>
End<T> EndOf(const Line<T>& line, VecOf<T> R, VecOf<T> n) {
  return {R, ToDouble(Cross(R, n)), {1, 0}, ToDouble(Dot(line.direction, R - line.A) / line.length)};
}

template <class T>
ClosestPoints Join(VecOf<T> n, T d, const End<T>& end1, const End<T>& end2) {
  return {ToVec2(n),      ToDouble(d), ToVec2(end1.R), ToVec2(end2.R), end1.moment, end2.moment, end1.curvature,
          end2.curvature, 0,           end1.s,         end2.s};
}

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
  return Join(n, sigma * distance - rho_sum, EndOf(round1, -n, n), EndOf(round2, n, n));
}

template <class T>
ClosestPoints Solve(const Round<T>& round1, const Line<T>& line2, VecOf<T> dx) {
  const VecOf<T> n = line2.normal;
  const VecOf<T> U_from_2 = dx + round1.U;
  const T rho(round1.rho);
  const T d = Dot(n, U_from_2 - line2.A) - rho;
  return Join(n, d, EndOf(round1, -n, n), EndOf(line2, U_from_2 - (rho + d) * n, n));
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

bool IsRegular(const ClosestPoints& c, Regularity required) {
  const double threshold = kSingularD * c.curvature_scale();
  return c.D() > threshold || (c.D() < -threshold && required == Regularity::kNonzeroD);
}

void RequireRegular(const ClosestPoints& c, Regularity required, const Pair& pair) {
  // Squares of lengths over- or underflow outside about 1e-150..1e150; the normal shows it.
  constexpr double kUnitTolerance = 1e-12;
  if (!(std::abs(Dot(c.n, c.n) - 1) <= kUnitTolerance)) {
    pair.Refuse("the normal is not a unit vector: a length is too small or too large for double");
  }
  const bool vertex = c.has_vertex();
  const double threshold = kSingularD * c.curvature_scale();
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

// A system of `count` equations for as many places on curves, at given places.
template <std::size_t count>
struct CurveEquations {
  std::array<DoubleDouble, count> step;  // Newton's step, in tau (oval) or s (Bezier)
  double residual = 0;                   // how far from solved: in radians, or parts of the curves' size
};

// A place on each of one or two curves.
template <std::size_t count>
using CurvePlaces = std::array<CurvePlace<DoubleDouble>, count>;

// Where Newton's method ended.
template <std::size_t count>
struct NewtonEnding {
  CurvePlaces<count> places;
  bool converged = false;
  bool nearly_solved = false;  // the equations hold roughly, whether converged or not
};

// Steps are in tau or s, of order 1 over the whole curve.
constexpr int kMostSteps = 100;
constexpr int kMostHalvings = 40;
constexpr double kLongestOvalStep = 0.5;
constexpr double kLongestBezierStep = 0.1;
// Far above the rounding of DoubleDouble, far below that of double: one more step is taken from here, which squares it.
constexpr double kConvergedStep = 1e-18;
// Below this the residual may be rounding, which no step decreases.
constexpr double kSmallStep = 1e-12;
// A residual this small counts as a solution where the Jacobian is singular.
constexpr double kNearlySolved = 1e-6;
// What a residual must decrease by, as a part of what a linear function would.
constexpr double kSufficientDecrease = 1e-4;

double LongestStep(const SmoothCurve& curve) { return curve.is_oval() ? kLongestOvalStep : kLongestBezierStep; }

// Newton's method for places on curves, in DoubleDouble: steps bounded by half a radian of an oval or a tenth of a
// Bezier curve, and halved until the residual decreases. Ends when a step is below 1e-18, and takes one more.
// @param evaluate  places -> CurveEquations<count>
template <std::size_t count, class Evaluate>
NewtonEnding<count> SafeguardedNewton(const std::array<const SmoothCurve*, count>& curves, CurvePlaces<count> places,
                                      const Evaluate& evaluate) {
  CurveEquations<count> now = evaluate(places);
  const auto stopped = [&] { return NewtonEnding<count>{places, false, now.residual <= kNearlySolved}; };
  for (int i = 0; i < kMostSteps; ++i) {
    // The longest part of the step, in units of what each curve allows.
    double excess = 0;
    double length = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double part = std::abs(now.step[k].hi);
      if (!std::isfinite(part)) return stopped();
      excess = std::max(excess, part / LongestStep(*curves[k]));
      length = std::max(length, part);
    }
    const auto moved = [&](double factor) {
      CurvePlaces<count> to;
      for (std::size_t k = 0; k < count; ++k) to[k] = curves[k]->Moved(places[k], DoubleDouble(factor) * now.step[k]);
      return to;
    };
    if (length <= kConvergedStep) return {moved(1), true, true};
    double factor = excess > 1 ? 1 / excess : 1;
    CurvePlaces<count> next = moved(factor);
    CurveEquations<count> then = evaluate(next);
    for (int k = 0; !(then.residual <= (1 - kSufficientDecrease * factor) * now.residual) && length > kSmallStep; ++k) {
      if (k == kMostHalvings) return stopped();
      factor /= 2;
      next = moved(factor);
      then = evaluate(next);
    }
    places = next;
    now = then;
  }
  return stopped();
}

using Wide = DoubleDouble;
using Place = CurvePlace<Wide>;
using Jet = CurveJet<Wide>;

// The chord between the unit vectors a and -b: 0 where they are opposite, monotone in the angle up to parallel.
double NotOpposite(VecOf<Wide> a, VecOf<Wide> b) { return ToDouble(Norm(a + b)); }

constexpr const char* kDiverged = "the search for the closest points does not converge from its start";

bool AreOpposite(VecOf<Wide> a, VecOf<Wide> b) { return ToDouble(Dot(a, b)) < 0; }

End<Wide> EndOf(const SmoothCurve& curve, const Place& place, const Jet& jet, VecOf<Wide> n) {
  return {jet.c, ToDouble(Cross(jet.c, n)), {1, ToDouble(jet.kappa)}, curve.Parameter(place)};
}

// Where a search came to: the closest points if the outward normals face each other there.
struct Foot {
  ClosestPoints closest;
  bool faces = true;
};

// Newton's method from `start`; `foot` gives the Foot at places.
template <std::size_t count, class Evaluate, class FootAt>
void Finish(const std::array<const SmoothCurve*, count>& curves, const CurvePlaces<count>& start,
            const Evaluate& evaluate, const FootAt& foot_at, bool beyond_ends, StationaryPoints* found) {
  constexpr double kNearlySingular = 1e-6;
  const NewtonEnding<count> ending = SafeguardedNewton<count>(curves, start, evaluate);
  Foot foot = foot_at(ending.places);
  ClosestPoints& c = foot.closest;
  for (const SmoothCurve* curve : curves) c.curvature_floor += curve->curvature_floor();
  if (!ending.converged) {
    const bool singular = ending.nearly_solved && std::abs(c.D()) <= kNearlySingular * c.curvature_scale();
    found->is_beyond_end = false;
    found->failure = singular ? "curvature match, or vertex at a centre of curvature: the search for the closest "
                                "points ends where D = 0"
                              : kDiverged;
    return;
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (beyond_ends || curves[k]->Holds(ending.places[k])) continue;
    found->is_beyond_end = true;
    found->failure = "the closest point lies beyond the end of the Bezier curve (s = " +
                     std::to_string(curves[k]->Parameter(ending.places[k])) + ", expected 0 <= s <= 1)";
    return;
  }
  if (foot.faces) {
    found->points.push_back(c);
  } else {
    found->is_beyond_end = false;
    found->failure = kDiverged;
  }
}

// SmoothCurve::kSamples directions, evenly spread over the plane.
std::vector<Vec2> EvenDirections() {
  std::vector<Vec2> directions;
  for (int i = 0; i < SmoothCurve::kSamples; ++i) {
    directions.push_back(LiftRotation<double>(SinCos(2 * std::numbers::pi * i / SmoothCurve::kSamples)));
  }
  return directions;
}

// Narrows a bracket of a sign change of f to about 1e-9 of itself, by bisection: f may be steep or flat at its ends.
template <class Function>
double NarrowedSignChange(double low, double high, const Function& f) {
  constexpr int kBisections = 30;
  const bool negative = f(low) < 0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = low + (high - low) / 2;
    ((f(middle) < 0) == negative ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

// A vertex or arc on body 1 and a curve on body 2.
StationaryPoints SearchRoundAndCurve(const PlacedFeature& round1, const PlacedFeature& curve2, const SearchStart& start,
                                     Angles angles) {
  const Round<Wide> round = PlaceRound<Wide>(round1, angles);
  const SmoothCurve curve(curve2, angles);
  const VecOf<Wide> q = Difference<Wide>(round1.x, curve2.x) + round.U;  // the centre, from the curve's centre of mass
  const auto equations = [&](const CurvePlaces<1>& at) {
    const Jet jet = curve.At(at[0]);
    const VecOf<Wide> to_q = q - jet.c;
    const Wide g = Dot(jet.d1, to_q);
    const Wide slope = Dot(jet.d2, to_q) - Dot(jet.d1, jet.d1);
    return CurveEquations<1>{{-g / slope}, std::abs(ToDouble(g / Norm(jet.d1))) / curve.size()};
  };
  const auto foot = [&](const CurvePlaces<1>& at) {
    const Jet jet = curve.At(at[0]);
    const VecOf<Wide> n = jet.N;
    return Foot{Join(n, Dot(n, q - jet.c) - Wide(round.rho), EndOf(round, -n, n), EndOf(curve, at[0], jet, n))};
  };
  StationaryPoints found;
  const auto finish_from = [&](const Place& place) {
    Finish<1>({&curve}, {place}, equations, foot, start.beyond_ends, &found);
  };
  if (start.s2) {
    finish_from(curve.FromParameter(*start.s2));
    return found;
  }
  const auto residual = [&](double tau) {
    const CurveJet<double> jet = curve.At(curve.Place(tau));
    return Dot(jet.d1, ToVec2(q) - jet.c);
  };
  const std::vector<double> samples = curve.Samples(EvenDirections());
  double before = residual(samples[0]);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double after = residual(samples[i]);
    if ((before < 0) != (after < 0)) {
      finish_from(curve.WidePlace(NarrowedSignChange(samples[i - 1], samples[i], residual)));
    }
    before = after;
  }
  return found;
}

// A curve on body 1 and a straight edge on body 2.
StationaryPoints SearchCurveAndLine(const PlacedFeature& curve1, const PlacedFeature& line2, std::optional<double> s1,
                                    Angles angles) {
  const SmoothCurve curve(curve1, angles);
  const Line<Wide> line = PlaceLine<Wide>(line2, angles);
  const VecOf<Wide> dx = Difference<Wide>(curve1.x, line2.x);
  const VecOf<Wide> n = line.normal;
  const auto equations = [&](const CurvePlaces<1>& at) {
    const Jet jet = curve.At(at[0]);
    return CurveEquations<1>{{-Dot(jet.d1, n) / Dot(jet.d2, n)}, NotOpposite(jet.N, n)};
  };
  const auto foot = [&](const CurvePlaces<1>& at) {
    const Jet jet = curve.At(at[0]);
    const VecOf<Wide> p1 = dx + jet.c;
    const Wide d = Dot(n, p1 - line.A);
    return Foot{Join(n, d, EndOf(curve, at[0], jet, n), EndOf(line, p1 - d * n, n)), AreOpposite(jet.N, n)};
  };
  StationaryPoints found;
  const auto finish_from = [&](const Place& start) { Finish<1>({&curve}, {start}, equations, foot, false, &found); };
  if (s1) {
    finish_from(curve.FromParameter(*s1));
  } else {
    for (const double tau : curve.WithNormal(-ToVec2(n))) finish_from(curve.WidePlace(tau));
  }
  return found;
}

// Where a curve faces a sample of the leading one, on which of its pieces, and how far along the leading one's tangent
// it lies.
struct Facing {
  double tau = 0;
  int piece = 0;
  double offset = 0;
};

std::vector<Facing> FacingPlaces(const SmoothCurve& lead, const SmoothCurve& other, Vec2 from_lead, double tau) {
  const CurveJet<double> jet = lead.At(lead.Place(tau));
  std::vector<Facing> all;
  for (const double facing : other.WithNormal(-jet.N)) {
    const Vec2 between = (other.At(other.Place(facing)).c - jet.c) + from_lead;
    all.push_back({facing, other.Piece(facing), Dot(Perp(jet.N), between)});
  }
  return all;
}

// Calls start(tau on the leading curve, tau on the other) near every stationary point that samples bracket.
template <class Start>
void ForEachBracket(const SmoothCurve& lead, const SmoothCurve& other, Vec2 from_lead, const Start& start) {
  const auto facing_on = [&](double tau, int piece) -> std::optional<Facing> {
    for (const Facing& facing : FacingPlaces(lead, other, from_lead, tau)) {
      if (facing.piece == piece) return facing;
    }
    return std::nullopt;
  };
  const std::vector<double> samples = lead.Samples(other.FacingNormals());
  std::vector<Facing> before = FacingPlaces(lead, other, from_lead, samples[0]);
  for (size_t i = 1; i < samples.size(); ++i) {
    std::vector<Facing> after = FacingPlaces(lead, other, from_lead, samples[i]);
    for (const Facing& b : before) {
      for (const Facing& a : after) {
        if (a.piece != b.piece || (a.offset < 0) == (b.offset < 0)) continue;
        const double tau = NarrowedSignChange(samples[i - 1], samples[i], [&](double at) {
          const std::optional<Facing> facing = facing_on(at, a.piece);
          return facing ? facing->offset : b.offset;
        });
        if (const std::optional<Facing> facing = facing_on(tau, a.piece)) start(tau, facing->tau);
      }
    }
    before = std::move(after);
  }
}

StationaryPoints SearchCurveAndCurve(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                     const SearchStart& start, Angles angles) {
  const SmoothCurve curve1(feature1, angles);
  const SmoothCurve curve2(feature2, angles);
  const VecOf<Wide> dx = Difference<Wide>(feature1.x, feature2.x);
  const double size = curve1.size() + curve2.size();
  const auto equations = [&](const CurvePlaces<2>& at) {
    const Jet j1 = curve1.At(at[0]);
    const Jet j2 = curve2.At(at[1]);
    const VecOf<Wide> between = dx + (j1.c - j2.c);
    const Wide parallel = Cross(j1.d1, j2.d1);
    const Wide normal = Dot(between, j2.d1);
    const Wide parallel_by_1 = Cross(j1.d2, j2.d1);
    const Wide parallel_by_2 = Cross(j1.d1, j2.d2);
    const Wide normal_by_1 = Dot(j1.d1, j2.d1);
    const Wide normal_by_2 = Dot(between, j2.d2) - Dot(j2.d1, j2.d1);
    const Wide determinant = parallel_by_1 * normal_by_2 - parallel_by_2 * normal_by_1;
    const double turned = NotOpposite(j1.N, j2.N);
    const double offset = ToDouble(normal / Norm(j2.d1)) / size;
    return CurveEquations<2>{{(parallel_by_2 * normal - normal_by_2 * parallel) / determinant,
                              (normal_by_1 * parallel - parallel_by_1 * normal) / determinant},
                             std::sqrt(turned * turned + offset * offset)};
  };
  const auto foot = [&](const CurvePlaces<2>& at) {
    const Jet j1 = curve1.At(at[0]);
    const Jet j2 = curve2.At(at[1]);
    const VecOf<Wide> n = j2.N;
    const Wide d = Dot(n, dx + (j1.c - j2.c));
    return Foot{Join(n, d, EndOf(curve1, at[0], j1, n), EndOf(curve2, at[1], j2, n)), AreOpposite(j1.N, n)};
  };
  StationaryPoints found;
  const auto finish_from = [&](const Place& place1, const Place& place2) {
    Finish<2>({&curve1, &curve2}, {place1, place2}, equations, foot, false, &found);
  };
  if (start.s1 && start.s2) {
    finish_from(curve1.FromParameter(*start.s1), curve2.FromParameter(*start.s2));
  } else if (start.s1) {
    const Place place = curve1.FromParameter(*start.s1);
    for (const double tau : curve2.WithNormal(-ToVec2(curve1.At(place).N))) finish_from(place, curve2.WidePlace(tau));
  } else if (start.s2) {
    const Place place = curve2.FromParameter(*start.s2);
    for (const double tau : curve1.WithNormal(-ToVec2(curve2.At(place).N))) finish_from(curve1.WidePlace(tau), place);
  } else if (curve1.is_oval() && !curve2.is_oval()) {
    // A Bezier curve leads: an oval has a facing place for every normal, a Bezier curve only for some.
    ForEachBracket(curve2, curve1, ToVec2(dx),
                   [&](double tau2, double tau1) { finish_from(curve1.WidePlace(tau1), curve2.WidePlace(tau2)); });
  } else {
    ForEachBracket(curve1, curve2, -ToVec2(dx),
                   [&](double tau1, double tau2) { finish_from(curve1.WidePlace(tau1), curve2.WidePlace(tau2)); });
  }
  return found;
}

// All numbers of a curve, with its kind: for an order of curves that knows nothing of bodies 1 and 2.
std::vector<double> Numbers(const PlacedFeature& placed) {
  std::vector<double> numbers = NumbersOf(placed.feature);
  numbers.insert(numbers.end(), {placed.rotation.cos, placed.rotation.sin, placed.x.x, placed.x.y});
  return numbers;
}

// With feature 2 a general curve, and feature 1 too (in the order of their numbers) or no straight edge; or with
// feature 1 a general curve and feature 2 a straight edge.
bool IsInOrder(const PlacedFeature& feature1, const PlacedFeature& feature2) {
  const bool first = IsSearched(feature1.feature);
  if (first && IsSearched(feature2.feature)) return !(Numbers(feature2) < Numbers(feature1));
  const Feature& other = first ? feature2.feature : feature1.feature;
  return first == std::holds_alternative<StraightEdge>(other);
}

StationaryPoints SearchInOrder(const PlacedFeature& feature1, const PlacedFeature& feature2, const SearchStart& start,
                               Angles angles) {
  if (!IsSearched(feature2.feature)) return SearchCurveAndLine(feature1, feature2, start.s1, angles);
  if (!IsSearched(feature1.feature)) return SearchRoundAndCurve(feature1, feature2, start, angles);
  return SearchCurveAndCurve(feature1, feature2, start, angles);
}

// The regular stationary point whose gap is closest to the nominal one; without any, an irregular one, so that the
// refusal can say what is wrong with it.
ClosestPoints SolveBySearch(const Pair& pair, const SearchStart& start, Regularity required, Angles angles) {
  const StationaryPoints found = SearchStationaryPoints(pair.feature1, pair.feature2, start, angles);
  if (found.points.empty()) pair.Refuse(found.failure);
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
  return SolveBySearch(pair, {c.s1, c.s2, c.d, start.beyond_ends}, required, Angles::kExact);
}

}  // namespace

ClosestPoints Swapped(const ClosestPoints& c) {
  ClosestPoints swapped = c;
  swapped.n = -c.n;
  std::swap(swapped.R1, swapped.R2);
  swapped.moment1 = -c.moment2;
  swapped.moment2 = -c.moment1;
  std::swap(swapped.curvature1, swapped.curvature2);
  std::swap(swapped.s1, swapped.s2);
  return swapped;
}

StationaryPoints SearchStationaryPoints(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                        const SearchStart& start, Angles angles) {
  if (!std::isfinite(start.s1.value_or(0)) || !std::isfinite(start.s2.value_or(0))) {
    return {{}, "a start value of the search is not finite"};
  }
  StationaryPoints found;
  if (IsInOrder(feature1, feature2)) {
    found = SearchInOrder(feature1, feature2, start, angles);
  } else {
    found = SearchInOrder(feature2, feature1, {start.s2, start.s1, start.nominal_gap, start.beyond_ends}, angles);
    for (ClosestPoints& c : found.points) c = Swapped(c);
  }
  if (found.points.empty() && found.failure.empty()) {
    found.failure = "the features have no stationary point of the distance";
  }
  return found;
}

ClosestPoints FindClosestPoints(const PlacedFeature& feature1, const PlacedFeature& feature2, const SearchStart& start,
                                Regularity required) {
  RequireValid(feature1.feature);
  RequireValid(feature2.feature);
  const Pair pair{feature1, feature2};
  const bool search = IsSearched(feature1.feature) || IsSearched(feature2.feature);
  const ClosestPoints c = search ? SolveBySearch(pair, start, required) : SolveClosedForm(pair);
  RequireRegular(c, required, pair);
  return c;
}

}  // namespace lcpbench
