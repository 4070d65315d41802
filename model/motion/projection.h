#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/body.h"
#include "model/contact/system.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The rows of `lcp` with another right-hand side: the LCPs of impulses and displacements have the matrix of the
/// accelerations. b has one entry a row.
LcpProblem WithRightHandSide(const AssembledLcp& lcp, const Eigen::VectorXd& b);

/// M^-1 J^T f, three entries a body: what row multipliers f do to accelerations, velocities or positions.
/// @param problem  given by factors
Eigen::VectorXd DisplacementOf(const LcpProblem& problem, const Eigen::VectorXd& f);

/// v += change, of movable bodies.
void AddToVelocities(const Eigen::VectorXd& change, std::span<Body> bodies);

/// Velocities of the same bodies.
void CopyVelocities(std::span<const Body> from, std::span<Body> to);

/// The worst violation: max(-x, 0) of unilateral rows and |x| of bilateral ones, x = d [m] or d_dot [m/s].
double WorstViolation(const std::vector<RowInfo>& rows, double RowInfo::*x = &RowInfo::d);

/// Answers an LCP of displacements: multipliers in result->f.
using DisplacementSolver = std::function<void(const LcpProblem& problem, LcpResult* result)>;

/// Moves the bodies by the smallest displacement, in the kinetic metric, after which to first order no unilateral
/// constraint of `system` has d < 0 and every bilateral one d = 0: delta x = M^-1 J^T f with
///     w = A f + d,   unilateral rows 0 <= f _|_ w >= 0,   bilateral rows w = 0,
/// A the Delassus matrix. Repeated, for constraints curve, until the violation is at most `goal` [m], at most
/// kMostProjections times, and taken back where it does not get smaller. The LCP can be unsolvable where redundant rows
/// are violated against each other (a disc between walls that are too close).
/// @return the violation that is left
double ProjectPositions(double goal, const DisplacementSolver& solve, ContactSystem* system);

inline constexpr int kMostProjections = 4;

}  // namespace lcpbench
