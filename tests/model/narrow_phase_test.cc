#include "model/narrow_phase.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>
#include <tuple>

#include "solvers/lcp/input_error.h"
#include "tests/model/gap_sampling.h"
#include "tests/model/random_contacts.h"
#include "tests/model/random_outlines.h"

namespace lcpbench {
namespace {

using namespace testing;

// A few hundred configurations per pair of kinds by default; the long comparison takes LCPBENCH_DETECTION_CASES=10000.
int CasesPerPair() {
  const char* cases = std::getenv("LCPBENCH_DETECTION_CASES");
  return cases != nullptr ? std::atoi(cases) : 200;
}

struct Tally {
  int configurations = 0;
  int overlapping = 0;  // left out
  int minima = 0;
  int at_vertices = 0;
  int unconfirmed = 0;  // detected, not sampled, but confirmed as minima by a descent from nearby
  int undecided = 0;    // descents that did not converge
  double worst_gap = 0;
};

// Two outlines that keep apart: one beside the other, or one inside the other's boundary.
struct Configuration {
  Outline outline1;
  Outline outline2;
  Pose pose1;
  Pose pose2;
  double reach = 0;
};

constexpr int kSamplesOfLoop = 320;

SampledLoop Sampled(const Outline& outline, const Pose& pose) {
  const OutlineLoop& loop = outline.loops[0];
  return {loop, pose, kSamplesOfLoop / static_cast<int>(loop.size())};
}

// Moves body 2 along a direction until the outlines are `gap` apart: never by more than the distance that is left.
void Approach(Configuration* c, Vec2 direction, double gap) {
  const SampledLoop loop1 = Sampled(c->outline1, c->pose1);
  SampledLoop loop2 = Sampled(c->outline2, c->pose2);
  constexpr int kMostMoves = 200;
  for (int i = 0; i < kMostMoves; ++i) {
    const double left = SmallestDistance(loop1, loop2) - gap;
    if (left < 0.1 * gap) break;
    loop2.Move(left * direction);
  }
  c->pose2 = loop2.pose();
}

Configuration RandomConfiguration(EdgeKind kind1, EdgeKind kind2, bool inside, Random* random) {
  Configuration c;
  c.outline1 = {"first", {RandomLoopOfKind(kind1, inside ? 2.0 : 1.0, !inside, random)}};
  c.outline2 = {"second", {RandomLoopOfKind(kind2, inside ? random->Uniform(0.2, 0.6) : 1.0, true, random)}};
  c.pose1 = {random->Vector(3), random->Uniform(-3, 3)};
  const Rotation u = SinCos(random->Uniform(-3.14, 3.14));
  const Vec2 direction{u.cos, u.sin};
  c.pose2 = {c.pose1.x - (inside ? 0.0 : 4.0) * direction, random->Uniform(-3, 3)};
  const double gap = 0.02 * random->Uniform(0.2, 1);
  c.reach = random->Uniform(0.02, 0.4);
  Approach(&c, direction, gap);
  return c;
}

class Comparison {
 public:
  Comparison(const Configuration& c, std::string name)
      : c_(c), name_(std::move(name)), loop1_(Sampled(c.outline1, c.pose1)), loop2_(Sampled(c.outline2, c.pose2)) {}

  void Run(Tally* tally) {
    const PlacedOutline placed1 = PlaceOutline(c_.outline1, c_.pose1.x, c_.pose1.theta);
    const PlacedOutline placed2 = PlaceOutline(c_.outline2, c_.pose2.x, c_.pose2.theta);
    std::vector<GapMinimum> detected;
    try {
      detected = FindGapMinima(placed1, placed2, {c_.reach, 0});
    } catch (const InputError& error) {
      ADD_FAILURE() << name_ << ": " << error.what();
      return;
    }
    const std::vector<SampledMinimum> sampled = SampledMinima(loop1_, loop2_, c_.reach, &tally->undecided);
    ++tally->configurations;
    // Sharp bends between samples can have let the outlines overlap, where distances are no gaps.
    constexpr double kOverlap = 1e-9;
    if (std::any_of(sampled.begin(), sampled.end(), [](const SampledMinimum& m) { return m.d < kOverlap; })) {
      ++tally->overlapping;
      return;
    }
    std::vector<bool> used(detected.size(), false);
    for (const SampledMinimum& m : sampled) {
      if (m.at_vertex1 && m.at_vertex2) continue;
      // On the edge of the range rounding decides.
      if (m.d > c_.reach * (1 - 1e-9)) continue;
      ++tally->minima;
      if (m.at_vertex1 || m.at_vertex2) ++tally->at_vertices;
      bool found = false;
      for (std::size_t k = 0; k < detected.size(); ++k) {
        const ClosestPoints& closest = detected[k].closest;
        if (!IsSame(m, c_.pose1.x + closest.R1, c_.pose2.x + closest.R2, kSamePlace)) continue;
        EXPECT_FALSE(found) << name_ << ": reported twice";
        found = true;
        used[k] = true;
        tally->worst_gap = std::max(tally->worst_gap, std::abs(closest.d - m.d));
        EXPECT_LE(std::abs(closest.d - m.d), 1e-9) << name_;
      }
      EXPECT_TRUE(found) << name_ << ": missed d = " << m.d << " at (" << m.p1.x << ", " << m.p1.y << "), vertices "
                         << m.at_vertex1 << m.at_vertex2 << ", reach " << c_.reach;
    }
    for (std::size_t k = 0; k < detected.size(); ++k) {
      if (used[k] || detected[k].closest.d > c_.reach * (1 - 1e-9)) continue;
      ++tally->unconfirmed;
      EXPECT_TRUE(IsMinimum(detected[k].closest))
          << name_ << ": spurious d = " << detected[k].closest.d << ", D = " << detected[k].closest.D();
    }
  }

