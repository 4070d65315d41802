#include "benchmarks/studies/geometry_packings.h"

#include <array>
#include <cmath>
#include <utility>

#include "model/geometry/trig.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "model/shape/mass_properties.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

// Of bodies about 1 m large. The greatest gap that a perturbation opens is a few times kPerturbation.
constexpr DetectionOptions kTolerance = {.tolerance = 1e-3, .penetration = 1e-3};
constexpr double kPerturbation = 1e-4;  // [m] and [rad]
constexpr double kDensity = 100;        // [kg/m^2]

// A movable body and its outline, both in the body frame.
struct Part {
  Body body;
  Outline outline;
};

Part MakePart(const Outline& outline) { return {MakeBody(outline, kDensity), Centered(outline)}; }

// Adds the part at about that place, moving and loaded at random.
void Place(const Part& part, Vec2 x, double theta, Random* random, Packing* packing) {
  Body body = part.body;
  const Vec2 shift = random->InUnitDisc();
  body.x = x + kPerturbation * shift;
  body.theta = theta + kPerturbation * random->Uniform(-1, 1);
  body.v = random->InUnitDisc();
  body.omega = random->Uniform(-1, 1);
  body.force = body.mass * random->InUnitDisc();
  body.torque = body.inertia * random->Uniform(-1, 1);
  packing->bodies.push_back(std::move(body));
  packing->outlines.push_back(part.outline);
}

Packing MakeDiscPile(int contacts, std::uint64_t seed) {
  // Pairs that do not touch are 6e-8 m apart at least, those that do are so to rounding.
  constexpr DetectionOptions kExact = {.tolerance = 1e-9, .penetration = 1e-9};
  Packing packing;
  packing.bodies = GenerateScene("disc-pile", contacts, seed).bodies;
  for (const Body& body : packing.bodies) packing.outlines.push_back(OutlineOf(body));
  packing.options = kExact;
  return packing;
}

Packing MakeEllipses(int contacts, std::uint64_t seed) {
  constexpr double kContactsPerBody = 3;
  constexpr double kA = 0.8;
  constexpr double kB = 0.5;
  // The discs' lattice turned before it is stretched, and the ellipses after: contacts lie nowhere in particular.
  constexpr double kLatticeTurn = 0.2;
  constexpr double kEllipseTurn = 0.7;
  const Rotation before = SinCos(kLatticeTurn);
  const Rotation after = SinCos(kEllipseTurn);
  const auto stretched = [&](Vec2 c) {
    const Vec2 turned = Rotate(before, c);
    return Rotate(after, {kA * turned.x, kB * turned.y});
  };
  const double row_height = std::sqrt(3.0);
  const int columns = static_cast<int>(std::ceil(std::sqrt(contacts / kContactsPerBody)));
  const int rows = columns;
  const Part part = MakePart(Ellipse(kA, kB));
  Random random(seed);
  Packing packing;
  packing.options = kTolerance;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Vec2 c{2.0 * j + i % 2, row_height * i};
      Place(part, stretched(c), kEllipseTurn, &random, &packing);
    }
  }
  return packing;
}

struct WallPart {
  Part part;
  double width = 1;
};

// Bodies 1 m high, a quarter of each kind: their highest and lowest points lie on the lines of their row, and their
// leftmost and rightmost ones half-way.
std::vector<WallPart> MakeWallParts() {
  constexpr int kWidths = 8;
  std::vector<WallPart> parts;
  for (int k = 1; k <= kWidths; ++k) {
    const double width = 1 + 0.11 * k;
    const double corner_radius = 0.05 * k;
    parts.push_back({MakePart(Disc(0.5)), 1});
    parts.push_back({MakePart(RoundedBox(width, 1, corner_radius)), width});
    parts.push_back({MakePart(Capsule(width - 1, 0.5)), width});
    parts.push_back({MakePart(Ellipse(width / 2, 0.5)), width});
  }
  return parts;
}

Packing MakeMixedWall(int contacts, std::uint64_t seed) {
  constexpr double kContactsPerBody = 1.6;  // measured
  constexpr double kMeanWidth = 1.37;
  const int bodies = static_cast<int>(contacts / kContactsPerBody);
  const double wall_width = std::sqrt(kMeanWidth * bodies);
  const std::vector<WallPart> parts = MakeWallParts();
  Random random(seed);
  Packing packing;
  packing.options = kTolerance;
  Vec2 at;
  for (int i = 0; i < bodies; ++i) {
    const WallPart& next = parts[static_cast<size_t>(random.Integer(static_cast<int>(parts.size())))];
    const double half_turn = random.Sign() > 0 ? 0 : kPi;
    Place(next.part, {at.x + next.width / 2, at.y}, half_turn, &random, &packing);
    at.x += next.width;
    if (at.x > wall_width) at = {0, at.y + 1};
  }
  return packing;
}

constexpr std::array kPackings = {
    PackingFamily{"disc-pile", MakeDiscPile},
    PackingFamily{"ellipses", MakeEllipses},
    PackingFamily{"mixed-wall", MakeMixedWall},
};

}  // namespace

std::vector<const Outline*> Packing::OutlinePointers() const {
  std::vector<const Outline*> pointers;
  pointers.reserve(outlines.size());
  for (const Outline& outline : outlines) pointers.push_back(&outline);
  return pointers;
}

std::span<const PackingFamily> AllPackings() { return kPackings; }

}  // namespace lcpbench
