#include "model/scenes/friction/piles.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/scenes/friction/friction_scene.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 10;
constexpr double kCardRadius = 0.02;
constexpr double kCardDensity = 50;

/// Discs of radius 1 / 2 by their rows: places k of row i.
using DiscRows = std::vector<std::vector<int>>;

}  // namespace

ContactSystem Wedges(int wedges, int layers, double alpha, double mu) {
  const auto [cos, sin] = SinCos(alpha);
  const double growth = (1 + sin) / (1 - sin);
  FrictionScene scene;
  double left = 0;
  for (int wedge = 0; wedge < wedges; ++wedge) {
    double reach = 0.5 / sin;  // from the apex to the lowest disc's centre
    double radius = 0.5;
    for (int k = 1; k < layers; ++k) {
      reach += radius * (1 + growth);
      radius *= growth;
    }
    const double top = 1.2 * (reach + radius);
    const double half = top * sin / cos;
    const Vec2 apex{left + half, 0};
    left += 2.2 * half;
    const int walls[] = {
        scene.AddFixed("left wall " + std::to_string(wedge), {WholeEdge(apex, apex + Vec2{-half, top})}),
        scene.AddFixed("right wall " + std::to_string(wedge), {WholeEdge(apex + Vec2{half, top}, apex)})};
    radius = 0.5;
    Vec2 center = apex + Vec2{0, radius / sin};
    int below = -1;
    for (int k = 0; k < layers; ++k) {
      const int disc = scene.Add("disc", MakeDisc(center, radius, kDensity / (growth * radius * radius)));
      for (const int wall : walls) scene.Touch(disc, wall);
      if (below >= 0) scene.Touch(disc, below);
      below = disc;
      center.y += radius * (1 + growth);
      radius *= growth;
    }
  }
  return scene.Finish(mu);
}

ContactSystem ThreeDiscs(double phi, double mu_top, double mu_ground) {
  const auto [cos, sin] = SinCos(phi);
  FrictionScene scene;
  const int floor = scene.AddFloor(-5, 5);
  const int discs[] = {scene.Add("disc", MakeDisc({-sin, 0.5}, 0.5, kDensity)),
                       scene.Add("disc", MakeDisc({sin, 0.5}, 0.5, kDensity)),
                       scene.Add("disc", MakeDisc({0, 0.5 + cos}, 0.5, kDensity))};
  for (const int k : {0, 1}) {
    scene.Touch(discs[k], floor, FrictionScene::Floor());
    scene.Touch(discs[2], discs[k]);
  }
  ContactSystem system = scene.Finish(mu_top);
  for (Constraint& contact : system.constraints) {
    if (contact.body2 == floor) contact.friction = mu_ground;
  }
  return system;
}

ContactSystem Pyramids(int pyramids, int base, double mu) {
  const double rise = std::sqrt(0.75);
  FrictionScene scene;
  const int floor = scene.AddFloor(-base, 2.0 * base * pyramids);
  for (int pyramid = 0; pyramid < pyramids; ++pyramid) {
    DiscRows rows;
    for (int row = 0; row < base; ++row) {
      rows.emplace_back();
      for (int k = 0; k < base - row; ++k) {
        const Vec2 x{2.0 * base * pyramid + k + 0.5 * row, 0.5 + rise * row};
        const int disc = scene.Add("disc", MakeDisc(x, 0.5, kDensity));
        rows.back().push_back(disc);
        const auto place = static_cast<std::size_t>(k);
        if (k > 0) scene.Touch(disc, rows.back()[place - 1]);
        if (row == 0) {
          scene.Touch(disc, floor, FrictionScene::Floor());
          continue;
        }
        const std::vector<int>& below = rows[static_cast<std::size_t>(row) - 1];
        scene.Touch(disc, below[place]);
        scene.Touch(disc, below[place + 1]);
      }
    }
  }
  return scene.Finish(mu);
}

double LeastCardFriction(double angle) {
  // Moments about the foot: weight on half the span, the other card's push at its own height.
  const auto [cos, sin] = SinCos(angle);
  return sin / 2 / (cos + kCardRadius);
}

