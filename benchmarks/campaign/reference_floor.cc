#include "benchmarks/campaign/reference_floor.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "solvers/lcp/rounding_floor.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

// By expected cost. The answers of an interior point, of pivoting and of descent from 0 lie apart where f is not
// unique: their floors differ by up to 50 on redundant packings.
constexpr std::array<std::string_view, 4> kReferenceSolvers = {"auto", "suitesparse", "nncg", "dantzig"};

}  // namespace

std::optional<double> FindReferenceFloor(const LcpProblem& problem, double tolerance, double time_limit_s) {
  std::optional<double> least;
  LcpOptions options;
  options.tolerance = tolerance;
  options.time_limit_s = time_limit_s;
  for (const std::string_view key : kReferenceSolvers) {
    const SolverEntry& entry = FindSolver(key);
    if (!entry.available || !SizeRefusal(entry, problem.size()).empty()) continue;
    LcpResult result;
    entry.make({})->Solve(problem, options, &result);
    LcpReference own;
    own.floor = RoundingFloor(problem, result.f);
    if (!Verify(problem, result, tolerance, &own).passes) continue;
    least = std::min(least.value_or(*own.floor), *own.floor);
    if (*least <= tolerance) break;
  }
  return least;
}

}  // namespace lcpbench
