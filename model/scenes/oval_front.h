#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "model/geometry/vec2.h"

namespace lcpbench {

/// An ellipse in the plane: semi-axis a along the unit vector u, b across it [m].
struct PlacedOval {
  Vec2 c;
  Vec2 u{1, 0};
  double a = 1;
  double b = 1;
};

/// The boundary point with outward unit normal n, from the oval's centre; h = n . arm is its support function there and
/// `radius` the radius of curvature.
struct OvalSupport {
  Vec2 arm;
  double h = 0;
  double radius = 0;
};
OvalSupport SupportOf(const PlacedOval& oval, Vec2 n);

/// The gap between two shapes with the unit normal from the other shape to the oval.
struct OvalGap {
  double d = 0;
  Vec2 n;
};
/// The largest separation over all normals, s(n) = n.(c - c') - h(n) - h'(n): the gap where d > 0, and near touching
/// less the depth. Newton's method on the normal's angle, s' = t.(c - c' - x - x'), s'' = -(s + rho + rho').
OvalGap GapBetween(const PlacedOval& oval, const PlacedOval& other);
/// The gap to the circle about the origin of that radius around the oval: the least of R + n.c - h(n).
OvalGap GapInside(const PlacedOval& oval, double bowl_radius);

/// What an oval rests on.
inline constexpr int kLeftBowl = -1;
inline constexpr int kRightBowl = -2;
/// The two things that an oval rests on.
struct OvalSupports {
  int left = kLeftBowl;  ///< index of an oval, or the bowl
  int right = kRightBowl;
};

/// Packs ovals into a round bowl, the circle of that radius about the origin, from its bottom: an advancing front (as
/// used for filling domains with circles; Feng, Han, Owen 2003), a chain of ovals from the bowl's left side to its
/// right. Each new oval goes into the lowest pocket between neighbours of the chain, touching both to rounding; where
/// it would overlap another of the chain, those in between are left behind. All others are further away than a
/// clearance.
/// + - * / sqrt only: the same bits everywhere. O(log n) for each oval.
class OvalFront {
 public:
  /// @param largest  bound on the semi-axes of all ovals, which the bowl's radius must exceed four times
  OvalFront(double bowl_radius, double largest);

  /// An oval that touches the bowl at its point in the direction `down` (unit) from the middle; the first of all.
  void AddFirst(PlacedOval oval, Vec2 down);
  /// Puts the oval into the lowest pocket; its centre is ignored. Nothing where no pocket takes it: try another one.
  std::optional<OvalSupports> Add(PlacedOval oval);
  /// Puts the oval on top of the highest oval of the chain that has room above: its support, or nothing.
  std::optional<int> AddOnCrest(PlacedOval oval);

  const std::vector<PlacedOval>& ovals() const { return ovals_; }
  /// The gap between an oval and what it rests on.
  OvalGap GapTo(const PlacedOval& oval, int support) const;

 private:
  struct Pocket {
    double height = 0;
    int left = 0;
    int right = 0;
    bool operator>(const Pocket& other) const {
      if (height != other.height) return height > other.height;
      return left != other.left ? left > other.left : right > other.right;
    }
  };
  /// Neither an oval nor the bowl.
  static constexpr int kNone = -3;

  const PlacedOval& Oval(int k) const { return ovals_[static_cast<std::size_t>(k)]; }
  int Next(int k) const { return k == kLeftBowl ? first_ : next_[static_cast<std::size_t>(k)]; }
  int Previous(int k) const { return k == kRightBowl ? last_ : previous_[static_cast<std::size_t>(k)]; }
  void InsertBetween(int left, int right, const PlacedOval& oval);
  void Bury(int left, int right);
  void PushPocket(int left, int right);
  Vec2 GuessCenter(const PlacedOval& oval, int left, int right) const;
  bool PlaceInPocket(int left, int right, PlacedOval* oval) const;
  int FindOverlap(const PlacedOval& oval, int support1, int support2) const;
  int Insert(const PlacedOval& oval);
  std::size_t CellOf(double coordinate) const;

  double bowl_radius_;
  double largest_;
  double clearance_;
  std::size_t cells_;
  std::vector<PlacedOval> ovals_;
  std::vector<int> next_;
  std::vector<int> previous_;
  int first_ = kRightBowl;
  int last_ = kLeftBowl;
  int refusals_ = 0;  ///< by the lowest pocket
  std::priority_queue<Pocket, std::vector<Pocket>, std::greater<>> pockets_;
  std::vector<std::vector<int>> grid_;
};

}  // namespace lcpbench