ContactSystem CardHouse(int levels, double angle, double mu) {
  const auto [cos, sin] = SinCos(angle);
  constexpr double kPlate = 0.04;  // thickness
  const double pitch = 2 * (sin + 3 * kCardRadius);
  const double storey = cos + 2 * kCardRadius;
  FrictionScene scene;
  const int floor = scene.AddFloor(-1, 1 + pitch * levels);
  std::vector<int> grounds(static_cast<std::size_t>(levels), floor);
  double y = 0;
  for (int level = 0; level < levels; ++level) {
    std::vector<int> cards;
    const double first = pitch / 2 * (level + 1);
    for (std::size_t k = 0; k < grounds.size(); ++k) {
      const double x = first + pitch * static_cast<double>(k);
      for (const double side : {-1.0, 1.0}) {
        Body card = MakePlate(Capsule(1, kCardRadius), kCardDensity);
        card.x = {x + side * (kCardRadius + sin / 2), y + kCardRadius + cos / 2};
        // The capsule's end at +x is the upper one.
        card.theta = kPi / 2 + side * angle;
        cards.push_back(scene.Add("card", card));
        const Feature foot = scene.Piece(cards.back(), 3);
        const Feature ground = grounds[k] == floor ? Feature(FrictionScene::Floor()) : scene.Piece(grounds[k], 2);
        scene.Touch(cards.back(), foot, grounds[k], ground);
      }
      const int left = cards[cards.size() - 2];
      scene.Touch(cards.back(), scene.Piece(cards.back(), 1), left, scene.Piece(left, 1));
    }
    y += storey;
    grounds.clear();
    if (level + 1 == levels) break;
    // Plates from tip to tip, each on the right card of one pair and the left card of the next.
    for (std::size_t k = 0; 2 * k + 2 < cards.size(); ++k) {
      const double x = first + pitch * (static_cast<double>(k) + 0.5);
      const Vec2 middle{x, y + kPlate / 2};
      const int plate = scene.Add("plate", MakeBox(middle, pitch - kCardRadius / 2, kPlate, kCardDensity));
      for (const std::size_t card : {2 * k + 1, 2 * k + 2}) {
        scene.Touch(plate, scene.Piece(plate, 0), cards[card], scene.Piece(cards[card], 1));
      }
      grounds.push_back(plate);
    }
    y += kPlate;
  }
  return scene.Finish(mu);
}

ContactSystem Arches(int arches, int stones, double inner, double mu) {
  FrictionScene scene;
  const int floor = scene.AddFloor(-2, 3.0 * arches);
  for (int arch = 0; arch < arches; ++arch) {
    const Vec2 center{3.0 * arch, 0};
    int previous = floor;
    for (int k = 0; k < stones; ++k) {
      const double begin = kPi * k / stones;
      const double end = kPi * (k + 1) / stones;
      const Vec2 from = Direction(begin);
      const Vec2 to = k + 1 < stones ? Direction(end) : Vec2{-1, 0};
      // From the joint's inner corner outwards, along the back, and inwards along the next joint.
      Body stone = MakePlate({"",
                              {{WholeEdge(inner * from, from),
                                {ArcEdge{{}, 1, Side::kConvex}, begin, end},
                                WholeEdge(to, inner * to),
                                {ArcEdge{{}, inner, Side::kConcave}, end, begin}}}},
                             kDensity);
      stone.x = stone.x + center;
      const int body = scene.Add("stone", stone);
      const Feature joint = previous == floor ? Feature(FrictionScene::Floor()) : scene.Piece(previous, 2);
      const StraightEdge face = std::get<StraightEdge>(scene.Piece(body, 0));
      for (const Vec2 corner : {face.a, face.b}) scene.Touch(body, Vertex{corner}, previous, joint);
      previous = body;
    }
    const StraightEdge last = std::get<StraightEdge>(scene.Piece(previous, 2));
    for (const Vec2 corner : {last.a, last.b}) scene.Touch(previous, Vertex{corner}, floor, FrictionScene::Floor());
  }
  return scene.Finish(mu);
}

