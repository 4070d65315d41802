#include "benchmarks/measure/body_order.h"

#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/linear_algebra/graph_order.h"
#endif

namespace lcpbench {

std::string ToString(BodyOrder order) { return order == BodyOrder::kMinimumDegree ? "amd" : "metis"; }

Eigen::VectorXi OrderBodies(const BodySystem& system, BodyOrder order) {
#ifdef LCPBENCH_WITH_SUITESPARSE
  return OrderGraph(system.graph,
                    order == BodyOrder::kMinimumDegree ? GraphOrder::kMinimumDegree : GraphOrder::kNestedDissection);
#else
  static_cast<void>(system);
  static_cast<void>(order);
  return {};
#endif
}

Eigen::VectorXi ExpandOrder(const BodySystem& system, const Eigen::VectorXi& bodies) {
  Eigen::VectorXi order(system.lower.cols());
  Index next = 0;
  for (const int body : bodies) {
    const auto at = static_cast<std::size_t>(body);
    for (int k = system.first[at]; k < system.first[at + 1]; ++k) order[next++] = k;
  }
  return order;
}

}  // namespace lcpbench
