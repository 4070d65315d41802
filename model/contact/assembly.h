#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/contact/system.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// One row of an assembled system, with the geometry it came from (world frame).
struct RowInfo {
  int constraint = 0;  ///< index into ContactSystem::constraints
  char axis = 'n';     ///< 'n' contact, path joint, rod or rope; 'x' or 'y' the rows of a pin
  bool bilateral = false;
  Vec2 p1;  ///< closest point on body 1
  Vec2 p2;  ///< closest point on body 2
  /// Unit normal from body 2 to body 1 (a pin row: its world axis; a rope: from p1 to p2, because it pulls). The row is
  /// J = [n, R1 x n, -n, -R2 x n] in every case: f acts on body 1 as +f n.
  Vec2 n;
  double d = 0;      ///< gap [m] (a pin row: its component of g = p1 - p2; a rod: |p1 - p2| - L; a rope: L - |p1 - p2|)
  double d_dot = 0;  ///< [m/s]
  double gamma = 0;  ///< velocity-product term of d'' [m/s^2]
};

/// J (n x 3N, columns of every body in body order, fixed ones included), inverse mass (3N, 0 for fixed bodies),
/// b = J M^-1 F + gamma (prescribed accelerations of fixed bodies through J), and the rows' geometry.
struct AssembledLcp {
  std::vector<RowInfo> rows;
  LcpProblem problem;
};

/// Assembles the acceleration-level LCP of `system`. [docs/model.md sections 3, 4, 6, 8]  O(rows).
/// @throws InputError for invalid geometry, and for singular constraints, naming the condition and both features
AssembledLcp AssembleContactLcp(const ContactSystem& system);

}  // namespace lcpbench
