#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/studies/fresh_problems.h"
#include "solvers/lcp/fresh_pass.h"
#include "solvers/registry.h"

namespace lcpbench {

/// What a timed solve begins at.
enum class TimedFrom {
  kArrays,   ///< ProblemArrays
  kProblem,  ///< the same, of which an LcpProblem is made for LcpSolver::Solve, and destroyed after it
  kRows,     ///< an engine's arrays (StepRows)
};

/// What fresh_benchmark times: a solver, and where it runs.
struct Contestant {
  SolverEntry entry;
  const char* place = "";  ///< in words
  /// The solver object of a pass in this process; empty where it runs in a worker.
  std::function<std::unique_ptr<LcpSolver>(const FreshStream& stream, const PassRequest& request)> make;
};

/// By keys of the registry. Own solvers run in this process. So do peers whose libraries are linked into this program
/// (linked_peers.h). Other peers run in their workers.
/// @param only_workers  linked peers run in their workers, too
/// @param begins        kRows: `auto` as StepSolver, and codes of linked peers that take a dense A, which is assembled
///                      from the rows on their clock; problems without such arrays are refused (InputError) when they
///                      are met. kProblem: own solvers; peers begin at arrays.
/// @throws InputError for an unknown key, a solver that is not in this build, or one that takes no rows
std::vector<Contestant> MakeContestants(const std::vector<std::string>& keys, bool only_workers, TimedFrom begins);

/// Whether f answers that problem of the stream.
bool IsRight(const FreshStream& stream, std::size_t place, const Eigen::VectorXd& f, double tier);

/// Which problems of the stream it solves, each by itself and within its limit, from arrays. Linked peers do so in
/// their workers: what crashes or hangs there is never timed here.
std::vector<bool> Judge(const Contestant& contestant, const FreshStream& stream, double tier,
                        const SolveLimits& limits);

/// lcpbench::RunPass, in this process or in a worker that is started for it.
/// @throws WorkerFailure where that did not come to its end
PassReply RunPass(const Contestant& contestant, const FreshStream& stream, const PassRequest& request);

}  // namespace lcpbench
