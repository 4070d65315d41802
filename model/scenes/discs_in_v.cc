// discs-in-v: equal discs stacked between two walls that open at 60 degrees.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kRadius = 0.1;
constexpr double kDensity = 50;
constexpr double kWeight = 0.2 * kGravity;  ///< times the number of layers [m/s^2]

/// The wedge has its apex at the origin; disc i of layer k (both from 0) is the (i+1)-th from the left of k + 1.
class Wedge final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    left_wall_ = AddFixed("left wall");
    right_wall_ = AddFixed("right wall");
    std::vector<int> below;
    std::vector<int> current;
    int layer = 0;
    while (left_ >= 2) {
      const int i = static_cast<int>(current.size());
      if (left_ == 2 && i > 0) {
        // The next disc would bring three rows: leave its place empty.
        if (i < layer) {
          AddCradled(layer, i + 1, below);
        } else {
          current.push_back(-1);
          AddCradled(layer + 1, 0, current);
        }
        break;
      }
      const int disc = AddCradled(layer, i, below);
      if (i > 0) Touch(disc, current.back());
      current.push_back(disc);
      if (i == layer) {
        below.swap(current);
        current.clear();
        ++layer;
      }
    }
    if (left_ == 1) {
      const int above = top_layer_ + 2;
      Touch(AddDisc(above, above), right_wall_, RightWall(1));
    }
    const double length = (top_layer_ + 3) * 2 * kRadius;
    Get(left_wall_).outline = {{LeftWall(length)}};
    Get(right_wall_).outline = {{RightWall(length)}};
  }

  void Load() override { Apply({.weight = kWeight / (1 + top_layer_), .gust = kGravity}); }

  void Launch(World* world) override { Stir(world, kStir, seed_); }

 private:
  /// A disc at place i of layer k, not yet touching anything.
  int AddDisc(int layer, int i) {
    top_layer_ = std::max(top_layer_, layer);
    // The lowest disc touches both walls: its centre is 2 r above the apex, as sin 30 degrees = 1/2.
    const Vec2 center{(2 * i - layer) * kRadius, (2 + layer * root3_) * kRadius};
    return Add("disc", MakeDisc(center, kRadius, kDensity));
  }

  /// A disc with its two supports below (disc or wall) and without neighbours in its layer: two rows.
  /// `below` are the discs of the layer below.
  int AddCradled(int layer, int i, const std::vector<int>& below) {
    const int disc = AddDisc(layer, i);
    if (i == 0) {
      Touch(disc, left_wall_, LeftWall(1));
    } else {
      Touch(disc, below[static_cast<std::size_t>(i) - 1]);
    }
    if (i == layer) {
      Touch(disc, right_wall_, RightWall(1));
    } else {
      Touch(disc, below[static_cast<std::size_t>(i)]);
    }
    return disc;
  }

  // Material on the left of a -> b: the left wall is walked up, the right wall down.
  StraightEdge LeftWall(double length) const { return {{}, {-length / 2, length * root3_ / 2}}; }
  StraightEdge RightWall(double length) const { return {{length / 2, length * root3_ / 2}, {}}; }

  const double root3_ = std::sqrt(3.0);
  int top_layer_ = 0;
  int left_wall_ = 0;
  int right_wall_ = 0;
};

}  // namespace

extern const SceneFamily kDiscsInV{
    "discs-in-v", "Equal discs stacked in a V of two walls",
    "Redundant contacts and force paths as long as the stack is high: A is rank deficient and f not unique, "
    "which tells methods that cope with singular A from those that need pivots of full rank.",
    &Make<Wedge>};

}  // namespace lcpbench
