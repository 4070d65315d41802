// boxes-and-discs: a stepped brick wall in running bond with discs in its joints and on its steps.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kLength = 0.5;
constexpr double kHeight = 0.22;
constexpr double kJointRadius = 0.05;
/// Distance of the bricks of a course: their length and a joint that a disc just fits into.
constexpr double kPitch = kLength + 2 * kJointRadius;
constexpr double kDensity = 100;
constexpr double kWeight = 0.4 * kGravity;  ///< times the root of the number of courses [m/s^2]
constexpr double kJointShare = 0.8;         ///< of the joints hold a disc
constexpr double kStepShare = 0.8;          ///< of the steps hold a disc

class Wall final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    floor_ = AddFixed("floor");
    // A pyramid on `base` bricks brings 2 rows a brick in the lowest course and 4 above, 3 a joint disc and 2 a step
    // disc: about 2 base^2 + 3/2 kJointShare base (base - 1) + 4 kStepShare base.
    const double square = 2 + 1.5 * kJointShare;
    const double linear = 4 * kStepShare - 1.5 * kJointShare;
    const double base = (std::sqrt(linear * linear + 4 * square * rows_) - linear) / (2 * square);
    base_ = std::max(1, static_cast<int>(std::ceil(base)));
    for (int course = 0; course < base_; ++course) {
      if (!BuildCourse(course)) break;
    }
    CloseCount();
    const double reach = kPitch * (base_ + 1);
    Get(floor_).outline = {WholeEdge({std::max(loose_x_, reach), 0}, {-kPitch, 0})};
  }

  void Load() override { Apply({.weight = kWeight / std::sqrt(1.0 + courses_), .gust = 2 * kGravity}); }

  void Launch(World* world) override { Stir(world, kStir, seed_); }

 private:
  /// False when the rows are used up but for fewer than the next element needs.
  bool BuildCourse(int course) {
    std::vector<int> bricks;
    for (int j = 0; j < base_ - course; ++j) {
      if (left_ < (course == 0 ? 2 : 4)) return false;
      bricks.push_back(AddBrick(course, j));
      if (j > 0 && random_.Uniform() < kJointShare) {
        if (left_ < 3) return false;
        AddJointDisc(course, j, bricks);
      }
    }
    below_ = bricks;
    ++courses_;
    for (const int side : {-1, 1}) {
      if (random_.Uniform() >= kStepShare) continue;
      if (left_ < 2) return false;
      AddStepDisc(course, side);
    }
    steps_ = {below_.front(), below_.back()};
    return true;
  }

  static double BrickX(int course, int j) { return (j + 0.5 * course) * kPitch; }

  int AddBrick(int course, int j) {
    const Vec2 x{BrickX(course, j), (course + 0.5) * kHeight};
    const int brick = Add("brick", MakeBox(x, kLength, kHeight, kDensity));
    last_brick_ = brick;
    if (course == 0) {
      Stand(brick, floor_, Floor());
    } else {
      const int lower_left = below_[static_cast<std::size_t>(j)];
      const int lower_right = below_[static_cast<std::size_t>(j) + 1];
      Touch(brick, Corner(brick, 0), lower_left, Piece(lower_left, 2));
      Touch(brick, lower_left, Corner(lower_left, 2));
      Touch(brick, lower_right, Corner(lower_right, 3));
      Touch(brick, Corner(brick, 1), lower_right, Piece(lower_right, 2));
    }
    return brick;
  }

  /// Between bricks j - 1 and j, on the brick (or floor) below the joint: three rows.
  void AddJointDisc(int course, int j, const std::vector<int>& bricks) {
    const Vec2 x{BrickX(course, j) - kPitch / 2, course * kHeight + kJointRadius};
    const int disc = AddDisc(x, kJointRadius);
    Lie(disc, course == 0 ? floor_ : below_[static_cast<std::size_t>(j)]);
    const int left = bricks[static_cast<std::size_t>(j) - 1];
    const int right = bricks[static_cast<std::size_t>(j)];
    Touch(disc, left, Piece(left, 1));
    Touch(disc, right, Piece(right, 3));
  }

  /// In the corner between the course's end brick and the step (or floor) that it leaves free: two rows.
  void AddStepDisc(int course, int side) {
    const double radius = random_.Uniform(0.25, 0.45) * kHeight;
    const int last = base_ - course - 1;
    const double face = BrickX(course, side < 0 ? 0 : last) + side * kLength / 2;
    const int disc = AddDisc({face + side * radius, course * kHeight + radius}, radius);
    Lie(disc, course == 0 ? floor_ : steps_[side < 0 ? 0 : 1]);
    const int brick = side < 0 ? below_.front() : below_.back();
    Touch(disc, brick, Piece(brick, side < 0 ? 3 : 1));
  }

  /// The disc on the floor or on top of a brick: one row.
  void Lie(int disc, int on) { Touch(disc, on, on == floor_ ? Feature{Floor()} : Piece(on, 2)); }

  /// Up to three discs on the last brick; should more rows be left, discs and bricks on the floor beside the wall.
  void CloseCount() {
    constexpr double kRadius = 0.3 * kLength / 2;
    loose_x_ = kPitch * (base_ + 1);
    for (int k = 0; last_brick_ >= 0 && k < 3 && left_ > 0; ++k) {
      const Vec2 brick = Get(last_brick_).x;
      const double offset = (k == 0 ? 0 : k == 1 ? -1 : 1) * 2.2 * kRadius;
      Lie(AddDisc(brick + Vec2{offset, kHeight / 2 + kRadius}, kRadius), last_brick_);
    }
    while (left_ > 0) {
      if (left_ >= 2) {
        Stand(Add("brick", MakeBox({loose_x_, kHeight / 2}, kLength, kHeight, kDensity)), floor_, Floor());
      } else {
        Lie(AddDisc({loose_x_, kRadius}, kRadius), floor_);
      }
      loose_x_ += kPitch;
    }
  }

  int AddDisc(Vec2 x, double radius) {
    Body disc = MakeDisc(x, radius, kDensity * random_.Uniform(1, 4));
    disc.theta = random_.Uniform(-kPi, kPi);
    return Add("disc", disc);
  }

  int floor_ = 0;
  int base_ = 1;  ///< bricks in the lowest course
  int courses_ = 0;
  int last_brick_ = -1;
  double loose_x_ = 0;
  std::vector<int> below_;  ///< the last complete course
  std::vector<int> steps_;  ///< end bricks of the course before
};

}  // namespace

extern const SceneFamily kBoxesAndDiscs{
    "boxes-and-discs", "Brick wall in running bond with discs in joints and on steps",
    "Flat contacts by pairs of vertices: more rows than degrees of freedom, many ties, and rotation coupled "
    "to translation - the everyday, highly redundant load of a physics engine.",
    &Make<Wall>};

}  // namespace lcpbench
