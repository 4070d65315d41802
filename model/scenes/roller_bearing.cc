// roller-bearing: bearings with rows of rollers between concentric races, side by side and on top of one another.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

/// Radius of every bearing's outer ring; with the frame's corner at (0, 0), neighbours touch without rounding.
constexpr double kOuterRadius = 0.75;
constexpr double kOuterThickness = 0.1;
constexpr double kInnerThickness = 0.05;
/// Rows of rollers in a bearing: the most that the rows left suffice for.
struct BearingSize {
  int roller_rows = 1;
  int rows = 0;  ///< of the whole bearing, about
  Range radius;  ///< of each row's load rollers
};
constexpr BearingSize kSizes[] = {{3, 270, {0.040, 0.055}}, {2, 110, {0.07, 0.09}}, {1, 0, {0.10, 0.14}}};
constexpr Range kSpacer{0.6, 0.9};  ///< radius over that of load rollers
constexpr double kDensity = 60;
constexpr double kWeight = 0.3 * kGravity;  ///< times the root of the number of bearings [m/s^2]
constexpr double kCentripetal = 0.3;        ///< largest centripetal acceleration over gravity
constexpr double kShaftLoad = 20;           ///< load on a shaft in the sequence, over its weight

/// The space between two rings that a row of rollers runs in.
struct Races {
  Vec2 middle;
  int inner = 0;  ///< body
  int outer = 0;
  double inner_radius = 0;
  double outer_radius = 0;
  double orbit = 0;  ///< angular velocity of the rollers about the middle [rad/s]

  double pitch_radius() const { return (inner_radius + outer_radius) / 2; }
  double roller_radius() const { return (outer_radius - inner_radius) / 2; }
};

/// What the next roller of a row touches.
struct Roller {
  int body = -1;
  double radius = 0;
  double distance = 0;  ///< from the middle
};

