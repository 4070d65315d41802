#include "model/motion/projection.h"

#include <algorithm>
#include <cmath>

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

LcpProblem WithRightHandSide(const AssembledLcp& lcp, const Eigen::VectorXd& b) {
  const LcpProblem& given = lcp.problem;
  return LcpProblem::FromFactors(given.id(), given.J(), given.inverse_mass(), b,
                                 RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()));
}

Eigen::VectorXd DisplacementOf(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::VectorXd forces = problem.J().transpose() * f;
  return problem.inverse_mass().cwiseProduct(forces);
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

double WorstViolation(const std::vector<RowInfo>& rows, double RowInfo::*x) {
  double worst = 0;
  for (const RowInfo& row : rows) worst = std::max(worst, row.bilateral ? std::abs(row.*x) : -(row.*x));
  return worst;
}

double ProjectPositions(double goal, const DisplacementSolver& solve, ContactSystem* system) {
  AssembledLcp lcp = AssembleContactLcp(*system);
  double violation = WorstViolation(lcp.rows);
  for (int round = 0; round < kMostProjections && violation > goal; ++round) {
    Eigen::VectorXd gaps(static_cast<Index>(lcp.rows.size()));
    for (std::size_t i = 0; i < lcp.rows.size(); ++i) gaps[static_cast<Index>(i)] = lcp.rows[i].d;
    const LcpProblem problem = WithRightHandSide(lcp, gaps);
    LcpResult result;
    solve(problem, &result);
    const std::vector<Body> before = system->bodies;
    Add(DisplacementOf(problem, result.f), system->bodies, &Body::x, &Body::theta);
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

}  // namespace lcpbench
