#include "benchmarks/measure/solver_pool.h"

#include <stdexcept>

#include "solvers/peers/protocol/external_solver.h"

namespace lcpbench {

LcpSolver& SolverPool::Get(const SolverEntry& entry) {
  if (entry.origin == SolverOrigin::kOwn) {
    fresh_.reset();
    fresh_ = entry.make({});
    return *fresh_;
  }
  std::unique_ptr<LcpSolver>& kept = workers_[entry.key];
  if (kept == nullptr) kept = entry.make({});
  if (auto* external = dynamic_cast<ExternalSolver*>(kept.get())) {
    try {
      external->Greet();
    } catch (const std::runtime_error&) {
      // The solve will say what is wrong.
    }
  }
  return *kept;
}

}  // namespace lcpbench
