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
#include "benchmarks/measure/progress.h"
#include "support/clock.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr const char* kWorkerCommand = "campaign-worker";
constexpr char kMark = '#';
constexpr const char* kRefusedMark = "# refused ";
// An allocation that the limit refused ends the worker with this status.
constexpr int kOutOfMemory = 86;
constexpr double kEnd = 10;  // s from closing its socket to its end
constexpr double kForever = std::numeric_limits<double>::infinity();

}  // namespace

template <typename Answer, typename Message>
Answer WorkerProcess::Request(const Message& request) {
  bool by_others = false;
  Answer answer = RequestOnce<Answer>(request, &by_others);
  // A job scheduler that has asked for the end may kill all processes.
  if (!by_others || Interruption::Requested()) return answer;
  const std::string retried = answer.detail;
  answer = RequestOnce<Answer>(request, &by_others);
  answer.retried = retried + (answer.retried.empty() ? "" : "; ") + answer.retried;
  return answer;
}

template <typename Answer, typename Message>
Answer WorkerProcess::RequestOnce(const Message& request, bool* by_others) {
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
  double limit_s = options_.make_s;
  std::string phase = "while the problem was made";
  std::string reply;
  const Transfer sent = WriteAll(process_->socket(), line.data(), line.size(), SteadyNow() + limit_s);
  Transfer got = sent;
  while (got == Transfer::kDone && (got = process_->ReadLine(&reply, SteadyNow() + limit_s)) == Transfer::kDone) {
    if (reply.empty() || reply.front() != kMark) return Parse<Answer>(reply);
    if (reply.starts_with(kRefusedMark)) throw InputError(reply.substr(std::strlen(kRefusedMark)));
    std::istringstream words(reply.substr(1));
    words >> limit_s >> std::ws;
    std::getline(words, phase);
    limit_s = limit_s * (1 + options_.grace_share) + options_.grace_s;
  }
  const bool hung_up = sent == Transfer::kDone && got == Transfer::kClosed;
  const int status = hung_up ? process_->WaitOrKill(kEnd) : process_->Kill();
  process_.reset();
  Answer answer;
  if (got == Transfer::kTimeout) {
    answer.outcome = "killed";
    answer.detail = "killed after " + std::to_string(static_cast<int>(limit_s)) + " s";
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory) {
    answer.outcome = "out_of_memory";
    answer.detail = "memory beyond the limit";
  } else {
    answer.outcome = "crashed";
    answer.detail = DescribeEnd(status);
    // Nor does it say anything of the solver where it did not take its request.
    *by_others = WasKilled(status) || sent != Transfer::kDone;
  }
  answer.detail += " " + phase;
  return answer;
}

JudgeReply WorkerProcess::Run(const JudgeRequest& request) { return Request<JudgeReply>(request); }
TimedReply WorkerProcess::Run(const TimedRequest& request) { return Request<TimedReply>(request); }
SequenceReply WorkerProcess::Run(const SequenceRequest& request) { return Request<SequenceReply>(request); }

int ServeTasks(const std::vector<std::string>& solver_arguments) {
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
  std::vector<std::string> serve = {"/proc/self/exe", kWorkerCommand};
  serve.insert(serve.end(), solver_arguments.begin(), solver_arguments.end());
  serve.emplace_back("--serve");
  TaskRunner runner(std::move(serve));
  SequenceRunner sequences;
  const auto begin = [&tell](double limit_s, const std::string& name) {
    tell(kMark + (" " + std::to_string(limit_s)) + " " + name);
  };
  const auto run = [&](const std::string& line) {
    const auto request = nlohmann::json::parse(line, nullptr, false);
    if (request.contains("file")) return Format(sequences.Run(Parse<SequenceRequest>(line), begin));
    if (request.contains("pass")) return Format(runner.Run(Parse<TimedRequest>(line), begin));
    return Format(runner.Run(Parse<JudgeRequest>(line), begin));
  };
  for (std::string line; std::getline(std::cin, line);) {
    try {
      tell(run(line));
    } catch (const InputError& error) {
      tell(std::string(kRefusedMark) + error.what());
    } catch (const std::bad_alloc&) {
      _exit(kOutOfMemory);
    }
  }
  return 0;
}

}  // namespace lcpbench
