#include "benchmarks/child_process.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "solvers/lcp/solver.h"

namespace lcpbench {
namespace {

constexpr int kNotStarted = 127;
constexpr const char* kThisProgram = "/proc/self/exe";

// The address sanitizer reserves more than any limit.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

struct Pipe {
  int read_end = -1;
  int write_end = -1;
};

Pipe MakePipe() {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  return {ends[0], ends[1]};
}

// After fork: only what is safe there.
[[noreturn]] void Become(char* const* arguments, const Pipe& output, const Pipe& error, const ChildLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (limits.memory_bytes > 0 && kLimitsMemory) {
    const rlimit limit{limits.memory_bytes, limits.memory_bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  dup2(output.write_end, STDOUT_FILENO);
  dup2(error.write_end, STDERR_FILENO);
  for (const int end : {output.read_end, output.write_end, error.read_end, error.write_end}) close(end);
  execv(kThisProgram, arguments);
  _exit(kNotStarted);
}

// Reads both pipes until both are closed.  @return false if the time was up before
bool ReadBoth(int output_end, int error_end, double time_s, std::string* output, std::string* error) {
  const double end = SteadyNow() + time_s;
  std::array<pollfd, 2> ends{pollfd{output_end, POLLIN, 0}, pollfd{error_end, POLLIN, 0}};
  const std::array<std::string*, 2> texts{output, error};
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    const double left = end - SteadyNow();
    if (left <= 0) return false;
    constexpr double kLongestWait = 1000;  // s
    if (poll(ends.data(), ends.size(), static_cast<int>(std::ceil(1e3 * std::min(left, kLongestWait)))) < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    for (std::size_t k = 0; k < ends.size(); ++k) {
      if (ends[k].revents == 0) continue;
      std::array<char, 65536> buffer{};
      const ssize_t count = read(ends[k].fd, buffer.data(), buffer.size());
      if (count > 0) {
        texts[k]->append(buffer.data(), static_cast<std::size_t>(count));
      } else if (count == 0 || errno != EINTR) {
        ends[k].fd = -1;  // poll passes over it
      }
    }
  }
  return true;
}

std::string LastLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

std::string HowItEnded(int status, bool in_time, double time_s, const std::string& error) {
  char text[64];
  if (!in_time) {
    std::snprintf(text, sizeof text, "killed after %.0f s", time_s);
    return text;
  }
  std::string how;
  if (WIFSIGNALED(status)) {
    how = "ended by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  } else if (WEXITSTATUS(status) != 0) {
    how = "exit status " + std::to_string(WEXITSTATUS(status));
  } else {
    return {};
  }
  const std::string line = LastLine(error);
  return line.empty() ? how : how + ": " + line;
}

}  // namespace

ChildOutcome RunSelf(const std::vector<std::string>& arguments, const ChildLimits& limits) {
  std::vector<std::string> copies = arguments;
  copies.insert(copies.begin(), kThisProgram);
  std::vector<char*> pointers;
  pointers.reserve(copies.size() + 1);
  for (std::string& copy : copies) pointers.push_back(copy.data());
  pointers.push_back(nullptr);
  const Pipe output = MakePipe();
  const Pipe error = MakePipe();
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (pid == 0) Become(pointers.data(), output, error, limits);
  close(output.write_end);
  close(error.write_end);

  ChildOutcome outcome;
  std::string error_text;
  const bool in_time = ReadBoth(output.read_end, error.read_end, limits.time_s, &outcome.output, &error_text);
  close(output.read_end);
  close(error.read_end);
  if (!in_time) kill(pid, SIGKILL);
  int status = 0;
  rusage usage{};
  while (wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  outcome.failure = HowItEnded(status, in_time, limits.time_s, error_text);
  outcome.ok = outcome.failure.empty();
  outcome.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return outcome;
}

}  // namespace lcpbench
