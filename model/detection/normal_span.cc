#include "model/detection/normal_span.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "model/geometry/angle.h"
#include "model/geometry/smooth_curve.h"

namespace lcpbench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRoundingSlack = 1e-12;  // [rad], far above the rounding of unit vectors

Vec2 Unit(Vec2 a) {
  const double length = Norm(a);
  return {a.x / length, a.y / length};
}

Vec2 OutwardNormal(const OutlineCurve& curve, double s, double sense) {
  return -(sense * Perp(Unit(CurveDirection(curve, s))));
}

// Ordered so that the normals turn counter-clockwise from the first to the last.
NormalCone ConeOf(const OutlineCurve& curve, double s_begin, double s_end, bool convex, double angle,
                  Rotation rotation) {
  const double sense = s_begin < s_end ? 1 : -1;
  Vec2 first = Rotate(rotation, OutwardNormal(curve, s_begin, sense));
  Vec2 last = Rotate(rotation, OutwardNormal(curve, s_end, sense));
  if (!convex) std::swap(first, last);
  return {first, last, angle};
}

Feature ToFeature(const OutlineCurve& curve) {
  return std::visit([](const auto& edge) -> Feature { return edge; }, curve);
}

double AngleBetween(Vec2 a, Vec2 b) { return std::atan2(std::abs(Cross(a, b)), Dot(a, b)); }

void AppendOval(const OutlinePiece& piece, Rotation rotation, std::vector<NormalSpan>* spans) {
  // Between its axes an oval's curvature rises or falls in one way, but for the superellipse's blunt corners.
  constexpr double kQuarter = kPi / 2;
  constexpr double kShortest = 1e-9;  // [rad]: no span of its own for what rounding leaves beyond an axis
  const double low = std::min(piece.s_begin, piece.s_end);
  const double high = std::max(piece.s_begin, piece.s_end);
  std::vector<double> cuts = {low};
  for (double k = std::ceil(low / kQuarter); k * kQuarter < high; ++k) {
    const double cut = k * kQuarter;
    if (cut > low + kShortest && cut < high - kShortest) cuts.push_back(cut);
  }
  cuts.push_back(high);
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (piece.s_begin < piece.s_end) {
      spans->push_back(NormalSpan::OfOval(piece.edge, cuts[k], cuts[k + 1], rotation));
    } else {
      spans->push_back(NormalSpan::OfOval(piece.edge, cuts[cuts.size() - 1 - k], cuts[cuts.size() - 2 - k], rotation));
    }
  }
}

void AppendBezierPart(const BezierEdge& edge, double s0, double s1, int depth, Rotation rotation,
                      std::vector<NormalSpan>* spans) {
  constexpr int kMaxDepth = 24;
  const auto P = BezierPiece(edge, s0, s1);
  const Vec2 legs[3] = {P[1] - P[0], P[2] - P[1], P[3] - P[2]};
  const bool turns_little = Dot(legs[0], legs[1]) > 0 && Dot(legs[1], legs[2]) > 0 && Dot(legs[0], legs[2]) > 0;
  if (!turns_little && depth < kMaxDepth) {
    const double middle = s0 + (s1 - s0) / 2;
    AppendBezierPart(edge, s0, middle, depth + 1, rotation, spans);
    AppendBezierPart(edge, middle, s1, depth + 1, rotation, spans);
    return;
  }
  const Vec2 t0 = Unit(CurveDirection(OutlineCurve(edge), s0));
  const Vec2 t1 = Unit(CurveDirection(OutlineCurve(edge), s1));
  const double turn = Cross(t0, t1);
  if (std::abs(turn) < NormalSpan::kFlatTurn) {
    spans->push_back(NormalSpan::OfStraight(OutlineCurve(edge), s0, s1, rotation));
  } else {
    spans->push_back(NormalSpan::OfBezier(edge, s0, s1, turn > 0, rotation));
  }
}

