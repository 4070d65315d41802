#include "model/detection/narrow_phase.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {
namespace {

/// Cosine of the angle [about pi / 32] within which D is taken to change its sign once at most.
constexpr double kNarrow = 0.9952;
/// Sine of the angle below which a change of sign of D is no longer pursued [rad].
constexpr double kFinest = 1e-9;
/// What normals may be off by from rounding [rad].
constexpr double kNormalRounding = 1e-14;
/// Sine of the angle [about 0.6 degrees] up to which straight edges count as lying on each other.
constexpr double kNearlyFlush = 1e-2;
/// Normals equal up to this are the same, for minima at the same place.
constexpr double kSameNormal = 1e-6;

double SingularThreshold(const CurvaturePair& c1, const CurvaturePair& c2) {
  const bool vertex = c1.is_vertex() || c2.is_vertex();
  return kSingularD * (vertex ? 1 : std::abs(c1.s) + std::abs(c2.s));
}

// Feet of one minimum, found from spans that join, differ by less [m].
double SamePlace(const NormalSpan& span1, const NormalSpan& span2) {
  constexpr double kSlacks = 4 * NormalSpan::kSlack;
  return kSlacks * (span1.reach() + span2.reach());
}

bool IsSame(const ClosestPoints& c, Vec2 n, Vec2 R1, Vec2 R2, double near) {
  return Norm(c.n - n) <= kSameNormal && Norm(c.R1 - R1) <= near && Norm(c.R2 - R2) <= near;
}

class SpanPair {
 public:
  SpanPair(const PlacedOutline& body1, int span1, const PlacedOutline& body2, int span2, const GapRange& range,
           std::vector<GapMinimum>* minima)
      : body1_(body1),
        body2_(body2),
        span1_(body1.spans[static_cast<std::size_t>(span1)]),
        span2_(body2.spans[static_cast<std::size_t>(span2)]),
        index1_(span1),
        index2_(span2),
        range_(range),
        reach_(std::max(range.gap, range.penetration)),
        dx_(body1.x - body2.x),
        minima_(minima) {}

  void Search() {
    using Kind = NormalSpan::Kind;
    const auto is_apart = [](const NormalSpan& a, const NormalSpan& b) {
      if (a.kind == Kind::kJoin) return b.kind != Kind::kStraight;
      if (!a.is_convex()) return !b.is_convex() || b.kind == Kind::kStraight;
      return a.kind == b.kind && (a.kind == Kind::kStraight || a.kind == Kind::kVertex);
    };
    if (is_apart(span1_, span2_) || is_apart(span2_, span1_)) return;
    const bool straight1 = span1_.kind == Kind::kStraight;
    const bool straight2 = span2_.kind == Kind::kStraight;
    if (straight2) {
      SearchStraight(span2_, span1_, dx_);
    } else if (straight1) {
      SearchStraight(span1_, span2_, -dx_);
    } else if (span1_.is_round() && span2_.is_round()) {
      SearchRound();
    } else {
      SearchCommonNormals();
    }
  }

 private:
  // Both spans' points for one normal, and the gap between them.
  struct Node {
    Vec2 n;
    SpanPoint p1;
    SpanPoint p2;
    double d = 0;
    double g = 0;
    double D = 0;
    bool is_singular = false;
  };

  bool IsInRange(double d, double margin) const {
    return d <= range_.gap + margin && d >= -range_.penetration - margin;
  }
  // What plain double evaluation may be wrong by.
  double Margin() const {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    return kRounding * (Norm(dx_) + span1_.reach() + span2_.reach());
  }

