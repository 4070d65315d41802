#pragma once

#include <Eigen/Core>
#include <optional>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A_ii = 0 makes row i of a PSD A zero: w_i = b_i whatever f is. If that is wrong by more than `threshold` in some
/// such row, +-e_i as a ray that VerifyFarkasRay accepts. O(n); allocates for a ray only. Internal to solvers/.
std::optional<Eigen::VectorXd> FindZeroRowRay(const LcpProblem& problem, double threshold);

}  // namespace lcpbench
