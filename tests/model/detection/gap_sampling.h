#pragma once

#include "model/shape/outline.h"
#include "tests/model/shape/random_outlines.h"

namespace lcpbench::testing {

// Local minima of the distance between two outlines that do not overlap, by brute force: dense samples of both, every
// pair of samples that is nearer than its eight neighbours, and from each a monotone descent of the distance along both
// outlines, over joins. It shares nothing with the narrow phase but the curves' formulas.

struct Pose {
  Vec2 x;
  double theta = 0;
};

struct SampledMinimum {
  Vec2 p1;
  Vec2 p2;
  double d = 0;
  bool at_vertex1 = false;
  bool at_vertex2 = false;
  bool through_material = false;  ///< a minimum of the distance, but from the inner side of an edge
};

/// A place on a loop: a piece and its parameter.
struct LoopPlace {
  std::size_t piece = 0;
  double s = 0;
};

class SampledLoop {
 public:
  SampledLoop(const OutlineLoop& loop, const Pose& pose, int samples_per_piece)
      : loop_(&loop), pose_(pose), rotation_(SinCos(pose.theta)) {
    for (const OutlinePiece& piece : loop) {
      features_.push_back(std::visit([](const auto& edge) -> Feature { return edge; }, piece.edge));
    }
    for (std::size_t k = 0; k < loop.size(); ++k) {
      for (int i = 0; i < samples_per_piece; ++i) {
        const double s = loop[k].s_begin + (loop[k].s_end - loop[k].s_begin) * i / samples_per_piece;
        places_.push_back({k, s});
        points_.push_back(World(CurvePoint(loop[k].edge, s)));
      }
    }
  }

  std::size_t size() const { return points_.size(); }
  const std::vector<Vec2>& points() const { return points_; }
  const LoopPlace& place(std::size_t i) const { return places_[i]; }
  double low(std::size_t piece) const { return std::min((*loop_)[piece].s_begin, (*loop_)[piece].s_end); }
  double high(std::size_t piece) const { return std::max((*loop_)[piece].s_begin, (*loop_)[piece].s_end); }

  void Move(Vec2 shift) {
    pose_.x = pose_.x + shift;
    for (Vec2& p : points_) p = p + shift;
  }
  const Pose& pose() const { return pose_; }

  struct Jet {
    Vec2 c;
    Vec2 d1;
    Vec2 d2;
  };
  Jet At(const LoopPlace& place) const {
    const EdgePoint e = EvaluateEdge(features_[place.piece], place.s);
    return {World(e.c), Rotate(rotation_, e.d1), Rotate(rotation_, e.d2)};
  }

  /// The place nearest to a point on the outline, by golden section around every sample that may be next to it: beside
  /// a sharp corner the nearest sample may be one of the wrong edge.
  LoopPlace Nearest(Vec2 p) const {
    double least = Norm(points_[0] - p);
    double spacing = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      least = std::min(least, Norm(points_[i] - p));
      spacing = std::max(spacing, Norm(points_[(i + 1) % size()] - points_[i]));
    }
    std::optional<LoopPlace> nearest;
    for (std::size_t i = 0; i < size(); ++i) {
      if (Norm(points_[i] - p) > least + spacing) continue;
      const LoopPlace& from = places_[i];
      const double low = this->low(from.piece);
      const double high = this->high(from.piece);
      const double per_sample = (high - low) * static_cast<double>(loop_->size()) / static_cast<double>(size());
      const LoopPlace found =
          NearestBetween(p, from.piece, std::max(low, from.s - per_sample), std::min(high, from.s + per_sample));
      if (!nearest || Norm(At(found).c - p) < Norm(At(*nearest).c - p)) nearest = found;
    }
    return *nearest;
  }

  Vec2 OutwardNormal(const LoopPlace& place) const {
    return Rotate(rotation_, EvaluateEdge(features_[place.piece], place.s).N);
  }

  /// The same point on the neighbouring piece, if the place is at an end of its own.
  std::optional<LoopPlace> Neighbour(const LoopPlace& place) const {
    const OutlinePiece& piece = (*loop_)[place.piece];
    const std::size_t n = loop_->size();
    if (place.s == piece.s_end) {
      const std::size_t next = (place.piece + 1) % n;
      return LoopPlace{next, (*loop_)[next].s_begin};
    }
    if (place.s == piece.s_begin) {
      const std::size_t before = (place.piece + n - 1) % n;
      return LoopPlace{before, (*loop_)[before].s_end};
    }
    return std::nullopt;
  }

