#include "solvers/external/external_solver.h"

#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "solvers/external/channel.h"
#include "solvers/lcp/input_error.h"

extern char** environ;

namespace lcpbench {
namespace {

using Outcome = Channel::Outcome;

// Which reserves terabytes of address space, in the worker too.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kAddressSanitizer = true;
#else
constexpr bool kAddressSanitizer = false;
#endif

// A worker that did not answer in time; it has been killed.
struct WorkerTimeout : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::string DescribeEnd(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  }
  return "ended with exit status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

// One worker process and the socket to it.
class ExternalSolver::Process {
 public:
  explicit Process(const ExternalSolverOptions& options) : name_(options.command.front()), channel_(-1, -1) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
      throw std::runtime_error("worker '" + name_ + "': no socket: " + std::strerror(errno));
    }
    socket_ = ends[0];
    channel_ = Channel(socket_, socket_);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<char*> argv;
    std::vector<std::string> command = options.command;
    argv.reserve(command.size() + 1);
    for (std::string& word : command) argv.push_back(word.data());
    argv.push_back(nullptr);
    // Not fork: the libraries of this process may hold locks and have handlers for it.
    const int error = posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error != 0) {
      close(socket_);
      throw std::runtime_error("worker '" + name_ + "' cannot be started: " + std::strerror(error));
    }
    if (options.memory_limit > 0 && !kAddressSanitizer) {
      const rlimit limit{options.memory_limit, options.memory_limit};
      prlimit(pid_, RLIMIT_AS, &limit, nullptr);
    }
  }
  ~Process() {
    if (pid_ > 0) {
      channel_.Write(MessageType::kQuit, {}, SteadyNow());
      Kill();
    }
    close(socket_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void Send(MessageType type, const Bytes& payload, double limit_s) {
    Check(channel_.Write(type, payload, SteadyNow() + limit_s), limit_s);
  }

  Bytes Receive(MessageType expected, double limit_s) {
    MessageType type{};
    Bytes payload;
    Check(channel_.Read(&type, &payload, SteadyNow() + limit_s), limit_s);
    if (type != expected) Check(Outcome::kBroken, limit_s);
    return payload;
  }

 private:
  void Check(Outcome outcome, double limit_s) {
    switch (outcome) {
      case Outcome::kDone:
        return;
      case Outcome::kTimeout:
        Kill();
        throw WorkerTimeout("worker '" + name_ + "' gave no answer within " + std::to_string(limit_s) +
                            " s and was killed");
      case Outcome::kBroken:
        Kill();
        throw std::runtime_error("worker '" + name_ + "' sent what is no message of the protocol");
      case Outcome::kClosed:
        throw std::runtime_error("worker '" + name_ + "' " + DescribeEnd(WaitOrKill()));
    }
  }

  // Its end of the socket is closed: it is about to end, unless it closed it on purpose.
  int WaitOrKill() {
    constexpr double kWait = 1;
    const double until = SteadyNow() + kWait;
    int status = 0;
    while (SteadyNow() < until) {
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = 0;
        return status;
      }
      usleep(1000);
    }
    return Kill();
  }

  int Kill() {
    int status = 0;
    if (pid_ <= 0) return status;
    kill(pid_, SIGKILL);
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = 0;
    return status;
  }

  std::string name_;
  pid_t pid_ = 0;
  int socket_ = -1;
  Channel channel_;
};

ExternalSolver::ExternalSolver(ExternalSolverOptions options) : options_(std::move(options)) {
  if (options_.command.empty()) throw InputError("external solver: expected a command");
  const bool valid =
      options_.start_limit_s > 0 && options_.prepare_limit_s > 0 && options_.grace_factor >= 0 && options_.grace_s > 0;
  if (!valid) throw InputError("external solver: limits must be > 0");
}

ExternalSolver::~ExternalSolver() = default;

const Hello& ExternalSolver::Greet() {
  if (process_ != nullptr) return hello_;
  try {
    process_ = std::make_unique<Process>(options_);
    hello_ = DecodeHello(process_->Receive(MessageType::kHello, options_.start_limit_s));
  } catch (const std::exception& error) {
    process_.reset();
    throw InputError(error.what());
  }
  return hello_;
}

void ExternalSolver::SendProblem(const LcpProblem& problem) {
  Greet();
  try {
    process_->Send(MessageType::kProblem, Encode(problem, hello_.form), options_.prepare_limit_s);
    prepared_ = DecodePrepared(process_->Receive(MessageType::kPrepared, options_.prepare_limit_s));
  } catch (...) {
    process_.reset();
    throw;
  }
}

void ExternalSolver::DoPrepare(const LcpProblem& problem) {
  failure_.clear();
  try {
    SendProblem(problem);
  } catch (const std::exception& error) {
    // A status of the solve that follows, not an end of the campaign.
    failure_ = error.what();
  }
}

void ExternalSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (!failure_.empty()) throw std::runtime_error(std::exchange(failure_, {}));
  try {
    // The worker may have ended at the solve before.
    if (process_ == nullptr) SendProblem(problem);
    if (!prepared_.why_unsupported.empty()) {
      result->status = LcpStatus::kUnsupported;
      result->detail = prepared_.why_unsupported;
      return;
    }
    SolveRequest request;
    request.tolerance = options.tolerance;
    request.time_limit_s = options.time_limit_s;
    request.max_iterations = options.max_iterations;
    request.repetitions = static_cast<std::uint64_t>(options.repetitions);
    if (options.initial_f != nullptr) request.start = *options.initial_f;
    const double limit = static_cast<double>(options.repetitions) * options.time_limit_s * (1 + options_.grace_factor) +
                         options_.grace_s;
    process_->Send(MessageType::kSolve, Encode(request), limit);
    *result = DecodeResult(process_->Receive(MessageType::kResult, limit), problem.size());
  } catch (const WorkerTimeout& error) {
    process_.reset();
    result->status = LcpStatus::kTimeLimit;
    result->detail = error.what();
  } catch (const std::exception&) {
    process_.reset();
    throw;
  }
}

}  // namespace lcpbench