  // A straight span against one that has a point facing it. to_other: from the straight span's body to the other.
  void SearchStraight(const NormalSpan& straight, const NormalSpan& other, Vec2 to_other) {
    const Vec2 n = straight.cone.first;
    const bool faces = other.kind != NormalSpan::Kind::kJoin && other.cone.Contains(-n, NormalSpan::kSlack);
    if (!faces && !other.is_point()) return;
    // A curve that begins flatly has no foot to find there: the contact is the join's.
    if (other.IsFlatWhere(-n)) return;
    const SpanPoint p = other.At(-n);
    const Vec2 along = straight.end - straight.begin;
    const Vec2 from_begin = to_other + p.arm - straight.begin;
    const double margin = Margin() + kSearchMargin * straight.chord();
    if (!IsInRange(Dot(n, from_begin), margin)) return;
    const double u = Dot(along, from_begin) / Dot(along, along);
    if (u < -kSearchMargin || u > 1 + kSearchMargin) return;
    is_flush_end_ = !faces;
    is_beside_cone_ = !other.cone.Contains(-n, kNormalRounding);
    if (is_flush_end_ && !IsFlushEnd(straight, other, from_begin)) return;
    std::optional<double> s_straight = straight.StraightParameter(u);
    std::optional<double> s_other = other.Parameter(p.place);
    if (&straight == &span1_) {
      Finish(s_straight, s_other);
    } else {
      Finish(s_other, s_straight);
    }
  }

  // Whether a vertex or join is the farther end of the overlap of its own straight edge with a straight span.
  // from_begin: the vertex, from the straight span's begin.
  bool IsFlushEnd(const NormalSpan& straight, const NormalSpan& vertex, Vec2 from_begin) const {
    const Vec2 n = straight.cone.first;
    if (vertex.is_flat_end && Dot(vertex.cone.first, n) < 0 &&
        std::abs(Cross(vertex.cone.first, n)) <= NormalSpan::kSlack) {
      return true;
    }
    const Vec2 t = Unit(straight.end - straight.begin);
    const double place = Dot(t, from_begin);
    // The material of either edge is on its left, so that edges that face each other run opposite ways.
    const auto overlaps = [&](const std::optional<Vec2>& far_end, double sense) {
      if (!far_end) return false;
      const Vec2 edge = *far_end - vertex.center;
      const double length = Norm(edge);
      const double slope = Dot(n, edge) / length;
      if (std::abs(slope) > kNearlyFlush || slope > kNormalRounding || sense * Dot(t, edge) < 0) return false;
      const double other_end = std::clamp(place + Dot(t, edge), 0.0, straight.chord());
      const double part = (other_end - place) / Dot(t, edge);
      return part > kSearchMargin && IsInRange(Dot(n, from_begin) + part * Dot(n, edge), 0);
    };
    return overlaps(vertex.straight_before, 1) || overlaps(vertex.straight_after, -1);
  }

  void SearchRound() {
    const Vec2 between = dx_ + span1_.center - span2_.center;
    const double rho_sum = span1_.rho() + span2_.rho();
    const double scale = std::abs(span1_.rho()) + std::abs(span2_.rho());
    const double distance = Norm(between);
    const bool convex = span1_.is_convex() && span2_.is_convex();
    const double sigma = convex ? 1 : -1;
    const double margin = Margin();
    // A convex span larger than the concave one rests on its ends, not here.
    if (!convex && rho_sum > kSingularD * scale) return;
    if (!IsInRange(sigma * distance - rho_sum, margin)) return;
    if (distance <= kSingularD * scale + margin || (!convex && std::abs(rho_sum) <= kSingularD * scale)) {
      // Every normal they have in common is one: FindClosestPoints refuses the pair by name.
      if (HaveCommonNormals()) Finish({}, {});
      return;
    }
    const Vec2 n = (sigma / distance) * between;
    const double slack = kSearchMargin + margin / distance;
    if (span1_.cone.Contains(-n, slack) && span2_.cone.Contains(n, slack)) Finish({}, {});
  }

  bool HaveCommonNormals() const {
    const NormalCone& cone1 = span1_.cone;
    const NormalCone& cone2 = span2_.cone;
    constexpr double kInside = -NormalSpan::kSlack;
    return cone2.Contains(-cone1.first, kInside) || cone2.Contains(-cone1.last, kInside) ||
           cone1.Contains(-cone2.first, kInside) || cone1.Contains(-cone2.last, kInside) ||
           (cone1.is_full && cone2.is_full);
  }

