// What OpenBLAS chose, and whether it computes rightly.

#include "solvers/linear_algebra/loaded_blas.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lcpbench {
namespace {

TEST(LoadedBlas, IsRightAndNamed) {
  EXPECT_TRUE(BlasIsRight());
  EXPECT_NE(BlasVersion(), "unknown");
}

// The widest kernels come first, and one of a width is enough.
TEST(LoadedBlas, KernelsAreListedByWidth) {
  const std::vector<std::string> kernels = RunnableBlasKernels();
  const bool has_avx512 = !kernels.empty() && kernels.front() == "SkylakeX";
  EXPECT_EQ(kernels.size(), has_avx512 ? 2U : kernels.size() == 1 ? 1U : 0U);
  if (!kernels.empty()) EXPECT_EQ(kernels.back(), "Haswell");
}

}  // namespace
}  // namespace lcpbench
