#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "model/detection/detection.h"
#include "model/geometry/feature.h"
#include "model/geometry/trig.h"
#include "model/shape/outline.h"
#include "solvers/io/json_lines.h"

namespace lcpbench::testing {

/// The smallest radius or half-width of any body in any scene family [m]: what gaps are compared with.
inline constexpr double kSceneSize = 0.02;

/// A body's outline as a solid in the world, for asking how deep points lie in it. Any edges, convex or not, several
/// loops; open chains bound a half plane locally. It shares nothing with contact detection but the curves' formulas.
class Solid {
 public:
  explicit Solid(const Body& body) : outline_(OutlineOf(body)), x_(body.x), turn_(SinCos(body.theta)) {
    constexpr int kSamples = 120;
    for (const OutlineLoop& loop : outline_.loops) {
      for (const OutlinePiece& piece : loop) {
        for (int k = 0; k <= kSamples; ++k) {
          samples_.push_back(CurvePoint(piece.edge, piece.s_begin + (piece.s_end - piece.s_begin) * k / kSamples));
          reach_ = std::max(reach_, Norm(samples_.back()));
        }
      }
    }
  }

  /// World points along the outline, ends of pieces included.
  std::vector<Vec2> Points() const {
    std::vector<Vec2> points;
    for (const Vec2 p : samples_) points.push_back(x_ + Rotate(turn_, p));
    return points;
  }
  /// Of the outline's points from the centre of mass [m].
  double reach() const { return reach_; }
  bool has_hole() const { return outline_.loops.size() > 1; }

  /// The distance to the outline, positive in the material; of points beyond reach of the body only a bound.
  double Depth(Vec2 world) const {
    const Vec2 p = Rotate({turn_.cos, -turn_.sin}, world - x_);
    // Samples miss bulges by less than this share.
    constexpr double kBulge = 1e-2;
    const bool bounded = Norm(p) > (1 + kBulge) * reach_ && !IsOpen();
    if (bounded) return reach_ - Norm(p);
    Nearest nearest;
    for (const OutlineLoop& loop : outline_.loops) {
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const OutlinePiece& after = loop[(k + 1) % loop.size()];
        Inside(loop[k], p, &nearest);
        Corner(loop[k], after, p, &nearest);
      }
    }
    return nearest.depth;
  }

 private:
  struct Nearest {
    double distance = 1e300;
    double depth = -1e300;
    void Take(double other_distance, double other_depth) {
      if (other_distance >= distance) return;
      distance = other_distance;
      depth = other_depth;
    }
  };

  bool IsOpen() const {
    return std::any_of(outline_.loops.begin(), outline_.loops.end(), [](const OutlineLoop& loop) {
      return Norm(End(loop.back()) - Begin(loop.front())) > 1e-9 * Reach(loop.back());
    });
  }
  static Vec2 Begin(const OutlinePiece& piece) { return CurvePoint(piece.edge, piece.s_begin); }
  static Vec2 End(const OutlinePiece& piece) { return CurvePoint(piece.edge, piece.s_end); }
  /// Unit, in the direction of travel: the material is on the left.
  static Vec2 Travel(const OutlinePiece& piece, double s) {
    const Vec2 along = CurveDirection(piece.edge, s);
    return ((piece.s_end < piece.s_begin ? -1 : 1) / Norm(along)) * along;
  }

  static void Inside(const OutlinePiece& piece, Vec2 p, Nearest* nearest) {
    if (const auto* line = std::get_if<StraightEdge>(&piece.edge)) {
      const Vec2 along = line->b - line->a;
      const double s = Dot(p - line->a, along) / Dot(along, along);
      if (s < piece.s_begin || s > piece.s_end) return;
      const double depth = Cross(along, p - line->a) / Norm(along);
      nearest->Take(std::abs(depth), depth);
      return;
    }
    const double low = std::min(piece.s_begin, piece.s_end);
    const double high = std::max(piece.s_begin, piece.s_end);
    if (const auto* arc = std::get_if<ArcEdge>(&piece.edge)) {
      const Vec2 from_center = p - arc->center;
      const double turn = 2 * std::numbers::pi;
      double s = std::atan2(from_center.y, from_center.x);
      s += turn * std::ceil((low - s) / turn);
      if (s > high) return;
      const double depth = (arc->side == Side::kConvex ? 1 : -1) * (arc->radius - Norm(from_center));
      nearest->Take(std::abs(depth), depth);
      return;
    }
    // Golden sections around the nearest of some samples. The depth is taken along the normal, where an error of s
    // counts by its square.
    constexpr int kSamples = 64;
    constexpr int kSteps = 40;
    constexpr double kGolden = 0.6180339887498949;
    const auto distance = [&](double s) { return Norm(CurvePoint(piece.edge, s) - p); };
    double best = low;
    for (int k = 1; k <= kSamples; ++k) {
      const double s = low + (high - low) * k / kSamples;
      if (distance(s) < distance(best)) best = s;
    }
    double from = std::max(low, best - (high - low) / kSamples);
    double to = std::min(high, best + (high - low) / kSamples);
    for (int k = 0; k < kSteps; ++k) {
      const double s1 = to - kGolden * (to - from);
      const double s2 = from + kGolden * (to - from);
      (distance(s1) < distance(s2) ? to : from) = distance(s1) < distance(s2) ? s2 : s1;
    }
    const double s = (from + to) / 2;
    const double margin = 1e-6 * (high - low);
    const bool at_end = s < low + margin || s > high - margin;
    const double depth = Cross(Travel(piece, s), p - CurvePoint(piece.edge, s));
    nearest->Take(at_end ? distance(s) : std::abs(depth), depth);
  }

  /// The end of a piece: outside around convex corners, inside around re-entrant ones.
  static void Corner(const OutlinePiece& piece, const OutlinePiece& after, Vec2 p, Nearest* nearest) {
    constexpr double kSmooth = 1e-6;
    const Vec2 corner = End(piece);
    const double distance = Norm(p - corner);
    const bool joins = Norm(Begin(after) - corner) <= 1e-9 * Reach(piece);
    const Vec2 travel = Travel(piece, piece.s_end);
    const double turn = joins ? Cross(travel, Travel(after, after.s_begin)) : 0;
    const double across = Cross(travel, p - corner);
    if (turn > kSmooth) {
      nearest->Take(distance, -distance);
    } else if (turn < -kSmooth) {
      nearest->Take(distance, distance);
    } else {
      nearest->Take(distance, joins ? across : -distance);
    }
    if (!joins) {
      const double begin_distance = Norm(p - Begin(after));
      nearest->Take(begin_distance, -begin_distance);
    }
  }

  Outline outline_;
  Vec2 x_;
  Rotation turn_;
  std::vector<Vec2> samples_;
  double reach_ = 0;
};

/// How many contacts every pair of bodies has (first < second).
inline std::map<std::pair<int, int>, int> ContactsOfPairs(const std::vector<Constraint>& constraints) {
  std::map<std::pair<int, int>, int> pairs;
  for (const Constraint& c : constraints) {
    if (c.type == ConstraintType::kContact) ++pairs[std::minmax(c.body1, c.body2)];
  }
  return pairs;
}

/// FNV-1a over the assembled problem's text, whose numbers read back to the same doubles.
inline std::uint64_t HashOf(const ContactSystem& system) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : FormatLcpRecord(AssembleContactLcp(system).problem, true)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  return hash;
}

}  // namespace lcpbench::testing
