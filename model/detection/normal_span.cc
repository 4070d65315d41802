#include "model/detection/normal_span.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

namespace lcpbench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRoundingSlack = 1e-12;  // [rad], far above the rounding of unit vectors

Vec2 OutwardNormal(const OutlineCurve& curve, double s, double sense) {
  return -(sense * Perp(Unit(CurveDirection(curve, s))));
}

// A vertex or join.
NormalSpan PointSpan(NormalSpan::Kind kind, Vec2 p, Vec2 first_normal, Vec2 last_normal, Rotation rotation) {
  NormalSpan span(kind, Vertex{p}, {Rotate(rotation, first_normal), Rotate(rotation, last_normal), 0});
  span.begin = span.end = span.center = Rotate(rotation, p);
  return span;
}

// The part s_begin..s_end of an edge, as its NormalCuts cut it.
NormalSpan PieceSpan(const OutlineCurve& curve, double s_begin, double s_end, Rotation rotation) {
  const Vec2 a = CurvePoint(curve, s_begin);
  const Vec2 b = CurvePoint(curve, s_end);
  const Vec2 first = Unit(CurveDirection(curve, s_begin));
  const Vec2 last = Unit(CurveDirection(curve, s_end));
  const double turn = Cross(first, last);
  NormalSpan span = std::visit(
      [&](const auto& e) {
        using Curve = std::decay_t<decltype(e)>;
        constexpr bool kIsStraight = Curve::kKind == CurveKind::kStraight;
        if (kIsStraight || (!Curve::kIsAngle && std::abs(turn) < NormalSpan::kFlatTurn)) {
          const Vec2 normal = Rotate(rotation, -Perp(Unit(b - a)));
          return NormalSpan(NormalSpan::Kind::kStraight, e, {normal, normal, 0});
        }
        constexpr bool kIsArc = Curve::kKind == CurveKind::kArc;
        const double sense = s_begin < s_end ? 1 : -1;
        const bool convex = Curve::kIsAngle ? sense > 0 : turn > 0;
        // Ordered so that the normals turn counter-clockwise from the first to the last.
        Vec2 first_normal = Rotate(rotation, -(sense * Perp(first)));
        Vec2 last_normal = Rotate(rotation, -(sense * Perp(last)));
        if (!convex) std::swap(first_normal, last_normal);
        const double angle = kIsArc ? std::abs(s_end - s_begin) : 0;
        NormalSpan part{
            kIsArc ? NormalSpan::Kind::kArc : NormalSpan::Kind::kCurve, e, {first_normal, last_normal, angle}};
        part.sign = convex ? 1 : -1;
        Curve turned = e;
        if constexpr (requires { e.center; }) part.center = turned.center = Rotate(rotation, e.center);
        if constexpr (requires { e.P; }) {
          for (Vec2& p : turned.P) p = Rotate(rotation, p);
        }
        if constexpr (requires { e.radius; }) part.radius = e.radius;
        if constexpr (requires { e.phi; }) {
          part.semi_axis = std::max(e.a, e.b);
          const Rotation phi = SinCos(e.phi);
          const Vec2 axis = Unit(Rotate(rotation, {phi.cos, phi.sin}));
          part.piece.turn = {axis.x, axis.y};
        }
        part.turned = turned;
        return part;
      },
      curve);
  span.begin = Rotate(rotation, a);
  span.end = Rotate(rotation, b);
  span.piece.s_begin = s_begin;
  span.piece.s_end = s_end;
  return span;
}

void AppendPiece(const OutlinePiece& piece, Rotation rotation, std::vector<NormalSpan>* spans) {
  const auto append = [&](const auto& curve) {
    if constexpr (std::decay_t<decltype(curve)>::kKind == CurveKind::kSearched) {
      const std::vector<double> cuts = curve.NormalCuts(piece.s_begin, piece.s_end);
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        spans->push_back(PieceSpan(piece.edge, cuts[k], cuts[k + 1], rotation));
      }
    } else {
      spans->push_back(PieceSpan(piece.edge, piece.s_begin, piece.s_end, rotation));
    }
  };
  std::visit(append, piece.edge);
}

double Extent(const OutlineLoop& loop) {
  double extent = 0;
  for (const OutlinePiece& piece : loop) extent = std::max(extent, Reach(piece));
  return extent;
}

// Where a straight span goes over into a convex curve: whether that curve is flat there.
std::optional<bool> FlatnessOfJoin(const NormalSpan& before, const NormalSpan& after, Vec2 normal) {
  const bool from_straight = before.kind == NormalSpan::Kind::kStraight;
  if (from_straight == (after.kind == NormalSpan::Kind::kStraight)) return std::nullopt;
  const NormalSpan& curve = from_straight ? after : before;
  if (!curve.is_convex()) return std::nullopt;
  // Arcs have their contact points in closed form, however flat they are.
  if (curve.kind == NormalSpan::Kind::kArc) return false;
  return std::abs(curve.At(normal).curvature.s) * curve.chord() <= NormalSpan::kFlatEnd;
}

