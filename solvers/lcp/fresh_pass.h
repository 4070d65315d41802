#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "support/process_watch.h"

namespace lcpbench {

/// What a pass over a stream of problems times.
enum class PassKind : std::uint8_t {
  /// From the caller's arrays to f, in one interval around everything: checking the input, LcpProblem, forms of A,
  /// scaling, ordering, analysis, factorizations, fallbacks, the solver's own check. By a solver object that has solved
  /// other problems and never this one: what a user pays who meets a new problem every step.
  kFresh,
  /// The same work with clock reads between its parts, for explanation. Never summed into a fresh time.
  kParts,
  /// The same matrix with another b, from LcpProblem::WithB to f, right after an untimed solve with the given b: what a
  /// driver of constant geometry pays.
  kAgain,
};

/// One pass: problems are named by their index in the stream.
struct PassRequest {
  /// What is timed.
  PassKind kind = PassKind::kFresh;
  /// On rho, LcpOptions::tolerance.
  double tolerance = 1e-9;
  double time_limit_s = 0;  ///< of one solve [s]
  double longest_s = 0;     ///< that a solve of these problems took before [s]; 0: not known
  /// Solved first and not timed, so that the solver object has its workspace and the processor knows the code: once,
  /// and again until what they take settles.
  std::vector<std::uint32_t> warm_up;
  double settle_s = 0;               ///< how long that may go on after the first time [s]
  std::vector<std::uint32_t> order;  ///< timed, in this order; none of warm_up, each once
  /// kAgain: the other b of the problems of `order`, in its order.
  std::vector<Eigen::VectorXd> other_b;
};

/// What happened to one problem of a pass.
struct PassEntry {
  double seconds = 0;  ///< of kFresh and kAgain; of kParts problem + prepare + solve
  // Parts of kParts [s].
  double problem_s = 0;  ///< LcpProblem::FromArrays
  double prepare_s = 0;  ///< LcpSolver::Prepare
  double convert_s = 0;  ///< of a foreign library's adapter: conversions inside the solve; else 0
  double solve_s = 0;    ///< LcpSolver::Solve without convert_s
  /// The solver's claim.
  LcpStatus status = LcpStatus::kNotRun;
  /// n.
  Eigen::VectorXd f;
};

/// What came of a pass.
struct PassReply {
  std::vector<PassEntry> entries;  ///< in the order of PassRequest::order
  /// What the machine did to the thread that solved, while it timed; empty where that is not known.
  std::optional<Disturbance> disturbance;
};

/// Makes the solver object of a pass.
using SolverFactory = std::function<std::unique_ptr<LcpSolver>()>;

/// What a pass may take in all [s]: every solve twice its limit or, where that is less, four times longest_s, and some
/// more for what surrounds it. A process that hangs is not waited for longer.
double PassLimit(const PassRequest& request);

/// Runs one pass in this thread. The solver object is made for it, warmed up, and meets every problem once. The stream
/// is read just before, as arrays that were just written: whatever ran earlier, it lies in the caches as far as these
/// hold it. Every solve is timed by itself (Stopwatch).
/// @param problems  the whole stream
PassReply RunPass(const SolverFactory& make, std::span<const ProblemArrays> problems, const PassRequest& request);

}  // namespace lcpbench
