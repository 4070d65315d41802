#include "solvers/linear_algebra/graph_order.h"

#include "solvers/linear_algebra/cholmod_view.h"

namespace lcpbench {
namespace {

// Silent, and freed with the scope.
struct Common {
  cholmod_common common{};
  Common() {
    cholmod_start(&common);
    common.print = 0;
  }
  ~Common() { cholmod_finish(&common); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
};

using Graph = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

}  // namespace

Eigen::VectorXi OrderGraph(const Graph& graph, GraphOrder order) {
  const Eigen::Index n = graph.cols();
  Eigen::VectorXi nodes(n);
  if (n == 0) return nodes;
  Common c;
  cholmod_sparse pattern = ViewOf(graph, CHOLMOD_PATTERN, -1);
  const int ordered = order == GraphOrder::kMinimumDegree
                          ? cholmod_amd(&pattern, nullptr, 0, nodes.data(), &c.common)
                          : cholmod_metis(&pattern, nullptr, 0, /*postorder=*/0, nodes.data(), &c.common);
  if (ordered == 0) return {};
  return Postordered(graph, nodes);
}

Eigen::VectorXi Postordered(const Graph& graph, const Eigen::VectorXi& nodes) {
  const Eigen::Index n = graph.cols();
  Eigen::VectorXi order = nodes;  // CHOLMOD only reads it
  if (n == 0) return order;
  Common c;
  cholmod_sparse pattern = ViewOf(graph, CHOLMOD_PATTERN, -1);
  cholmod_sparse* permuted = cholmod_ptranspose(&pattern, 0, order.data(), nullptr, 0, &c.common);
  Eigen::VectorXi parent(n), post(n);
  const bool done = permuted != nullptr && cholmod_etree(permuted, parent.data(), &c.common) != 0 &&
                    cholmod_postorder(parent.data(), static_cast<size_t>(n), nullptr, post.data(), &c.common) == n;
  cholmod_free_sparse(&permuted, &c.common);
  if (!done) return {};
  for (Eigen::Index k = 0; k < n; ++k) order[k] = nodes[post[k]];
  return order;
}

}  // namespace lcpbench
