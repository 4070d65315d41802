#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/friction/relaxation.h"

namespace lcpbench {

/// Coulomb's law of planar contacts as an LCP of four rows a contact [docs/friction.md section 1, form 2; Stewart,
/// Trinkle 1996]: the variables p, beta+, beta-, sigma take the place of f_n; f_n = p, f_t = beta+ - beta-,
///     w_n >= 0 for p,   sigma +- w_t >= 0 for beta+-,   mu p - beta+ - beta- >= 0 for sigma.
/// sigma and its row are in units of A_tt (a power of two), so that the entries are of one size. A contact with mu = 0
/// keeps its row n alone; joints stay as they are. The matrix is copositive where A is positive semidefinite, and not
/// symmetric. f solves the problem if and only if VariablesOf(f) solves the LCP.
class FourRows {
 public:
  /// @param problem  with up to one friction row a contact, without sliding and bounded rows.  O(nnz A)
  explicit FourRows(const LcpProblem& problem);

  /// The LCP, given by its sparse matrix, for the b of the problem that it was made of, or for another one.
  const LcpProblem& lcp() const { return *lcp_; }
  Eigen::VectorXd LoadsOf(const Eigen::VectorXd& b) const { return rows_ * b; }  ///< of lcp(), for another b
  /// Forces brought to p, beta+, beta- >= 0, with sigma = |w_t|.
  Eigen::VectorXd VariablesOf(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;
  /// The other way.
  Eigen::VectorXd ForcesOf(const Eigen::VectorXd& variables) const { return rows_.transpose() * variables; }

 private:
  struct Contact {
    Index tangent, sigma;  // a row of the problem, and one of the LCP
    double unit;           // of sigma
  };
  std::vector<Contact> contacts_;  // with mu > 0
  SparseMatrix rows_;              // of the problem, with signs, that the LCP has; none for sigma
  std::optional<LcpProblem> lcp_;
};

/// Hands a problem with friction as FourRows to a solver of LCPs whose matrix is not symmetric.
///
/// Takes friction rows, one a contact, beside unilateral and bilateral ones; symmetric A. Refuses plain problems,
/// sliding and bounded rows, several friction rows a contact, and what the solver within refuses of the LCP. Status,
/// iterations and guarantees are those of that solver on the LCP, tolerances too; its kInfeasible becomes
/// kNumericalFailure, because a ray of the LCP proves nothing of the problem. Warm start: VariablesOf. Cost: FourRows
/// and one solve; allocates.
using FourRowSolver = EngineSolver<WithinOptions, class FourRowEngine>;
extern template class EngineSolver<WithinOptions, FourRowEngine>;

}  // namespace lcpbench