class Bearings final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    frame_ = AddFixed("frame");
    columns_ = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(rows_) / kSizes[0].rows))));
    while (left_ >= 2) AddBearing();
    if (left_ == 1) AddTopDisc();
    const double width = (2 * columns_ + 1) * kOuterRadius;
    const int stories = 1 + count_ / columns_;
    const double height = 2 * kOuterRadius * stories;
    Get(frame_).outline = Polyline({{width, height}, {width, 0}, {}, {0, height}});
  }

  void Load() override { Apply({.weight = kWeight / std::sqrt(1.0 + count_), .gust = kGravity}); }

  void Launch(World* world) override {
    for (std::size_t i = 0; i < world->bodies.size(); ++i) {
      const Body& body = world->bodies[i];
      if (!body.name.starts_with("shaft")) continue;
      world->loads.wrenches.push_back({{static_cast<int>(i), {}}, {0, -kShaftLoad * body.mass * kGravity}, 0});
    }
  }

 private:
  /// At the next place of the rows of bearings: two rows for its outer ring, the others inside.
  void AddBearing() {
    const int column = count_ % columns_;
    const int story = count_ / columns_;
    const Vec2 middle{(2 * column + 1) * kOuterRadius, (2 * story + 1) * kOuterRadius};
    const BearingSize& size =
        *std::find_if(std::begin(kSizes), std::end(kSizes), [this](const BearingSize& s) { return left_ >= s.rows; });
    // From the outside inwards: whatever is left is the shaft.
    const double bore = kOuterRadius - kOuterThickness;
    std::vector<double> roller_radii;
    double shaft_radius = bore - (size.roller_rows - 1) * kInnerThickness;
    for (int k = 0; k < size.roller_rows; ++k) {
      roller_radii.push_back(random_.Uniform(size.radius));
      shaft_radius -= 2 * roller_radii.back();
    }
    const int ring = Add("outer ring", MakeRing(middle, kOuterRadius, bore, kDensity));
    rings_.push_back(ring);
    ++count_;
    if (column > 0) {
      Touch(ring, rings_[rings_.size() - 2]);
    } else {
      Touch(ring, frame_, StraightEdge{{}, {0, 1}});
    }
    if (count_ > columns_) {
      Touch(ring, rings_[rings_.size() - 1 - static_cast<std::size_t>(columns_)]);
    } else {
      Touch(ring, frame_, Floor());
    }

    if (left_ < 2) return;
    Races races{middle, -1, -1, shaft_radius, 0, 0};
    races.inner = Add("shaft", MakeDisc(middle, shaft_radius, kDensity));
    for (int k = 0; k < size.roller_rows; ++k) {
      const bool last = k + 1 == size.roller_rows;
      races.outer_radius = last ? bore : races.inner_radius + 2 * roller_radii[static_cast<std::size_t>(k)];
      const double rim_radius = races.outer_radius + kInnerThickness;
      races.outer = last ? ring : Add("ring", MakeRing(middle, rim_radius, races.outer_radius, kDensity));
      const double speed = std::sqrt(random_.Uniform(0.1, 1) * kCentripetal * kGravity / races.pitch_radius());
      races.orbit = random_.Sign() * speed;
      FillRow(races);
      races.inner = races.outer;
      races.inner_radius = rim_radius;
    }
  }

  /// Load rollers and spacers by turns, as many as the circle and the rows left allow.
  void FillRow(const Races& races) {
    constexpr double kSlack = 0.3;  // free between the last and the first, over the load rollers' radius
    const double r = races.roller_radius();
    Vec2 direction = RandomDirection();
    const Vec2 first = races.pitch_radius() * direction;
    Roller previous;
    bool past_half = false;
    for (int k = 0; left_ >= (k > 0 && k % 2 == 0 ? 3 : 2); ++k) {
      Roller next{-1, r, races.pitch_radius()};
      bool on_inner = true;
      if (k % 2 == 1) {
        next.radius = r * random_.Uniform(kSpacer);
        on_inner = random_.Uniform() < 0.5;
        next.distance = on_inner ? races.inner_radius + next.radius : races.outer_radius - next.radius;
      }
      if (k > 0) {
        direction = NextDirection(direction, previous, next);
        const Vec2 x = next.distance * direction;
        past_half = past_half || Cross(first, x) < 0;
        const bool full_turn = past_half && Cross(first, x) >= 0;
        if (full_turn || (past_half && Norm(x - first) < next.radius + (1 + kSlack) * r)) break;
      }
      next.body = AddRoller(races, next.distance * direction, next.radius);
      if (k % 2 == 0 || on_inner) Touch(next.body, races.inner);
      if (k % 2 == 0 || !on_inner) Touch(next.body, races.outer, Piece(races.outer, 1));
      if (k > 0) Touch(next.body, previous.body);
      previous = next;
    }
  }

  /// From one roller's direction to that of the next, which touches it: a load roller and a spacer have centres whose
  /// distances from the middle differ by as much as their radii, so that the triangle with sides a, b and r1 + r2 has
  /// sin^2(angle / 2) = ((r1 + r2)^2 - (a - b)^2) / (4 a b) = r1 r2 / (a b).
  static Vec2 NextDirection(Vec2 direction, const Roller& previous, const Roller& next) {
    const double square = previous.radius * next.radius / (previous.distance * next.distance);
    return Turned(direction, {1 - 2 * square, 2 * std::sqrt(square * (1 - square))});
  }

  int AddRoller(const Races& races, Vec2 from_middle, double radius) {
    Body roller = MakeDisc(races.middle + from_middle, radius, kDensity * random_.Uniform(1, 2));
    roller.v = races.orbit * Perp(from_middle);
    // As if rolling on the inner race at rest; no row depends on it.
    roller.omega = races.orbit * Norm(from_middle) / radius;
    return Add("roller", roller);
  }

  /// One row on top of the last bearing, or on the floor.
  void AddTopDisc() {
    constexpr double kRadius = 0.1;
    const bool alone = rings_.empty();
    const Vec2 x = alone ? Vec2{kOuterRadius, kRadius} : Get(rings_.back()).x + Vec2{0, kOuterRadius + kRadius};
    const int on = alone ? frame_ : rings_.back();
    Touch(Add("disc", MakeDisc(x, kRadius, kDensity)), on, alone ? Feature{Floor()} : Piece(on));
  }

  int frame_ = 0;
  int columns_ = 1;
  int count_ = 0;
  std::vector<int> rings_;  ///< outer ones
};

}  // namespace

extern const SceneFamily kRollerBearing{
    "roller-bearing", "Rollers between concentric races",
    "Convex arcs in concave ones, highly redundant, with rings that touch hundreds of rollers: dense "
    "blocks in A, which tell methods that form A from those that work with J.",
    &Make<Bearings>};

}  // namespace lcpbench
