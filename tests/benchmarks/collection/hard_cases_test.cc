// What is said of hard cases holds exactly, by rational arithmetic.

#include "benchmarks/collection/recipes/hard_cases.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "benchmarks/collection/recipes/recipe.h"
#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/sparse_rank.h"

namespace lcpbench {
namespace {

ExactAnswer Exactly(const char* key, int rows, std::uint64_t seed) {
  const ExactLcp problem = ExactFrom(MakeInstance({key, rows, seed, {}}).problem);
  ExactAnswer answer = SolveExactly(problem, {});
  EXPECT_EQ(FindFault(problem, answer), "") << key << " " << rows;
  return answer;
}

TEST(HardCases, SqueezedRowsHaveTheRayOfOnes) {
  for (const char* key : {"squeezed-row", "barely-squeezed-row"}) {
    for (const int rows : {2, 3, 8, 31}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const ExactAnswer answer = Exactly(key, rows, seed);
        ASSERT_EQ(answer.status, ExactAnswer::Status::kInfeasible) << key << " " << rows;
        ASSERT_EQ(answer.ray.size(), static_cast<size_t>(rows));
        for (const Rational& y : answer.ray) EXPECT_EQ(y, answer.ray.front());
      }
    }
  }
}

TEST(HardCases, IdleLinesAreDegenerateSideways) {
  for (const int rows : {1, 2, 9, 40}) {
    const ExactAnswer answer = Exactly("idle-line", rows, 1);
    ASSERT_EQ(answer.status, ExactAnswer::Status::kSolved);
    ASSERT_EQ(answer.w.size(), static_cast<size_t>(rows));
    for (const Rational& w : answer.w) EXPECT_EQ(w, 0);
    EXPECT_EQ(answer.degenerate.size(), static_cast<size_t>(rows / 2));
    EXPECT_EQ(answer.f_unique, true);
  }
}

TEST(HardCases, FixedPairsHaveRowsOfZeros) {
  const Instance instance = MakeInstance({"fixed-pairs", 21, 1, {}});
  int zero = 0;
  for (Index i = 0; i < instance.problem.size(); ++i) zero += instance.problem.DiagonalA()[i] == 0 ? 1 : 0;
  EXPECT_EQ(zero, 10);
  const ExactAnswer answer = Exactly("fixed-pairs", 21, 1);
  EXPECT_EQ(answer.status, ExactAnswer::Status::kSolved);
  EXPECT_EQ(answer.f_unique, false);
}

TEST(HardCases, OverpinnedBeamsAgreeExactly) {
  for (const int rows : {4, 6, 20}) {
    const ExactAnswer answer = Exactly("overpinned-beam", rows, 2);
    EXPECT_EQ(answer.status, ExactAnswer::Status::kSolved) << rows;
    EXPECT_EQ(RankOf(MakeInstance({"overpinned-beam", rows, 2, {}}).problem, 100), rows == 4 ? 4 : 5);
  }
}

TEST(HardCases, HaveTheRowsAskedFor) {
  for (const HardCase& hard : AllHardCases()) {
    for (const int rows : {1, 2, 5, 12, 33}) {
      const Instance instance = MakeInstance({std::string(hard.key), rows, 4, {}});
      EXPECT_LE(instance.problem.size(), std::max(rows, 2)) << hard.key;
      EXPECT_GE(instance.problem.size(), rows - 1) << hard.key;
    }
  }
}

}  // namespace
}  // namespace lcpbench
