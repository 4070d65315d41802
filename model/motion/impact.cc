#include "model/motion/impact.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "model/motion/projection.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// The constraints of `system` without unilateral ones that separate.
ContactSystem WithoutSeparating(const ContactSystem& system, double tolerance) {
  const AssembledLcp all = AssembleContactLcp(system);
  std::vector<bool> stays(system.constraints.size(), false);
  for (const RowInfo& row : all.rows) {
    if (row.bilateral || row.d_dot <= tolerance) stays[static_cast<std::size_t>(row.constraint)] = true;
  }
  ContactSystem touching{system.name, system.bodies, {}};
  for (std::size_t k = 0; k < stays.size(); ++k) {
    if (stays[k]) touching.constraints.push_back(system.constraints[k]);
  }
  return touching;
}

double RestitutionOf(const ImpactOptions& options, const ContactSystem& system, const RowInfo& row) {
  if (row.bilateral || -row.d_dot < options.resting_speed) return 0;
  if (!options.pair_restitution) return options.restitution;
  const Constraint& constraint = system.constraints[static_cast<std::size_t>(row.constraint)];
  const double e = options.pair_restitution(constraint.body1, constraint.body2);
  if (!(e >= 0 && e <= 1)) {
    throw InputError("the restitution of bodies " + std::to_string(constraint.body1) + " and " +
                     std::to_string(constraint.body2) + " must be in [0, 1], found " + std::to_string(e));
  }
  return e;
}

// Solves w = A p + q and applies p.
Eigen::VectorXd Apply(const ImpulseSolver& solve, const AssembledLcp& lcp, const Eigen::VectorXd& q,
                      ContactSystem* system) {
  const LcpProblem problem = WithRightHandSide(lcp, q);
  LcpResult result;
  solve(*system, lcp.rows, problem, &result);
  AddToVelocities(DisplacementOf(problem, result.f), system->bodies);
  return result.f;
}

Eigen::VectorXd GapRates(const std::vector<RowInfo>& rows) {
  Eigen::VectorXd rates(static_cast<Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) rates[static_cast<Index>(i)] = rows[i].d_dot;
  return rates;
}

void CompressOnly(const ImpulseSolver& solve, ContactSystem* touching) {
  const AssembledLcp lcp = AssembleContactLcp(*touching);
  if (!lcp.rows.empty()) Apply(solve, lcp, GapRates(lcp.rows), touching);
}

void Newton(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* touching) {
  const AssembledLcp lcp = AssembleContactLcp(*touching);
  double approach = 0;
  for (const RowInfo& row : lcp.rows) {
    if (!row.bilateral) approach = std::max(approach, -row.d_dot);
  }
  const double e = approach < options.resting_speed ? 0 : options.restitution;
  Eigen::VectorXd q = GapRates(lcp.rows);
  for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
    if (!lcp.rows[i].bilateral) q[static_cast<Index>(i)] *= 1 + e;
  }
  Apply(solve, lcp, q, touching);
}

void Poisson(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* touching) {
  const AssembledLcp lcp = AssembleContactLcp(*touching);
  Eigen::VectorXd restored = Apply(solve, lcp, GapRates(lcp.rows), touching);
  for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
    restored[static_cast<Index>(i)] *= RestitutionOf(options, *touching, lcp.rows[i]);
  }
  AddToVelocities(DisplacementOf(lcp.problem, restored), touching->bodies);
  // All rows again, whether they separate now or not: none of them demands more than w >= 0.
  CompressOnly(solve, touching);
}

}  // namespace

void RequireValid(const ImpactOptions& options) {
  if (!(options.restitution >= 0 && options.restitution <= 1)) {
    throw InputError("the restitution must be in [0, 1], found " + std::to_string(options.restitution));
  }
  if (options.pair_restitution && options.law != ImpactLaw::kPoisson) {
    throw InputError("restitution by pairs of bodies needs Poisson's law: Newton's may have no solution");
  }
  if (!(std::isfinite(options.resting_speed) && options.resting_speed >= 0)) {
    throw InputError("the resting speed must be finite and >= 0");
  }
  if (!(std::isfinite(options.velocity_tolerance) && options.velocity_tolerance > 0)) {
    throw InputError("the velocity tolerance must be finite and > 0");
  }
}

void ResolveImpact(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system) {
  ContactSystem touching = WithoutSeparating(*system, options.velocity_tolerance);
  if (touching.constraints.empty()) return;
  switch (options.law) {
    case ImpactLaw::kNewton:
      Newton(options, solve, &touching);
      break;
    case ImpactLaw::kPoisson:
      Poisson(options, solve, &touching);
      break;
  }
  CopyVelocities(touching.bodies, system->bodies);
}

void StopApproach(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system) {
  ContactSystem touching = WithoutSeparating(*system, options.velocity_tolerance);
  CompressOnly(solve, &touching);
  CopyVelocities(touching.bodies, system->bodies);
}

void StopSeparation(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system) {
  // In reversed motion the contacts approach.
  const auto reverse = [](ContactSystem* reversed) {
    for (Body& body : reversed->bodies) {
      body.v = -body.v;
      body.omega = -body.omega;
    }
  };
  reverse(system);
  CompressOnly(solve, system);
  reverse(system);
  StopApproach(options, solve, system);
}

}  // namespace lcpbench
