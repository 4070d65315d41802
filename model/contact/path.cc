#include "model/contact/path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "model/contact/contact_row.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

// The side of a path joint that has the edge.
struct EdgeSide {
  int body;
  Feature& feature;
  std::optional<double>& s;
};

EdgeSide EdgeSideOf(Constraint* joint) {
  if (IsVertex(joint->feature1)) return {joint->body2, joint->feature2, joint->s2};
  return {joint->body1, joint->feature1, joint->s1};
}

// Puts the joint on a piece of its path, with a start value that is held to the piece.
void PutOnPiece(std::size_t piece, std::optional<double> s, Constraint* joint) {
  const OutlineEdge& edge = joint->path[piece];
  joint->piece = piece;
  const EdgeSide side = EdgeSideOf(joint);
  side.feature = ToFeature(edge.edge);
  const auto [least, greatest] = std::minmax(edge.s_begin, edge.s_end);
  side.s = s ? std::clamp(*s, least, greatest) : s;
}

Vec2 BeginOf(const OutlineEdge& piece) { return CurvePoint(piece.edge, piece.s_begin); }
Vec2 EndOf(const OutlineEdge& piece) { return CurvePoint(piece.edge, piece.s_end); }

// The direction of travel.
Vec2 DirectionAt(const OutlineEdge& piece, double s) {
  return (piece.s_begin < piece.s_end ? 1.0 : -1.0) * Unit(CurveDirection(piece.edge, s));
}

bool Joins(const OutlineEdge& before, const OutlineEdge& after) {
  constexpr double kJoined = 1e-9;  // of the lengths that the ends are computed from, as outlines may be open
  return Norm(BeginOf(after) - EndOf(before)) <= kJoined * std::max(Reach(before), Reach(after));
}

// The angle that a path turns by between two pieces, 0 to pi [rad].
double KinkBetween(const OutlineEdge& before, const OutlineEdge& after) {
  const Vec2 from = DirectionAt(before, before.s_end);
  const Vec2 to = DirectionAt(after, after.s_begin);
  return std::abs(AngleOf({Dot(from, to), Cross(from, to)}));
}

// Goes on to the piece after or before this one.  @throws PathEnd
void PassOn(std::span<const Body> bodies, bool forward, Constraint* joint) {
  const std::vector<OutlineEdge>& path = joint->path;
  const OutlineEdge& piece = path[joint->piece];
  const std::size_t last = path.size() - 1;
  const bool is_last = joint->piece == (forward ? last : 0);
  const auto fail = [&](const std::string& what) {
    const EdgeSide edge = EdgeSideOf(joint);
    const int point_body = edge.body == joint->body1 ? joint->body2 : joint->body1;
    const auto name = [&](int body) { return BodyText(bodies, static_cast<std::size_t>(body)); };
    const Vec2 place = WorldPoint(bodies[static_cast<std::size_t>(edge.body)], forward ? EndOf(piece) : BeginOf(piece));
    throw PathEnd("the point of " + name(point_body) + " comes to " + what + " of its path on " + name(edge.body) +
                  ", at (" + NumberText(place.x) + ", " + NumberText(place.y) + ") m");
  };
  if (is_last && !IsClosed(path)) fail("the end");
  const std::size_t neighbour = forward ? joint->piece + 1 : joint->piece - 1;
  const std::size_t next = is_last ? last - joint->piece : neighbour;
  const double kink = forward ? KinkBetween(piece, path[next]) : KinkBetween(path[next], piece);
  if (!(kink <= kSmoothJoin)) fail("a kink of " + NumberText(kink) + " rad");
  PutOnPiece(next, forward ? path[next].s_begin : path[next].s_end, joint);
}

}  // namespace

PlaceOnPiece FindPlaceOnPiece(const Constraint& joint, std::span<const Body> bodies) {
  const OutlineEdge& piece = joint.path[joint.piece];
  const ClosestPoints closest = FindClosestPoints(joint, bodies, Regularity::kNonzeroD);
  const bool on_1 = !IsVertex(joint.feature1);
  const Body& body = bodies[static_cast<std::size_t>(on_1 ? joint.body1 : joint.body2)];
  const Vec2 foot = RotateBack(SinCos(body.theta), on_1 ? closest.R1 : closest.R2);
  const double near = (on_1 ? joint.s1 : joint.s2).value_or((piece.s_begin + piece.s_end) / 2);
  const double s = std::visit(
      [&](const auto& curve) {
        if constexpr (requires { curve.AngleAt(foot); }) {
          constexpr double kFullTurn = 2 * std::numbers::pi;
          const double angle = curve.AngleAt(foot);
          return angle + kFullTurn * std::round((near - angle) / kFullTurn);
        } else {
          return (on_1 ? closest.s1 : closest.s2).value();
        }
      },
      piece.edge);
  return {s, (s - piece.s_begin) / (piece.s_end - piece.s_begin), closest.d};
}