void AppendBezier(const OutlinePiece& piece, Rotation rotation, std::vector<NormalSpan>* spans) {
  // A part no longer than this [of s] would have control points that coincide but for rounding: what rounding makes of
  // the inflection at an end of vanishing curvature.
  constexpr double kShortest = 1e-9;
  const auto& edge = std::get<BezierEdge>(piece.edge);
  std::vector<double> cuts = {piece.s_begin};
  const Feature feature = edge;
  const SmoothCurve curve(PlacedFeature{feature, Vec2{}, Rotation{}});
  for (const double s : curve.ends()) {
    if (s > cuts.back() + kShortest && s < piece.s_end - kShortest) cuts.push_back(s);
  }
  cuts.push_back(piece.s_end);
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    AppendBezierPart(edge, cuts[k], cuts[k + 1], 0, rotation, spans);
  }
}

void AppendPiece(const OutlinePiece& piece, Rotation rotation, std::vector<NormalSpan>* spans) {
  if (std::holds_alternative<StraightEdge>(piece.edge)) {
    spans->push_back(NormalSpan::OfStraight(piece.edge, piece.s_begin, piece.s_end, rotation));
  } else if (const auto* arc = std::get_if<ArcEdge>(&piece.edge)) {
    spans->push_back(NormalSpan::OfArc(*arc, piece.s_begin, piece.s_end, rotation));
  } else if (std::holds_alternative<BezierEdge>(piece.edge)) {
    AppendBezier(piece, rotation, spans);
  } else {
    AppendOval(piece, rotation, spans);
  }
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

NormalSpan::NormalSpan(Kind kind, const Feature& feature, NormalCone cone)
    : kind_(kind), feature_(feature), cone_(cone) {}

NormalSpan NormalSpan::OfVertex(Vec2 p, Vec2 first_normal, Vec2 last_normal, Rotation rotation) {
  const Vec2 first = Rotate(rotation, first_normal);
  const Vec2 last = Rotate(rotation, last_normal);
  NormalSpan span(Kind::kVertex, Vertex{p}, {first, last, AngleBetween(first, last)});
  span.angle_ = AngleBetween(first, last);
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

NormalSpan NormalSpan::OfStraight(const OutlineCurve& curve, double s_begin, double s_end, Rotation rotation) {
  const Vec2 a = CurvePoint(curve, s_begin);
  const Vec2 b = CurvePoint(curve, s_end);
  const Vec2 normal = Rotate(rotation, -Perp(Unit(b - a)));
  NormalSpan span(Kind::kStraight, ToFeature(curve), {normal, normal, 0});
  span.begin_ = Rotate(rotation, a);
  span.end_ = Rotate(rotation, b);
  span.s_begin_ = s_begin;
  span.s_end_ = s_end;
  return span;
}

NormalSpan NormalSpan::OfArc(const ArcEdge& arc, double s_begin, double s_end, Rotation rotation) {
  const bool convex = arc.side == Side::kConvex;
  const double angle = std::abs(s_end - s_begin);
  NormalSpan span(Kind::kArc, arc, ConeOf(arc, s_begin, s_end, convex, angle, rotation));
  span.sign_ = convex ? 1 : -1;
  span.angle_ = angle;
  span.begin_ = Rotate(rotation, CurvePoint(arc, s_begin));
  span.end_ = Rotate(rotation, CurvePoint(arc, s_end));
  span.center_ = Rotate(rotation, arc.center);
  span.radius_ = arc.radius;
  return span;
}

NormalSpan NormalSpan::OfOval(const OutlineCurve& oval, double s_begin, double s_end, Rotation rotation) {
  const bool convex = s_begin < s_end;
  const NormalCone cone = ConeOf(oval, s_begin, s_end, convex, 0, rotation);
  NormalSpan span(Kind::kOval, ToFeature(oval), cone);
  span.sign_ = convex ? 1 : -1;
  span.angle_ = AngleBetween(cone.first(), cone.last());
  span.begin_ = Rotate(rotation, CurvePoint(oval, s_begin));
  span.end_ = Rotate(rotation, CurvePoint(oval, s_end));
  const auto take = [&](const auto& e, int m) {
    span.center_ = Rotate(rotation, e.center);
    span.a_ = e.a;
    span.b_ = e.b;
    span.m_ = m;
    const Rotation phi = SinCos(e.phi);
    const Vec2 axis = Unit(Rotate(rotation, {phi.cos, phi.sin}));
    span.turn_ = {axis.x, axis.y};
  };
  if (const auto* ellipse = std::get_if<EllipseEdge>(&oval)) take(*ellipse, 2);
  if (const auto* superellipse = std::get_if<SuperellipseEdge>(&oval)) take(*superellipse, superellipse->m);
  return span;
}

NormalSpan NormalSpan::OfBezier(const BezierEdge& edge, double s_begin, double s_end, bool convex, Rotation rotation) {
  const NormalCone cone = ConeOf(edge, s_begin, s_end, convex, 0, rotation);
  NormalSpan span(Kind::kBezier, edge, cone);
  span.sign_ = convex ? 1 : -1;
  span.angle_ = AngleBetween(cone.first(), cone.last());
  span.begin_ = Rotate(rotation, CurvePoint(edge, s_begin));
  span.end_ = Rotate(rotation, CurvePoint(edge, s_end));
  for (std::size_t k = 0; k < edge.P.size(); ++k) span.P_[k] = Rotate(rotation, edge.P[k]);
  span.s_begin_ = s_begin;
  span.s_end_ = s_end;
  return span;
}

double NormalSpan::reach() const {
  double reach = Norm(center_) + radius_ + Norm(begin_) + Norm(end_);
  if (kind_ == Kind::kOval) reach += std::max(a_, b_);
  return reach;
}

BoundingBox NormalSpan::Bounds() const {
  BoundingBox box = {{std::min(begin_.x, end_.x), std::min(begin_.y, end_.y)},
                     {std::max(begin_.x, end_.x), std::max(begin_.y, end_.y)}};
  if (kind_ == Kind::kVertex || kind_ == Kind::kJoin || kind_ == Kind::kStraight) return box;
  for (const Vec2 axis : {Vec2{1, 0}, Vec2{0, 1}, Vec2{-1, 0}, Vec2{0, -1}}) {
    if (!cone_.Contains(axis, kSlack)) continue;
    const Vec2 p = At(axis).arm;
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y)};
  }
  return box;
}

