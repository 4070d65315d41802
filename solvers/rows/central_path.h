#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/lcp/solver.h"
#include "solvers/rows/profile_factor.h"

namespace lcpbench {

/// Interior points on the scaled rows of one island: Mehrotra's predictor and corrector [Mehrotra 1992] on
///     w = A~ x + b~,  x z = mu,  z = w  on contacts,  w = 0 on joints,  mu -> 0,
/// with a factor of A~ + diag(z / x) within its profile. Finds the active set where pivoting does not settle. Only
/// Reserve allocates.
class CentralPath {
 public:
  void Reserve(Index max_rows);
  /// From x until |min(x, w)| <= enough, for 30 steps at most, or until the time is up, which is looked at before every
  /// factorization. x ends above 0 on contacts.
  /// @param factor    of these rows, assembled
  /// @param deadline  nullptr for none
  /// @returns factorizations
  std::int64_t Follow(const ScaledProblem& scaled, const RowKernel& rows, double enough, const Deadline* deadline,
                      ProfileFactor* factor, Point* x);

 private:
  void Start(Point* x);
  void Step(double mu, double contacts, double* x);
  double StepLength(const double* x, const double* change) const;
  double SlackChange(Index i, const double* x, const double* change) const {
    return corrector_[i] - slack_[i] - slack_[i] / x[i] * change[i];
  }

  const ScaledProblem* scaled_ = nullptr;
  const RowKernel* rows_ = nullptr;
  ProfileFactor* factor_ = nullptr;
  Array gaps_, slack_, corrector_, direction_, shift_;  // by row: w, z, (target - dx dz) / x, dx, z / x
  std::vector<unsigned char> all_;                      // 1
};

}  // namespace lcpbench
