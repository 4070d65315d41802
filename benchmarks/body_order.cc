#include "benchmarks/body_order.h"

#ifdef LCPBENCH_WITH_SUITESPARSE
#include <cholmod.h>
#endif

namespace lcpbench {

std::string ToString(BodyOrder order) { return order == BodyOrder::kMinimumDegree ? "amd" : "metis"; }

Eigen::VectorXi OrderBodies(const BodySystem& system, BodyOrder order) {
#ifdef LCPBENCH_WITH_SUITESPARSE
  cholmod_common common{};
  cholmod_start(&common);
  common.print = 0;
  // CHOLMOD takes patterns as non-const and only reads them.
  const BodySystem::ColumnMatrix& graph = system.graph;
  cholmod_sparse pattern{};
  pattern.nrow = pattern.ncol = static_cast<std::size_t>(graph.cols());
  pattern.nzmax = static_cast<std::size_t>(graph.nonZeros());
  pattern.p = const_cast<int*>(graph.outerIndexPtr());
  pattern.i = const_cast<int*>(graph.innerIndexPtr());
  pattern.stype = -1;
  pattern.itype = CHOLMOD_INT;
  pattern.xtype = CHOLMOD_PATTERN;
  pattern.dtype = CHOLMOD_DOUBLE;
  pattern.sorted = 1;
  pattern.packed = 1;
  Eigen::VectorXi permutation(graph.cols());
  const int done = order == BodyOrder::kMinimumDegree
                       ? cholmod_amd(&pattern, nullptr, 0, permutation.data(), &common)
                       : cholmod_metis(&pattern, nullptr, 0, /*postorder=*/1, permutation.data(), &common);
  cholmod_finish(&common);
  if (done == 0) permutation.resize(0);
  return permutation;
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