 private:
  LoopPlace NearestBetween(Vec2 p, std::size_t piece, double from, double to) const {
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSteps = 60;
    for (int i = 0; i < kSteps; ++i) {
      const double s1 = to - kGolden * (to - from);
      const double s2 = from + kGolden * (to - from);
      if (Norm(At({piece, s1}).c - p) < Norm(At({piece, s2}).c - p)) {
        to = s2;
      } else {
        from = s1;
      }
    }
    return {piece, from + (to - from) / 2};
  }

  Vec2 World(Vec2 c) const { return pose_.x + Rotate(rotation_, c); }

  const OutlineLoop* loop_;
  Pose pose_;
  Rotation rotation_;
  std::vector<Feature> features_;
  std::vector<LoopPlace> places_;
  std::vector<Vec2> points_;
};

/// Descends |p1 - p2|^2 / 2 from a pair of places by Newton's method, projected onto the pieces and safeguarded.
class Descent {
 public:
  Descent(const SampledLoop& loop1, const SampledLoop& loop2) : loops_{&loop1, &loop2} {}

  std::optional<SampledMinimum> Run(LoopPlace place1, LoopPlace place2) {
    at_ = {place1, place2};
    constexpr int kMostSteps = 400;
    for (int i = 0; i < kMostSteps; ++i) {
      std::array<bool, 2> pinned = {false, false};
      for (std::size_t k = 0; k < 2; ++k) pinned[k] = !Hop(k);
      if (!Step(pinned)) {
        // Outlines that cross have no normal between them to be stationary along.
        constexpr double kStationary = 1e-7;
        constexpr double kCrossing = 1e-12;
        const bool crosses = Value(at_) < kCrossing * kCrossing;
        for (std::size_t k = 0; k < 2; ++k) {
          if (!crosses && !pinned[k] && std::abs(Slope(at_, k)) > kStationary) return std::nullopt;
        }
        SampledMinimum found;
        found.p1 = loops_[0]->At(at_[0]).c;
        found.p2 = loops_[1]->At(at_[1]).c;
        found.d = Norm(found.p1 - found.p2);
        found.at_vertex1 = pinned[0];
        found.at_vertex2 = pinned[1];
        const Vec2 to_1 = found.p1 - found.p2;
        found.through_material = Dot(Outward(0, pinned[0]), to_1) > 0 || Dot(Outward(1, pinned[1]), to_1) < 0;
        return found;
      }
    }
    return std::nullopt;
  }

 private:
  using Places = std::array<LoopPlace, 2>;

  double Value(const Places& at) const {
    const Vec2 v = loops_[0]->At(at[0]).c - loops_[1]->At(at[1]).c;
    return Dot(v, v) / 2;
  }
  // The derivative of the squared distance by s, relative to the distance and the speed: a cosine.
  double Slope(const Places& at, std::size_t k) const {
    const Vec2 v = loops_[0]->At(at[0]).c - loops_[1]->At(at[1]).c;
    const Vec2 d1 = loops_[k]->At(at[k]).d1;
    return (k == 0 ? 1 : -1) * Dot(v, d1) / (Norm(v) * Norm(d1));
  }
  bool LeadsOut(const Places& at, std::size_t k) const {
    constexpr double kFlat = 1e-13;
    const double slope = Slope(at, k);
    const bool at_low = at[k].s <= loops_[k]->low(at[k].piece);
    const bool at_high = at[k].s >= loops_[k]->high(at[k].piece);
    return (at_low && slope > -kFlat) || (at_high && slope < kFlat);
  }
  // At a vertex, the sum of both edges' outward normals.
  Vec2 Outward(std::size_t k, bool at_vertex) const {
    const Vec2 own = loops_[k]->OutwardNormal(at_[k]);
    const std::optional<LoopPlace> neighbour = at_vertex ? loops_[k]->Neighbour(at_[k]) : std::nullopt;
    return neighbour ? own + loops_[k]->OutwardNormal(*neighbour) : own;
  }

  // Moves on to the next piece where the distance falls that way. False: the place is at a join and stays there.
  bool Hop(std::size_t k) {
    if (!LeadsOut(at_, k)) return true;
    const std::optional<LoopPlace> neighbour = loops_[k]->Neighbour(at_[k]);
    Places there = at_;
    there[k] = *neighbour;
    if (LeadsOut(there, k)) return false;
    at_ = there;
    return true;
  }

