#pragma once

#include "tests/solvers/test_problems.h"

namespace lcpbench {

/// 2 to 8 rows of which some are parallel to another but for 1e-3 to 1e-9: forces up to 10^18 |b|, which no double
/// holds finely enough. Dense, sparse or factors; contacts, joints or both. For rows of equal size, w sums large terms
/// that cancel, and its rounding can be anything, 0 too.
LcpProblem NearlyParallelRows(unsigned seed);

/// Two nearly parallel joints, A dense, and their one answer rounded to doubles.
struct TwoJoints {
  LcpProblem problem;
  Eigen::VectorXd f;
};
/// The angle is 1e-2 to 1e-7, so that the rounding floor of f lies between 1e-13 and 1e-2.
TwoJoints NearlyParallelJoints(unsigned seed);

/// A Scott-Russell linkage at an angle of 1 to 1e-8 rad from its dead point: a ladder on two walls and 1 to 3 equal
/// arms from the corner to its middle, all rows joints. One arm too many and every further one makes A singular; the
/// rows are off by up to 1e-11, so that they contradict each other by as much.
LcpProblem RedundantLinkage(unsigned seed);

}  // namespace lcpbench
