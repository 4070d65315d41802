#include "benchmarks/campaign/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <iostream>
#include <new>
#include <sstream>
#include <stdexcept>

#include "benchmarks/campaign/sequences/sequence_runner.h"
#include "benchmarks/campaign/task_runner.h"
#include "solvers/lcp/solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr const char* kWorkerCommand = "campaign-worker";
constexpr int kNotStarted = 127;
constexpr char kMark = '#';
constexpr const char* kSolveMark = "# solve";
constexpr const char* kStepMark = "# step ";
constexpr double kSecondsBetweenSteps = 0.2;  // of a sequence that the worker tells of
constexpr const char* kRefusedMark = "# refused ";
// An allocation that the limit refused ends the worker with this status.
constexpr int kOutOfMemory = 86;

#ifdef __SANITIZE_ADDRESS__
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

// After fork: only what is safe there.
[[noreturn]] void Become(const WorkerOptions& options, char* const* arguments, int input, int output) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Ctrl-C and job schedulers signal the whole group. That is for the runner to answer, which lets the cell in flight
  // end; a worker that ended at once would look like a solver that crashes.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  if (options.memory_bytes > 0 && kLimitsMemory) {
    const rlimit limit{options.memory_bytes, options.memory_bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (options.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<size_t>(options.cpu), &set);
    sched_setaffinity(0, sizeof set, &set);
  }
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  execv(arguments[0], arguments);
  _exit(kNotStarted);
}

}  // namespace

WorkerProcess::WorkerProcess(const WorkerOptions& options) : options_(options) {
  // A worker that ended must not end the campaign where it is written to.
  std::signal(SIGPIPE, SIG_IGN);
}

WorkerProcess::~WorkerProcess() { End(); }

