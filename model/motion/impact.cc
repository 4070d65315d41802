#include "model/motion/impact.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {
namespace {

// vector += and scalar += the three numbers of `change`, for every movable body.
void Add(const Eigen::VectorXd& change, std::span<Body> bodies, Vec2 Body::*vector, double Body::*scalar) {
  Index k = 0;
  for (Body& body : bodies) {
    if (!body.fixed) {
      body.*vector = body.*vector + Vec2{change[k], change[k + 1]};
      body.*scalar += change[k + 2];
    }
    k += 3;
  }
}

}  // namespace

Eigen::VectorXd DisplacementOf(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::VectorXd forces = problem.J().transpose() * f;
  return problem.inverse_mass().cwiseProduct(forces);
}

Eigen::VectorXd SolveRows(const ImpulseSolver& solve, const ContactSystem& system, const AssembledLcp& lcp,
                          const Eigen::VectorXd& b, Eigen::VectorXd* change) {
  // The LCPs of impulses and displacements have the matrix of the accelerations.
  const LcpProblem& given = lcp.problem;
  const LcpProblem problem =
      LcpProblem::FromFactors(given.id(), given.J(), given.inverse_mass(), b,
                              RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()));
  LcpResult result;
  solve(system, lcp.rows, problem, &result);
  *change = DisplacementOf(problem, result.f);
  return std::move(result.f);
}

Eigen::VectorXd ValuesOf(const std::vector<RowInfo>& rows, double RowInfo::*x) {
  Eigen::VectorXd values(static_cast<Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) values[static_cast<Index>(i)] = rows[i].*x;
  return values;
}

void AddToVelocities(const Eigen::VectorXd& change, std::span<Body> bodies) {
  Add(change, bodies, &Body::v, &Body::omega);
}

void CopyVelocities(std::span<const Body> from, std::span<Body> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i].v = from[i].v;
    to[i].omega = from[i].omega;
  }
}

ContactSystem PartOf(const ContactSystem& system, const std::vector<bool>& chosen) {
  ContactSystem part{system.name, system.bodies, {}};
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (chosen[k]) part.constraints.push_back(system.constraints[k]);
  }
  return part;
}

double WorstViolation(const std::vector<RowInfo>& rows, double RowInfo::*x) {
  double worst = 0;
  for (const RowInfo& row : rows) worst = std::max(worst, row.bilateral ? std::abs(row.*x) : -(row.*x));
  return worst;
}

double ProjectPositions(double goal, const ImpulseSolver& solve, ContactSystem* system) {
  AssembledLcp lcp = AssembleContactLcp(*system);
  double violation = WorstViolation(lcp.rows);
  for (int round = 0; round < kMostProjections && violation > goal; ++round) {
    Eigen::VectorXd change;
    SolveRows(solve, *system, lcp, ValuesOf(lcp.rows, &RowInfo::d), &change);
    const std::vector<Body> before = system->bodies;
    Add(change, system->bodies, &Body::x, &Body::theta);
    double left = violation;
    try {
      lcp = AssembleContactLcp(*system);
      left = WorstViolation(lcp.rows);
    } catch (const InputError&) {
      // A displacement so large that geometry became singular was no correction.
    }
    if (!(left < violation)) {
      system->bodies = before;
      break;
    }
    violation = left;
  }
  return violation;
}

namespace {

// The constraints of `system` without unilateral ones that separate.
ContactSystem WithoutSeparating(const ContactSystem& system, double tolerance) {
  const AssembledLcp all = AssembleContactLcp(system);
  std::vector<bool> stays(system.constraints.size(), false);
  for (const RowInfo& row : all.rows) {
    if (row.bilateral || row.d_dot <= tolerance) stays[static_cast<std::size_t>(row.constraint)] = true;
  }
  return PartOf(system, stays);
}

// Solves w = A p + q and applies p.
Eigen::VectorXd Apply(const ImpulseSolver& solve, const AssembledLcp& lcp, const Eigen::VectorXd& q,
                      ContactSystem* system) {
  Eigen::VectorXd change;
  Eigen::VectorXd p = SolveRows(solve, *system, lcp, q, &change);
  AddToVelocities(change, system->bodies);
  return p;
}

void CompressOnly(const ImpulseSolver& solve, ContactSystem* touching) {
  const AssembledLcp lcp = AssembleContactLcp(*touching);
  if (!lcp.rows.empty()) Apply(solve, lcp, ValuesOf(lcp.rows, &RowInfo::d_dot), touching);
}

void Newton(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* touching) {
  const AssembledLcp lcp = AssembleContactLcp(*touching);
  double approach = 0;
  for (const RowInfo& row : lcp.rows) {
    if (!row.bilateral) approach = std::max(approach, -row.d_dot);
  }
  const double e = approach < options.resting_speed ? 0 : options.restitution;
  Eigen::VectorXd q = ValuesOf(lcp.rows, &RowInfo::d_dot);
  for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
    if (!lcp.rows[i].bilateral) q[static_cast<Index>(i)] *= 1 + e;
  }
  Apply(solve, lcp, q, touching);
}

void Poisson(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* touching) {
  const AssembledLcp lcp = AssembleContactLcp(*touching);
  Eigen::VectorXd restored = Apply(solve, lcp, ValuesOf(lcp.rows, &RowInfo::d_dot), touching);
  for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
    const RowInfo& row = lcp.rows[i];
    const bool rests = row.bilateral || -row.d_dot < options.resting_speed;
    restored[static_cast<Index>(i)] *= rests ? 0 : options.restitution;
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