  // Cones of at most a quarter turn, to which the other's can be compared.
  static void AppendQuarters(const NormalCone& cone, std::vector<NormalCone>* parts) {
    if (cone.is_narrow && Dot(cone.first, cone.last) >= 0) {
      parts->push_back(cone);
      return;
    }
    Vec2 middle = cone.first + cone.last;
    if (cone.is_full) {
      middle = -cone.first;
    } else if (Norm(middle) < kSameNormal) {
      middle = Perp(cone.first);
    } else if (!cone.is_narrow) {
      middle = -middle;
    }
    middle = Unit(middle);
    AppendQuarters({cone.first, middle, 0}, parts);
    AppendQuarters({middle, cone.last, 0}, parts);
  }

  void SearchCommonNormals() {
    std::vector<NormalCone> parts1;
    std::vector<NormalCone> parts2;
    AppendQuarters(span1_.cone, &parts1);
    AppendQuarters(span2_.cone, &parts2);
    for (const NormalCone& part1 : parts1) {
      for (const NormalCone& part2 : parts2) {
        const NormalCone facing(-part1.first, -part1.last, 0);
        constexpr double slack = NormalSpan::kSlack;
        const bool from_2 = facing.Contains(part2.first, 2 * slack);
        if (!from_2 && !part2.Contains(facing.first, 2 * slack)) continue;
        const bool to_2 = facing.Contains(part2.last, 2 * slack);
        if (!to_2 && !part2.Contains(facing.last, 2 * slack)) continue;
        const Vec2 first = from_2 ? part2.first : facing.first;
        const Vec2 last = to_2 ? part2.last : facing.last;
        // Wider by the slack, as what joins there may have begun as much later.
        SearchBetween(At(Unit(first - slack * Perp(first))), At(Unit(last + slack * Perp(last))));
      }
    }
  }

  Node At(Vec2 n) const {
    Node node;
    node.n = n;
    node.p1 = span1_.At(-n);
    node.p2 = span2_.At(n);
    const Vec2 between = dx_ + node.p1.arm - node.p2.arm;
    node.d = Dot(n, between);
    node.g = Dot(Perp(n), between);
    const CurvaturePair c1 = node.p1.curvature;
    const CurvaturePair c2 = node.p2.curvature;
    node.D = c1.r * c2.s + c1.s * c2.r + node.d * (c1.s * c2.s);
    node.is_singular = std::abs(node.D) <= SingularThreshold(c1, c2);
    return node;
  }

  // Whether the parts between two normals are further apart than the range along the middle normal or its tangent.
  bool AreApart(const Node& low, const Node& high, double sine, double cosine) const {
    const Vec2 n = Unit(low.n + high.n);
    const Vec2 t = Perp(n);
    // Parts lie within this of their chords.
    const double rise = std::abs(sine) / (1 + cosine) / 2;
    const double heights = rise * (Norm(high.p1.arm - low.p1.arm) + Norm(high.p2.arm - low.p2.arm));
    const double room = reach_ + heights + Margin();
    const auto apart_along = [&](Vec2 axis) {
      const auto [low1, high1] = std::minmax({Dot(axis, low.p1.arm), Dot(axis, high.p1.arm)});
      const auto [low2, high2] = std::minmax({Dot(axis, low.p2.arm), Dot(axis, high.p2.arm)});
      const double shift = Dot(axis, dx_);
      return shift + low1 - high2 > room || low2 - high1 - shift > room;
    };
    return apart_along(n) || apart_along(t);
  }

