#include "model/contact/closest_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

#include "model/geometry/curve_samples.h"
#include "model/geometry/placed_shapes.h"
#include "model/geometry/safeguarded_newton.h"
#include "model/geometry/smooth_curve.h"

namespace lcpbench {
namespace {

using Wide = DoubleDouble;
using WidePlace = CurvePlace<Wide>;
using WideJet = CurveJet<Wide>;

// The chord between the unit vectors a and -b: 0 where they are opposite, monotone in the angle up to parallel.
double NotOpposite(VecOf<Wide> a, VecOf<Wide> b) { return ToDouble(Norm(a + b)); }

bool AreOpposite(VecOf<Wide> a, VecOf<Wide> b) { return ToDouble(Dot(a, b)) < 0; }

// Whether a place is on the curve: a Bezier curve has ends.
bool IsOnCurve(const SmoothCurve& curve, const WidePlace& place) {
  return curve.is_oval() || (place.x.hi >= -SmoothCurve::kEndSlack && place.x.hi <= 1 + SmoothCurve::kEndSlack);
}

WidePlace Widened(const SmoothCurve& curve, double tau) {
  const CurvePlace<double> place = curve.Place(tau);
  if (!curve.is_oval()) return {place.x, 0.0};
  const VecOf<Wide> unit = Unit(VecOf<Wide>{place.x, place.y});
  return {unit.x, unit.y};
}

const char* Text(SearchFailure failure) {
  switch (failure) {
    case SearchFailure::kStartNotFinite:
      return "a start value of the search is not finite";
    case SearchFailure::kNoStationaryPoint:
      return "the features have no stationary point of the distance";
    case SearchFailure::kDiverged:
      return "the search for the closest points does not converge from its start";
    case SearchFailure::kSingular:
      return "curvature match, or vertex at a centre of curvature: the search for the closest points ends where D = 0";
    case SearchFailure::kBeyondEnd:
      return "the closest point lies beyond the end of the Bezier curve";
    case SearchFailure::kNone:
      break;
  }
  return "";
}

void Fail(SearchFailure failure, StationaryPoints* found) {
  found->failure = failure;
  found->failure_text = Text(failure);
}

void FailBeyondEnd(const SmoothCurve& curve, const WidePlace& place, StationaryPoints* found) {
  Fail(SearchFailure::kBeyondEnd, found);
  found->failure_text += " (s = " + std::to_string(curve.Parameter(place)) + ", expected 0 <= s <= 1)";
}

void FailIfNothingFound(StationaryPoints* found) {
  if (found->points.empty() && found->failure == SearchFailure::kNone) Fail(SearchFailure::kNoStationaryPoint, found);
}

// Why a search did not converge, given the point it stopped at.
SearchFailure WhyStopped(const ClosestPoints& c, bool nearly_solved) {
  constexpr double kNearlySingular = 1e-6;
  const bool vertex = c.curvature1.is_vertex() || c.curvature2.is_vertex();
  const double scale = vertex ? 1 : std::abs(c.curvature1.s) + std::abs(c.curvature2.s) + c.curvature_floor;
  const bool singular = nearly_solved && std::abs(c.D()) <= kNearlySingular * scale;
  return singular ? SearchFailure::kSingular : SearchFailure::kDiverged;
}

CurvaturePair Curvature(const WideJet& jet) { return {1, ToDouble(jet.kappa)}; }

// A vertex or arc on body 1 and a curve on body 2.
class RoundAndCurve {
 public:
  RoundAndCurve(const PlacedFeature& round1, const PlacedFeature& curve2, Angles angles)
      : round_(PlaceRound<Wide>(round1, angles)),
        curve_(curve2, angles),
        q_(Difference<Wide>(round1.x, curve2.x) + round_.U) {}

  StationaryPoints Search(std::optional<double> s2) const {
    StationaryPoints found;
    if (s2) {
      Finish(curve_.FromParameter(*s2), &found);
      return found;
    }
    const VecOf<double> q = Lift<double>(ToVec2(q_));
    const auto residual = [&](double tau) {
      const CurveJet<double> jet = curve_.At(curve_.Place(tau));
      return Dot(jet.d1, q - jet.c);
    };
    const std::vector<double> samples = CurveSamples(curve_, EvenDirections());
    double before = residual(samples[0]);
    for (size_t i = 1; i < samples.size(); ++i) {
      const double after = residual(samples[i]);
      if ((before < 0) != (after < 0))
        Finish(Widened(curve_, NarrowedSignChange(samples[i - 1], samples[i], residual)), &found);
      before = after;
    }
    FailIfNothingFound(&found);
    return found;
  }

