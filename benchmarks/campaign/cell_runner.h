#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "benchmarks/cache_flush.h"
#include "benchmarks/campaign/cell.h"
#include "benchmarks/hardware_counters.h"
#include "benchmarks/solver_pool.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {

/// Runs cells, within a worker process: makes the problem, sets the solver up, solves, judges, and lets Google
/// Benchmark time the solve again where it passed. Keeps the last problem, the manifest and its references.
class CellRunner {
 public:
  /// Called when a phase begins whose length the caller limits: the problem is made, and the set-up and first solve
  /// begin; these are done, and repetitions begin.
  enum class Phase { kSolve, kRepeat };

  CellRunner();
  ~CellRunner();

  /// @throws InputError for an unknown manifest, problem or solver
  CellReply Run(const CellRequest& request, const std::function<void(Phase)>& begin);

 private:
  struct Set;
  Set& Load(const std::string& manifest);
  const LcpProblem& Make(const CellRequest& request);
  // Observed: allocations, counters, factorisations. Returns its time.
  double SolveFirst(LcpSolver& solver, const LcpProblem& problem, const LcpOptions& options, bool times_itself,
                    CacheFlush* flush, LcpResult* result, CellReply* reply);

  std::map<std::string, std::unique_ptr<Set>> sets_;
  std::string problem_id_;
  std::optional<LcpProblem> problem_;
  LcpReference reference_;  // of the problem
  SolverPool pool_;
  HardwareCounters counters_;
  std::optional<CacheFlush> flush_;
};

}  // namespace lcpbench
