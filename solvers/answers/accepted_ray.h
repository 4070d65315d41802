#pragma once

#include <Eigen/Core>
#include <optional>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A direction found in doubles as a Farkas ray that VerifyFarkasRay accepts: as it is, or without entries that are
/// rounding of zeros; where that is a ray within rounding only, with entries of a few digits if this is a proof (ratios
/// of small whole numbers are frequent). Nothing where it is not accepted.  Up to six calls of VerifyFarkasRay;
/// allocates. Internal to solvers/.
/// @param direction  n numbers
std::optional<Eigen::VectorXd> AcceptedRay(const LcpProblem& problem, const Eigen::VectorXd& direction);

}  // namespace lcpbench