void AppendLoop(const OutlineLoop& loop, Rotation rotation, std::vector<NormalSpan>* spans) {
  const double closure = NormalSpan::kSlack * Extent(loop);
  // Between which spans of edges each joint of the loop's pieces is.
  struct Joint {
    std::size_t before = 0;
    std::size_t after = 0;
    std::optional<NormalSpan> vertex;
    bool flat = false;
  };
  std::vector<NormalSpan> edges;
  std::vector<Joint> joints(loop.size());
  for (std::size_t k = 0; k < loop.size(); ++k) {
    joints[(k + loop.size() - 1) % loop.size()].after = edges.size();
    AppendPiece(loop[k], rotation, &edges);
    joints[k].before = edges.size() - 1;
  }
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const OutlinePiece& piece = loop[k];
    const OutlinePiece& next = loop[(k + 1) % loop.size()];
    const Vec2 p = CurvePoint(next.edge, next.s_begin);
    if (Norm(p - CurvePoint(piece.edge, piece.s_end)) > closure) continue;
    const Vec2 first = OutwardNormal(piece.edge, piece.s_end, piece.s_begin < piece.s_end ? 1 : -1);
    const Vec2 last = OutwardNormal(next.edge, next.s_begin, next.s_begin < next.s_end ? 1 : -1);
    const double turn = Cross(first, last);
    Joint& joint = joints[k];
    const bool smooth = std::abs(turn) <= NormalSpan::kSlack && Dot(first, last) > 0;
    const std::optional<bool> flat =
        smooth ? FlatnessOfJoin(edges[joint.before], edges[joint.after], Rotate(rotation, first)) : std::nullopt;
    if (turn > kRoundingSlack) {
      joint.vertex = PointSpan(NormalSpan::Kind::kVertex, p, first, last, rotation);
    } else if (flat) {
      joint.vertex = PointSpan(NormalSpan::Kind::kJoin, p, first, first, rotation);
    }
    joint.flat = flat.value_or(false);
  }
  for (Joint& joint : joints) {
    if (!joint.vertex) continue;
    NormalSpan& before = edges[joint.before];
    NormalSpan& after = edges[joint.after];
    const bool from_straight = before.kind == NormalSpan::Kind::kStraight;
    if (from_straight) joint.vertex->straight_before = before.begin;
    if (after.kind == NormalSpan::Kind::kStraight) joint.vertex->straight_after = after.end;
    joint.vertex->is_flat_end = joint.flat;
    if (joint.flat) (from_straight ? after : before).flat_normals.push_back(joint.vertex->cone.first);
  }
  // Every piece's spans, then the vertex at its end.
  std::size_t edge = 0;
  for (Joint& joint : joints) {
    for (; edge <= joint.before; ++edge) spans->push_back(std::move(edges[edge]));
    if (joint.vertex) spans->push_back(std::move(*joint.vertex));
  }
}

}  // namespace

NormalCone::NormalCone(Vec2 begin, Vec2 end, double angle)
    : first(begin), last(end), is_narrow(angle <= kPi), is_full(angle >= 2 * kPi - kRoundingSlack) {}

bool NormalCone::Contains(Vec2 n, double slack) const {
  if (is_full) return true;
  // Where the ends are less than 90 degrees apart, either way, the sines alone do not tell a side from its opposite.
  const bool near_ends = Dot(first, last) <= 0 || Dot(n, first + last) > 0;
  if (is_narrow) return near_ends && Cross(first, n) >= -slack && Cross(n, last) >= -slack;
  return !(near_ends && Cross(last, n) > slack && Cross(n, first) > slack);
}

BoundingBox NormalSpan::Bounds() const {
  BoundingBox box = Union({begin, begin}, {end, end});
  if (is_point() || kind == Kind::kStraight) return box;
  for (const Vec2 axis : {Vec2{1, 0}, Vec2{0, 1}, Vec2{-1, 0}, Vec2{0, -1}}) {
    if (!cone.Contains(axis, kSlack)) continue;
    const Vec2 p = At(axis).arm;
    box = Union(box, {p, p});
  }
  return box;
}

SpanPoint NormalSpan::At(Vec2 n) const {
  if (kind != Kind::kArc && kind != Kind::kCurve) return {center, {0, 1}, {}};
  return std::visit([&](const auto& e) { return e.AtNormal(n, piece); }, turned);
}

std::optional<double> NormalSpan::Parameter(Vec2 place) const {
  if (kind != Kind::kCurve) return std::nullopt;
  return std::visit([&](const auto& e) { return e.kIsAngle ? AngleOf(place) : place.x; }, turned);
}

std::optional<double> NormalSpan::StraightParameter(double u) const {
  if (!IsSearched(feature)) return std::nullopt;
  return piece.s_begin + std::clamp(u, 0.0, 1.0) * (piece.s_end - piece.s_begin);
}

bool NormalSpan::IsFlatWhere(Vec2 n) const {
  return std::any_of(flat_normals.begin(), flat_normals.end(),
                     [&](Vec2 flat) { return Dot(flat, n) > 0 && std::abs(Cross(flat, n)) <= kSlack; });
}

bool NormalSpan::Holds(Vec2 arm, Vec2 outward) const {
  if (is_point()) return cone.Contains(outward, kSlack);
  // Beyond half a turn the chord does not tell; along less, the foot's projection on the chord is the sharper test.
  if (kind == Kind::kArc && std::abs(piece.s_end - piece.s_begin) > kPi / 2) return cone.Contains(outward, kSlack);
  if (kind == Kind::kStraight) {
    if (Dot(outward, cone.first) <= 0) return false;
  } else if (!cone.Contains(outward, kSlack)) {
    return false;
  }
  const Vec2 along = end - begin;
  const double square = Dot(along, along);
  const double u = Dot(arm - begin, along) / square;
  const double slack =
      kSlack + 8 * std::numeric_limits<double>::epsilon() * (Norm(begin) + Norm(end)) / std::sqrt(square);
  return u >= -slack && u <= 1 + slack;
}

std::vector<NormalSpan> NormalSpans(const Outline& outline, Rotation rotation) {
  std::vector<NormalSpan> spans;
  for (const OutlineLoop& loop : outline.loops) AppendLoop(loop, rotation, &spans);
  return spans;
}

}  // namespace lcpbench
