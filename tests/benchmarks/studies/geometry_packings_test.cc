#include "benchmarks/studies/geometry_packings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "model/contact/assembly.h"
#include "model/detection/detection.h"

namespace lcpbench {
namespace {

ContactSystem Detected(const Packing& packing) {
  return {"", packing.bodies, DetectContacts(packing.bodies, packing.OutlinePointers(), packing.options)};
}

TEST(GeometryPackings, HaveAboutTheWantedNumberOfContacts) {
  for (const PackingFamily& family : AllPackings()) {
    for (const int wanted : {100, 1000, 10000}) {
      const double found = static_cast<double>(Detected(family.make(wanted, 1)).constraints.size());
      // Flush bricks of the wall touch at both ends, and some by chance at a corner: up to a quarter more.
      EXPECT_NEAR(found / wanted, 1, 0.25) << family.key << ", " << wanted;
    }
  }
}

// The perturbation is small against the tolerance, so that none of the bodies that touch is lost. Between the rows of
// the wall a corner may also lie near a neighbour by chance, at any distance.
TEST(GeometryPackings, PerturbedBodiesStayWellWithinTheTolerance) {
  for (const PackingFamily& family : AllPackings()) {
    if (family.key == "disc-pile") continue;  // touches to rounding
    SCOPED_TRACE(family.key);
    const Packing packing = family.make(2000, 3);
    int open = 0;
    int penetrating = 0;
    int far = 0;
    for (const RowInfo& row : AssembleContactLcp(Detected(packing)).rows) {
      EXPECT_LE(std::abs(row.d), packing.options.tolerance);
      far += std::abs(row.d) > 0.5 * packing.options.tolerance ? 1 : 0;
      ++(row.d > 0 ? open : penetrating);
    }
    EXPECT_GT(open, 500);
    EXPECT_GT(penetrating, 500);
    EXPECT_LE(far, family.key == "ellipses" ? 0 : 40);
  }
}

TEST(GeometryPackings, EllipsesTouchAllTheirSixNeighbours) {
  const Packing packing = AllPackings()[1].make(3 * 20 * 20, 1);
  std::vector<std::set<int>> neighbours(packing.bodies.size());
  for (const Constraint& contact : Detected(packing).constraints) {
    neighbours[static_cast<size_t>(contact.body1)].insert(contact.body2);
    neighbours[static_cast<size_t>(contact.body2)].insert(contact.body1);
  }
  ASSERT_EQ(neighbours.size(), 400U);
  for (size_t i = 1; i + 1 < 20; ++i) {
    for (size_t j = 1; j + 1 < 20; ++j) EXPECT_EQ(neighbours[20 * i + j].size(), 6U) << i << ", " << j;
  }
}

TEST(GeometryPackings, AreTheSameForTheSameSeedOnly) {
  for (const PackingFamily& family : AllPackings()) {
    const auto positions = [&](std::uint64_t seed) {
      std::vector<std::pair<double, double>> at;
      for (const Body& body : family.make(200, seed).bodies) at.emplace_back(body.x.x, body.theta);
      return at;
    };
    EXPECT_EQ(positions(1), positions(1)) << family.key;
    EXPECT_NE(positions(1), positions(2)) << family.key;
  }
}

}  // namespace
}  // namespace lcpbench