  bool Step(const std::array<bool, 2>& pinned) {
    const auto j1 = loops_[0]->At(at_[0]);
    const auto j2 = loops_[1]->At(at_[1]);
    const Vec2 v = j1.c - j2.c;
    const double f1 = pinned[0] ? 0 : Dot(v, j1.d1);
    const double f2 = pinned[1] ? 0 : -Dot(v, j2.d1);
    const double m1 = Dot(j1.d1, j1.d1);
    const double m2 = Dot(j2.d1, j2.d1);
    const double h11 = m1 + Dot(v, j1.d2);
    const double h22 = m2 - Dot(v, j2.d2);
    const double h12 = pinned[0] || pinned[1] ? 0 : -Dot(j1.d1, j2.d1);
    constexpr double kConverged = 1e-14;
    constexpr double kFlatValley = 1e-12;
    if (std::abs(f1) <= kConverged * Norm(v) * std::sqrt(m1) && std::abs(f2) <= kConverged * Norm(v) * std::sqrt(m2)) {
      return false;
    }
    const double determinant = h11 * h22 - h12 * h12;
    std::array<double, 2> step = {-f1 / m1 / 2, -f2 / m2 / 2};
    if (h12 == 0) {
      if (h11 > 0) step[0] = -f1 / h11;
      if (h22 > 0) step[1] = -f2 / h22;
    } else if (h11 > 0 && determinant > kFlatValley * h11 * h22) {
      step = {(-f1 * h22 + f2 * h12) / determinant, (-f2 * h11 + f1 * h12) / determinant};
    } else if (h22 > 0) {
      // Along the valley, where both places move together, as far as is allowed.
      const double slope = f1 - f2 * h12 / h22;
      const double length = slope < 0 ? 1 : -1;
      step = {length, -(f2 + h12 * length) / h22};
    }
    // Next to a minimum rounding hides whether the distance falls, but the slopes show it.
    constexpr double kNear = 1e-6;
    if (Steepest(at_, pinned) < kNear) return Polish(step, pinned);
    // Along the valley both move in proportion, up to the first end; where that does not help, one at a time.
    return Advance(step) || Advance({step[0], 0}) || Advance({0, step[1]});
  }

  // The steepest slope of the places that are not pinned.
  double Steepest(const Places& at, const std::array<bool, 2>& pinned) const {
    double slope = 0;
    for (std::size_t k = 0; k < 2; ++k) slope = std::max(slope, pinned[k] ? 0 : std::abs(Slope(at, k)));
    return slope;
  }

  // The whole step within both pieces, if it makes the slopes less.
  bool Polish(const std::array<double, 2>& step, const std::array<bool, 2>& pinned) {
    Places to = at_;
    for (std::size_t k = 0; k < 2; ++k) {
      if (pinned[k]) continue;
      to[k].s += step[k];
      if (to[k].s <= loops_[k]->low(at_[k].piece) || to[k].s >= loops_[k]->high(at_[k].piece)) return false;
    }
    if (!(Steepest(to, pinned) < Steepest(at_, pinned))) return false;
    at_ = to;
    return true;
  }

  // Moves by the step, or a part of it, if that brings the places nearer to each other.
  bool Advance(const std::array<double, 2>& step) {
    const double before = Value(at_);
    double factor = 1;
    // Small steps only, so as not to leave the valley.
    constexpr double kLongest = 0.05;
    for (std::size_t k = 0; k < 2; ++k) {
      const double low = loops_[k]->low(at_[k].piece);
      const double high = loops_[k]->high(at_[k].piece);
      const double longest = std::min(kLongest * (high - low), step[k] < 0 ? at_[k].s - low : high - at_[k].s);
      if (std::abs(step[k]) > longest) factor = std::min(factor, longest / std::abs(step[k]));
    }
    for (int i = 0; i < 50; ++i, factor /= 2) {
      Places to = at_;
      for (std::size_t k = 0; k < 2; ++k) {
        const double low = loops_[k]->low(at_[k].piece);
        const double high = loops_[k]->high(at_[k].piece);
        to[k].s = at_[k].s + factor * step[k];
        // To the end itself, which rounding may have missed.
        constexpr double kAtEnd = 1e-12;
        if (to[k].s <= low + kAtEnd * (high - low)) to[k].s = low;
        if (to[k].s >= high - kAtEnd * (high - low)) to[k].s = high;
      }
      if (to[0].s == at_[0].s && to[1].s == at_[1].s) return false;
      if (Value(to) < before) {
        at_ = to;
        return true;
      }
    }
    return false;
  }

