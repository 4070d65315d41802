// tall-stacks: stacks of boxes, discs and ovals, heavy on light, many of them with a heavy beam across three.
//
// Contacts are flat (box on box or floor, two rows), round on flat, and round on round (one row); discs and ovals roll
// and slide over one another, so that gamma is nonzero there and depends on curvature. A beam stands on three stacks of
// the same height and overhangs by its own contacts: rank 0.97 of the rows at 1000.
//
// The topmost and heaviest bodies of every second group or stack, the first among them, are pulled upwards, the others
// either way: one that presses down closes its whole stack.
//
// As a sequence: the same velocities under gravity alone; the stacks fall apart.
//
// The last rows go to single stacks without a beam.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr int kMinBodies = 5;  ///< in a leg
constexpr int kMaxBodies = 12;
constexpr int kLegs = 3;
/// More rows than any group of legs with their beam has.
constexpr int kGroupRows = 2 * kLegs * (kMaxBodies + 1);
/// Height over number of bodies of a leg, about.
constexpr double kStorey = 0.16;
constexpr double kMinShare = 0.7;  ///< of a body's height before legs are made equal, over the largest
constexpr double kSpacing = 0.6;   ///< of legs
constexpr double kBeamHeight = 0.2;
constexpr double kLightest = 0.01;  ///< [kg]
constexpr int kMostDecades = 6;     ///< of mass
constexpr double kMaxSpeed = 1;     ///< sideways [m/s]
constexpr double kMaxSpin = 3;      ///< of discs and ovals [rad/s]
constexpr double kWeight = 0.05 * kGravity;

enum class Kind { kBox, kDisc, kOval };

/// How masses are spread over a stack.
enum class Profile { kHeavyTop, kRising, kByTurns };

/// A body of a stack before it has a place.
struct Element {
  Kind kind = Kind::kBox;
  double height = 0;
  double width = 0;
};

double PowerOfTen(int exponent) {
  double power = 1;
  for (int k = 0; k < exponent; ++k) power *= 10;
  return power;
}

/// The top of what has been stacked so far.
struct Top {
  int body = 0;
  Kind kind = Kind::kBox;
  double width = 0;  ///< the floor's is infinite
  double height = 0;
  double y = 0;  ///< of the uppermost point
};

