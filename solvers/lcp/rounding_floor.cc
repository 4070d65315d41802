#include "solvers/lcp/rounding_floor.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace lcpbench {

bool IsBelowFloor(const Metrics& metrics, double tolerance) {
  const bool is_near = metrics.rho <= std::min(kFloorReach * metrics.answer_floor, kLargestFloor);
  return metrics.floor < 0 && tolerance < metrics.answer_floor && is_near;
}

void FloorTeller::Tell(const LcpProblem& problem, double tolerance, LcpResult* result) const {
  if (!is_outermost_ || result->status != LcpStatus::kNumericalFailure) return;
  const Metrics metrics = ComputeMetrics(problem, result->f);
  if (!IsBelowFloor(metrics, tolerance)) return;
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.2g is below the rounding floor %.2g of this problem", tolerance,
                metrics.answer_floor);
  result->detail.append(result->detail.empty() ? "" : "; ").append(text.data());
}

}  // namespace lcpbench