SpanPoint NormalSpan::At(Vec2 n) const {
  switch (kind_) {
    case Kind::kArc:
      return {center_ + (sign_ * radius_) * n, {1, sign_ / radius_}, {}};
    case Kind::kOval: {
      const Vec2 local = Rotate({turn_.cos, -turn_.sin}, sign_ * n);
      return m_ == 2 ? EllipseAt(local) : SuperellipseAt(local);
    }
    case Kind::kBezier:
      return BezierAt(n);
    case Kind::kVertex:
    case Kind::kJoin:
    case Kind::kStraight:
      break;
  }
  return {center_, {0, 1}, {}};
}

SpanPoint NormalSpan::EllipseAt(Vec2 local) const {
  // The normal at (a cos s, b sin s) is parallel to (cos s / a, sin s / b).
  const Vec2 u = Unit({a_ * local.x, b_ * local.y});
  const Vec2 p = {a_ * u.x, b_ * u.y};
  const double speed = Norm({a_ * u.y, b_ * u.x});
  const double kappa = sign_ * ((a_ / speed) * (b_ / speed)) / speed;
  const bool polar = std::holds_alternative<SuperellipseEdge>(feature_);
  return {center_ + Rotate(turn_, p), {1, kappa}, polar ? p : u};
}

SpanPoint NormalSpan::SuperellipseAt(Vec2 local) const {
  // X^(m-1) : Y^(m-1) = a |n_x| : b |n_y|; a start for the search, so that the library's pow will do.
  const double x_power = a_ * std::abs(local.x);
  const double y_power = b_ * std::abs(local.y);
  const bool x_leads = x_power >= y_power;
  const double q = std::pow(x_leads ? y_power / x_power : x_power / y_power, 1.0 / (m_ - 1));
  const double large = 1 / RootOfOnePlusPower(q, m_);
  const double small = q * large;
  const double X = x_leads ? large : small;
  const double Y = x_leads ? small : large;
  const Vec2 p = {std::copysign(a_ * X, local.x), std::copysign(b_ * Y, local.y)};
  const double X_power = IntegerPower(X, m_ - 2);
  const double Y_power = IntegerPower(Y, m_ - 2);
  const double gradient = Norm({X * X_power / a_, Y * Y_power / b_});
  const double kappa =
      sign_ * (m_ - 1) * (X_power / (a_ * gradient)) * (Y_power / (b_ * gradient)) / (a_ * b_ * gradient);
  return {center_ + Rotate(turn_, p), {1, kappa}, p};
}

