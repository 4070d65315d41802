#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/mode_equations.h"
#include "solvers/friction/profile_lu.h"
#include "solvers/linear_algebra/sparse_lu.h"

/// Internal to solvers/.
namespace lcpbench {

/// The factor of a choice of sides (ModeEquations). Many unknowns of a problem given by factors are solved for through
/// the velocities of the bodies, by a sparse LU of their graph; of others by one of K.
class ModeFactor {
 public:
  /// Up to so many unknowns the factor is dense, within the profile that K has in the order of the rows: O(m^3) at
  /// most, and nothing is allocated where as many have been met or reserved.
  static constexpr Index kMostDense = 128;

  /// For problems of up to so many rows.
  void Reserve(Index max_rows);
  /// phi of these sides with omega_E = -eps (phi - center)_E: the sides' own solution for eps = 0.
  /// @param sides   of ContactRows::FindSides
  /// @param center  n
  /// @return false where K + eps is singular in double; *phi is not to be used then
  bool Solve(const ContactRows& rows, const std::vector<RangeSide>& sides, const PaddedVector& center, double eps,
             PaddedVector* phi);
  /// The same about *phi, which the last solve has given, by its factor: what eps and rounding have left of omega_E.
  /// O(m^2 + nnz A)
  void Refine(const ContactRows& rows, PaddedVector* phi);
  /// The factor alone; false where it is singular.
  bool Factorize(const ContactRows& rows, const std::vector<RangeSide>& sides, double eps);
  /// *phi = B y with K y = right_E, by the factor at hand.
  void SolveEquations(const ContactRows& rows, const PaddedVector& right, PaddedVector* phi);
  /// The equations that the factor was made of.
  const ModeEquations<double>& equations() const { return of_; }

 private:
  void SolveFactor(const ContactRows& rows, double fine);
  void Expand(Index n, PaddedVector* phi) const;
  bool Correct(const ContactRows& rows, const PaddedVector& center, PaddedVector* phi);
  bool FactorizeDense(const ContactRows& rows, double eps);
  void AddDenseColumns(const ContactRows& rows);
  bool FactorizeSparse(const ContactRows& rows, double eps);
  bool FactorizeOnBodies(const ContactRows& rows, double eps);
  void SolveOnBodies(const ContactRows& rows, double fine);

  Index size() const { return of_.size(); }  // m

  ModeEquations<double> of_;
  std::vector<Index> before_;    // n + 1: how many equations are of rows before
  PaddedVector y_;               // right-hand side, then the correction
  PaddedVector refined_, gaps_;  // n
  ProfileLu dense_;
  const SparseMatrix* on_bodies_ = nullptr;  // G of the rows, where lu_ is of the bodies; eps_ is what it was made with
  double eps_ = 0;
  Eigen::SparseMatrix<double> sparse_;
  SparseLu lu_;
};

}  // namespace lcpbench
