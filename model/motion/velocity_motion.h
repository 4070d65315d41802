#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "model/motion/contact_finder.h"
#include "model/motion/motion.h"
#include "model/motion/row_matching.h"

namespace lcpbench {

/// Lengths marked "sizes" are in units of VelocityMotion::size(), that of the smallest movable body.
struct VelocityOptions {
  double step = 1e-3;  ///< h [s], > 0
  /// Newton's e, one for all contacts, in [0, 1]. A contact that approaches fast enough to close within the step leaves
  /// with e times its speed, where impulses on other contacts do not make it faster.
  double restitution = 0;
  /// What can touch within the step must be in the LCP: contacts enter up to the gap reach * 2 h V + contact_gap, V the
  /// largest speed of any point of a body at its free velocity v^. >= 1; more than 1 because impulses make bodies
  /// faster than v^ says. What comes faster still is met one step later, with penetration.
  double reach = 1.5;
  /// [sizes], > 0: above the rounding of gaps, where everything is at rest.
  double contact_gap = 1e-6;
  /// Deeper overlaps are not seen as contacts [sizes], > 0.
  double max_depth = 0.25;
  /// A corner that lies a little below a face may lie deep below the face around the next corner, and must not be
  /// pushed out there: contacts deeper than this [sizes], > 0, count only if the two bodies have no shallower one that
  /// lies behind both surfaces of the deeper and faces another way.
  double doubtful_depth = 0.02;
  /// delta [sizes], > 0: no more than this depth (or joint error) is undone in one step.
  double depth_clamp = 0.01;
  /// The share of the (clamped) depth or joint error that one step undoes, in [0, 1]. 1 is the scheme as published.
  double stabilisation = 1;
  /// Starts every solve from the impulses of the step before, rows matched by RowMatching.
  bool warm_start = true;
  /// Tolerance and limits of every solve; initial_f is not read.
  LcpOptions lcp;
};

/// The time stepping of Anitescu and Potra (1997) and Stewart and Trinkle (1996) without friction [MODEL.md section 9]:
///     v^ = v + h M^-1 F,   w = A p + J v^ + c,   0 <= p perp w >= 0 (joints: w = 0, p free),
///     v+ = v^ + M^-1 J^T p,   x+ = x + h v+,   theta+ = theta + h omega+,
/// with J, the gaps d and the forces F at the step's beginning, p impulses [N s], w velocities [m/s], and
///     c = d / h                                   of contacts and ropes with d >= 0,
///     c = stabilisation max(d, -delta) / h        of those with d < 0; joints: d clamped to [-delta, delta],
///     c = min(c, e d')                            of contacts that close within the step at d' = J v < 0, if e > 0.
/// Order 1 in h. Kinematic bodies follow their prescribed acceleration exactly; J v^ has their mean velocity.
///
/// Energy: under constant forces every exact step changes it by  -|v+ - v|_M^2 / 2 - p.c.  With e = 0 it grows by the
/// depth term alone, and never while nothing overlaps.
///
/// Unsolvable steps: rows with c < 0 (or moving kinematic bodies) that oppose each other can leave no solution. Where
/// the solver says kInfeasible, the observer gets that problem with its ray, statistics().unsolvable counts it, and the
/// step is repeated with less: first with c = max(c, 0) on contacts and ropes and c = 0 on joints, then also with
/// kinematic bodies at rest, for which a solution always exists. They move on as prescribed all the same. Any other
/// failure goes on with the impulses that it left, unless they are not finite: kSolverFailed.
///
/// O(contacts) per step beside the broad phase and the solve.
class VelocityMotion final : public Motion {
 public:
  /// @param solver  not owned; must outlive the motion
  /// @throws InputError for an invalid world (RequireValid) or options outside their ranges
  VelocityMotion(World world, const VelocityOptions& options, LcpSolver& solver);

  /// The smallest width or height of a movable body's outline in its body frame [m]; 1 where none has an outline.
  double size() const { return size_; }

 private:
  /// By the least number of equal steps of at most VelocityOptions::step.
  void Move(double duration) override;
  void Step(double h);
  Eigen::VectorXd FreeVelocity(double h) const;
  double LargestSpeed(const Eigen::VectorXd& v_free) const;
  std::vector<Constraint> WithoutGhosts(const ContactSystem& system, const std::vector<RowInfo>& rows) const;
  double DepthTerm(const RowInfo& row, bool contact, double h) const;
  void GuessImpulses(const ContactSystem& system, const std::vector<RowInfo>& rows);
  LcpResult Solve(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd& v_free, double h);
  void MoveBodies(const Eigen::VectorXd& v_new, double h);

  VelocityOptions options_;
  ContactFinder finder_;
  RowMatching matching_;
  std::vector<Extent> extents_;  // of the bodies
  double size_ = 1;
  Eigen::VectorXd impulses_;  // of the step before
  Eigen::VectorXd guess_;
};

}  // namespace lcpbench
