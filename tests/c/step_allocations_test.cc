// What lcpbench.h promises of lcpbench_step_solve: no allocation up to the sizes of its options.

#include <lcpbench.h>

#include "benchmarks/measure/allocation_count.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

struct Arrays {
  std::vector<std::int32_t> body;
  std::vector<double> J, b, inverse_mass;
  std::vector<std::uint8_t> kinds;
};

// Rows that each have a body of their own, so that f is unique, in columns of ten bodies.
Arrays MakeArrays(int n, int p, unsigned seed) {
  std::mt19937_64 random(seed);
  Arrays arrays;
  for (int i = 0; i < n; ++i) {
    arrays.body.insert(arrays.body.end(), {i, i % 10 == 0 ? -1 : i - 1});
    for (int c = 0; c < 2 * p; ++c) arrays.J.push_back(Uniform(&random, -1, 1));
    for (int c = 0; c < p; ++c) arrays.inverse_mass.push_back(Uniform(&random, 0.5, 2));
    arrays.b.push_back(Uniform(&random, -1, 1));
    arrays.kinds.push_back(i % 4 == 3 ? LCPBENCH_BILATERAL : LCPBENCH_UNILATERAL);
  }
  return arrays;
}

TEST(StepFromC, AllocatesInItsCreationOnly) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  constexpr int kMostRows = 1000;
  for (const int p : {3, 6}) {
    const lcpbench_step_options options = {sizeof options, 0, 0, 0, kMostRows, kMostRows};
    lcpbench_step* step = nullptr;
    CountAllocations(true);
    const long at_first = AllocationCount();
    ASSERT_EQ(lcpbench_step_create(&options, &step), LCPBENCH_OK);
    EXPECT_GT(AllocationCount(), at_first) << "the library's allocations are counted";
    for (const int n : {1, 5, 60, kMostRows}) {
      const Arrays arrays = MakeArrays(n, p, static_cast<unsigned>(n));
      std::vector<double> f(arrays.b.size());
      std::vector<double> w(arrays.b.size());
      const std::vector<double> start(arrays.b.size(), 0.25);
      lcpbench_problem_data data = {};
      lcpbench_answer answer = {};
      const long before = AllocationCount();
      answer.size = sizeof answer;
      data.size = sizeof data;
      data.form = LCPBENCH_TWO_BODIES;
      data.rows = data.bodies = n;
      data.columns_per_body = p;
      data.body = arrays.body.data();
      data.values = arrays.J.data();
      data.b = arrays.b.data();
      data.kinds = arrays.kinds.data();
      data.inverse_mass = arrays.inverse_mass.data();
      for (const double* initial_f : {static_cast<const double*>(nullptr), start.data()}) {
        ASSERT_EQ(lcpbench_step_solve(step, &data, initial_f, f.data(), w.data(), &answer), LCPBENCH_OK);
        EXPECT_EQ(answer.status, LCPBENCH_SOLVED);
        EXPECT_EQ(answer.fallbacks, 0);
      }
      EXPECT_EQ(AllocationCount(), before) << n << " rows, " << p << " columns a body";
    }
    CountAllocations(false);
    lcpbench_step_free(step);
  }
}

}  // namespace
}  // namespace lcpbench