 private:
  void Finish(const WidePlace& start, StationaryPoints* found) const {
    const NewtonEnding<1> ending = SafeguardedNewton<1>({&curve_}, {start}, [&](const CurvePlaces<1>& at) {
      const WideJet jet = curve_.At(at[0]);
      const VecOf<Wide> to_q = q_ - jet.c;
      const Wide g = Dot(jet.d1, to_q);
      const Wide slope = Dot(jet.d2, to_q) - Dot(jet.d1, jet.d1);
      return CurveEquations<1>{{-g / slope}, std::abs(ToDouble(g / Norm(jet.d1))) / curve_.size()};
    });
    const WidePlace& place = ending.places[0];
    if (!ending.converged) {
      Fail(WhyStopped(At(place), ending.nearly_solved), found);
    } else if (!IsOnCurve(curve_, place)) {
      FailBeyondEnd(curve_, place, found);
    } else {
      found->points.push_back(At(place));
    }
  }

  ClosestPoints At(const WidePlace& place) const {
    const WideJet jet = curve_.At(place);
    const VecOf<Wide> n = jet.N;
    const VecOf<Wide> R1 = round_.U - Wide(round_.rho) * n;
    ClosestPoints c;
    c.n = ToVec2(n);
    c.d = ToDouble(Dot(n, q_ - jet.c) - Wide(round_.rho));
    c.R1 = ToVec2(R1);
    c.R2 = ToVec2(jet.c);
    c.moment1 = Moment(R1, round_.U, n);
    c.moment2 = ToDouble(Cross(jet.c, n));
    c.curvature1 = round_.curvature();
    c.curvature2 = Curvature(jet);
    c.curvature_floor = curve_.curvature_floor();
    c.owner = 2;
    c.s1 = round_.Parameter(-c.n);
    c.s2 = curve_.Parameter(place);
    return c;
  }

  Round<Wide> round_;
  SmoothCurve curve_;
  VecOf<Wide> q_;  // the centre, from the curve's centre of mass
};

// A curve on body 1 and a straight edge on body 2.
class CurveAndLine {
 public:
  CurveAndLine(const PlacedFeature& curve1, const PlacedFeature& line2, Angles angles)
      : curve_(curve1, angles), line_(PlaceLine<Wide>(line2, angles)), dx_(Difference<Wide>(curve1.x, line2.x)) {}

  StationaryPoints Search(std::optional<double> s1) const {
    StationaryPoints found;
    if (s1) {
      Finish(curve_.FromParameter(*s1), &found);
      return found;
    }
    for (const double tau : curve_.WithNormal(-ToVec2(line_.normal))) Finish(Widened(curve_, tau), &found);
    FailIfNothingFound(&found);
    return found;
  }

 private:
  void Finish(const WidePlace& start, StationaryPoints* found) const {
    const NewtonEnding<1> ending = SafeguardedNewton<1>({&curve_}, {start}, [&](const CurvePlaces<1>& at) {
      const WideJet jet = curve_.At(at[0]);
      return CurveEquations<1>{{-Dot(jet.d1, line_.normal) / Dot(jet.d2, line_.normal)},
                               NotOpposite(jet.N, line_.normal)};
    });
    const WidePlace& place = ending.places[0];
    const WideJet jet = curve_.At(place);
    if (!ending.converged) {
      Fail(WhyStopped(At(place, jet), ending.nearly_solved), found);
    } else if (!IsOnCurve(curve_, place)) {
      FailBeyondEnd(curve_, place, found);
    } else if (!AreOpposite(jet.N, line_.normal)) {
      Fail(SearchFailure::kDiverged, found);
    } else {
      found->points.push_back(At(place, jet));
    }
  }

  ClosestPoints At(const WidePlace& place, const WideJet& jet) const {
    const VecOf<Wide> n = line_.normal;
    const VecOf<Wide> p1 = dx_ + jet.c;
    const Wide d = Dot(n, p1 - line_.A);
    const VecOf<Wide> R2 = p1 - d * n;
    ClosestPoints c;
    c.n = ToVec2(n);
    c.d = ToDouble(d);
    c.R1 = ToVec2(jet.c);
    c.R2 = ToVec2(R2);
    c.moment1 = ToDouble(Cross(jet.c, n));
    c.moment2 = ToDouble(Cross(R2, n));
    c.curvature1 = Curvature(jet);
    c.curvature2 = {1, 0};
    c.curvature_floor = curve_.curvature_floor();
    c.owner = 2;
    c.s1 = curve_.Parameter(place);
    c.s2 = ToDouble(Dot(line_.direction, R2 - line_.A) / line_.length);
    return c;
  }

