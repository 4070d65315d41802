#pragma once

#include <Eigen/Core>

namespace lcpbench {

/// Singular values of a dense matrix, descending, with absolute errors of some roundings of the largest (LAPACK's
/// dgesdd).  O(rows columns min(rows, columns)); the matrix is overwritten
/// @throws std::runtime_error where the iteration does not converge
Eigen::VectorXd SingularValues(Eigen::MatrixXd* matrix);

}  // namespace lcpbench