  void SearchBetween(const Node& low, const Node& high) {
    const double sine = Cross(low.n, high.n);
    const double cosine = Dot(low.n, high.n);
    if (AreApart(low, high, sine, cosine)) return;
    const bool one_sign = (low.D > 0) == (high.D > 0);
    if (cosine < kNarrow || (!one_sign && sine > kFinest)) {
      const Node middle = At(Unit(low.n + high.n));
      if (!one_sign && IsMatch(low, middle, high)) Refuse();
      SearchBetween(low, middle);
      SearchBetween(middle, high);
      return;
    }
    if (one_sign && IsMatch(low, At(Unit(low.n + high.n)), high)) Refuse();
    if (one_sign && low.D <= 0) return;
    const double sign = span1_.is_convex() && span2_.is_convex() ? 1 : -1;
    const bool falls = sign * low.g >= 0 && sign * high.g <= 0;
    const bool rises = sign * low.g <= 0 && sign * high.g >= 0;
    if (falls || (!one_sign && rises)) FinishNear(Zero(low, high));
  }

  // Two curves that run along each other: g and D vanish everywhere.
  bool IsMatch(const Node& low, const Node& middle, const Node& high) const {
    constexpr double kSameCurve = 1e-9;
    const double length = kSameCurve * std::min(Norm(high.p1.arm - low.p1.arm), Norm(high.p2.arm - low.p2.arm));
    for (const Node* node : {&low, &middle, &high}) {
      if (!node->is_singular || !IsInRange(node->d, 0) || std::abs(node->g) > length + Margin()) return false;
    }
    return true;
  }

  [[noreturn]] void Refuse() const {
    throw InputError("curvature match: the edges run along each other and have no unique contact point; feature 1: " +
                     Describe(span1_.feature) + "; feature 2: " + Describe(span2_.feature));
  }

  // The zero of g between two normals of opposite sign.
  Node Zero(const Node& low, const Node& high) const {
    constexpr int kMostSteps = 80;
    constexpr double kWidth = 1e-14;
    double u = 0;
    double v = 1;
    double at_u = low.g;
    double at_v = high.g;
    int kept = 0;  // the end that the last step left: 1 the upper, -1 the lower
    Node node = std::abs(at_u) < std::abs(at_v) ? low : high;
    for (int i = 0; i < kMostSteps && at_u != 0 && at_v != 0 && v - u > kWidth; ++i) {
      // Bisection every third step, for functions as steep as a superellipse's at its flat points.
      double w = i % 3 == 2 ? u + (v - u) / 2 : u + (v - u) * (at_u / (at_u - at_v));
      if (!(w > u && w < v)) w = u + (v - u) / 2;
      node = At(Unit((1 - w) * low.n + w * high.n));
      if (node.g == 0) break;
      if ((node.g < 0) == (at_u < 0)) {
        u = w;
        at_u = node.g;
        if (kept == 1) at_v /= 2;
        kept = 1;
      } else {
        v = w;
        at_v = node.g;
        if (kept == -1) at_u /= 2;
        kept = -1;
      }
    }
    return node;
  }

  void FinishNear(const Node& node) {
    if (!IsInRange(node.d, Margin() + kSearchMargin * (std::abs(node.d) + reach_))) return;
    // At the ends of spans the neighbours find the same minimum; the search for it is what costs.
    const double near = SamePlace(span1_, span2_);
    const bool known = std::any_of(minima_->begin(), minima_->end(), [&](const GapMinimum& m) {
      return IsSame(m.closest, node.n, node.p1.arm, node.p2.arm, near);
    });
    if (!known) Finish(span1_.Parameter(node.p1.place), span2_.Parameter(node.p2.place));
  }

  void Finish(std::optional<double> s1, std::optional<double> s2) {
    const PlacedFeature placed1{span1_.feature, body1_.x, body1_.rotation};
    const PlacedFeature placed2{span2_.feature, body2_.x, body2_.rotation};
    const SearchStart start{s1, s2, 0};
    ClosestPoints closest;
    if (s1 || s2) {
      const StationaryPoints found = SearchStationaryPoints(placed1, placed2, start);
      if (found.points.empty()) {
        // A foot just beyond the end of a Bezier curve is one of the next edge.
        if (found.is_beyond_end || is_beside_cone_) return;
        throw InputError(found.failure + "; feature 1: " + Describe(span1_.feature) +
                         "; feature 2: " + Describe(span2_.feature));
      }
      closest = found.points.front();
      const double threshold =
          SingularThreshold(closest.curvature1, closest.curvature2) + kSingularD * closest.curvature_floor;
      if (closest.D() < -threshold || !IsHeld(closest)) return;
      if (closest.D() <= threshold) closest = FindClosestPoints(placed1, placed2, start);  // refuses it by name
    } else {
      closest = FindClosestPoints(placed1, placed2);
      if (!IsHeld(closest)) return;
    }
    minima_->push_back({index1_, index2_, closest, s1, s2, is_flush_end_});
  }

