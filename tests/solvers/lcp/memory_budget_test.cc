#include "solvers/lcp/memory_budget.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {
namespace {

TEST(MemoryBudget, SomeMemoryIsAvailable) { EXPECT_GT(AvailableMemory(), kAlwaysAllowed); }

TEST(MemoryBudget, RefusesWithFiguresWhatNoMachineHas) {
  try {
    RequireMemory(1e18, "the factor of A");
    FAIL();
  } catch (const MemoryRefusal& refusal) {
    const std::string text = refusal.what();
    EXPECT_EQ(text.find("the factor of A needs 1000000000.0 GB, "), 0u) << text;
    EXPECT_NE(text.find(" GB are available"), std::string::npos) << text;
  }
  EXPECT_NO_THROW(RequireMemory(kAlwaysAllowed, "little"));
}

TEST(MemoryBudget, ALimitOfTheAddressSpaceCounts) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const double before = AvailableMemory();
    const auto limit = static_cast<rlim_t>(before / 2 + 1e9);
    const rlimit address_space{limit, limit};
    const bool set = setrlimit(RLIMIT_AS, &address_space) == 0;
    _exit(set && AvailableMemory() < static_cast<double>(limit) && AvailableMemory() < before ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(MemoryBudget, AIsNotFormedWhereItCannotFit) {
  constexpr Index kRows = 10'000'000;
  SparseMatrix J(kRows, 3);
  J.reserve(Eigen::VectorXi::Ones(kRows));
  for (Index i = 0; i < kRows; ++i) J.insert(i, 0) = 1;
  const LcpProblem problem = LcpProblem::FromFactors("tall", J, Eigen::VectorXd::Ones(3), Eigen::VectorXd::Zero(kRows));
  EXPECT_THROW(static_cast<void>(problem.DenseA()), MemoryRefusal);
  EXPECT_THROW(static_cast<void>(problem.SparseA()), MemoryRefusal);
}

}  // namespace
}  // namespace lcpbench