  SmoothCurve curve_;
  Line<Wide> line_;
  VecOf<Wide> dx_;  // from body 2's centre of mass to body 1's
};

class CurveAndCurve {
 public:
  CurveAndCurve(const PlacedFeature& curve1, const PlacedFeature& curve2, Angles angles)
      : curve1_(curve1, angles),
        curve2_(curve2, angles),
        dx_(Difference<Wide>(curve1.x, curve2.x)),
        size_(curve1_.size() + curve2_.size()) {}

  StationaryPoints Search(std::optional<double> s1, std::optional<double> s2) const {
    StationaryPoints found;
    if (s1 && s2) {
      Finish({curve1_.FromParameter(*s1), curve2_.FromParameter(*s2)}, &found);
      return found;
    }
    if (s1) {
      const WidePlace place1 = curve1_.FromParameter(*s1);
      for (const double tau : curve2_.WithNormal(-ToVec2(curve1_.At(place1).N))) {
        Finish({place1, Widened(curve2_, tau)}, &found);
      }
    } else if (s2) {
      const WidePlace place2 = curve2_.FromParameter(*s2);
      for (const double tau : curve1_.WithNormal(-ToVec2(curve2_.At(place2).N))) {
        Finish({Widened(curve1_, tau), place2}, &found);
      }
    } else {
      SearchAll(&found);
    }
    FailIfNothingFound(&found);
    return found;
  }

 private:
  // Where the other curve faces a sample of the leading one, on which of its pieces, and how far along the leading
  // one's tangent it lies.
  struct Facing {
    double tau = 0;
    int piece = 0;
    double offset = 0;
  };

  std::vector<Facing> FacingPlaces(const SmoothCurve& lead, const SmoothCurve& other, Vec2 from_lead,
                                   double tau) const {
    const CurveJet<double> jet = lead.At(lead.Place(tau));
    std::vector<Facing> all;
    for (const double facing : other.WithNormal(-ToVec2(jet.N))) {
      const CurveJet<double> there = other.At(other.Place(facing));
      const Vec2 between = ToVec2(there.c - jet.c) + from_lead;
      all.push_back({facing, other.Piece(facing), Dot(Perp(ToVec2(jet.N)), between)});
    }
    return all;
  }

  void SearchAll(StationaryPoints* found) const {
    // A Bezier curve leads: an oval has a facing place for every normal, a Bezier curve only for some.
    const bool second_leads = curve1_.is_oval() && !curve2_.is_oval();
    const SmoothCurve& lead = second_leads ? curve2_ : curve1_;
    const SmoothCurve& other = second_leads ? curve1_ : curve2_;
    const Vec2 dx = ToVec2(dx_);
    const Vec2 from_lead = second_leads ? dx : -dx;
    const auto facing_on = [&](double tau, int piece) -> std::optional<Facing> {
      for (const Facing& facing : FacingPlaces(lead, other, from_lead, tau)) {
        if (facing.piece == piece) return facing;
      }
      return std::nullopt;
    };
    const std::vector<double> samples = CurveSamples(lead, FacingNormals(other));
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
          const std::optional<Facing> facing = facing_on(tau, a.piece);
          if (!facing) continue;
          const WidePlace lead_place = Widened(lead, tau);
          const WidePlace other_place = Widened(other, facing->tau);
          Finish(second_leads ? CurvePlaces<2>{other_place, lead_place} : CurvePlaces<2>{lead_place, other_place},
                 found);
        }
      }
      before = std::move(after);
    }
  }

  void Finish(const CurvePlaces<2>& start, StationaryPoints* found) const {
    const NewtonEnding<2> ending = SafeguardedNewton<2>({&curve1_, &curve2_}, start, [&](const CurvePlaces<2>& at) {
      const WideJet j1 = curve1_.At(at[0]);
      const WideJet j2 = curve2_.At(at[1]);
      const VecOf<Wide> between = dx_ + (j1.c - j2.c);
      const Wide parallel = Cross(j1.d1, j2.d1);
      const Wide normal = Dot(between, j2.d1);
      const Wide parallel_by_1 = Cross(j1.d2, j2.d1);
      const Wide parallel_by_2 = Cross(j1.d1, j2.d2);
      const Wide normal_by_1 = Dot(j1.d1, j2.d1);
      const Wide normal_by_2 = Dot(between, j2.d2) - Dot(j2.d1, j2.d1);
      const Wide determinant = parallel_by_1 * normal_by_2 - parallel_by_2 * normal_by_1;
      const double turned = NotOpposite(j1.N, j2.N);
      const double offset = ToDouble(normal / Norm(j2.d1)) / size_;
      return CurveEquations<2>{{(parallel_by_2 * normal - normal_by_2 * parallel) / determinant,
                                (normal_by_1 * parallel - parallel_by_1 * normal) / determinant},
                               std::sqrt(turned * turned + offset * offset)};
    });
    const auto& [place1, place2] = ending.places;
    const WideJet j1 = curve1_.At(place1);
    const WideJet j2 = curve2_.At(place2);
    if (!ending.converged) {
      Fail(WhyStopped(At(place1, j1, place2, j2), ending.nearly_solved), found);
    } else if (!IsOnCurve(curve1_, place1)) {
      FailBeyondEnd(curve1_, place1, found);
    } else if (!IsOnCurve(curve2_, place2)) {
      FailBeyondEnd(curve2_, place2, found);
    } else if (!AreOpposite(j1.N, j2.N)) {
      Fail(SearchFailure::kDiverged, found);
    } else {
      found->points.push_back(At(place1, j1, place2, j2));
    }
  }

  ClosestPoints At(const WidePlace& place1, const WideJet& j1, const WidePlace& place2, const WideJet& j2) const {
    ClosestPoints c;
    const VecOf<Wide> n = j2.N;
    c.n = ToVec2(n);
    c.d = ToDouble(Dot(n, dx_ + (j1.c - j2.c)));
    c.R1 = ToVec2(j1.c);
    c.R2 = ToVec2(j2.c);
    c.moment1 = ToDouble(Cross(j1.c, n));
    c.moment2 = ToDouble(Cross(j2.c, n));
    c.curvature1 = Curvature(j1);
    c.curvature2 = Curvature(j2);
    c.curvature_floor = curve1_.curvature_floor() + curve2_.curvature_floor();
    c.owner = 2;
    c.s1 = curve1_.Parameter(place1);
    c.s2 = curve2_.Parameter(place2);
    return c;
  }

  SmoothCurve curve1_;
  SmoothCurve curve2_;
  VecOf<Wide> dx_;  // from body 2's centre of mass to body 1's
  double size_;
};

