#include "benchmarks/measure/solver_pool.h"

#include <stdexcept>

#include "solvers/peers/protocol/external_solver.h"

namespace lcpbench {

LcpSolver& SolverPool::Get(const SolverEntry& entry) {
  if (solver_ == nullptr || key_ != entry.key || entry.origin == SolverOrigin::kOwn) {
    solver_.reset();
    solver_ = entry.make({});
    key_ = entry.key;
  }
  if (auto* external = dynamic_cast<ExternalSolver*>(solver_.get())) {
    try {
      external->Greet();
    } catch (const std::runtime_error&) {
      // The solve will say what is wrong.
    }
  }
  return *solver_;
}

}  // namespace lcpbench
