// discs-in-v: equal discs stacked between two walls that open at 60 degrees.
//
// The triangular lattice fits the wedge exactly, so layer k holds k discs and every disc touches up to six others:
// about three rows per disc against two degrees of freedom that contacts can push on (a disc's spin is free). A is rank
// deficient (rank 0.68 of the rows at 1000), f is not unique, w is. Forces run along straight lattice lines from the
// top layer to both walls, so that a local method has to carry information over as many steps as there are layers.
//
// Rows with w > 0 at the solution, seeds 1 to 5: 20-60 % at 10 rows, 27-38 % at 100, 14-30 % at 1000, 14-21 % at 3000;
// from 1000 on another 6-20 % have f = w = 0 in a basic solution.
//
// Rows are filled disc by disc, layer by layer. The last discs close the count: one in a cradle without its left
// neighbour (two rows) or one that slides down the right-hand wall above the stack (one row).
//
// In motion: upright, every body stirred a little (start.h), settling.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/parts.h"
#include "model/scenes/scene.h"
#include "model/scenes/start.h"

namespace lcpbench {
namespace {

constexpr double kRadius = 0.1;
constexpr double kDensity = 50;
/// In-plane gravity times the number of layers [m/s^2]. The plane of motion lies nearly flat, the flatter the higher
/// the stack: sums of random gusts grow with a region's size, those of weights with its square, and an upright stack's
/// weight would close every contact below the top layers.
constexpr double kWeight = 0.2 * kGravity;

/// The wedge has its apex at the origin; disc i of layer k (both from 0) is the (i+1)-th from the left of k + 1.
class Wedge {
 public:
  explicit Wedge(ContactSystem* system) : system_(system) {
    left_ = AddBody(system, "wall", MakeFixed("left wall"));
    right_ = AddBody(system, "wall", MakeFixed("right wall"));
  }

  /// A disc at place i of layer k, not yet touching anything.
  int AddDisc(int layer, int i) {
    top_layer_ = std::max(top_layer_, layer);
    // The lowest disc touches both walls: its centre is 2 r above the apex, as sin 30 degrees = 1/2.
    const Vec2 center{(2 * i - layer) * kRadius, (2 + layer * root3_) * kRadius};
    return AddBody(system_, "disc", MakeDisc(center, kRadius, kDensity));
  }
  void TouchDisc(int disc, int other) { AddContact(system_, disc, Circle(kRadius), other, Circle(kRadius)); }
  void TouchLeftWall(int disc) { AddContact(system_, disc, Circle(kRadius), left_, LeftWall(1)); }
  void TouchRightWall(int disc) { AddContact(system_, disc, Circle(kRadius), right_, RightWall(1)); }

  int top_layer() const { return top_layer_; }

  void DrawWalls() {
    const double length = (top_layer_ + 3) * 2 * kRadius;
    const StraightEdge left = LeftWall(length);
    const StraightEdge right = RightWall(length);
    system_->bodies[static_cast<std::size_t>(left_)].outline = {WholeEdge(left.a, left.b)};
    system_->bodies[static_cast<std::size_t>(right_)].outline = {WholeEdge(right.a, right.b)};
  }

 private:
  // Material on the left of a -> b: the left wall is walked up, the right wall down.
  StraightEdge LeftWall(double length) const { return {{}, {-length / 2, length * root3_ / 2}}; }
  StraightEdge RightWall(double length) const { return {{length / 2, length * root3_ / 2}, {}}; }

  ContactSystem* system_;
  const double root3_ = std::sqrt(3.0);
  int top_layer_ = 0;
  int left_ = 0;
  int right_ = 0;
};

/// A disc with its two supports below (disc or wall) and without neighbours in its layer: two rows.
/// `below` are the discs of the layer below.
int AddCradled(Wedge* wedge, int layer, int i, const std::vector<int>& below) {
  const int disc = wedge->AddDisc(layer, i);
  if (i == 0) {
    wedge->TouchLeftWall(disc);
  } else {
    wedge->TouchDisc(disc, below[static_cast<std::size_t>(i) - 1]);
  }
  if (i == layer) {
    wedge->TouchRightWall(disc);
  } else {
    wedge->TouchDisc(disc, below[static_cast<std::size_t>(i)]);
  }
  return disc;
}

ContactSystem Generate(int rows, std::uint64_t seed) {
  ContactSystem system = EmptyScene("discs-in-v", rows, seed);
  Wedge wedge(&system);
  std::vector<int> below;
  std::vector<int> current;
  int layer = 0;
  int left = rows;
  while (left >= 2) {
    const int i = static_cast<int>(current.size());
    if (left == 2 && i > 0) {
      // The next disc would bring three rows: leave its place empty.
      if (i < layer) {
        AddCradled(&wedge, layer, i + 1, below);
      } else {
        current.push_back(-1);
        AddCradled(&wedge, layer + 1, 0, current);
      }
      left = 0;
      break;
    }
    const int disc = AddCradled(&wedge, layer, i, below);
    left -= 2;
    if (i > 0) {
      wedge.TouchDisc(disc, current.back());
      --left;
    }
    current.push_back(disc);
    if (i == layer) {
      below.swap(current);
      current.clear();
      ++layer;
    }
  }
  if (left == 1) {
    const int above = wedge.top_layer() + 2;
    wedge.TouchRightWall(wedge.AddDisc(above, above));
  }
  wedge.DrawWalls();

  Random random(seed);
  ApplyLoads(&system, {.weight = kWeight / (1 + wedge.top_layer()), .gust = kGravity}, &random);
  return system;
}

World Start(int rows, std::uint64_t seed) {
  World world = WorldUnderGravity(Generate(rows, seed), {0, -kGravity});
  Stir(&world, kStir, seed);
  return world;
}

}  // namespace

extern const SceneFamily kDiscsInV{
    "discs-in-v",
    "Equal discs stacked in a V of two walls",
    "Redundant contacts and force paths as long as the stack is high: A is rank deficient and f not unique, "
    "which tells methods that cope with singular A from those that need pivots of full rank.",
    &Generate,
    &Start,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
