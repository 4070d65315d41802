#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/profile_lu.h"
#include "solvers/linear_algebra/sparse_lu.h"

/// Internal to solvers/.
namespace lcpbench {

/// The linear system of a choice of modes [docs/friction.md section 5]: unknowns are the normal forces of closed
/// contacts, the tangential forces of those that stick, the forces of joints and of bounded rows between their bounds;
/// equations say that the gaps of the same rows are 0. phi = B y + what is at a bound, K = A_E,: B: square, and
/// nonsymmetric where a contact slips. Many unknowns of a problem given by factors are solved for through the
/// velocities of the bodies, by a sparse LU of their graph; of others by one of K.
class ModeFactor {
 public:
  /// Up to so many unknowns the factor is dense, within the profile that K has in the order of the rows: O(m^3) at
  /// most, and nothing is allocated where as many have been met or reserved.
  static constexpr Index kMostDense = 128;

  /// For problems of up to so many rows.
  void Reserve(Index max_rows);
  /// phi of these modes with omega_E = -eps (phi - center)_E: the modes' own solution for eps = 0.
  /// @param modes   of ContactRows::FindModes
  /// @param center  n
  /// @return false where K + eps is singular in double; *phi is not to be used then
  bool Solve(const ContactRows& rows, const std::vector<RowMode>& modes, const Eigen::VectorXd& center, double eps,
             Eigen::VectorXd* phi);
  /// The same about *phi, which the last solve has given, by its factor: what eps and rounding have left of omega_E.
  /// O(m^2 + nnz A)
  void Refine(const ContactRows& rows, Eigen::VectorXd* phi);
  /// The factor alone; false where it is singular.
  bool Factorize(const ContactRows& rows, const std::vector<RowMode>& modes, double eps);
  /// *phi = B y with K y = right_E, by the factor at hand.
  void SolveEquations(const ContactRows& rows, const Eigen::VectorXd& right, Eigen::VectorXd* phi);
  /// Whether the force of a row is an unknown of these modes.
  bool IsUnknown(Index row) const {
    return unknown_[static_cast<size_t>(row)] >= 0 &&
           equation_[static_cast<size_t>(unknown_[static_cast<size_t>(row)])] == row;
  }

 private:
  void SolveFactor(const ContactRows& rows, double fine);
  void SetModes(const ContactRows& rows, const std::vector<RowMode>& modes);
  void AddUnknowns(Index n);
  void Expand(Index n, Eigen::VectorXd* phi) const;
  bool Correct(const ContactRows& rows, const Eigen::VectorXd& center, Eigen::VectorXd* phi);
  bool FactorizeDense(const ContactRows& rows, double eps);
  void AddDenseColumns(const ContactRows& rows);
  bool FactorizeSparse(const ContactRows& rows, double eps);
  bool FactorizeOnBodies(const ContactRows& rows, double eps);
  void SolveOnBodies(const ContactRows& rows, double fine);

  Index size() const { return static_cast<Index>(equation_.size()); }  // m

  std::vector<Index> equation_;          // rows, in the order of the unknowns: ascending
  std::vector<Index> unknown_;           // n, -1: none
  std::vector<Index> before_;            // n + 1: how many equations are of rows before
  Eigen::VectorXd coefficient_, fixed_;  // n: phi_i = coefficient_i y_unknown + fixed_i
  Eigen::VectorXd y_;                    // right-hand side, then the correction
  Eigen::VectorXd refined_, gaps_;       // n
  ProfileLu dense_;
  const SparseMatrix* on_bodies_ = nullptr;  // G of the rows, where lu_ is of the bodies; eps_ is what it was made with
  double eps_ = 0;
  Eigen::SparseMatrix<double> sparse_;
  SparseLu<Eigen::AMDOrdering<int>> lu_;
};

}  // namespace lcpbench
