// A worker that misbehaves as its first argument says, or serves dantzig well, by any version of the protocol.

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/peers/protocol/protocol.h"
#include "solvers/peers/protocol/worker.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

class BadSolver : public LcpSolver {
 public:
  explicit BadSolver(std::string manner) : manner_(std::move(manner)) {}

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {
    if (manner_ == "crash-in-prepare") std::abort();
  }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const bool at_nine = problem.size() == 9;
    if (manner_ == "crash" || (manner_ == "crash-at-nine" && at_nine)) std::raise(SIGSEGV);
    if (manner_ == "exit") std::_Exit(3);
    if (manner_ == "throw") throw std::runtime_error("the library gave up");
    if (manner_ == "hang-aloud") std::fputs("hangs\n", stderr);
    if (manner_.starts_with("hang") && (manner_ != "hang-at-nine" || at_nine)) {
      for (;;) pause();
    }
    if (manner_ == "memory") {
      std::vector<std::vector<char>> hoard;
      for (;;) hoard.emplace_back(std::size_t{1} << 26U, 'x');
    }
    if (manner_ == "print") {
      std::printf("printing to standard output\n");
      std::fflush(stdout);
    }
    if (manner_ == "add-one") {
      if (options.initial_f != nullptr) result->f = *options.initial_f;
      result->f.array() += 1;
    }
    // Claims success, whatever f is.
    result->status = LcpStatus::kSolved;
    if (manner_ == "nan") result->f.setConstant(problem.size(), std::nan(""));
  }

 private:
  std::string manner_;
};

// Right, and long enough under way for something to happen meanwhile.
class SlowSolver : public LcpSolver {
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    usleep(20'000);
    MakeSolver("dantzig")->Solve(problem, options, result);
  }
};

// Right, unless it is given the matrix of its last problem with another b.
class HangingAgainSolver : public LcpSolver {
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Eigen::VectorXd& diagonal = problem.DiagonalA();
    const bool again = diagonal.size() == diagonal_.size() && diagonal == diagonal_ && problem.b() != b_;
    diagonal_ = diagonal;
    b_ = problem.b();
    if (again) std::fputs("hangs\n", stderr);
    while (again) pause();
    MakeSolver("dantzig")->Solve(problem, options, result);
  }
  Eigen::VectorXd diagonal_, b_;
};

// What a program must do at the least, by an older version of the protocol.
// @param form  of problems, for version 1
int ServeVersion(std::uint32_t version, WantedForm form) {
  constexpr double kForever = 1e9;
  const auto solver = MakeSolver("dantzig");
  std::optional<LcpProblem> problem;
  const Hello hello{version, form, "version-" + std::to_string(version), "1.0", "none"};
  WriteFrame(STDOUT_FILENO, MessageType::kHello, Encode(hello), kForever);
  MessageType type{};
  Bytes payload;
  while (ReadFrame(STDIN_FILENO, &type, &payload, kForever) == Transfer::kDone) {
    if (type == MessageType::kProblem) {
      const ProblemArrays arrays = DecodeProblem(payload, version);
      const MatrixForm wanted = form == WantedForm::kDense ? MatrixForm::kDense : MatrixForm::kSparse;
      const bool as_wanted = form == WantedForm::kAsGiven || arrays.form == wanted;
      problem = LcpProblem::FromArrays(arrays);
      if (version > 1) {
        WriteFrame(STDOUT_FILENO, MessageType::kLoaded, {}, kForever);
        continue;
      }
      WriteFrame(STDOUT_FILENO, MessageType::kPrepared, Encode(Prepared{0.25, as_wanted ? "" : "another form"}),
                 kForever);
    } else if (type == MessageType::kSolve) {
      LcpResult result;
      solver->Solve(*problem, {}, &result);
      result.own_solve_s = 0.5;
      WriteFrame(STDOUT_FILENO, MessageType::kResult, Encode(result, version), kForever);
    } else {
      return type == MessageType::kQuit ? 0 : 1;
    }
  }
  return 0;
}

// Greets, and stops where its manner says: before or within what it is sent, or within its answer.
[[noreturn]] void Stop(const Hello& hello, const std::string& manner) {
  constexpr double kForever = 1e9;
  WriteFrame(STDOUT_FILENO, MessageType::kHello, Encode(hello), kForever);
  char some[20];
  if (manner == "stop-within-problem") ReadAll(STDIN_FILENO, some, sizeof some, kForever);
  if (manner == "stop-within-answer") {
    MessageType type{};
    Bytes payload;
    ReadFrame(STDIN_FILENO, &type, &payload, kForever);
    type = MessageType::kLoaded;
    WriteAll(STDOUT_FILENO, &type, 3, kForever);
  }
  for (;;) pause();
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  using namespace lcpbench;
  const std::string manner = argc > 1 ? argv[1] : "";
  if (manner == "mute") {
    for (;;) pause();
  }
  if (manner == "refuse") return RefuseToStart("expected speed in (0, 1)") ? 2 : 1;
  if (manner == "garbage") {
    std::puts("Hello, I am not a worker, and this is more than a header");
    return 0;
  }
  if (manner == "version-1-dense") return ServeVersion(1, WantedForm::kDense);
  if (manner == "version-1-sparse") return ServeVersion(1, WantedForm::kSparse);
  if (manner == "version-1-given") return ServeVersion(1, WantedForm::kAsGiven);
  for (const std::uint32_t version : {2U, 3U, 4U}) {
    if (manner == "version-" + std::to_string(version)) return ServeVersion(version, WantedForm::kAsGiven);
  }
  const Hello hello{kProtocolVersion, {}, manner, "1.0", "none"};
  if (manner.rfind("stop-", 0) == 0) Stop(hello, manner);
  return RunWorker(hello, [&]() -> std::unique_ptr<LcpSolver> {
    if (manner == "dantzig") return MakeSolver("dantzig");
    if (manner == "slow") return std::make_unique<SlowSolver>();
    if (manner == "again-hangs") return std::make_unique<HangingAgainSolver>();
    return std::make_unique<BadSolver>(manner);
  });
}
