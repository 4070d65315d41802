// A worker that misbehaves as its first argument says, or serves dantzig well.

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/external/worker.h"
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
    if (manner_ == "crash") std::raise(SIGSEGV);
    if (manner_ == "exit") std::_Exit(3);
    if (manner_ == "throw") throw std::runtime_error("the library gave up");
    if (manner_ == "hang") {
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

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  using namespace lcpbench;
  const std::string manner = argc > 1 ? argv[1] : "";
  if (manner == "mute") {
    for (;;) pause();
  }
  if (manner == "garbage") {
    std::puts("Hello, I am not a worker, and this is more than a header");
    return 0;
  }
  const Hello hello{kProtocolVersion, WantedForm::kAsGiven, manner, "1.0", "none"};
  if (manner == "dantzig") return RunWorker(hello, *MakeSolver("dantzig"));
  BadSolver solver(manner);
  return RunWorker(hello, solver);
}
