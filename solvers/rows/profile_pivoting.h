#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/rows/profile_factor.h"
#include "solvers/rows/scaled_rows.h"

namespace lcpbench {

/// One island of a step with more rows than a dense tableau is good for: nonsmooth conjugate gradients (as nncg.h) find
/// most of the active set, and block principal pivoting [Judice, Pires 1994] on a sparse factor the rest.
///
/// Rows are scaled and ordered (ScaledRows); A~_FF + delta I is factorized within its profile (ProfileFactor). A
/// hyperstatic A_FF is singular: the shift delta makes each solve a proximal step from the sweeps' point [Rockafellar
/// 1976], which leaves delta |x - x_sweeps| in w and is repeated where that is too much.
///
/// Iterations and pivoting rounds alternate, each granted about what the other one costs, until f passes or the limits
/// of profile_pivoting.cc are reached; from the second alternation on Mehrotra's interior points go before the rounds.
/// The deadline is looked at before every factorization and once in sixteen iterations.
/// Guaranteed class: symmetric PSD, as nncg; no promise on the number of iterations. Cost: O(n) an iteration, and that
/// of ProfileFactor. Only Reserve allocates.
class ProfilePivoting {
 public:
  struct Request {
    double tolerance;          ///< on rho
    const double* initial_f;   ///< by row of the whole step, or nullptr
    const Deadline* deadline;  ///< or nullptr
  };

  /// @param max_rows  of an island; one whose profile needs more than ProfileFactor::kMostProfile numbers a row on
  ///                  average is solved by sweeps alone
  void Reserve(Index max_rows, Index max_bodies);

  /// Writes the entries `part` of f. Returns rho as the scaled sums have it; the caller judges f by the given rows.
  double Solve(const StepRows& all, std::span<const std::int32_t> part, const Request& request, double* f);

  /// The last Solve's f made as exact as its active set allows, where single rows have too large an error. Returns rho.
  /// @param rounding  forces of at most this part of the largest one become 0
  double Polish(const StepRows& all, double rounding, double* f);

  /// Of the last Solve: iterations of conjugate gradients, and factorizations.
  std::int64_t iterations() const { return iterations_; }

 private:
  template <Index p>
  double SolveOf(const Request& request, double* f);
  template <Index p>
  void Start(const double* initial_f);
  template <Index p>
  double PolishOf(double rounding, double* f);
  void Store(double* f) const;
  bool TimeIsUp() const { return deadline_ != nullptr && deadline_->Expired(); }

  template <Index p, bool backward>
  void Sweep(double* energy, double* residual);
  template <Index p>
  double Iterate();
  template <Index p>
  void Restart();
  template <Index p>
  double Residual();
  template <Index p>
  bool Pivot(int most_patience);
  template <Index p>
  void FindBasicPoint(double* x, double* y);
  template <Index p>
  Index ExchangeViolated(const double* x, const double* y);
  template <Index p>
  void FollowCentralPath(double enough);
  void StepToCentre(double mu, double contacts, double* x);
  double StepLength(const double* x, const double* change) const;

  ScaledRows rows_;
  ProfileFactor factor_;
  bool has_profile_ = false;
  Index n_ = 0;  // of the island; 0 where it could not be loaded
  std::int64_t iterations_ = 0;
  const Deadline* deadline_ = nullptr;
  double violation_ = 0;  // what counts as one

  // By row, in the order of rows_: scaled forces, and which rows are active.
  Eigen::VectorXd x_;
  std::vector<unsigned char> is_active_;
  // By body of the island, padded to registers: y = G^T x.
  Eigen::VectorXd y_;
  // Conjugate gradients.
  Eigen::VectorXd x_before_, y_before_, previous_x_, previous_y_, extra_x_, extra_y_;
  bool has_previous_ = false;
  double previous_w_ = 0, least_residual_ = 0;
  std::int64_t hovering_ = 0;
  int projections_ = 0;
  // Pivoting and interior points.
  Eigen::VectorXd trial_x_, trial_y_, correction_, shift_;
  Eigen::VectorXd slack_, right_side_, corrector_, direction_;
};

}  // namespace lcpbench
