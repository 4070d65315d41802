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

// The widest kernels come first, one of a width.
TEST(LoadedBlas, KernelsAreListedByWidth) {
  const std::vector<std::string> all = {"SkylakeX", "Haswell"};
  const std::vector<std::string> kernels = RunnableBlasKernels();
  EXPECT_EQ(kernels, std::vector<std::string>(all.end() - static_cast<std::ptrdiff_t>(kernels.size()), all.end()));
}

}  // namespace
}  // namespace lcpbench