  // Whether a stationary point lies on both spans and in the range, and is a minimum, not a maximum, of the distance.
  bool IsHeld(const ClosestPoints& c) const {
    if (!IsInRange(c.d, 0)) return false;
    // The end of a flush edge is where it is, whatever normals its vertex has.
    const auto holds = [&](const NormalSpan& span, Vec2 arm, Vec2 outward) {
      return (is_flush_end_ && span.kind != NormalSpan::Kind::kStraight) || span.Holds(arm, outward);
    };
    if (!holds(span1_, c.R1, -c.n) || !holds(span2_, c.R2, c.n)) return false;
    // Across a wide gap D > 0 holds for maxima too.
    const auto is_ahead = [&](const CurvaturePair& edge) { return edge.is_vertex() || 1 + c.d * edge.s > 0; };
    return is_ahead(c.curvature1) && is_ahead(c.curvature2);
  }

  // How far rounding may put what a search then finds exactly.
  static constexpr double kSearchMargin = 1e-7;

  const PlacedOutline& body1_;
  const PlacedOutline& body2_;
  const NormalSpan& span1_;
  const NormalSpan& span2_;
  int index1_;
  int index2_;
  GapRange range_;
  double reach_;
  Vec2 dx_;
  bool is_beside_cone_ = false;  // the straight span's normal is the other's within its slack only: it may have no foot
  bool is_flush_end_ = false;    // what is being finished is not a minimum of the distance
  std::vector<GapMinimum>* minima_;
};

// From one angle counter-clockwise to another, in 0..2 pi [rad].
double Turn(double from, double to) {
  const double turn = std::fmod(to - from, 2 * std::numbers::pi);
  return turn < 0 ? turn + 2 * std::numbers::pi : turn;
}

DirectionRange NormalsOf(const NormalSpan& span) {
  const bool known = IsFinite(span.cone.first) && IsFinite(span.cone.last);
  if (!known || (!span.is_point() && span.kind != NormalSpan::Kind::kStraight)) return {0, 2 * std::numbers::pi};
  const double begin = std::atan2(span.cone.first.y, span.cone.first.x);
  return {begin, Turn(begin, std::atan2(span.cone.last.y, span.cone.last.x))};
}

SpanBound Join(const SpanBound& a, const SpanBound& b) {
  const auto from = [](const DirectionRange& p, const DirectionRange& q) {
    const double width = std::max(p.width, Turn(p.begin, q.begin) + q.width);
    return DirectionRange{p.begin, std::min(width, 2 * std::numbers::pi)};
  };
  const DirectionRange from_a = from(a.normals, b.normals);
  const DirectionRange from_b = from(b.normals, a.normals);
  return {Union(a.box, b.box), from_a.width <= from_b.width ? from_a : from_b};
}

// Whether spans with these normals may face each other: as straight edges and corners do, also as nearly flush ones.
bool MayFace(const DirectionRange& a, const DirectionRange& b) {
  constexpr double kSlack = 2 * kNearlyFlush;
  const double turn = Turn(a.begin + std::numbers::pi, b.begin);
  return turn <= a.width + kSlack || 2 * std::numbers::pi - turn <= b.width + kSlack;
}

constexpr DirectionRange kAllDirections{0, 2 * std::numbers::pi};

// Calls found(k) for a body's spans in ascending order; of a long outline those that a box touches, in the body's frame
// of boxes, and that normals may face.
template <class Found>
void VisitNear(const PlacedOutline& body, const BoundingBox& box, const DirectionRange& normals, const Found& found) {
  if (!body.tree) {
    for (std::size_t k = 0; k < body.spans.size(); ++k) found(k);
    return;
  }
  body.tree->Visit([&](const SpanBound& bound, std::size_t k, std::size_t count) {
    if (!Overlap(box, bound.box) || !MayFace(normals, bound.normals)) return false;
    if (count == 1) found(k);
    return true;
  });
}

// Sorts by (span1, span2) and keeps the first of minima that are the same point: feet within a few NormalSpan::kSlack
// of the spans' lengths, and the same normal.
void RemoveRepeated(const PlacedOutline& body1, const PlacedOutline& body2, std::vector<GapMinimum>* minima) {
  // Minima go before ends of flush edges at the same place.
  const auto before = [](const GapMinimum& a, const GapMinimum& b) {
    return std::tuple(a.is_flush_end, a.span1, a.span2) < std::tuple(b.is_flush_end, b.span1, b.span2);
  };
  std::stable_sort(minima->begin(), minima->end(), before);
  const auto spread = [&](const GapMinimum& m) {
    return SamePlace(body1.spans[static_cast<std::size_t>(m.span1)], body2.spans[static_cast<std::size_t>(m.span2)]);
  };
  std::vector<GapMinimum> kept;
  for (const GapMinimum& m : *minima) {
    const bool repeated = std::any_of(kept.begin(), kept.end(), [&](const GapMinimum& k) {
      return IsSame(k.closest, m.closest.n, m.closest.R1, m.closest.R2, spread(m) + spread(k));
    });
    if (!repeated) kept.push_back(m);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const GapMinimum& a, const GapMinimum& b) {
    return std::pair(a.span1, a.span2) < std::pair(b.span1, b.span2);
  });
  minima->swap(kept);
}

}  // namespace