  std::array<const SampledLoop*, 2> loops_;
  Places at_;
};

/// Whether the distance of two outlines has a local minimum at two places, by its derivatives along the pieces that
/// meet there. It must not fall to either side: within a piece its slope is zero; at an end, where two pieces meet, it
/// rises, or is level, along each. And where it is level, its second derivatives must be positive definite.
/// Finite steps instead of derivatives cannot decide this: a re-entrant corner may be nearer than any step, and beyond
/// it the outline comes nearer, though the foot on this side is a minimum in its own neighbourhood.
inline bool IsLocalMinimum(const SampledLoop& loop1, const LoopPlace& place1, const SampledLoop& loop2,
                           const LoopPlace& place2) {
  // A foot as near to an end as this, relative to the piece, is taken to be there.
  constexpr double kAtEnd = 1e-9;
  constexpr double kLevel = 1e-7;
  // A piece at the foot, and the sense in which s may change: 1, -1, or 0 for both.
  struct Side {
    LoopPlace place;
    double sense = 0;
  };
  const auto sides_of = [&](const SampledLoop& loop, LoopPlace place) {
    const double low = loop.low(place.piece);
    const double high = loop.high(place.piece);
    const bool at_low = place.s - low <= kAtEnd * (high - low);
    const bool at_high = high - place.s <= kAtEnd * (high - low);
    std::vector<Side> sides;
    if (!at_low && !at_high) return std::vector<Side>{{place, 0}};
    place.s = at_low ? low : high;
    sides.push_back({place, at_low ? 1.0 : -1.0});
    const LoopPlace next = *loop.Neighbour(place);
    sides.push_back({next, next.s == loop.low(next.piece) ? 1.0 : -1.0});
    return sides;
  };
  for (const Side& side1 : sides_of(loop1, place1)) {
    for (const Side& side2 : sides_of(loop2, place2)) {
      const auto j1 = loop1.At(side1.place);
      const auto j2 = loop2.At(side2.place);
      const Vec2 v = j1.c - j2.c;
      const double slope1 = Dot(v, j1.d1) / (Norm(v) * Norm(j1.d1));
      const double slope2 = -Dot(v, j2.d1) / (Norm(v) * Norm(j2.d1));
      const auto falls = [&](double slope, double sense) {
        return sense == 0 ? std::abs(slope) > kLevel : sense * slope < -kLevel;
      };
      if (falls(slope1, side1.sense) || falls(slope2, side2.sense)) return false;
      // Second derivatives of |v|^2 / 2 by lengths along the pieces.
      const double h11 = 1 + Dot(v, j1.d2) / Dot(j1.d1, j1.d1);
      const double h22 = 1 - Dot(v, j2.d2) / Dot(j2.d1, j2.d1);
      const double h12 = Dot(j1.d1, j2.d1) / (Norm(j1.d1) * Norm(j2.d1));
      const bool level1 = std::abs(slope1) <= kLevel;
      const bool level2 = std::abs(slope2) <= kLevel;
      if ((level1 && !(h11 > 0)) || (level2 && !(h22 > 0))) return false;
      if (level1 && level2 && !(h11 * h22 - h12 * h12 > 0)) return false;
    }
  }
  return true;
}

/// The least distance of the polygons through the samples, which must not overlap.
inline double SmallestDistance(const SampledLoop& loop1, const SampledLoop& loop2) {
  double least = 1e300;
  const auto from_points_of = [&](const SampledLoop& one, const SampledLoop& other) {
    for (const Vec2 p : one.points()) {
      for (std::size_t j = 0; j < other.size(); ++j) {
        const Vec2 a = other.points()[j];
        const Vec2 b = other.points()[(j + 1) % other.size()];
        if (std::max(std::abs(p.x - a.x), std::abs(p.y - a.y)) > least + std::abs(b.x - a.x) + std::abs(b.y - a.y)) {
          continue;
        }
        least = std::min(least, DistanceToSegment(p, a, b));
      }
    }
  };
  from_points_of(loop1, loop2);
  from_points_of(loop2, loop1);
  return least;
}

