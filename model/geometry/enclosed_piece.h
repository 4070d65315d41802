#pragma once

#include <algorithm>

#include "model/geometry/broad_phase.h"
#include "model/geometry/feature.h"

namespace lcpbench {

/// The box around two points.
inline BoundingBox BoxOf(Vec2 a, Vec2 b) { return Union({a, a}, {b, b}); }

/// A piece of a curve that turns by less than 180 degrees, enclosed: every point of it lies within `height` of its
/// chord. Halving it divides the height by about four.
struct EnclosedPiece {
  /// @param of  kept by reference: must outlive the piece
  EnclosedPiece(const OutlineCurve& of, double s_first, double s_last)
      : curve(&of),
        s_begin(s_first),
        s_end(s_last),
        begin(CurvePoint(of, s_first)),
        end(CurvePoint(of, s_last)),
        enclosure(Enclose(of, s_first, s_last)) {}

  double height() const { return enclosure.height; }
  double chord() const { return Norm(end - begin); }
  double middle() const { return s_begin + (s_end - s_begin) / 2; }
  bool can_split() const { return middle() != s_begin && middle() != s_end; }
  EnclosedPiece FirstHalf() const { return {*curve, s_begin, middle()}; }
  EnclosedPiece SecondHalf() const { return {*curve, middle(), s_end}; }
  /// Contains the piece, and `margin` around it.
  BoundingBox Bounds(double margin) const { return Inflated(BoxOf(begin, end), {}, height() + margin); }

  const OutlineCurve* curve;
  double s_begin;
  double s_end;
  Vec2 begin;
  Vec2 end;
  Enclosure enclosure;
};

}  // namespace lcpbench
