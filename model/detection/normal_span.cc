#include "model/detection/normal_span.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "model/geometry/trig.h"

namespace lcpbench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRoundingSlack = 1e-12;  // [rad], far above the rounding of unit vectors

Vec2 OutwardNormal(const OutlineCurve& curve, double s, double sense) {
  return -(sense * Perp(Unit(CurveDirection(curve, s))));
}

void AppendPiece(const OutlinePiece& piece, Rotation rotation, std::vector<NormalSpan>* spans) {
  std::visit(
      [&](const auto& curve) {
        if constexpr (std::decay_t<decltype(curve)>::kKind == CurveKind::kSearched) {
          const std::vector<double> cuts = curve.NormalCuts(piece.s_begin, piece.s_end);
          for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
            spans->push_back(NormalSpan::OfPiece(piece.edge, cuts[k], cuts[k + 1], rotation));
          }
        } else {
          spans->push_back(NormalSpan::OfPiece(piece.edge, piece.s_begin, piece.s_end, rotation));
        }
      },
      piece.edge);
}

double Extent(const OutlineLoop& loop) {
  double extent = 0;
  for (const OutlinePiece& piece : loop) extent = std::max(extent, Reach(piece));
  return extent;
}

// Where a straight span goes over into a convex curve: whether that curve is flat there.
std::optional<bool> FlatnessOfJoin(const NormalSpan& before, const NormalSpan& after, Vec2 normal) {
  const bool from_straight = before.kind() == NormalSpan::Kind::kStraight;
  if (from_straight == (after.kind() == NormalSpan::Kind::kStraight)) return std::nullopt;
  const NormalSpan& curve = from_straight ? after : before;
  if (!curve.is_convex()) return std::nullopt;
  // Arcs have their contact points in closed form, however flat they are.
  if (curve.kind() == NormalSpan::Kind::kArc) return false;
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
      joint.vertex = NormalSpan::OfVertex(p, first, last, rotation);
    } else if (flat) {
      joint.vertex = NormalSpan::OfJoin(p, first, rotation);
    }
    joint.flat = flat.value_or(false);
  }
  for (Joint& joint : joints) {
    if (joint.vertex) NormalSpan::Connect(&edges[joint.before], &*joint.vertex, &edges[joint.after], joint.flat);
  }
  // Every piece's spans, then the vertex at its end.
  std::size_t edge = 0;
  for (Joint& joint : joints) {
    for (; edge <= joint.before; ++edge) spans->push_back(std::move(edges[edge]));
    if (joint.vertex) spans->push_back(std::move(*joint.vertex));
  }
}

}  // namespace

NormalCone::NormalCone(Vec2 first, Vec2 last, double angle) : first_(first), last_(last), width_(Width::kNarrow) {
  if (angle > kPi) width_ = angle >= 2 * kPi - kRoundingSlack ? Width::kFull : Width::kWide;
}

bool NormalCone::Contains(Vec2 n, double slack) const {
  if (is_full()) return true;
  // Where the ends are less than 90 degrees apart, either way, the sines alone do not tell a side from its opposite.
  const bool sharp = Dot(first_, last_) > 0;
  const bool near_ends = !sharp || Dot(n, first_ + last_) > 0;
  if (is_narrow()) return near_ends && Cross(first_, n) >= -slack && Cross(n, last_) >= -slack;
  return !(near_ends && Cross(last_, n) > slack && Cross(n, first_) > slack);
}

NormalSpan NormalSpan::OfVertex(Vec2 p, Vec2 first_normal, Vec2 last_normal, Rotation rotation) {
  NormalSpan span(Kind::kVertex, Vertex{p}, {Rotate(rotation, first_normal), Rotate(rotation, last_normal), 0});
  span.begin_ = span.end_ = span.center_ = Rotate(rotation, p);
  return span;
}

NormalSpan NormalSpan::OfJoin(Vec2 p, Vec2 normal, Rotation rotation) {
  const Vec2 n = Rotate(rotation, normal);
  NormalSpan span(Kind::kJoin, Vertex{p}, {n, n, 0});
  span.begin_ = span.end_ = span.center_ = Rotate(rotation, p);
  return span;
}

void NormalSpan::Connect(NormalSpan* before, NormalSpan* vertex, NormalSpan* after, bool flat) {
  if (before->kind_ == Kind::kStraight) vertex->straight_before_ = before->begin_;
  if (after->kind_ == Kind::kStraight) vertex->straight_after_ = after->end_;
  if (!flat) return;
  vertex->is_flat_end_ = true;
  NormalSpan* curve = before->kind_ == Kind::kStraight ? after : before;
  curve->flat_normals_.push_back(vertex->cone_.first());
}