StationaryPoints Swapped(StationaryPoints found) {
  for (ClosestPoints& c : found.points) c = Swapped(c);
  return found;
}

// All numbers of a curve, with its kind, in a fixed order: for an order of curves that knows nothing of bodies 1 and 2.
std::vector<double> Numbers(const PlacedFeature& placed) {
  std::vector<double> numbers = {static_cast<double>(placed.feature.index())};
  const auto add_oval = [&](const auto& oval, int m) {
    for (const double number : {oval.center.x, oval.center.y, oval.a, oval.b, oval.phi, static_cast<double>(m),
                                oval.side == Side::kConvex ? 0.0 : 1.0}) {
      numbers.push_back(number);
    }
  };
  if (const auto* ellipse = std::get_if<EllipseEdge>(&placed.feature)) add_oval(*ellipse, 2);
  if (const auto* superellipse = std::get_if<SuperellipseEdge>(&placed.feature))
    add_oval(*superellipse, superellipse->m);
  if (const auto* bezier = std::get_if<BezierEdge>(&placed.feature)) {
    for (const Vec2& p : bezier->P) {
      numbers.push_back(p.x);
      numbers.push_back(p.y);
    }
  }
  for (const double number : {placed.rotation.cos, placed.rotation.sin, placed.x.x, placed.x.y}) {
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

StationaryPoints SearchStationaryPoints(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                        const SearchStart& start, Angles angles) {
  for (const std::optional<double>& s : {start.s1, start.s2}) {
    if (s && !std::isfinite(*s)) {
      StationaryPoints found;
      Fail(SearchFailure::kStartNotFinite, &found);
      return found;
    }
  }
  const bool first = SmoothCurve::Holds(feature1.feature);
  const bool second = SmoothCurve::Holds(feature2.feature);
  if (first && second) {
    if (Numbers(feature2) < Numbers(feature1)) {
      StationaryPoints found = Swapped(CurveAndCurve(feature2, feature1, angles).Search(start.s2, start.s1));
      for (ClosestPoints& c : found.points) c.owner = 2;
      return found;
    }
    return CurveAndCurve(feature1, feature2, angles).Search(start.s1, start.s2);
  }
  const PlacedFeature& other = first ? feature2 : feature1;
  if (std::holds_alternative<StraightEdge>(other.feature)) {
    return first ? CurveAndLine(feature1, feature2, angles).Search(start.s1)
                 : Swapped(CurveAndLine(feature2, feature1, angles).Search(start.s2));
  }
  return first ? Swapped(RoundAndCurve(feature2, feature1, angles).Search(start.s1))
               : RoundAndCurve(feature1, feature2, angles).Search(start.s2);
}

}  // namespace lcpbench