void WorkerProcess::Start() {
  std::array<int, 2> requests{};
  std::array<int, 2> replies{};
  // Closed in the worker's own children by themselves.
  if (pipe2(requests.data(), O_CLOEXEC) != 0 || pipe2(replies.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  }
  std::vector<std::string> words = {options_.program, kWorkerCommand};
  words.insert(words.end(), options_.solver_arguments.begin(), options_.solver_arguments.end());
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (pid_ == 0) Become(options_, arguments.data(), requests[0], replies[1]);
  close(requests[0]);
  close(replies[1]);
  to_ = requests[1];
  from_ = replies[0];
  buffer_.clear();
}

void WorkerProcess::End() {
  if (pid_ <= 0) return;
  close(to_);
  close(from_);
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

bool WorkerProcess::ReadLine(double limit_s, std::string* line, std::string* how) {
  const double end = SteadyNow() + limit_s;
  for (;;) {
    const size_t stop = buffer_.find('\n');
    if (stop != std::string::npos) {
      *line = buffer_.substr(0, stop);
      buffer_.erase(0, stop + 1);
      return true;
    }
    const double left = end - SteadyNow();
    if (left <= 0) {
      *how = "killed";
      return false;
    }
    pollfd ready{from_, POLLIN, 0};
    constexpr double kLongestWait = 1000;  // s
    const int count = poll(&ready, 1, static_cast<int>(std::ceil(1e3 * std::min(left, kLongestWait))));
    if (count < 0 && errno != EINTR) throw std::runtime_error(std::string("poll: ") + std::strerror(errno));
    if (count <= 0) continue;
    std::array<char, 65536> bytes{};
    const ssize_t read_bytes = read(from_, bytes.data(), bytes.size());
    if (read_bytes > 0) {
      buffer_.append(bytes.data(), static_cast<size_t>(read_bytes));
    } else if (read_bytes == 0 || errno != EINTR) {
      *how = "crashed";
      return false;
    }
  }
}

std::optional<std::string> WorkerProcess::Ask(const std::string& request,
                                              const std::function<Phase(const std::string& mark)>& phase_of,
                                              std::string* how, std::string* detail) {
  if (pid_ <= 0) Start();
  const std::string line = request + "\n";
  size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = write(to_, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;  // it ended: reading says how
    written += static_cast<size_t>(count);
  }
  Phase phase{options_.make_s, "while the problem was made"};
  std::string reply;
  while (ReadLine(phase.limit_s, &reply, how)) {
    if (reply.empty() || reply.front() != kMark) return reply;
    if (reply.starts_with(kRefusedMark)) throw InputError(reply.substr(std::strlen(kRefusedMark)));
    phase = phase_of(reply);
  }

  if (*how == "killed") {
    *detail = "killed after " + std::to_string(static_cast<int>(phase.limit_s)) + " s " + phase.name;
    End();
    return std::nullopt;
  }
  close(to_);
  close(from_);
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  if (WIFSIGNALED(status)) {
    *detail = std::string("ended by ") + strsignal(WTERMSIG(status)) + " " + phase.name;
  } else if (WEXITSTATUS(status) == kOutOfMemory) {
    *how = "out_of_memory";
    *detail = "memory beyond the limit " + phase.name;
  } else {
    *detail = "ended with status " + std::to_string(WEXITSTATUS(status)) + " " + phase.name;
  }
  return std::nullopt;
}

JudgeReply WorkerProcess::Run(const JudgeRequest& request) {
  const double limit = request.time_limit_s * (1 + options_.grace_share) + options_.grace_s;
  JudgeReply outcome;
  const std::optional<std::string> reply = Ask(
      FormatRequest(request),
      [limit](const std::string&) {
        return Phase{limit, "while it was solved"};
      },
      &outcome.claim, &outcome.detail);
  return reply ? ParseJudgeReply(*reply) : outcome;
}

TimedReply WorkerProcess::Run(const TimedRequest& request) {
  // Warm-ups are not in the budget, and judging the answers takes its time, too.
  const auto solves = static_cast<double>(request.pass.warm_up.size() + 1);
  const double limit = options_.make_s +
                       (request.pass.budget_s + solves * request.pass.time_limit_s) * (1 + options_.grace_share) +
                       options_.grace_s;
  TimedReply outcome;
  const std::optional<std::string> reply = Ask(
      FormatRequest(request),
      [limit](const std::string&) {
        return Phase{limit, "in a timed pass"};
      },
      &outcome.outcome, &outcome.detail);
  return reply ? ParseTimedReply(*reply) : outcome;
}

SequenceReply WorkerProcess::Run(const SequenceRequest& request) {
  SequenceReply outcome;
  const std::optional<std::string> reply = Ask(
      FormatSequenceRequest(request),
      [&](const std::string& mark) {
        // "# step NUMBER LIMIT"
        std::istringstream words(mark.substr(std::strlen(kStepMark)));
        std::string step;
        double limit = 0;
        words >> step >> limit;
        return Phase{kSecondsBetweenSteps + limit * (1 + options_.grace_share) + options_.grace_s,
                     "in step " + step + " or soon after"};
      },
      &outcome.outcome, &outcome.detail);
  return reply ? ParseSequenceReply(*reply) : outcome;
}

int ServeTasks() {
  // What libraries print must not get among the replies.
  const int replies = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  const auto tell = [replies](std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    text += '\n';
    size_t written = 0;
    while (written < text.size()) {
      const ssize_t count = write(replies, text.data() + written, text.size() - written);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) _exit(0);  // nobody listens any more
      written += static_cast<size_t>(count);
    }
  };
  // What does not fit ends the worker: the next one starts with all its memory.
  std::set_new_handler([] { _exit(kOutOfMemory); });
  TaskRunner runner;
  SequenceRunner sequences;
  std::string line;
  while (std::getline(std::cin, line)) {
    try {
      if (IsSequenceRequest(line)) {
        // Not every step: who is told wakes up, on the same processor perhaps, and would be timed.
        double told = -kSecondsBetweenSteps;
        tell(FormatSequenceReply(sequences.Run(ParseSequenceRequest(line), [&](int step, double limit_s) {
          const double now = SteadyNow();
          if (now - told < kSecondsBetweenSteps) return;
          told = now;
          tell(kStepMark + std::to_string(step) + " " + std::to_string(limit_s));
        })));
        continue;
      }
      const auto begin = [&tell] { tell(kSolveMark); };
      const nlohmann::json request = nlohmann::json::parse(line, nullptr, false);
      tell(IsTimedRequest(request) ? FormatReply(runner.Run(ParseTimedRequest(request), begin))
                                   : FormatReply(runner.Run(ParseJudgeRequest(request), begin)));
    } catch (const InputError& error) {
      tell(std::string(kRefusedMark) + error.what());
    } catch (const std::bad_alloc&) {
      _exit(kOutOfMemory);
    }
  }
  return 0;
}

}  // namespace lcpbench
