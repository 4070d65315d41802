#include "benchmarks/campaign/worker_process.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <iostream>
#include <limits>
#include <new>
#include <sstream>
#include <utility>

#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/campaign/task_runner.h"
#include "support/clock.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr const char* kWorkerCommand = "campaign-worker";
constexpr char kMark = '#';
constexpr const char* kSolveMark = "# solve";
constexpr const char* kStepMark = "# step ";
constexpr double kSecondsBetweenSteps = 0.2;  // of a sequence that the worker tells of
constexpr const char* kRefusedMark = "# refused ";
// An allocation that the limit refused ends the worker with this status.
constexpr int kOutOfMemory = 86;
constexpr double kForever = std::numeric_limits<double>::infinity();

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <typename... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

}  // namespace

template <typename Message, typename Answer>
void WorkerProcess::Ask(const Message& request, const std::function<Phase(const std::string& mark)>& phase_of,
                        Answer* answer) {
  if (!process_) {
    SubprocessOptions start;
    start.command = {options_.program, kWorkerCommand};
    start.command.insert(start.command.end(), options_.solver_arguments.begin(), options_.solver_arguments.end());
    start.memory_limit = options_.memory_bytes;
    start.cpu = options_.cpu;
    start.core_file = false;
    // Ctrl-C and job schedulers signal the whole group. That is for the runner to answer, which lets the solve in
    // flight end; a worker that ended at once would look like a solver that crashes.
    start.block_interrupts = true;
    process_ = std::make_unique<Subprocess>(start);
  }
  const std::string line = Format(request) + "\n";
  Phase phase{options_.make_s, "while the problem was made"};
  // A worker that ended while it was written to: reading says how.
  WriteAll(process_->socket(), line.data(), line.size(), SteadyNow() + phase.limit_s);
  std::string reply;
  Transfer got = Transfer::kDone;
  while ((got = process_->ReadLine(&reply, SteadyNow() + phase.limit_s)) == Transfer::kDone) {
    if (reply.empty() || reply.front() != kMark) {
      *answer = Parse<Answer>(reply);
      return;
    }
    if (reply.starts_with(kRefusedMark)) throw InputError(reply.substr(std::strlen(kRefusedMark)));
    phase = phase_of(reply);
  }
  const int status = got == Transfer::kTimeout ? process_->Kill() : process_->WaitOrKill(kForever);
  process_.reset();
  if (got == Transfer::kTimeout) {
    answer->outcome = "killed";
    answer->detail = "killed after " + std::to_string(static_cast<int>(phase.limit_s)) + " s";
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory) {
    answer->outcome = "out_of_memory";
    answer->detail = "memory beyond the limit";
  } else {
    answer->outcome = "crashed";
    answer->detail = DescribeEnd(status);
  }
  answer->detail += " " + phase.name;
}

JudgeReply WorkerProcess::Run(const JudgeRequest& request) {
  JudgeReply reply;
  const double limit = WithGrace(request.time_limit_s);
  Ask(
      request,
      [limit](const std::string&) {
        return Phase{limit, "while it was solved"};
      },
      &reply);
  return reply;
}

TimedReply WorkerProcess::Run(const TimedRequest& request) {
  // Warm-ups are not in the budget, and judging the answers takes its time, too.
  const auto solves = static_cast<double>(request.pass.warm_up.size() + 1);
  const double limit = options_.make_s + WithGrace(request.pass.budget_s + solves * request.pass.time_limit_s);
  TimedReply reply;
  Ask(
      request,
      [limit](const std::string&) {
        return Phase{limit, "in a timed pass"};
      },
      &reply);
  return reply;
}

SequenceReply WorkerProcess::Run(const SequenceRequest& request) {
  SequenceReply reply;
  const auto phase_of = [this](const std::string& mark) {
    // "# step NUMBER LIMIT"
    std::istringstream words(mark.substr(std::strlen(kStepMark)));
    std::string step;
    double limit = 0;
    words >> step >> limit;
    return Phase{kSecondsBetweenSteps + WithGrace(limit), "in step " + step + " or soon after"};
  };
  Ask(request, phase_of, &reply);
  return reply;
}

int ServeTasks() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a campaign that is killed leaves nobody who goes on solving
  // What libraries print must not get among the replies.
  const int replies = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  const auto tell = [replies](std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    text += '\n';
    if (WriteAll(replies, text.data(), text.size(), kForever) != Transfer::kDone) _exit(0);  // nobody listens any more
  };
  // What does not fit ends the worker: the next one starts with all its memory.
  std::set_new_handler([] { _exit(kOutOfMemory); });
  TaskRunner runner;
  SequenceRunner sequences;
  const auto begin = [&tell] { tell(kSolveMark); };
  const auto run = Overloaded{[&](const JudgeRequest& request) { return Format(runner.Run(request, begin)); },
                              [&](const TimedRequest& request) { return Format(runner.Run(request, begin)); },
                              [&](const SequenceRequest& request) {
                                // Not every step: who is told wakes up, on the same processor perhaps, and would be
                                // timed.
                                double told = -kSecondsBetweenSteps;
                                return Format(sequences.Run(request, [&](int step, double limit_s) {
                                  const double now = SteadyNow();
                                  if (now - told < kSecondsBetweenSteps) return;
                                  told = now;
                                  tell(kStepMark + std::to_string(step) + " " + std::to_string(limit_s));
                                }));
                              }};
  for (std::string line; std::getline(std::cin, line);) {
    try {
      tell(std::visit(run, ParseRequest(line)));
    } catch (const InputError& error) {
      tell(std::string(kRefusedMark) + error.what());
    } catch (const std::bad_alloc&) {
      _exit(kOutOfMemory);
    }
  }
  return 0;
}

}  // namespace lcpbench
