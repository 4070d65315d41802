// tall-stacks: stacks of boxes, discs and ovals, heavy on light, many of them with a heavy beam across three.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr int kMinBodies = 5;  ///< in a leg
constexpr int kMaxBodies = 12;
constexpr int kLegs = 3;
constexpr int kGroupRows = 2 * kLegs * (kMaxBodies + 1);  ///< more rows than any group of legs with their beam has
constexpr double kStorey = 0.16;                          ///< height over number of bodies of a leg, about
constexpr double kMinShare = 0.7;  ///< of a body's height before legs are made equal, over the largest
constexpr double kSpacing = 0.6;   ///< of legs
constexpr double kBeamHeight = 0.2;
constexpr double kLightest = 0.01;  ///< [kg]
constexpr int kMostDecades = 6;     ///< of mass
constexpr double kMaxSpeed = 1;     ///< sideways [m/s]
constexpr double kMaxSpin = 3;      ///< of discs and ovals [rad/s]
constexpr double kWeight = 0.05 * kGravity;

enum class Kind { kBox, kDisc, kOval };

/// A body of a stack before it has a place.
struct Element {
  Kind kind = Kind::kBox;
  double height = 0;
  double width = 0;
};

/// How masses are spread over a stack.
enum class Profile { kHeavyTop, kRising, kByTurns };

/// The masses of a stack: the lightest and, at most, ten to the power `decades` times it.
struct Masses {
  Profile profile;
  int decades;

  static double PowersUp(int exponent) {
    double power = 1;
    for (int k = 0; k < exponent; ++k) power *= 10;
    return kLightest * power;
  }
  double Heaviest() const { return PowersUp(decades); }
  /// Mass of body k of `count` from the floor.
  double Of(int k, int count) const {
    if (profile == Profile::kHeavyTop) return PowersUp(k + 1 == count ? decades : 0);
    if (profile == Profile::kRising) return PowersUp(count > 1 ? decades * k / (count - 1) : 0);
    return PowersUp(k % 2 == 1 ? decades : 0);
  }
};

/// The top of what has been stacked so far.
struct Top {
  int body = 0;
  Feature face;      ///< what the next body touches; a straight edge from the right to the left
  double width = 0;  ///< the floor's is infinite
  double y = 0;      ///< of the uppermost point
};

class Stacks final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    floor_ = AddFixed("floor");
    int decades = kMostDecades;
    while (left_ > 0) {
      const Masses masses{static_cast<Profile>(random_.Integer(3)), decades};
      if (left_ >= kGroupRows) {
        AddGroup(masses);
      } else {
        AddSingle(masses);
      }
      decades = random_.Integer(1, kMostDecades);
      lift_ = !lift_;
      axis_ += kSpacing;
    }
    Get(floor_).outline = {WholeEdge({axis_, 0}, {-kSpacing, 0})};
  }

  void Load() override {
    Apply({.weight = kWeight, .gust = kGravity});
    for (const int heavy : lifted_) Get(heavy).force.y = std::abs(Get(heavy).force.y);
  }

 private:
  /// Three legs of the same height with a beam across.
  void AddGroup(const Masses& masses) {
    const int bodies = random_.Integer(kMinBodies, kMaxBodies);
    const double height = bodies * kStorey;
    const double first = axis_;
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
        top = Put(Scaled(elements[static_cast<std::size_t>(k)], height / sum), masses, masses.Of(k, own + 1), top);
      }
      tops.push_back(top);
    }
    axis_ -= kSpacing;
    const double width = axis_ - first + kSpacing / 2;
    const Vec2 x{(first + axis_) / 2, height + kBeamHeight / 2};
    const int beam = Add("beam", MakeBox(x, width, kBeamHeight, masses.Heaviest() / (width * kBeamHeight)));
    if (lift_) lifted_.push_back(beam);
    for (const Top& top : tops) {
      if (const auto* face = std::get_if<StraightEdge>(&top.face)) {
        for (const Vec2 corner : {face->a, face->b}) Touch(beam, top.body, Vertex{corner});
      } else {
        TouchAbove(beam, top);
      }
    }
  }

  /// A stack that ends where the rows do.
  void AddSingle(const Masses& masses) {
    const int bodies = std::min(left_, random_.Integer(kMinBodies, kMaxBodies));
    Top top = FloorTop();
    for (int k = 0; k < bodies && left_ > 0; ++k) {
      Element element = Scaled(NewElement(), kStorey);
      if (left_ == 1 && element.kind == Kind::kBox) element.kind = Kind::kDisc;
      top = Put(element, masses, masses.Of(k, bodies), top);
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

  static Element Scaled(const Element& element, double factor) {
    return {element.kind, element.height * factor, element.width * factor};
  }

  Top FloorTop() const { return {floor_, Floor(), 1e300, 0}; }

  /// Puts an element on top of a stack. Discs and ovals are upright, so that all normals are vertical and sideways
  /// motion and spin keep every gap.
  Top Put(const Element& element, const Masses& masses, double mass, const Top& below) {
    const double w = element.kind == Kind::kDisc ? element.height : element.width;
    const double h = element.height;
    const Vec2 x{axis_, below.y + h / 2};
    const char* name = "box";
    Body body;
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
    const int put = Add(name, body);
    if (lift_ && mass == masses.Heaviest()) lifted_.push_back(put);
    const auto* face = std::get_if<StraightEdge>(&below.face);
    if (element.kind != Kind::kBox || face == nullptr) {
      TouchAbove(put, below);
    } else if (w < below.width) {
      // The narrower one's corners on the other's face.
      Stand(put, below.body, below.face);
    } else {
      for (const Vec2 corner : {face->b, face->a}) Touch(put, below.body, Vertex{corner});
    }
    return {put, Piece(put, element.kind == Kind::kBox ? 2 : 0), w, below.y + h};
  }

  /// Ovals are upright: touched from below at s = -pi/2 and from above at pi/2.
  void TouchAbove(int body, const Top& below) {
    Constraint& contact = Touch(body, below.body, below.face);
    if (std::holds_alternative<EllipseEdge>(contact.feature1)) contact.s1 = -kPi / 2;
    if (std::holds_alternative<EllipseEdge>(contact.feature2)) contact.s2 = kPi / 2;
  }

  int floor_ = 0;
  double axis_ = 0;   ///< x of the next stack
  bool lift_ = true;  ///< the heaviest bodies of the stacks being built
  std::vector<int> lifted_;
};

}  // namespace

extern const SceneFamily kTallStacks{
    "tall-stacks", "Stacks with mass ratios up to a million",
    "Heavy bodies on light ones: forces and the eigenvalues of A spread over as many orders of magnitude, "
    "which tells direct methods from those that sweep locally, and relative from absolute tolerances.",
    &Make<Stacks>};

}  // namespace lcpbench
