#include "model/shape/outline_meeting.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include "model/geometry/trig.h"

namespace lcpbench {
namespace {

Vec2 Unit(Vec2 a) {
  const double length = Norm(a);
  return length > 0 ? Vec2{a.x / length, a.y / length} : a;
}

double DistanceToSegment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double square = Dot(along, along);
  const double t = square > 0 ? std::clamp(Dot(p - a, along) / square, 0.0, 1.0) : 0;
  return Norm(p - a - t * along);
}

BoundingBox BoxOf(Vec2 a, Vec2 b) {
  return {{std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}};
}

// The boxes keep segments apart that follow each other on one line, whose sides are mere rounding.
bool Intersect(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (!Overlap(BoxOf(a, b), BoxOf(c, d))) return false;
  const double c_side = Cross(b - a, c - a);
  const double d_side = Cross(b - a, d - a);
  const double a_side = Cross(d - c, a - c);
  const double b_side = Cross(d - c, b - c);
  return ((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0));
}

double SegmentDistance(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (Intersect(a, b, c, d)) return 0;
  return std::min(
      {DistanceToSegment(a, c, d), DistanceToSegment(b, c, d), DistanceToSegment(c, a, b), DistanceToSegment(d, a, b)});
}

// The height of the triangle of chord and end tangents of an arc over 2 alpha of an ellipse: its apex is apart from the
// chord's middle by the image of (cos s, sin s) sin^2 alpha / cos alpha at the middle parameter.
Vec2 EllipseApexOffset(double a, double b, double phi, double s_begin, double s_end) {
  const Rotation middle = SinCos(s_begin + (s_end - s_begin) / 2);
  const Rotation half = SinCos((s_end - s_begin) / 2);
  const double rise = half.sin * half.sin / half.cos;
  return Rotate(SinCos(phi), {a * rise * middle.cos, b * rise * middle.sin});
}

// Whether v points into the cone of less than 180 degrees between u1 and u2. The last condition matters to cones that
// are thin but for rounding, for which the others hold on the opposite side too.
bool InCone(Vec2 v, Vec2 u1, Vec2 u2) {
  if (Cross(u1, u2) < 0) std::swap(u1, u2);
  return Cross(u1, v) >= 0 && Cross(v, u2) >= 0 && Dot(v, u1 + u2) > 0;
}

bool ConesOverlap(const EnclosedPiece& p, const EnclosedPiece& q) {
  // Seen from the joint p runs backwards.
  const Vec2 p1 = -p.first_direction();
  const Vec2 p2 = -p.second_direction();
  const Vec2 q1 = q.first_direction();
  const Vec2 q2 = q.second_direction();
  return InCone(p1, q1, q2) || InCone(p2, q1, q2) || InCone(q1, p1, p2) || InCone(q2, p1, p2);
}

constexpr double kRightAngle = std::numbers::pi / 2;

// Cut in halves until the control polygon turns by less than 90 degrees. A cubic's derivative is zero only at a cusp.
bool AppendBezier(const OutlineCurve& curve, double s_begin, double s_end, int depth,
                  std::vector<EnclosedPiece>* pieces) {
  const auto P = BezierPiece(std::get<BezierEdge>(curve), s_begin, s_end);
  const Vec2 legs[3] = {P[1] - P[0], P[2] - P[1], P[3] - P[2]};
  const bool regular = Dot(legs[0], legs[1]) > 0 && Dot(legs[1], legs[2]) > 0 && Dot(legs[0], legs[2]) > 0;
  constexpr int kMaxDepth = 24;
  if (regular && depth > 0) {
    pieces->emplace_back(curve, s_begin, s_end);
    return true;
  }
  if (depth == kMaxDepth) return false;
  const double middle = s_begin + (s_end - s_begin) / 2;
  return AppendBezier(curve, s_begin, middle, depth + 1, pieces) &&
         AppendBezier(curve, middle, s_end, depth + 1, pieces);
}

}  // namespace

EnclosedPiece::EnclosedPiece(const OutlineCurve& curve, double s_begin, double s_end)
    : curve_(&curve),
      s_begin_(s_begin),
      s_end_(s_end),
      begin_(CurvePoint(curve, s_begin)),
      end_(CurvePoint(curve, s_end)) {
  if (const auto* bezier = std::get_if<BezierEdge>(&curve)) {
    EncloseBezier(*bezier);
    return;
  }
  const double sense = s_begin < s_end ? 1 : -1;
  direction_[0] = sense * Unit(CurveDirection(curve, s_begin));
  direction_[1] = sense * Unit(CurveDirection(curve, s_end));
  if (const auto* arc = std::get_if<ArcEdge>(&curve)) {
    height_ = Norm(EllipseApexOffset(arc->radius, arc->radius, 0, s_begin, s_end));
  } else if (const auto* ellipse = std::get_if<EllipseEdge>(&curve)) {
    const Vec2 offset = EllipseApexOffset(ellipse->a, ellipse->b, ellipse->phi, s_begin, s_end);
    height_ = DistanceToSegment(begin_ + 0.5 * (end_ - begin_) + offset, begin_, end_);
  } else if (std::holds_alternative<SuperellipseEdge>(curve)) {
    EncloseByTangents();
  }
}

