// rounded-wall: a toothed brick wall in running bond, of bricks with rounded corners.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kPitch = 0.5;  ///< distance of the bricks of a course; where both joints are closed, their length
constexpr double kHeight = 0.2;
constexpr double kHalfJoint = 0.01;   ///< by how much each of two bricks stands back from an open joint
constexpr double kClosedShare = 0.7;  ///< of the joints
constexpr Range kSharp{0.06, 0.15};   ///< ranges of the corner radius over the height
constexpr Range kBlunt{0.2, 0.4};
constexpr double kDensity = 100;
constexpr Range kAspect{0.7, 2};            ///< bricks in the lowest course over courses, at random up to
constexpr double kWeight = 0.4 * kGravity;  ///< times the root of the number of courses [m/s^2]
constexpr double kLean = 1.0 / 6;           ///< sine of the floor's slope in the sequence

class RoundedWall final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    floor_ = AddFixed("floor");
    const double rows_per_brick = 4 + 2 * kClosedShare;
    const double aspect = random_.Uniform(kAspect);
    base_ = std::max(2, static_cast<int>(std::sqrt(aspect * rows_ / rows_per_brick)));
    std::vector<int> below;
    for (;; ++courses_) {
      const std::vector<int> course = BuildCourse(below);
      if (static_cast<int>(course.size()) < BricksIn(courses_)) break;
      below = course;
    }
    const double end = CloseCount();
    Get(floor_).outline = {WholeEdge({end, 0}, {-kPitch, 0})};
  }

  void Load() override { Apply({.weight = kWeight / std::sqrt(1.0 + (courses_ + 1)), .gust = 2 * kGravity}); }

  void Launch(World* world) override { world->loads.gravity = kGravity * Vec2{kLean, -std::sqrt(1 - kLean * kLean)}; }

 private:
  /// Odd courses begin and end half a brick further in.
  int BricksIn(int course) const { return base_ - course % 2; }

  /// As many bricks of the next course as the rows left allow.
  std::vector<int> BuildCourse(const std::vector<int>& below) {
    std::vector<int> course;
    const int count = BricksIn(courses_);
    // What brick j stands on: bricks j and j + 1 below in odd courses, j - 1 and j in even ones.
    const int shift = courses_ % 2 == 1 ? 0 : -1;
    bool closed_left = false;
    for (int j = 0; j < count; ++j) {
      const bool closed_right = j + 1 < count && random_.Uniform() < kClosedShare;
      const int first = std::max(0, j + shift);
      const int last = std::min(static_cast<int>(below.size()) - 1, j + shift + 1);
      const int supports = courses_ == 0 ? 1 : last - first + 1;
      if (2 * supports + (closed_left ? 2 : 0) > left_) break;
      const int brick = AddBrick(j, closed_left, closed_right);
      course.push_back(brick);
      if (courses_ == 0) StandOnFloor(brick);
      for (int k = first; courses_ > 0 && k <= last; ++k) {
        StandOn(brick, below[static_cast<std::size_t>(k)], k == j + shift);
      }
      if (closed_left) Abut(course[course.size() - 2], brick);
      closed_left = closed_right;
    }
    return course;
  }

  // Pieces of a brick's outline: sides 0..3 (bottom, right, top, left) and corners 0..3 (counter-clockwise from the
  // lower left) by turns.
  Feature SideOf(int brick, std::size_t k) const { return Piece(brick, 2 * k); }
  Feature RoundOf(int brick, std::size_t k) const { return Piece(brick, 2 * ((k + 3) % 4) + 1); }

  void StandOnFloor(int brick) {
    for (const std::size_t corner : {0U, 1U}) Touch(brick, RoundOf(brick, corner), floor_, Floor());
  }

  int AddBrick(int j, bool closed_left, bool closed_right) {
    const double begin = (j + 0.5 * (courses_ % 2)) * kPitch + (closed_left ? 0 : kHalfJoint);
    const double end = (j + 1 + 0.5 * (courses_ % 2)) * kPitch - (closed_right ? 0 : kHalfJoint);
    const double corner = kHeight * random_.Uniform((j + courses_) % 2 == 0 ? kSharp : kBlunt);
    const Vec2 x{(begin + end) / 2, (courses_ + 0.5) * kHeight};
    return Add("brick", MakeRoundedBox(x, end - begin, kHeight, corner, kDensity));
  }

  /// The overlap with the brick below on the left or right ends at one corner of each.
  void StandOn(int brick, int below, bool on_left) {
    Touch(brick, RoundOf(brick, on_left ? 0 : 1), below, SideOf(below, 2));
    Touch(brick, SideOf(brick, 0), below, RoundOf(below, on_left ? 2 : 3));
  }

  /// The blunter brick's straight face is the shorter one: the overlap ends at its two corners.
  void Abut(int left, int right) {
    const auto radius = [this](int brick) { return std::get<ArcEdge>(RoundOf(brick, 0)).radius; };
    if (radius(left) > radius(right)) {
      for (const std::size_t corner : {1U, 2U}) Touch(right, SideOf(right, 3), left, RoundOf(left, corner));
    } else {
      for (const std::size_t corner : {0U, 3U}) Touch(right, RoundOf(right, corner), left, SideOf(left, 1));
    }
  }

  /// Returns where the floor ends.
  double CloseCount() {
    double x = kPitch * (base_ + 1);
    while (left_ > 0) {
      if (left_ >= 2) {
        const double corner = kHeight * random_.Uniform(kBlunt);
        StandOnFloor(Add("brick", MakeRoundedBox({x, kHeight / 2}, kPitch, kHeight, corner, kDensity)));
      } else {
        Touch(Add("disc", MakeDisc({x, kHeight / 2}, kHeight / 2, kDensity)), floor_, Floor());
      }
      x += 1.5 * kPitch;
    }
    return x;
  }

  int floor_ = 0;
  int base_ = 2;     ///< bricks in even courses
  int courses_ = 0;  ///< complete ones
};

}  // namespace

extern const SceneFamily kRoundedWall{
    "rounded-wall", "Wall of bricks with rounded corners",
    "Flat contacts through corner arcs, up to six rows a brick against three degrees of freedom: the most "
    "redundant wall, with A far from full rank.",
    &Make<RoundedWall>};

}  // namespace lcpbench
