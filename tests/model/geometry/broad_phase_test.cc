#include "model/geometry/broad_phase.h"

#include "tests/model/shape/random_outlines.h"

namespace lcpbench::testing {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Pairs BruteForce(const std::vector<BoundingBox>& boxes) {
  Pairs pairs;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      if (Overlap(boxes[i], boxes[j])) pairs.emplace_back(static_cast<int>(i), static_cast<int>(j));
    }
  }
  return pairs;
}

BoundingBox BoxAt(Vec2 lower, double width, double height) { return {lower, {lower.x + width, lower.y + height}}; }

// Boxes of many kinds of distributions: spread, crowded, in a row, on a lattice (touching), slivers, sizes over many
// orders of magnitude, with or without huge ones.
std::vector<BoundingBox> RandomBoxes(Random* random) {
  const int count = RandomInteger(80, random);
  const int kind = RandomInteger(7, random);
  const double spread = std::pow(10, random->Uniform(-1, 2));
  std::vector<BoundingBox> boxes;
  for (int k = 0; k < count; ++k) {
    Vec2 lower = random->Vector(spread);
    double width = random->Uniform(0, 2);
    double height = random->Uniform(0, 2);
    if (kind == 1) lower.y *= 1e-3;
    if (kind == 2) lower.x *= 1e-3;
    if (kind == 3) {
      lower = {std::floor(lower.x), std::floor(lower.y)};
      width = 1;
      height = 1;
    }
    if (kind == 4) {
      width *= random->Uniform(0, 1) < 0.5 ? 1e-3 : 10;
      height *= random->Uniform(0, 1) < 0.5 ? 1e-3 : 10;
    }
    if (kind == 5) {
      width *= std::pow(10, random->Uniform(-4, 4));
      height *= std::pow(10, random->Uniform(-4, 4));
    }
    if (kind == 6) width = height = 0;
    boxes.push_back(BoxAt(lower, width, height));
  }
  const int huge = RandomInteger(3, random);
  for (int k = 0; k < huge; ++k) {
    boxes.push_back(BoxAt({-1e3, -1e3}, 2e3, random->Uniform(1, 2e3)));
    if (k == 1) boxes.back() = BoxAt({-1e300, -1e300}, 1.5e300, 1.7e300);
  }
  return boxes;
}

TEST(BroadPhase, FindsThePairsOfBruteForceInTheirOrder) {
  Random random(1);
  for (int k = 0; k < 5000; ++k) {
    SCOPED_TRACE(k);
    const std::vector<BoundingBox> boxes = RandomBoxes(&random);
    ASSERT_EQ(FindOverlappingPairs(boxes), BruteForce(boxes));
  }
}

TEST(BroadPhase, ManyBoxesOnAFloorAreNoMoreThanTheirPairs) {
  // Untimed: an algorithm of n^2 comparisons would take minutes here.
  Random random(4);
  const int count = 100000;
  std::vector<BoundingBox> boxes = {BoxAt({-1e3, -1e3}, 2e3, 2e3)};
  for (int k = 0; k < count; ++k) boxes.push_back(BoxAt(random.Vector(300), 1, 1));
  const Pairs pairs = FindOverlappingPairs(boxes);
  for (int k = 0; k < count; ++k) EXPECT_EQ(pairs[static_cast<std::size_t>(k)], std::pair(0, k + 1));
}

TEST(BroadPhase, RefusesBoxesThatAreNone) {
  for (const BoundingBox& bad : {BoundingBox{{0, kNaN}, {1, 1}}, BoundingBox{{0, 0}, {kInfinity, 1}},
                                 BoundingBox{{0, 2}, {1, 1}}, BoundingBox{{2, 0}, {1, 1}}}) {
    const std::vector<BoundingBox> boxes = {BoxAt({0, 0}, 1, 1), bad};
    EXPECT_THROW(FindOverlappingPairs(boxes), InputError);
  }
}

}  // namespace
}  // namespace lcpbench::testing
