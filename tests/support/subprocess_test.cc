#include "support/subprocess.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "support/clock.h"
#include "tests/support/test.h"

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

// Nothing of the child's is left: the socket that all of it has is closed.
TEST(Subprocess, WhatItStartedEndsWithIt) {
  for (const bool ends_itself : {false, true}) {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe(ends.data()), 0);  // inherited, as it is not marked
    {
      Subprocess child(
          Shell(std::string("trap '' TERM; sleep 100 & echo started; ") + (ends_itself ? "exit" : "wait")));
      std::string line;
      ASSERT_EQ(child.ReadLine(&line, kForever), Transfer::kDone);
      child.WaitOrKill(ends_itself ? kForever : 0.05);
    }
    close(ends[1]);
    char byte = 0;
    EXPECT_EQ(ReadAll(ends[0], &byte, 1, SteadyNow() + 10), Transfer::kClosed);
    close(ends[0]);
  }
}

// A process that has a child ends by a signal: the last one to hold the pipe is gone.
TEST(Subprocess, DoesNotOutliveItsParent) {
  struct Case {
    int signal;
    const char* script;
  };
  for (const Case& one :
       {Case{SIGKILL, "echo started; exec sleep 100"}, Case{SIGKILL, "sleep 100 & echo started; wait"},
        Case{SIGTERM, "sleep 100 & echo started; wait"}, Case{SIGINT, "sleep 100 & echo started; wait"}}) {
    SCOPED_TRACE(one.signal);
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe(ends.data()), 0);
    Subprocess parent([&](int socket) {
      if (one.signal != SIGKILL) std::signal(one.signal, SIG_DFL);  // a shell's background has it ignored
      Subprocess child(Shell(one.script));
      std::string line;
      child.ReadLine(&line, kForever);
      WriteAll(socket, "ready\n", 6, kForever);
      for (;;) pause();
    });
    std::string line;
    ASSERT_EQ(parent.ReadLine(&line, kForever), Transfer::kDone);
    ASSERT_EQ(kill(parent.pid(), one.signal), 0);
    EXPECT_EQ(WTERMSIG(parent.WaitOrKill(10)), one.signal);
    close(ends[1]);
    char byte = 0;
    EXPECT_EQ(ReadAll(ends[0], &byte, 1, SteadyNow() + 10), Transfer::kClosed);
    close(ends[0]);
  }
}

TEST(Subprocess, SaysThatThereIsNoSuchProgram) {
  SubprocessOptions options;
  options.command = {"/no/such/program"};
  EXPECT_THROW(Subprocess{options}, std::runtime_error);
}

}  // namespace
}  // namespace lcpbench
