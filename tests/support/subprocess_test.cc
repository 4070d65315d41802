#include "support/subprocess.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <limits>
#include <stdexcept>

#include "support/clock.h"

namespace lcpbench {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

SubprocessOptions Shell(const std::string& script) {
  SubprocessOptions options;
  options.command = {"sh", "-c", script};
  return options;
}

TEST(Subprocess, TalksThroughItsSocketAndTellsHowItEnded) {
  Subprocess child(Shell("read word; printf 'one\\n%s\\n' $word; exit 3"));
  ASSERT_EQ(WriteAll(child.socket(), "two\n", 4, kForever), Transfer::kDone);
  std::string line;
  for (const char* expected : {"one", "two"}) {
    ASSERT_EQ(child.ReadLine(&line, kForever), Transfer::kDone);
    EXPECT_EQ(line, expected);
  }
  EXPECT_EQ(child.ReadLine(&line, kForever), Transfer::kClosed);
  EXPECT_EQ(DescribeEnd(child.WaitOrKill(kForever)), "ended with exit status 3");
}

TEST(Subprocess, IsGivenUpAtItsTime) {
  Subprocess child(Shell("trap '' TERM; sleep 100"));
  std::string line;
  EXPECT_EQ(child.ReadLine(&line, SteadyNow() + 0.05), Transfer::kTimeout);
  EXPECT_EQ(WTERMSIG(child.WaitOrKill(0.05)), SIGKILL);
}

TEST(Subprocess, KeepsItsLimitsAndProcessor) {
  SubprocessOptions options;
  options.command = {"grep", "-E", "SigBlk|Cpus_allowed_list", "/proc/self/status"};
  options.block_interrupts = true;
  options.cpu = 0;
  Subprocess child(options);
  std::string line;
  ASSERT_EQ(child.ReadLine(&line, kForever), Transfer::kDone);
  EXPECT_EQ(line, "SigBlk:\t0000000000004002");
  ASSERT_EQ(child.ReadLine(&line, kForever), Transfer::kDone);
  EXPECT_EQ(line, "Cpus_allowed_list:\t0");
}

TEST(Subprocess, RunsAFunctionInAFork) {
  Subprocess child([](int socket) { WriteAll(socket, "born\n", 5, kForever); });
  std::string line;
  EXPECT_EQ(child.ReadLine(&line, kForever), Transfer::kDone);
  EXPECT_EQ(line, "born");
}

TEST(Subprocess, SaysThatThereIsNoSuchProgram) {
  SubprocessOptions options;
  options.command = {"/no/such/program"};
  EXPECT_THROW(Subprocess{options}, std::runtime_error);
}

}  // namespace
}  // namespace lcpbench