NormalSpan NormalSpan::OfPiece(const OutlineCurve& curve, double s_begin, double s_end, Rotation rotation) {
  const Vec2 a = CurvePoint(curve, s_begin);
  const Vec2 b = CurvePoint(curve, s_end);
  const Vec2 first = Unit(CurveDirection(curve, s_begin));
  const Vec2 last = Unit(CurveDirection(curve, s_end));
  const double turn = Cross(first, last);
  NormalSpan span = std::visit(
      [&](const auto& e) {
        using Curve = std::decay_t<decltype(e)>;
        constexpr bool kIsStraight = Curve::kKind == CurveKind::kStraight;
        if (kIsStraight || (!Curve::kIsAngle && std::abs(turn) < kFlatTurn)) {
          const Vec2 normal = Rotate(rotation, -Perp(Unit(b - a)));
          return NormalSpan(Kind::kStraight, e, {normal, normal, 0});
        }
        constexpr bool kIsArc = Curve::kKind == CurveKind::kArc;
        const double sense = s_begin < s_end ? 1 : -1;
        const bool convex = Curve::kIsAngle ? sense > 0 : turn > 0;
        // Ordered so that the normals turn counter-clockwise from the first to the last.
        Vec2 first_normal = Rotate(rotation, -(sense * Perp(first)));
        Vec2 last_normal = Rotate(rotation, -(sense * Perp(last)));
        if (!convex) std::swap(first_normal, last_normal);
        const double angle = kIsArc ? std::abs(s_end - s_begin) : 0;
        NormalSpan part(kIsArc ? Kind::kArc : Kind::kCurve, e, {first_normal, last_normal, angle});
        part.sign_ = convex ? 1 : -1;
        Curve turned = e;
        if constexpr (requires { e.center; }) part.center_ = turned.center = Rotate(rotation, e.center);
        if constexpr (requires { e.P; }) {
          for (Vec2& p : turned.P) p = Rotate(rotation, p);
        }
        if constexpr (requires { e.radius; }) part.radius_ = e.radius;
        if constexpr (requires { e.phi; }) {
          part.semi_axis_ = std::max(e.a, e.b);
          const Rotation phi = SinCos(e.phi);
          const Vec2 axis = Unit(Rotate(rotation, {phi.cos, phi.sin}));
          part.piece_.turn = {axis.x, axis.y};
        }
        part.turned_ = turned;
        return part;
      },
      curve);
  span.begin_ = Rotate(rotation, a);
  span.end_ = Rotate(rotation, b);
  span.piece_.s_begin = s_begin;
  span.piece_.s_end = s_end;
  return span;
}

double NormalSpan::reach() const { return Norm(center_) + radius_ + Norm(begin_) + Norm(end_) + semi_axis_; }

BoundingBox NormalSpan::Bounds() const {
  BoundingBox box = Union({begin_, begin_}, {end_, end_});
  if (kind_ == Kind::kVertex || kind_ == Kind::kJoin || kind_ == Kind::kStraight) return box;
  for (const Vec2 axis : {Vec2{1, 0}, Vec2{0, 1}, Vec2{-1, 0}, Vec2{0, -1}}) {
    if (!cone_.Contains(axis, kSlack)) continue;
    const Vec2 p = At(axis).arm;
    box = Union(box, {p, p});
  }
  return box;
}

SpanPoint NormalSpan::At(Vec2 n) const {
  if (kind_ != Kind::kArc && kind_ != Kind::kCurve) return {center_, {0, 1}, {}};
  return std::visit([&](const auto& e) { return e.AtNormal(n, piece_); }, turned_);
}

std::optional<double> NormalSpan::Parameter(Vec2 place) const {
  if (kind_ != Kind::kCurve) return std::nullopt;
  return std::visit([&](const auto& e) { return e.kIsAngle ? AngleOf(place) : place.x; }, turned_);
}

std::optional<double> NormalSpan::StraightParameter(double u) const {
  if (!IsSearched(feature_)) return std::nullopt;
  return piece_.s_begin + std::clamp(u, 0.0, 1.0) * (piece_.s_end - piece_.s_begin);
}

bool NormalSpan::IsFlatWhere(Vec2 n) const {
  return std::any_of(flat_normals_.begin(), flat_normals_.end(),
                     [&](Vec2 flat) { return Dot(flat, n) > 0 && std::abs(Cross(flat, n)) <= kSlack; });
}

bool NormalSpan::Holds(Vec2 arm, Vec2 outward) const {
  if (kind_ == Kind::kVertex || kind_ == Kind::kJoin) return cone_.Contains(outward, kSlack);
  // Beyond half a turn the chord does not tell; along less, the foot's projection on the chord is the sharper test.
  if (kind_ == Kind::kArc && std::abs(piece_.s_end - piece_.s_begin) > kPi / 2) return cone_.Contains(outward, kSlack);
  if (kind_ == Kind::kStraight) {
    if (Dot(outward, cone_.first()) <= 0) return false;
  } else if (!cone_.Contains(outward, kSlack)) {
    return false;
  }
  const Vec2 along = end_ - begin_;
  const double square = Dot(along, along);
  const double u = Dot(arm - begin_, along) / square;
  const double slack =
      kSlack + 8 * std::numeric_limits<double>::epsilon() * (Norm(begin_) + Norm(end_)) / std::sqrt(square);
  return u >= -slack && u <= 1 + slack;
}

std::vector<NormalSpan> NormalSpans(const Outline& outline, Rotation rotation) {
  std::vector<NormalSpan> spans;
  for (const OutlineLoop& loop : outline.loops) AppendLoop(loop, rotation, &spans);
  return spans;
}

}  // namespace lcpbench