PlacedOutline PlaceOutline(const Outline& outline, Vec2 x, double theta) {
  PlacedOutline placed;
  placed.x = x;
  placed.rotation = SinCos(theta);
  placed.spans = NormalSpans(outline, placed.rotation);
  placed.boxes.reserve(placed.spans.size());
  for (const NormalSpan& span : placed.spans) placed.boxes.push_back(span.Bounds());
  if (!placed.boxes.empty())
    placed.whole = std::reduce(placed.boxes.begin(), placed.boxes.end(), placed.boxes[0], Union);
  if (placed.spans.size() > kManySpans) {
    for (std::size_t k = 0; k < placed.spans.size(); ++k) {
      placed.bounds.push_back({placed.boxes[k], NormalsOf(placed.spans[k])});
    }
    placed.tree.emplace(placed.bounds, Join);
  }
  return placed;
}

std::vector<GapMinimum> FindGapMinima(const PlacedOutline& body1, const PlacedOutline& body2, const GapRange& range,
                                      const StopCheck& check) {
  // A little more than the range, and the rounding of centres far from the world's origin.
  constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
  const double margin = 1.001 * std::max(range.gap, range.penetration) + kRounding * (Norm(body1.x) + Norm(body2.x));
  const auto in_body2 = [&](const BoundingBox& box) { return Inflated(box, body1.x - body2.x, margin); };
  std::vector<GapMinimum> minima;
  const auto search = [&](std::size_t i, std::size_t j) {
    if (!Overlap(in_body2(body1.boxes[i]), body2.boxes[j])) return;
    SpanPair(body1, static_cast<int>(i), body2, static_cast<int>(j), range, &minima).Search();
  };
  // On a long outline only the spans near the other body are looked at: many bodies may lie along it.
  VisitNear(body1, Inflated(body2.whole, body2.x - body1.x, margin), kAllDirections, [&](std::size_t i) {
    if (body1.tree || body2.tree) check();
    VisitNear(body2, in_body2(body1.boxes[i]), body1.tree ? body1.bounds[i].normals : kAllDirections,
              [&](std::size_t j) { search(i, j); });
  });
  RemoveRepeated(body1, body2, &minima);
  return minima;
}

}  // namespace lcpbench