double LeftOnPiece(const PlaceOnPiece& place) { return 0.5 + kPathSlack - std::abs(place.along - 0.5); }

void PutOnPath(std::span<const Body> bodies, Constraint* joint) {
  const bool on_1 = !IsVertex(joint->feature1);
  const Body& carrier = bodies[static_cast<std::size_t>(on_1 ? joint->body1 : joint->body2)];
  const Body& other = bodies[static_cast<std::size_t>(on_1 ? joint->body2 : joint->body1)];
  const Vec2 point = WorldPoint(other, std::get<Vertex>(on_1 ? joint->feature2 : joint->feature1).p);
  const std::optional<double> start = EdgeSideOf(joint).s;
  double least = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  double s_there = joint->path[0].s_begin;
  for (std::size_t k = 0; k < joint->path.size(); ++k) {
    const OutlineEdge& piece = joint->path[k];
    PutOnPiece(k, start, joint);
    // Beyond its ends, a piece is as far as the nearer of them.
    const double from_begin = Norm(point - WorldPoint(carrier, BeginOf(piece)));
    const double from_end = Norm(point - WorldPoint(carrier, EndOf(piece)));
    double distance = std::min(from_begin, from_end);
    double s = from_begin <= from_end ? piece.s_begin : piece.s_end;
    try {
      const PlaceOnPiece place = FindPlaceOnPiece(*joint, bodies);
      if (LeftOnPiece(place) > 0) {
        distance = std::abs(place.gap - joint->nominal_gap);
        s = place.s;
      }
    } catch (const InputError&) {
      // No closest point, or not one only.
    }
    if (!(distance < least)) continue;
    least = distance;
    nearest = k;
    s_there = s;
  }
  PutOnPiece(nearest, {}, joint);
  EdgeSideOf(joint).s = start.value_or(s_there);
}

void FollowPath(std::span<const Body> bodies, Constraint* joint) {
  PutOnPiece(joint->piece, EdgeSideOf(joint).s, joint);
  std::optional<bool> forward;
  // No further than once around.
  for (std::size_t passed = 0; passed <= joint->path.size(); ++passed) {
    const PlaceOnPiece place = FindPlaceOnPiece(*joint, bodies);
    const bool beyond_end = place.along > 0.5;
    // Where the point is off its path by rounding, pieces may disagree about which of them it is on.
    if (LeftOnPiece(place) > 0 || (forward && *forward != beyond_end)) {
      EdgeSideOf(joint).s = place.s;
      return;
    }
    forward = beyond_end;
    PassOn(bodies, beyond_end, joint);
  }
}

bool IsClosed(const std::vector<OutlineEdge>& path) { return Joins(path.back(), path.front()); }

std::string WhyInvalidPath(const Constraint& constraint) {
  const std::vector<OutlineEdge>& path = constraint.path;
  if (path.empty()) return "";
  if (constraint.type != ConstraintType::kPathJoint) return "only a path joint has a path";
  if (constraint.piece >= path.size()) return "the piece of its path does not exist";
  if (IsVertex(constraint.feature1) == IsVertex(constraint.feature2))
    return "a path joint needs one vertex and one edge";
  for (std::size_t k = 0; k < path.size(); ++k) {
    const std::string name = "edge " + std::to_string(k) + " of its path";
    if (const std::string why = WhyInvalid(path[k]); !why.empty()) return name + ": " + why;
    if (k > 0 && !Joins(path[k - 1], path[k])) return name + " does not begin where the one before ends";
  }
  const Feature& edge = IsVertex(constraint.feature1) ? constraint.feature2 : constraint.feature1;
  if (!(edge == ToFeature(path[constraint.piece].edge))) return "its edge is not the piece of its path that it is on";
  return "";
}

}  // namespace lcpbench