inline bool IsSame(const SampledMinimum& a, Vec2 p1, Vec2 p2, double tolerance) {
  return Norm(a.p1 - p1) <= tolerance && Norm(a.p2 - p2) <= tolerance;
}

/// @param reach  minima further apart are left out
/// @param undecided  counts descents that do not converge
inline std::vector<SampledMinimum> SampledMinima(const SampledLoop& loop1, const SampledLoop& loop2, double reach,
                                                 int* undecided) {
  const std::size_t rows = loop1.size();
  const std::size_t columns = loop2.size();
  std::vector<double> square(rows * columns);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const Vec2 v = loop1.points()[i] - loop2.points()[j];
      square[i * columns + j] = Dot(v, v);
    }
  }
  std::vector<SampledMinimum> minima;
  constexpr double kSame = 1e-6;
  // A sample is never much further than the minimum next to it.
  const double limit = (1.5 * reach) * (1.5 * reach);
  Descent descent(loop1, loop2);
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t rows_near[3] = {(i + rows - 1) % rows, i, (i + 1) % rows};
    for (std::size_t j = 0; j < columns; ++j) {
      const double here = square[i * columns + j];
      if (here > limit) continue;
      bool is_least = true;
      for (const std::size_t r : rows_near) {
        for (const std::size_t c : {(j + columns - 1) % columns, j, (j + 1) % columns}) {
          is_least = is_least && here <= square[r * columns + c];
        }
      }
      if (!is_least) continue;
      const auto found = descent.Run(loop1.place(i), loop2.place(j));
      if (!found) {
        ++*undecided;
        continue;
      }
      if (found->d > reach || found->through_material) continue;
      if (std::any_of(minima.begin(), minima.end(),
                      [&](const SampledMinimum& m) { return IsSame(m, found->p1, found->p2, kSame); })) {
        continue;
      }
      minima.push_back(*found);
    }
  }
  return minima;
}

/// A smooth closed curve of Bezier edges through random points about the origin.
inline OutlineLoop RandomBlob(double radius, bool counter_clockwise, Random* random) {
  const int count = 3 + RandomInteger(4, random);
  const std::vector<Vec2> p = RandomCorners(count, {}, radius, counter_clockwise, 0.2, 0.3, random);
  OutlineLoop loop;
  const auto at = [&](int k) { return p[static_cast<std::size_t>((k + count) % count)]; };
  for (int k = 0; k < count; ++k) {
    constexpr double kTension = 1.0 / 4;
    const Vec2 a = at(k) + kTension * (at(k + 1) - at(k - 1));
    const Vec2 b = at(k + 1) - kTension * (at(k + 2) - at(k));
    loop.push_back({BezierEdge{{at(k), a, b, at(k + 1)}}, 0, 1});
  }
  return loop;
}

/// A closed loop of edges of one kind about the origin: with corners, or one smooth curve.
inline OutlineLoop RandomLoopOfKind(EdgeKind kind, double radius, bool counter_clockwise, Random* random) {
  const Side side = counter_clockwise ? Side::kConvex : Side::kConcave;
  const double turn = 2 * std::numbers::pi;
  const double begin = counter_clockwise ? 0 : turn;
  const double end = turn - begin;
  if (kind != EdgeKind::kStraight && random->Uniform(0, 1) < 0.5) {
    const double a = radius * random->Uniform(0.8, 1.2);
    const double b = a * random->Uniform(0.4, 1);
    const double phi = random->Uniform(-3, 3);
    if (kind == EdgeKind::kArc) return {{ArcEdge{{}, a, side}, begin, end}};
    if (kind == EdgeKind::kEllipse) return {{EllipseEdge{{}, a, b, phi, side}, begin, end}};
    if (kind == EdgeKind::kSuperellipse) {
      return {{SuperellipseEdge{{}, a, b, 2 + 2 * RandomInteger(4, random), phi, side}, begin, end}};
    }
    return RandomBlob(radius, counter_clockwise, random);
  }
  const int vertices = 4 + RandomInteger(4, random);
  return RandomLoopThrough(
      RandomCorners(vertices, {}, radius, counter_clockwise, 0.2, 0.2, random), [&] { return kind; }, random);
}

}  // namespace lcpbench::testing