class Stacks final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    floor_ = Add("floor", MakeFixed("floor"));
    int decades = kMostDecades;
    while (left_ > 0) {
      const auto profile = static_cast<Profile>(random_.Integer(3));
      if (left_ >= kGroupRows) {
        AddGroup(profile, decades);
      } else {
        AddSingle(profile, decades);
      }
      decades = 1 + random_.Integer(kMostDecades);
      lift_ = !lift_;
      axis_ += kSpacing;
    }
    Get(floor_).outline = {WholeEdge({axis_, 0}, {-kSpacing, 0})};
  }

  void Load() override {
    ApplyLoads(&system_, {.weight = kWeight, .gust = kGravity}, &random_);
    for (const int heavy : lifted_) Get(heavy).force.y = std::abs(Get(heavy).force.y);
  }

 private:
  /// Three legs of the same height with a beam across.
  void AddGroup(Profile profile, int decades) {
    const int bodies = kMinBodies + random_.Integer(kMaxBodies - kMinBodies + 1);
    const double height = bodies * kStorey;
    const double first = axis_;
    const double mass = kLightest * PowerOfTen(decades);
    std::vector<Top> tops;
    for (int leg = 0; leg < kLegs; ++leg, axis_ += kSpacing) {
      // As many bodies or one less, so that legs differ.
      const int own = bodies - random_.Integer(2);
      std::vector<Element> elements;
      double sum = 0;
      for (int k = 0; k < own; ++k) {
        elements.push_back(NewElement());
        sum += elements.back().height;
      }
      Top top = FloorTop();
      for (int k = 0; k < own; ++k) {
        Element element = Scaled(elements[static_cast<std::size_t>(k)], height / sum);
        top = Put(element, Mass(profile, decades, k, own + 1), mass, top);
      }
      tops.push_back(top);
    }
    axis_ -= kSpacing;
    const double width = axis_ - first + kSpacing / 2;
    const Vec2 x{(first + axis_) / 2, height + kBeamHeight / 2};
    const int beam = Add("beam", MakeBox(x, width, kBeamHeight, mass / (width * kBeamHeight)));
    if (lift_) lifted_.push_back(beam);
    for (const Top& top : tops) {
      if (top.kind == Kind::kBox) {
        for (const int corner : {2, 3}) Touch(beam, BoxEdge(width, kBeamHeight, 0), top.body, Corner(top, corner));
      } else {
        Touch(beam, BoxEdge(width, kBeamHeight, 0), top.body, Round(top));
      }
    }
  }

  /// A stack that ends where the rows do.
  void AddSingle(Profile profile, int decades) {
    const int bodies = std::min(left_, kMinBodies + random_.Integer(kMaxBodies - kMinBodies + 1));
    Top top = FloorTop();
    for (int k = 0; k < bodies && left_ > 0; ++k) {
      Element element = Scaled(NewElement(), kStorey);
      if (left_ == 1 && element.kind == Kind::kBox) element.kind = Kind::kDisc;
      top = Put(element, Mass(profile, decades, k, bodies), kLightest * PowerOfTen(decades), top);
    }
    if (lift_) lifted_.push_back(top.body);
  }

  Element NewElement() {
    Element element;
    const double draw = random_.Uniform();
    element.kind = draw < 0.45 ? Kind::kBox : draw < 0.7 ? Kind::kDisc : Kind::kOval;
    element.height = random_.Uniform(kMinShare, 1);
    element.width = random_.Uniform(0.9, 1.8) * element.height;
    return element;
  }

  static Element Scaled(Element element, double factor) {
    element.height *= factor;
    element.width *= factor;
    return element;
  }

  /// Of body k of `count` from the floor.
  static double Mass(Profile profile, int decades, int k, int count) {
    int exponent = 0;
    switch (profile) {
      case Profile::kHeavyTop:
        exponent = k + 1 == count ? decades : 0;
        break;
      case Profile::kRising:
        exponent = count > 1 ? decades * k / (count - 1) : 0;
        break;
      case Profile::kByTurns:
        exponent = k % 2 == 1 ? decades : 0;
        break;
    }
    return kLightest * PowerOfTen(exponent);
  }

  Top FloorTop() const { return {floor_, Kind::kBox, 1e300, 0, 0}; }

  /// Puts an element on top of a stack. Discs and ovals are upright, so that all normals are vertical and sideways
  /// motion and spin keep every gap.
  Top Put(const Element& element, double mass, double heaviest, const Top& below) {
    const double w = element.kind == Kind::kDisc ? element.height : element.width;
    const double h = element.height;
    const Vec2 x{axis_, below.y + h / 2};
    Body body;
    const char* name = "box";
    if (element.kind == Kind::kBox) {
      body = MakeBox(x, w, h, mass / (w * h));
    } else if (element.kind == Kind::kDisc) {
      name = "disc";
      body = MakeDisc(x, h / 2, 4 * mass / (kPi * h * h));
    } else {
      name = "oval";
      body = MakeOval(x, 0, w / 2, h / 2, 4 * mass / (kPi * w * h));
    }
    body.v = {random_.Uniform(-kMaxSpeed, kMaxSpeed), 0};
    if (element.kind != Kind::kBox) body.omega = random_.Uniform(-kMaxSpin, kMaxSpin);
    const Top top{Add(name, body), element.kind, w, h, below.y + h};
    if (lift_ && mass == heaviest) lifted_.push_back(top.body);
    if (element.kind == Kind::kBox && below.kind == Kind::kBox) {
      // The narrower one's corners on the other's face.
      for (const int side : {0, 1}) {
        if (w < below.width) {
          Touch(top.body, Corner(top, side), below.body, Face(below));
        } else {
          Touch(top.body, BoxEdge(w, h, 0), below.body, Corner(below, 3 - side));
        }
      }
    } else {
      const Feature under = below.kind == Kind::kBox ? Feature{Face(below)} : Round(below);
      Touch(top.body, element.kind == Kind::kBox ? Feature{BoxEdge(w, h, 0)} : Round(top), below.body, under);
    }
    return top;
  }

  static Feature Round(const Top& top) {
    if (top.kind == Kind::kDisc) return Circle(top.height / 2);
    return Oval(top.width / 2, top.height / 2);
  }
  static Vertex Corner(const Top& top, int corner) { return {BoxCorner(top.width, top.height, corner)}; }
  StraightEdge Face(const Top& top) const {
    if (top.body == floor_) return {{1, 0}, {}};
    return BoxEdge(top.width, top.height, 2);
  }

  void Touch(int body1, const Feature& feature1, int body2, const Feature& feature2) {
    SceneBuilder::Touch(body1, feature1, body2, feature2);
    Constraint& contact = system_.constraints.back();
    // Ovals are upright: touched from below at s = -pi/2 and from above at pi/2.
    if (std::holds_alternative<EllipseEdge>(feature1)) contact.s1 = -kPi / 2;
    if (std::holds_alternative<EllipseEdge>(feature2)) contact.s2 = kPi / 2;
  }

  int floor_ = 0;
  double axis_ = 0;   ///< x of the next stack
  bool lift_ = true;  ///< the heaviest bodies of the stacks being built
  std::vector<int> lifted_;
};

}  // namespace

extern const SceneFamily kTallStacks{
    "tall-stacks",
    "Stacks with mass ratios up to a million",
    "Heavy bodies on light ones: forces and the eigenvalues of A spread over as many orders of magnitude, "
    "which tells direct methods from those that sweep locally, and relative from absolute tolerances.",
    &Make<Stacks>,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
