#pragma once

#include <cstddef>
#include <vector>

#include "model/geometry/broad_phase.h"
#include "model/geometry/vec2.h"
#include "model/shape/outline_piece.h"

namespace lcpbench {

/// A piece of a curve that turns by less than 180 degrees, enclosed: every point of it lies within `height` of its
/// chord. Halving it divides the height by about four.
class EnclosedPiece {
 public:
  /// @param curve  kept by reference: must outlive the piece
  EnclosedPiece(const OutlineCurve& curve, double s_begin, double s_end);

  Vec2 begin() const { return begin_; }
  Vec2 end() const { return end_; }
  double height() const { return height_; }
  double chord() const { return Norm(end_ - begin_); }
  /// The directions of travel lie in the cone from first to second, whichever way round is less than 180 degrees.
  Vec2 first_direction() const { return direction_[0]; }
  Vec2 second_direction() const { return direction_[1]; }
  bool can_split() const { return middle() != s_begin_ && middle() != s_end_; }
  EnclosedPiece FirstHalf() const { return {*curve_, s_begin_, middle()}; }
  EnclosedPiece SecondHalf() const { return {*curve_, middle(), s_end_}; }
  /// Contains the piece, and `margin` around it.
  BoundingBox Bounds(double margin) const;

 private:
  double middle() const { return s_begin_ + (s_end_ - s_begin_) / 2; }
  void EncloseBezier(const BezierEdge& edge);
  void EncloseByTangents();

  const OutlineCurve* curve_;
  double s_begin_;
  double s_end_;
  Vec2 begin_;
  Vec2 end_;
  double height_ = 0;
  Vec2 direction_[2];
};

/// Cuts a piece into two or more that EnclosedPiece can hold: curves into equal parts of at most a quarter turn of the
/// parameter, Bezier edges until each turns by less than 90 degrees.
/// @return false if a Bezier edge's derivative vanishes on the way: no piece around that point is turned by so little
bool AppendEnclosed(const OutlinePiece& piece, std::vector<EnclosedPiece>* pieces);

/// What is known of two pieces.
enum class Meeting {
  kApart,      ///< proved
  kMeet,       ///< they come as near as the tolerance
  kUndecided,  ///< the budget of comparisons is used up
};

/// Whether two pieces come nearer to each other than `tolerance` [m].
/// @param budget  comparisons left; each takes one
Meeting FindMeeting(const EnclosedPiece& p, const EnclosedPiece& q, double tolerance, int* budget);

/// The same for q beginning where p ends: whether they meet anywhere else, or leave the joint in the same direction.
/// @param joint  pieces shorter than this [m] are not looked into: what then still runs the same way makes a cusp
Meeting FindMeetingBeyondJoint(const EnclosedPiece& p, const EnclosedPiece& q, double tolerance, double joint,
                               int* budget);

/// How often a closed loop of pieces runs counter-clockwise around a point that is further than `tolerance` from it.
int WindingNumber(const std::vector<EnclosedPiece>& loop, Vec2 point, double tolerance);

}  // namespace lcpbench
