// rounded-wall: a toothed brick wall in running bond, of bricks with rounded corners.
//
// Corner radii are random, from two ranges that alternate along a course, so that the ends of two faces' overlap never
// coincide (where they do, the contact's features are ambiguous). All at rest: gamma = 0.
//
// As a sequence: the wall on a plane that leans by a sixth, down which its courses slide.
//
// Rows left when the next brick would bring too many are closed beside the wall by bricks (two rows) and a disc (one)
// on the floor.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

/// Distance of the bricks of a course; where both joints are closed, their length.
constexpr double kPitch = 0.5;
constexpr double kHeight = 0.2;
/// By how much each of two bricks stands back from an open joint.
constexpr double kHalfJoint = 0.01;
constexpr double kClosedShare = 0.7;  ///< of the joints
/// Ranges of the corner radius over the height.
constexpr double kSharp[2] = {0.06, 0.15};
constexpr double kBlunt[2] = {0.2, 0.4};
constexpr double kDensity = 100;
/// Bricks in the lowest course over courses, at random up to.
constexpr double kMinAspect = 0.7;
constexpr double kMaxAspect = 2;
/// In-plane gravity times the square root of the number of courses [m/s^2]: an inclined plane, on which weights do not
/// outgrow the random gusts as the wall gets higher.
constexpr double kWeight = 0.4 * kGravity;
constexpr double kLean = 1.0 / 6;  ///< sine of the floor's slope in the sequence

struct Brick {
  int body = -1;
  RoundedBoxShape shape;
};

class RoundedWall final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    floor_ = Add("floor", MakeFixed("floor"));
    const double rows_per_brick = 4 + 2 * kClosedShare;
    const double aspect = random_.Uniform(kMinAspect, kMaxAspect);
    base_ = std::max(2, static_cast<int>(std::sqrt(aspect * rows_ / rows_per_brick)));
    std::vector<Brick> below;
    for (;; ++courses_) {
      const std::vector<Brick> course = BuildCourse(below);
      if (static_cast<int>(course.size()) < BricksIn(courses_)) break;
      below = course;
    }
    const double end = CloseCount();
    Get(floor_).outline = {WholeEdge({end, 0}, {-kPitch, 0})};
  }

  void Load() override {
    ApplyLoads(&system_, {.weight = kWeight / std::sqrt(1.0 + (courses_ + 1)), .gust = 2 * kGravity}, &random_);
  }

  void Launch(World* world) override { world->loads.gravity = kGravity * Vec2{kLean, -std::sqrt(1 - kLean * kLean)}; }

 private:
  /// Odd courses begin and end half a brick further in.
  int BricksIn(int course) const { return base_ - course % 2; }

  /// As many bricks of the next course as the rows left allow.
  std::vector<Brick> BuildCourse(const std::vector<Brick>& below) {
    std::vector<Brick> course;
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
      course.push_back(AddBrick(j, closed_left, closed_right));
      const Brick& brick = course.back();
      if (courses_ == 0) {
        for (const int corner : {0, 1}) Touch(brick.body, brick.shape.Corner(corner), floor_, Floor());
      }
      for (int k = first; courses_ > 0 && k <= last; ++k) {
        StandOn(brick, below[static_cast<std::size_t>(k)], k == j + shift);
      }
      if (closed_left) Abut(course[course.size() - 2], brick);
      closed_left = closed_right;
    }
    return course;
  }

  Brick AddBrick(int j, bool closed_left, bool closed_right) {
    const double begin = (j + 0.5 * (courses_ % 2)) * kPitch + (closed_left ? 0 : kHalfJoint);
    const double end = (j + 1 + 0.5 * (courses_ % 2)) * kPitch - (closed_right ? 0 : kHalfJoint);
    const double* range = (j + courses_) % 2 == 0 ? kSharp : kBlunt;
    Brick brick;
    brick.shape = {end - begin, kHeight, kHeight * random_.Uniform(range[0], range[1])};
    const Vec2 x{(begin + end) / 2, (courses_ + 0.5) * kHeight};
    brick.body = Add("brick", MakeRoundedBox(x, brick.shape, kDensity));
    return brick;
  }

  /// The overlap with the brick below on the left or right ends at one corner of each.
  void StandOn(const Brick& brick, const Brick& below, bool on_left) {
    Touch(brick.body, brick.shape.Corner(on_left ? 0 : 1), below.body, below.shape.Edge(2));
    Touch(brick.body, brick.shape.Edge(0), below.body, below.shape.Corner(on_left ? 2 : 3));
  }

  /// The blunter brick's straight face is the shorter one: the overlap ends at its two corners.
  void Abut(const Brick& left, const Brick& right) {
    if (left.shape.corner > right.shape.corner) {
      for (const int corner : {1, 2}) Touch(right.body, right.shape.Edge(3), left.body, left.shape.Corner(corner));
    } else {
      for (const int corner : {0, 3}) Touch(right.body, right.shape.Corner(corner), left.body, left.shape.Edge(1));
    }
  }

  /// Returns where the floor ends.
  double CloseCount() {
    double x = kPitch * (base_ + 1);
    while (left_ > 0) {
      if (left_ >= 2) {
        const RoundedBoxShape shape{kPitch, kHeight, kHeight * random_.Uniform(kBlunt[0], kBlunt[1])};
        const int brick = Add("brick", MakeRoundedBox({x, kHeight / 2}, shape, kDensity));
        for (const int corner : {0, 1}) Touch(brick, shape.Corner(corner), floor_, Floor());
      } else {
        constexpr double kRadius = kHeight / 2;
        Touch(Add("disc", MakeDisc({x, kRadius}, kRadius, kDensity)), Circle(kRadius), floor_, Floor());
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
    "rounded-wall",
    "Wall of bricks with rounded corners",
    "Flat contacts through corner arcs, up to six rows a brick against three degrees of freedom: the most "
    "redundant wall, with A far from full rank.",
    &Make<RoundedWall>,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