SpanPoint NormalSpan::BezierAt(Vec2 n) const {
  // c'.n = 0 is quadratic in s; of its roots the one on the span, or nearest to it.
  const double k0 = Dot(P_[1] - P_[0], n);
  const double k1 = Dot(P_[2] - P_[1], n);
  const double k2 = Dot(P_[3] - P_[2], n);
  const double a = k0 - 2 * k1 + k2;
  const double half_b = k1 - k0;
  const double discriminant = half_b * half_b - a * k0;
  const double q = -(half_b + std::copysign(std::sqrt(std::max(discriminant, 0.0)), half_b));
  double s = s_begin_;
  double least = std::numeric_limits<double>::infinity();
  for (const double root : {q / a, k0 / q}) {
    if (!std::isfinite(root)) continue;
    const double held = std::clamp(root, s_begin_, s_end_);
    if (std::abs(root - held) < least) {
      least = std::abs(root - held);
      s = held;
    }
  }
  const double t = 1 - s;
  const Vec2 c = (t * t * t) * P_[0] + (3 * t * t * s) * P_[1] + (3 * t * s * s) * P_[2] + (s * s * s) * P_[3];
  const Vec2 e0 = P_[1] - P_[0];
  const Vec2 e1 = P_[2] - P_[1];
  const Vec2 e2 = P_[3] - P_[2];
  const Vec2 d1 = 3 * ((t * t) * e0 + (2 * t * s) * e1 + (s * s) * e2);
  const Vec2 d2 = 6 * (t * (e1 - e0) + s * (e2 - e1));
  const double speed = Norm(d1);
  return {c, {1, Cross(d1, d2) / (speed * speed * speed)}, {s, 0}};
}

std::optional<double> NormalSpan::Parameter(Vec2 place) const {
  if (kind_ == Kind::kBezier) return place.x;
  if (kind_ == Kind::kOval) return AngleOf(place);
  return std::nullopt;
}

std::optional<double> NormalSpan::StraightParameter(double u) const {
  if (std::holds_alternative<StraightEdge>(feature_)) return std::nullopt;
  return s_begin_ + std::clamp(u, 0.0, 1.0) * (s_end_ - s_begin_);
}

bool NormalSpan::IsFlatWhere(Vec2 n) const {
  return std::any_of(flat_normals_.begin(), flat_normals_.end(),
                     [&](Vec2 flat) { return Dot(flat, n) > 0 && std::abs(Cross(flat, n)) <= kSlack; });
}

bool NormalSpan::Holds(Vec2 arm, Vec2 outward) const {
  if (kind_ == Kind::kVertex || kind_ == Kind::kJoin) return cone_.Contains(outward, kSlack);
  // Beyond half a turn the chord does not tell; along less, the foot's projection on the chord is the sharper test.
  if (kind_ == Kind::kArc && angle_ > kPi / 2) return cone_.Contains(outward, kSlack);
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
