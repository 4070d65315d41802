#include "solvers/external/worker.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>

#include "solvers/external/channel.h"

namespace lcpbench {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

class Worker {
 public:
  Worker(LcpSolver& solver, Channel channel) : solver_(solver), channel_(channel) {}

  int Run(const Hello& hello) {
    if (!Send(MessageType::kHello, Encode(hello))) return 1;
    MessageType type{};
    Bytes payload;
    for (;;) {
      const Channel::Outcome outcome = channel_.Read(&type, &payload, kForever);
      if (outcome == Channel::Outcome::kClosed) return 0;
      if (outcome != Channel::Outcome::kDone) return 1;
      switch (type) {
        case MessageType::kQuit:
          return 0;
        case MessageType::kProblem:
          if (!TakeProblem(payload)) return 1;
          break;
        case MessageType::kSolve:
          if (!problem_ || !Solve(DecodeSolve(payload, problem_->size()))) return 1;
          break;
        default:
          return 1;
      }
    }
  }

 private:
  bool Send(MessageType type, const Bytes& payload) {
    return channel_.Write(type, payload, kForever) == Channel::Outcome::kDone;
  }

  bool TakeProblem(const Bytes& payload) {
    problem_ = DecodeProblem(payload);
    Prepared prepared;
    prepared.why_unsupported = solver_.WhyUnsupported(*problem_);
    const double start = SteadyNow();
    if (prepared.why_unsupported.empty()) solver_.Prepare(*problem_);
    prepared.convert_s = SteadyNow() - start;
    return Send(MessageType::kPrepared, Encode(prepared));
  }

  bool Solve(const SolveRequest& request) {
    LcpOptions options;
    options.tolerance = request.tolerance;
    options.time_limit_s = request.time_limit_s;
    options.max_iterations = request.max_iterations;
    if (request.start) options.initial_f = &*request.start;
    LcpResult result;
    double solving = 0;
    double converting = 0;
    const std::uint64_t count = std::max<std::uint64_t>(1, request.repetitions);
    for (std::uint64_t i = 0; i < count; ++i) {
      const double start = SteadyNow();
      solver_.Solve(*problem_, options, &result);
      const double wall = SteadyNow() - start;
      solving += result.own_solve_s >= 0 ? result.own_solve_s : wall;
      converting += std::max(0.0, result.own_convert_s);
    }
    result.own_solve_s = solving / static_cast<double>(count);
    result.own_convert_s = converting / static_cast<double>(count);
    return Send(MessageType::kResult, Encode(result));
  }

  LcpSolver& solver_;
  Channel channel_;
  std::optional<LcpProblem> problem_;
};

}  // namespace

int RunWorker(const Hello& hello, LcpSolver& solver) {
  // Nobody would wait for the answer of a worker whose host was killed.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int out = dup(STDOUT_FILENO);
  if (out < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return 1;
  try {
    return Worker(solver, Channel(STDIN_FILENO, out)).Run(hello);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "worker: %s\n", error.what());
    return 1;
  }
}

}  // namespace lcpbench