namespace {

constexpr int kRows = 2;  ///< of a contact

// Random velocities, which a step meets beside the weights.
void StirBodies(double speed, Random* random, ContactSystem* system) {
  for (Body& body : system->bodies) {
    if (body.fixed) continue;
    body.v = speed * random->InUnitDisc();
    body.omega = speed * random->Uniform(-1, 1) / std::sqrt(body.inertia / body.mass);
  }
}

ContactSystem DrawWedges(int rows, Random* random) {
  constexpr int kMostLayers = 6;
  const int layers = std::clamp((rows / kRows + 1) / 3, 1, kMostLayers);
  const double alpha = random->Uniform(0.1, 0.5);
  const double mu = random->Uniform(0.5, 2) * SinCos(alpha).sin / SinCos(alpha).cos;
  ContactSystem system = Wedges(std::max(1, rows / (kRows * (3 * layers - 1))), layers, alpha, mu);
  StirBodies(0.3, random, &system);
  return system;
}

ContactSystem DrawThreeDiscs(int /*rows*/, Random* random) {
  const double phi = random->Uniform(kPi / 6, 1.3);
  const double least = SinCos(phi / 2).sin / SinCos(phi / 2).cos;
  const double top = random->Uniform(0.7, 1.5) * least;
  const double ground = random->Uniform(0.7, 1.5) * least / 3;
  return ThreeDiscs(phi, top, ground);
}

// A pyramid of k discs at its base has 3 k (k - 1) / 2 + k contacts.
ContactSystem DrawPyramids(int rows, Random* random) {
  constexpr int kMostBase = 12;
  const auto contacts = [](int base) { return 3 * base * (base - 1) / 2 + base; };
  int base = 2;
  while (base < kMostBase && kRows * contacts(base + 1) <= rows) ++base;
  return Pyramids(std::max(1, rows / (kRows * contacts(base))), base, random->Uniform(0.2, 0.7));
}

// `levels` storeys have 3 contacts a pair, and 2 a plate.
ContactSystem DrawCardHouse(int rows, Random* random) {
  const auto contacts = [](int levels) { return 3 * levels * (levels + 1) / 2 + levels * (levels - 1); };
  int levels = 1;
  while (kRows * contacts(levels + 1) <= rows) ++levels;
  const double angle = random->Uniform(0.15, 0.5);
  const double mu = random->Uniform(0.8, 3) * LeastCardFriction(angle);
  return CardHouse(levels, angle, mu);
}

ContactSystem DrawArches(int rows, Random* random) {
  constexpr int kMostStones = 31;
  const int stones = std::clamp(rows / (2 * kRows) - 1, 5, kMostStones);
  const double inner = random->Uniform(0.6, 0.98);
  return Arches(std::max(1, rows / (2 * kRows * (stones + 1))), stones, inner, random->Uniform(0.2, 0.8));
}

// Half as many rows of the family without friction, thrown about.
ContactSystem DrawDrum(int rows, Random* random) {
  const double mu = random->Uniform(0.1, 1);
  ContactSystem system = GenerateScene("spinning-drum", std::max(1, rows / kRows), random->Bits());
  for (Body& body : system.bodies) body.friction = mu;
  for (Constraint& contact : system.constraints) contact.friction = mu;
  StirBodies(3, random, &system);
  return system;
}

// In motion weights alone act, and the drum turns at constant speed, as in the family without friction.
class DrumScene final : public DrawnScene<&DrawDrum> {
 public:
  using DrawnScene::DrawnScene;

  void Launch(World* world) override {
    for (Body& body : world->bodies) body.alpha = 0;
  }
};

}  // namespace

extern const SceneFamily kWedgeJam{
    "wedge-jam",
    "Discs that jam between two walls",
    "Forces in the friction cones that balance without a load: unbounded solutions beside bounded ones.",
    &Make<DrawnScene<&DrawWedges>>,
    MotionLevel::kVelocity,
    kFrictionStep};
extern const SceneFamily kThreeDiscs{
    "three-discs",
    "A disc on two others",
    "The smallest pile that friction holds; two thresholds, of contacts between discs and at the ground.",
    &Make<DrawnScene<&DrawThreeDiscs>>,
    MotionLevel::kVelocity,
    kFrictionStep};
extern const SceneFamily kPyramids{"pyramids",
                                   "Triangles of equal discs",
                                   "Redundant contacts whose friction decides whether a pile stands.",
                                   &Make<DrawnScene<&DrawPyramids>>,
                                   MotionLevel::kVelocity,
                                   kFrictionStep};
extern const SceneFamily kCardHouse{"card-house",
                                    "Houses of leaning cards and plates",
                                    "Long chains of contacts near their friction limits.",
                                    &Make<DrawnScene<&DrawCardHouse>>,
                                    MotionLevel::kVelocity,
                                    kFrictionStep};
extern const SceneFamily kVoussoirArch{"voussoir-arch",
                                       "Half-circle arches of stones",
                                       "Redundant contacts that all stick, or hinges where the arch is thin.",
                                       &Make<DrawnScene<&DrawArches>>,
                                       MotionLevel::kVelocity,
                                       kFrictionStep};
extern const SceneFamily kDrum{"drum",
                               "Balls and ovals thrown about in a turning drum",
                               "Fast slip of both signs and impacts at once.",
                               &Make<DrumScene>,
                               MotionLevel::kVelocity,
                               kFrictionStep};

}  // namespace lcpbench