 private:
  static constexpr double kSamePlace = 1e-5;

  // Whether descents from the samples around a point lead back to it.
  bool IsMinimum(const ClosestPoints& c) const {
    const Vec2 p1 = c_.pose1.x + c.R1;
    const Vec2 p2 = c_.pose2.x + c.R2;
    const auto nearest = [](const SampledLoop& loop, Vec2 p) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < loop.size(); ++i) {
        if (Norm(loop.points()[i] - p) < Norm(loop.points()[best] - p)) best = i;
      }
      return best;
    };
    const std::size_t i = nearest(loop1_, p1);
    const std::size_t j = nearest(loop2_, p2);
    Descent descent(loop1_, loop2_);
    for (const std::size_t di : {0u, 1u, static_cast<unsigned>(loop1_.size()) - 1}) {
      for (const std::size_t dj : {0u, 1u, static_cast<unsigned>(loop2_.size()) - 1}) {
        const auto found = descent.Run(loop1_.place((i + di) % loop1_.size()), loop2_.place((j + dj) % loop2_.size()));
        if (found && IsSame(*found, p1, p2, kSamePlace)) return true;
      }
    }
    return false;
  }

  const Configuration& c_;
  std::string name_;
  SampledLoop loop1_;
  SampledLoop loop2_;
};

const char* NameOf(EdgeKind kind) {
  constexpr const char* kNames[] = {"Straight", "Arc", "Ellipse", "Superellipse", "Bezier"};
  return kNames[static_cast<int>(kind)];
}

using Kinds = std::tuple<int, int, bool>;

class NarrowPhase : public ::testing::TestWithParam<Kinds> {};

TEST_P(NarrowPhase, FindsTheMinimaThatDenseSamplingFinds) {
  const auto [first, second, inside] = GetParam();
  const auto kind1 = static_cast<EdgeKind>(first);
  const auto kind2 = static_cast<EdgeKind>(second);
  Random random(1000 + static_cast<unsigned>(100 * first + 10 * second + (inside ? 1 : 0)));
  Tally tally;
  const int cases = CasesPerPair();
  for (int k = 0; k < cases; ++k) {
    const Configuration c = RandomConfiguration(kind1, kind2, inside, &random);
    Comparison(c, "case " + std::to_string(k)).Run(&tally);
  }
  EXPECT_EQ(tally.configurations, cases);
  EXPECT_LE(tally.overlapping, 1 + cases / 100);
  EXPECT_GE(tally.minima, cases / 4);
  RecordProperty("minima", tally.minima);
  std::cout << NameOf(kind1) << (inside ? " around " : " beside ") << NameOf(kind2) << ": " << tally.configurations
            << " configurations (" << tally.overlapping << " overlapping), " << tally.minima << " minima, "
            << tally.at_vertices << " of them at vertices, " << tally.unconfirmed << " confirmed by descent only, "
            << tally.undecided << " descents undecided, gaps within " << tally.worst_gap << " m\n";
}

std::string CaseName(const ::testing::TestParamInfo<Kinds>& info) {
  const auto [first, second, inside] = info.param;
  return std::string(NameOf(static_cast<EdgeKind>(first))) + (inside ? "Around" : "Beside") +
         NameOf(static_cast<EdgeKind>(second));
}

INSTANTIATE_TEST_SUITE_P(AllKinds, NarrowPhase,
                         ::testing::Combine(::testing::Range(0, kEdgeKinds), ::testing::Range(0, kEdgeKinds),
                                            ::testing::Bool()),
                         CaseName);

}  // namespace
}  // namespace lcpbench
