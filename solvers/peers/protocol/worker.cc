#include "solvers/peers/protocol/worker.h"

#include <malloc.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/peers/protocol/protocol.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

// The heap is touched before a stream is decoded: it holds the stream in one stretch, and what a solver takes for it,
// so that a timed solve meets no page for the first time. So many times the stream's size, and at least so much.
constexpr std::size_t kHeapShare = 2;
constexpr std::size_t kLeastHeap = std::size_t{32} << 20U;  // bytes

void ReserveHeap(std::size_t bytes) {
  const int most = static_cast<int>(std::min<std::size_t>(2 * bytes, std::numeric_limits<int>::max()));
  mallopt(M_TRIM_THRESHOLD, most);
  mallopt(M_MMAP_THRESHOLD, most);
  void* const heap = std::malloc(bytes);
  if (heap == nullptr) return;  // decoding says so
  std::memset(heap, 1, bytes);
  asm volatile("" : : "r"(heap) : "memory");  // else the compiler leaves all of this out
  std::free(heap);
}

class Worker {
 public:
  Worker(const SolverFactory& make, int in, int out) : make_(make), solver_(make()), in_(in), out_(out) {}

  int Run(const Hello& hello) {
    if (!Send(MessageType::kHello, Encode(hello))) return 1;
    for (;;) {
      MessageType type{};
      Bytes payload;
      const Transfer outcome = ReadFrame(in_, &type, &payload, kForever);
      if (outcome == Transfer::kClosed || type == MessageType::kQuit) return 0;
      if (!Answer(type, payload)) return 1;
    }
  }

 private:
  // False where the host broke the protocol or is gone.
  bool Answer(MessageType type, const Bytes& payload) {
    switch (type) {
      case MessageType::kProblem:
        arrays_ = DecodeProblem(payload);
        problem_.reset();
        other_b_.reset();
        return Send(MessageType::kLoaded, {});
      case MessageType::kOtherB:
        if (!arrays_) return false;
        other_b_ = DecodeOtherB(payload, arrays_->rows);
        if (!problem_) {
          // As if it had just been solved.
          problem_ = LcpProblem::FromArrays(*arrays_);
          solver_->Prepare(*problem_);
        }
        return Send(MessageType::kLoaded, {});
      case MessageType::kSolve:
        return arrays_ && Solve(DecodeSolve(payload, arrays_->rows));
      case MessageType::kStream:
        ReserveHeap(kHeapShare * payload.size() + kLeastHeap);
        stream_ = DecodeStream(payload);
        return Send(MessageType::kLoaded, {});
      case MessageType::kPass:
        return Send(MessageType::kPassReply, Encode(RunPass(make_, stream_, DecodePass(payload, stream_))));
      default:
        return false;
    }
  }

  bool Send(MessageType type, const Bytes& payload) {
    return WriteFrame(out_, type, payload, kForever) == Transfer::kDone;
  }

  bool Solve(const SolveRequest& request) {
    LcpOptions options;
    options.tolerance = request.tolerance;
    options.time_limit_s = request.time_limit_s;
    options.max_iterations = request.max_iterations;
    options.time_parts = request.time_parts;
    if (request.start) options.initial_f = &*request.start;
    LcpResult result;
    const double start = SteadyNow();
    if (other_b_) {
      solver_->Solve(problem_->WithB(*other_b_), options, &result);
    } else {
      solver_->SolveArrays(*arrays_, options, &result);
    }
    result.own_fresh_s = SteadyNow() - start;
    if (result.own_solve_s < 0) result.own_solve_s = result.own_fresh_s;
    return Send(MessageType::kResult, Encode(result));
  }

  const SolverFactory& make_;
  std::unique_ptr<LcpSolver> solver_;
  int in_;
  int out_;
  // For single solves: the problem as sent, the b that replaces its b, and the matrix that they share.
  std::optional<ProblemArrays> arrays_;
  std::optional<LcpProblem> problem_;
  std::optional<Eigen::VectorXd> other_b_;
  std::vector<ProblemArrays> stream_;
};

}  // namespace

bool RefuseToStart(const std::string& why) {
  struct stat out = {};
  if (fstat(STDOUT_FILENO, &out) != 0 || !S_ISSOCK(out.st_mode)) return false;
  constexpr double kWait = 10;  // s
  return WriteFrame(STDOUT_FILENO, MessageType::kRefusal, EncodeRefusal(why), SteadyNow() + kWait) == Transfer::kDone;
}

int ServeFrames(int in, int out, const Hello& hello, const SolverFactory& make) {
  return Worker(make, in, out).Run(hello);
}

int RunWorker(const Hello& hello, const SolverFactory& make) {
  // Nobody would wait for the answer of a worker whose host was killed.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int out = dup(STDOUT_FILENO);
  if (out < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return 1;
  try {
    return ServeFrames(STDIN_FILENO, out, hello, make);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "worker: %s\n", Printable(error.what()).c_str());
    return 1;
  }
}

}  // namespace lcpbench
