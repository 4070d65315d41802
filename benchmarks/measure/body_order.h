#pragma once

#include <Eigen/Core>
#include <string>

#include "benchmarks/measure/body_system.h"

namespace lcpbench {

/// How the bodies of a system are ordered for little fill. Ordering bodies and not coordinates takes a graph a third of
/// the size, and the unknowns of a body, which have the same neighbours, end up beside each other all the same.
enum class BodyOrder {
  kMinimumDegree,     ///< AMD [Amestoy, Davis, Duff, Algorithm 837, ACM TOMS 30, 2004]
  kNestedDissection,  ///< METIS [Karypis, Kumar, SIAM J. Sci. Comput. 20, 1998], where CHOLMOD was built with it
};

inline constexpr BodyOrder kBodyOrders[] = {BodyOrder::kMinimumDegree, BodyOrder::kNestedDissection};

/// "amd" or "metis".
std::string ToString(BodyOrder order);

/// order[k] = the body to eliminate k-th. Empty where this build cannot order so.
Eigen::VectorXi OrderBodies(const BodySystem& system, BodyOrder order);

/// The same for unknowns, each body's in their given order.  O(unknowns)
Eigen::VectorXi ExpandOrder(const BodySystem& system, const Eigen::VectorXi& bodies);

}  // namespace lcpbench
