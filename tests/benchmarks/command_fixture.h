#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace lcpbench {

struct CommandOutcome {
  int status = -1;
  std::string out;
  std::string error;
};

inline std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Runs the lcpbench command, or another program, in a folder of the test's own.
class CommandTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("lcpbench_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  CommandOutcome Run(const std::string& arguments, const std::string& input = "") {
    Write("stdin", input);
    const std::string command =
        program_ + " " + arguments + " < " + Path("stdin") + " > " + Path("stdout") + " 2> " + Path("stderr");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(folder_ / "stdout"), ReadFile(folder_ / "stderr")};
  }

  /// Begins to run the command, silent, in a process group of its own, so that nothing of it need be left.
  pid_t Start(const std::string& arguments) const {
    const pid_t child = fork();
    if (child == 0) {
      setpgid(0, 0);
      const std::string command = "exec " + program_ + " " + arguments + " > /dev/null 2>&1";
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    setpgid(child, child);  // whoever is first
    return child;
  }

  /// Runs the command and kills it after so many milliseconds. False where it had ended before, with status 0.
  bool RunAndKill(const std::string& arguments, int milliseconds) const {
    const pid_t child = Start(arguments);
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFEXITED(status)) return true;
    EXPECT_EQ(WEXITSTATUS(status), 0);
    return false;
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  std::string program_ = LCPBENCH_COMMAND;
  std::filesystem::path folder_;
};

}  // namespace lcpbench