void EnclosedPiece::EncloseByTangents() {
  // A triangle of the chord and tangents that turn by t is at most chord / 2 tan(t / 2) high. That is without rounding
  // errors for small t, where the tangents' intersection would have few digits left.
  constexpr double kParallel = 1e-12;
  const double sine = Cross(direction_[0], direction_[1]);
  const double cosine = Dot(direction_[0], direction_[1]);
  height_ = std::numeric_limits<double>::infinity();
  if (cosine >= 0) height_ = chord() / 2 * std::abs(sine) / (1 + cosine);
  if (std::abs(sine) > kParallel) {
    const double reach = Cross(end_ - begin_, direction_[1]) / sine;
    height_ = std::min(height_, DistanceToSegment(begin_ + reach * direction_[0], begin_, end_));
  }
}

void EnclosedPiece::EncloseBezier(const BezierEdge& edge) {
  const auto P = BezierPiece(edge, s_begin_, s_end_);
  height_ = std::max(DistanceToSegment(P[1], begin_, end_), DistanceToSegment(P[2], begin_, end_));
  // The cone of the control polygon's legs contains every tangent.
  direction_[0] = direction_[1] = Unit(P[1] - P[0]);
  for (const Vec2 leg : {P[2] - P[1], P[3] - P[2]}) {
    const Vec2 u = Unit(leg);
    if (InCone(u, direction_[0], direction_[1])) continue;
    // Widens the cone (ordered counter-clockwise) on the side on which the leg lies.
    if (Cross(direction_[0], u) < 0) {
      direction_[0] = u;
    } else {
      direction_[1] = u;
    }
  }
}

BoundingBox EnclosedPiece::Bounds(double margin) const {
  const double around = height_ + margin;
  const BoundingBox box = BoxOf(begin_, end_);
  return {{box.lower.x - around, box.lower.y - around}, {box.upper.x + around, box.upper.y + around}};
}

bool AppendEnclosed(const OutlinePiece& piece, std::vector<EnclosedPiece>* pieces) {
  if (std::holds_alternative<BezierEdge>(piece.edge)) {
    return AppendBezier(piece.edge, piece.s_begin, piece.s_end, 0, pieces);
  }
  const double range = piece.s_end - piece.s_begin;
  int parts = 2;
  if (!std::holds_alternative<StraightEdge>(piece.edge)) {
    constexpr double kRoundingSlack = 1 - 1e-12;  // a full turn makes four parts, not five
    parts = std::max(parts, static_cast<int>(std::ceil(std::abs(range) / kRightAngle * kRoundingSlack)));
  }
  for (int k = 0; k < parts; ++k) {
    const double s0 = piece.s_begin + range * k / parts;
    const double s1 = k + 1 == parts ? piece.s_end : piece.s_begin + range * (k + 1) / parts;
    pieces->emplace_back(piece.edge, s0, s1);
  }
  return true;
}

Meeting FindMeeting(const EnclosedPiece& first, const EnclosedPiece& second, double tolerance, int* budget) {
  std::vector<std::pair<EnclosedPiece, EnclosedPiece>> open = {{first, second}};
  while (!open.empty()) {
    if (--*budget < 0) return Meeting::kUndecided;
    const auto [p, q] = open.back();
    open.pop_back();
    const double heights = p.height() + q.height();
    if (SegmentDistance(p.begin(), p.end(), q.begin(), q.end()) > heights + tolerance) continue;
    const bool split_p = p.height() >= q.height();
    if (heights <= tolerance || !(split_p ? p : q).can_split()) return Meeting::kMeet;
    if (split_p) {
      open.emplace_back(p.FirstHalf(), q);
      open.emplace_back(p.SecondHalf(), q);
    } else {
      open.emplace_back(p, q.FirstHalf());
      open.emplace_back(p, q.SecondHalf());
    }
  }
  return Meeting::kApart;
}

Meeting FindMeetingBeyondJoint(const EnclosedPiece& first, const EnclosedPiece& second, double tolerance, double joint,
                               int* budget) {
  EnclosedPiece p = first;
  EnclosedPiece q = second;
  while (ConesOverlap(p, q)) {
    if (--*budget < 0) return Meeting::kUndecided;
    const bool split_p = p.chord() >= q.chord();
    if ((split_p ? p : q).chord() <= joint || !(split_p ? p : q).can_split()) return Meeting::kMeet;
    // The half away from the joint against all of the other; the other half goes on.
    const EnclosedPiece away = split_p ? p.FirstHalf() : q.SecondHalf();
    const Meeting meeting = FindMeeting(away, split_p ? q : p, tolerance, budget);
    if (meeting != Meeting::kApart) return meeting;
    if (split_p) {
      p = p.SecondHalf();
    } else {
      q = q.FirstHalf();
    }
  }
  return Meeting::kApart;
}

int WindingNumber(const std::vector<EnclosedPiece>& loop, Vec2 point, double tolerance) {
  std::vector<EnclosedPiece> open = loop;
  double angle = 0;
  while (!open.empty()) {
    const EnclosedPiece piece = open.back();
    open.pop_back();
    // While the point is clear of the enclosure, the piece can be pulled taut onto its chord without passing over it.
    const bool clear = DistanceToSegment(point, piece.begin(), piece.end()) > piece.height();
    if (!clear && piece.height() > tolerance && piece.can_split()) {
      open.push_back(piece.FirstHalf());
      open.push_back(piece.SecondHalf());
      continue;
    }
    const Vec2 from = piece.begin() - point;
    const Vec2 to = piece.end() - point;
    // Only the nearest whole number of turns counts, so that the library's atan2 is exact enough.
    angle += std::atan2(Cross(from, to), Dot(from, to));
  }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

}  // namespace lcpbench
