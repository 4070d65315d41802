#pragma once

#include <Eigen/Core>
#include <optional>

#include "tests/solvers/test_problems.h"

namespace lcpbench {

/// A problem that is solvable or not by construction, in numbers that no solver is made for.
///
/// Integers and powers of two first: J, M^-1 and a planted f and w, or a ray y, all exact in double, and so are A and
/// b. Every rank from 0 on, repeated and opposed rows, joints that depend on each other, rows that nothing can move, f
/// = w = 0, chains up to 300 rows; often a row that closes a combination of others, J^T y = 0, with b.y negative
/// (unsolvable), 0 or barely positive. Then powers of two, which round nothing:
///     A -> S A S,  b -> t S b,  f -> t S^-1 f,  w -> t S w,  J_ik -> S_ii J_ik / c_k,  m_k -> m_k c_k^2
/// with S up to 2^+-500 (2^-900 by factors), t up to 2^+-1450, given as dense or sparse A or by factors.
///
/// With friction, rows are contacts, joints, friction rows of any number a contact, sliding and bounded rows, mu is 0
/// to 1e6 before it is scaled with the rows, S up to 2^+-300; f and w are planted in every mode. Rays are of contacts,
/// joints and bounded rows without a bound. Some problems have any b: whether there is a solution is not known of them.
struct AttackProblem {
  TestProblem test;       ///< with status, and w where it is unique
  Eigen::VectorXd proof;  ///< a solution f, or a ray y
  /// A warm start, near a solution but for some rows; of some problems.
  std::optional<Eigen::VectorXd> start = std::nullopt;
  /// Where kNumericalFailure is right, too: forces of this scale may leave the range of doubles, or the problem is
  /// unsolvable by so little that no ray proves it once it is rounded to double.
  bool may_fail = false;
  /// Where it is right, too, to call a solvable problem infeasible within rounding.
  bool is_nearly_infeasible = false;
};

/// The same seed gives the same problem, with one standard library. The verifier has accepted its proof, without any
/// rounding (forces beyond the range excepted, and problems of unknown status).
AttackProblem MakeAttackProblem(unsigned seed, bool with_friction);

}  // namespace lcpbench
