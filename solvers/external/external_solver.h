#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "solvers/external/protocol.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The worker and its limits.
struct ExternalSolverOptions {
  /// Program (looked up in PATH unless it holds a slash) and its arguments.
  std::vector<std::string> command;
  /// Address space that the worker may use [bytes]; 0 for no limit of our own.
  std::uint64_t memory_limit = std::uint64_t{8} << 30U;
  /// For the worker to say hello, and to take over a problem [s]. Interpreters start slowly.
  double start_limit_s = 60;
  double prepare_limit_s = 120;  ///< to take over a problem [s]
  /// What a solve may take beyond its own time limit before the worker is killed: grace_factor times it + grace_s.
  double grace_factor = 0.5;
  double grace_s = 1;  ///< [s], see grace_factor
};

/// A solver in a process of its own, behind the protocol of protocol.h: code that crashes, hangs, exhausts memory,
/// prints, or does not live in one process with other libraries.
///
/// Method, guarantees, options: the worker's. Set-up is the conversion into the form that the worker wants, sending it,
/// and the worker's own preparation. result.own_solve_s is the worker's reading around the solve alone, so that pipes
/// are not part of it; options.repetitions repeats the solve there.
/// What a failure leaves: a worker that ends or breaks the protocol is kNumericalFailure with the way it ended in
/// detail; one that does not stop at its time limit is killed and kTimeLimit; f is zero then. The next solve starts a
/// new worker. A worker's claims are verified like everyone's.
/// The worker starts with the first problem and ends with this object.
class ExternalSolver : public LcpSolver {
 public:
  /// @throws InputError for an empty command or limits that are not > 0
  explicit ExternalSolver(ExternalSolverOptions options);
  ~ExternalSolver() override;
  ExternalSolver(const ExternalSolver&) = delete;
  ExternalSolver& operator=(const ExternalSolver&) = delete;

  /// What the worker says of itself; starts it.
  /// @throws InputError if it cannot be started or does not greet as the protocol prescribes
  const Hello& Greet();

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  class Process;

  void SendProblem(const LcpProblem& problem);

  ExternalSolverOptions options_;
  std::unique_ptr<Process> process_;
  Hello hello_;
  Prepared prepared_;
  std::string failure_;  // of the last DoPrepare
};

}  // namespace lcpbench
