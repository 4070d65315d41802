#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/peers/protocol/protocol.h"
#include "support/subprocess.h"

namespace lcpbench {

/// What a worker has to say hello [s], unless told otherwise.
inline constexpr double kStartLimit = 10;

/// The worker and its limits.
struct ExternalSolverOptions {
  /// Program (looked up in PATH unless it holds a slash) and its arguments.
  std::vector<std::string> command;
  std::string name = {};  ///< for messages; "": the program
  /// Address space that the worker may use [bytes]; 0 for no limit of our own.
  std::uint64_t memory_limit = std::uint64_t{8} << 30U;
  double start_limit_s = kStartLimit;  ///< for the worker to say hello [s]; interpreters start slowly
  /// To take over a stream, and at most for a problem [s]. A problem has as long as a solve, see below, and a second
  /// for every 20 MB of it.
  double prepare_limit_s = 120;
  /// What a solve may take beyond its own time limit before the worker is killed: grace_factor times it + grace_s.
  double grace_factor = 0.5;
  double grace_s = 1;  ///< [s], see grace_factor
};

/// What became of a worker that was to load a stream or run a pass: it is gone, and the next use starts another.
class WorkerFailure : public std::runtime_error {
 public:
  /// How the worker ended.
  enum class How {
    kNotStarted,  ///< or did not greet
    kTimeLimit,   ///< no answer in time: it was killed
    kEnded,       ///< by itself: a crash, an exit
    kKilled,      ///< by something else (SIGKILL, SIGTERM)
    kBroken,      ///< broke the protocol, and was killed
  };
  /// @param what  the reason in words
  WorkerFailure(How how, const std::string& what) : std::runtime_error(what), how_(how) {}
  /// How the worker ended.
  How how() const { return how_; }

 private:
  How how_;
};

/// A solver in a process of its own, behind the protocol of protocol.h: code that crashes, hangs, exhausts memory,
/// prints, or does not live in one process with other libraries.
///
/// Method, guarantees, options: the worker's. The problem is sent in its given form; the worker forms and converts what
/// its library takes on its own clock, result.own_fresh_s, so that pipes are not part of it. After LcpProblem::WithB
/// only b is sent.
/// A worker that something else kills (SIGKILL, SIGTERM) says nothing of the solver: the solve, or the pass, is tried
/// once more by a new one.
/// What a failure leaves: a worker that ends or breaks the protocol is kNumericalFailure with the way it ended in
/// detail; one that does not take the problem in time, or stop at its time limit, is killed and kTimeLimit; f is zero
/// then. The next solve starts a new worker. A worker's claims are verified like everyone's.
/// The worker starts with the first problem and ends with this object.
///
/// Problems with friction or bounded rows are for the worker to take or to refuse; one of a version before 5, which is
/// sent plain problems only, is not asked: kUnsupported.
///
/// For a worker of version 1, A is formed here, anew for every problem and every b; own_fresh_s is the sum of that and
/// of what the worker says of its conversions and its solve.
class ExternalSolver : public LcpSolver {
 public:
  /// @throws InputError for an empty command or limits that are not > 0
  explicit ExternalSolver(ExternalSolverOptions options);
  ~ExternalSolver() override;
  ExternalSolver(const ExternalSolver&) = delete;
  ExternalSolver& operator=(const ExternalSolver&) = delete;

  /// What the worker says of itself; starts it.
  /// @throws InputError if it cannot be started, refuses (what it says), or does not greet as the protocol prescribes
  const Hello& Greet();
  /// Starts it. @throws InputError as Greet
  bool is_version_1() { return Greet().version == 1; }
  /// What forming A for a worker of version 1 took here in the last solve [s]; else 0.
  double formed_on_host_s() const { return formed_on_host_s_; }

  /// How workers ended that something else killed since the last call, before a new one tried again; "": none did.
  std::string TakeRetried() { return std::exchange(retried_, {}); }

  bool TakesFriction() const override { return true; }  ///< the worker says whether it does
  bool TakesBounded() const override { return true; }   ///< the worker says whether it does

  /// The stream that passes are about; it must stay until another is loaded. A worker started later gets it by itself.
  /// @throws WorkerFailure
  void LoadStream(std::span<const ProblemArrays> stream);
  /// As lcpbench::RunPass, in the worker. With a worker of a version before 4, or before 5 where not all of the stream
  /// is plain, every problem is a solve of its own by one and the same worker; of version 1 PassEntry::problem_s is
  /// what forming A took here, whatever the kind, and nothing is known "again".
  /// @param limit_s  for the whole pass [s]
  /// @throws WorkerFailure
  PassReply RunPass(const PassRequest& request, double limit_s);

 protected:
  /// Nothing: what taking over a problem may take depends on the limit of its solve.
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  std::string Name() const {
    return "worker '" + (options_.name.empty() ? options_.command.front() : options_.name) + "' ";
  }
  void Check(Transfer outcome, double limit_s);
  Bytes Receive(MessageType expected, double limit_s);
  double WithGrace(double time_limit_s) const { return time_limit_s * (1 + options_.grace_factor) + options_.grace_s; }
  template <typename Decode>
  auto Exchange(MessageType type, const Bytes& payload, MessageType answer, double limit_s, Decode decode);
  void Load(const LcpProblem& problem, double time_limit_s);
  void SendStream();
  bool RunsPasses() const;
  bool Retries(const WorkerFailure& failure);
  LcpResult RequestSolve(const LcpProblem& problem, const LcpOptions& options);
  PassReply RunPassByProblems(const PassRequest& request, double limit_s);

  ExternalSolverOptions options_;
  std::unique_ptr<Subprocess> process_;
  Hello hello_;
  bool may_retry_ = true;  // no retry yet of what is under way
  std::string retried_;
  // What the worker holds.
  std::optional<LcpProblem> loaded_;
  bool has_stream_ = false;

  std::span<const ProblemArrays> stream_;
  // Version 1.
  Prepared prepared_;
  double formed_on_host_s_ = 0;
};

}  // namespace lcpbench
