#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "model/geometry/broad_phase.h"
#include "model/geometry/enclosed_piece.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// Which points a body's outline has the material around, and how deep they lie in it. Everything is in the body frame.
/// A point belongs to the side of the outline that it is on where the outline is nearest to it, so that holes, bowls
/// and outlines whose material is outside need no rule of their own. Open chains have no inside beyond their ends.
class OutlineRegion {
 public:
  /// Where a point lies.
  struct Place {
    double depth = 0;       ///< the distance to the outline [m], < 0 outside the material
    int edge = -1;          ///< the nearest edge, counted through the outline's loops
    bool on_chain = false;  ///< the nearest edge is one of an open chain
  };
  /// A part of an edge that is nearly straight.
  struct Chord {
    EnclosedPiece piece;
    int edge = 0;
  };

  /// @param outline   pieces valid (RequireValidPiece); loops may be open or run either way
  /// @param fineness  chords lie within about this of their edges, and samples are at most this far apart [m], > 0
  OutlineRegion(const Outline& outline, double fineness);
  // Chords point to the edges.
  OutlineRegion(const OutlineRegion&) = delete;
  OutlineRegion& operator=(const OutlineRegion&) = delete;
  OutlineRegion(OutlineRegion&&) = default;
  OutlineRegion& operator=(OutlineRegion&&) = default;

  bool empty() const { return chords_.empty(); }
  /// Around the outline.
  const BoundingBox& box() const { return box_; }
  /// Samples of what overlaps this need not be nearer to each other than this [m]: at most the fineness, and
  /// half_thickness.
  double spacing() const { return std::min(fineness_, half_thickness_); }
  /// Half of the material's mean thickness [m]; infinite where it has no bounds.
  double half_thickness() const { return half_thickness_; }
  bool is_on_chain(int edge) const { return ends_[static_cast<std::size_t>(edge)].on_chain; }
  bool has_chain() const { return has_chain_; }
  /// A point within the material near the outline, deeper than rounding; nothing where the outline has an open chain.
  const std::optional<Vec2>& inner_point() const { return inner_point_; }
  std::span<const Chord> chords() const { return chords_; }
  /// The tree of the chords' bounds.
  const RunTree<BoundingBox>& tree() const { return *tree_; }

  /// @param accuracy  of the depth [m]; 0 for a relative 1e-6, or rounding where that is larger
  /// @param shallow   a point that is no further than this from the outline [m] gets some depth within +-shallow
  /// O(log chords) expected, for points near the outline.
  Place At(Vec2 p, double accuracy, double shallow = -1) const;

  /// A point that lies nearly as deep in the material as any: nothing where a part of the outline is an open chain or
  /// no material was found. Below a millisecond.
  std::optional<Vec2> DeepestPoint() const;

 private:
  // The ends of an edge: the sum of the outward normals of both edges that meet there, none at the end of a chain.
  struct Ends {
    std::optional<Vec2> begin;
    std::optional<Vec2> end;
    bool on_chain = false;
  };
  struct Nearest;

  void AddLoop(const OutlineLoop& loop, int first);
  void Look(const EnclosedPiece& piece, int edge, Vec2 p, double accuracy, Nearest* nearest) const;
  void FindInnerPoint();

  std::vector<OutlinePiece> edges_;
  std::vector<Ends> ends_;
  std::vector<Chord> chords_;
  std::optional<RunTree<BoundingBox>> tree_;
  BoundingBox box_;
  std::optional<Vec2> inner_point_;
  bool has_chain_ = false;
  double fineness_;
  double half_thickness_;
  double rounding_ = 0;  // [m]
};

}  // namespace lcpbench
