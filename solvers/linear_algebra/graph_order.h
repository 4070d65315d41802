#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace lcpbench {

/// How the nodes of a graph are ordered for little fill of a symmetric factor.
enum class GraphOrder {
  kMinimumDegree,     ///< AMD [Amestoy, Davis, Duff, Algorithm 837, ACM TOMS 30, 2004]
  kNestedDissection,  ///< METIS [Karypis, Kumar, SIAM J. Sci. Comput. 20, 1998], where CHOLMOD was built with it
};

/// order[k] = the node to eliminate k-th, postordered along the elimination tree, so that columns of like structure
/// follow each other. Empty where this build cannot order so.
/// @param graph  lower triangle of the adjacency matrix; only its pattern is read; the diagonal does not matter
Eigen::VectorXi OrderGraph(const Eigen::SparseMatrix<double, Eigen::ColMajor, int>& graph, GraphOrder order);

/// The order `nodes` of this graph, postordered: of equal fill. Empty where there is no memory for it.
Eigen::VectorXi Postordered(const Eigen::SparseMatrix<double, Eigen::ColMajor, int>& graph,
                            const Eigen::VectorXi& nodes);

}  // namespace lcpbench
