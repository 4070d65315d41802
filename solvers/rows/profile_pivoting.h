#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// One island of a step with more rows than a dense tableau is good for: nonsmooth conjugate gradients (as nncg.h) find
/// most of the active set, and block principal pivoting [Judice, Pires 1994] on a sparse factor the rest.
///
/// Rows are scaled to A_ii = 1 and bodies to unit mass: A~ = G G^T with G = D^-1/2 J M^-1/2, so that one array of 2 p
/// numbers a row serves sweeps (y = G^T x, w = G y + b~) and products. Bodies are put into breadth-first order
/// [Cuthill, McKee 1969], rows after the later one of their bodies; A~ is stored by rows from its first nonzero to the
/// diagonal (its profile), and L D L^T of A_FF + delta I stays within it. A hyperstatic A_FF is singular: the shift
/// delta makes each solve a proximal step from the sweeps' point [Rockafellar 1976], which leaves delta |x - x_sweeps|
/// in w and is repeated where that is too much.
///
/// Iterations and pivoting rounds alternate, each granted about what the other one costs, until f passes or the limits
/// of ProfilePivoting.cc are reached. Guaranteed class: symmetric PSD, as nncg; no promise on the number of iterations.
/// Cost: O(n) an iteration; a factor takes the sum of squared column heights of the profile. Only Reserve allocates.
class ProfilePivoting {
 public:
  struct Request {
    double tolerance;          ///< on rho
    const double* initial_f;   ///< by row of the whole step, or nullptr
    const Deadline* deadline;  ///< or nullptr
  };

  /// @param max_rows  of an island; the profile is granted kMostProfile numbers a row on average, and an island that
  ///                  needs more is solved by sweeps alone
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
  double SolveOf(const StepRows& all, std::span<const std::int32_t> part, const Request& request, double* f);
  void Store(double* f) const;
  template <Index p>
  double PolishOf(double rounding, double* f);
  template <Index p, typename Real>
  bool Load(const StepRows& all, const Real* J, std::span<const std::int32_t> part);
  void OrderBodies();
  void FindProfile();
  template <Index p>
  void AssembleProfile();

  template <Index p>
  double Gap(Index i, const double* y) const;
  template <Index p>
  void AddRow(Index i, double x, double* y) const;
  template <Index p, bool backward>
  void Sweep(double* energy, double* residual);
  template <Index p>
  double Iterate();
  template <Index p>
  void Restart();
  template <Index p>
  double Residual();
  template <Index p>
  void FollowCentralPath(double enough);
  template <Index p>
  bool Pivot(int most_patience);
  template <Index p>
  double Energy(const double* x, double* y) const;
  void Factorize();
  void SolveFactor(double* x);

  Index n_ = 0, bodies_ = 0;  // of the island
  std::int64_t iterations_ = 0;
  double b_norm_ = 1;
  double violation_ = 0;                     // what counts as one
  double factor_cost_ = 0, sweep_cost_ = 0;  // processor cycles, roughly

  // By row, in the order of the profile.
  std::vector<std::int32_t> given_, first_body_, second_body_, profile_first_, last_below_;
  std::vector<std::int32_t> active_first_;  // profile_first_ of active rows, n of others
  std::vector<std::int64_t> profile_at_;
  std::vector<unsigned char> is_joint_, is_active_;
  Eigen::VectorXd G_, b_, scale_;
  Eigen::VectorXd x_, x_before_, previous_x_, extra_x_, trial_x_, gap_, previous_gap_, barrier_;
  // By body of the island, padded to registers.
  Eigen::VectorXd y_, y_before_, previous_y_, extra_y_, trial_y_;
  // Orders.
  std::vector<std::int32_t> local_, global_, place_, queue_, rows_of_body_, body_begin_, order_, bucket_;
  // Profile.
  Eigen::VectorXd A_, L_, column_, mask_;
  bool has_profile_ = false;
  // Conjugate gradients.
  bool has_previous_ = false;
  double previous_w_ = 0, least_residual_ = 0;
  std::int64_t hovering_ = 0;
  int projections_ = 0;
};

}  // namespace lcpbench
