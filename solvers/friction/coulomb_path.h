#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/linear_algebra/sparse_lu.h"

/// Internal to solvers/.
namespace lcpbench {

/// The central path of Coulomb's law, followed through its folds. With velocities v_n of opening and v+, v- of slip, a
/// contact has three pairs, (phi_n, v_n), (mu phi_n + phi_t, v+) and (mu phi_n - phi_t, v-), and
///     omega_n = v_n,  omega_t = v+ - v-
/// [docs/solvers/friction.md]. The products of all pairs are kappa, and what these equations are off by at the start
/// shrinks with kappa from 1 to 0. The problem is not monotone, so that kappa may rise in between: the sign of a
/// determinant tells which way the path goes [Allgower, Georg 1990, ch. 2]. Modes of points on the way are tried by
/// Newton steps, which end most paths long before kappa is rounding.
///
/// For problems given by factors that the relaxation takes (ContactRows::can_relax). A step costs one sparse LU factor
/// of the bodies' graph, always of the same pattern. Allocates.
class CoulombPath {
 public:
  /// Up to so many steps; *phi: room.
  /// @return true where an answer passes
  bool Follow(const ContactRows& rows, int steps, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer);

 private:
  // What is positive at a contact, or how it changes. Rows without friction have kForce and kOpening only, joints
  // kForce alone.
  static constexpr int kForce = 0, kUpperCone = 1, kLowerCone = 2, kOpening = 3, kForward = 4, kBackward = 5;
  static constexpr int kParts = 6;
  using Parts = Eigen::Array<double, Eigen::Dynamic, kParts>;
  using Products = Eigen::Array<double, Eigen::Dynamic, kParts / 2>;
  using Rest = Eigen::Array<double, Eigen::Dynamic, 2>;  // of the equations of omega_n, omega_t

  // A contact, or a joint's row.
  struct Place {
    Index normal, tangent = -1;
    double mu = 0;
    bool is_joint = false;
    std::size_t first = 0, entries = 0;  // of columns_ and what goes with it
    std::size_t block = 0;               // of positions_: entries^2
  };

  void Start(const ContactRows& rows);
  void SetPattern(Index columns);
  void ComputeRest(const ContactRows& rows);
  bool Factorize();
  void Solve(const Products& products, const Rest& rest, Parts* change) const;
  bool Advance();
  double Compare(const Parts& a, const Parts& b) const;
  double Largest(const Parts& change) const;
  bool TryModes(const ContactRows& rows, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer);

  std::vector<Place> places_;  // joints first
  Index joints_ = 0;
  std::vector<int> columns_;              // of the bodies, place by place
  std::vector<double> normal_, tangent_;  // entries of G there
  std::vector<int> positions_;            // in the values of K_
  Eigen::SparseMatrix<double> K_;
  SparseLu lu_;
  Parts parts_;
  Products pairs_;                                   // 1 where there is one, else 0
  Products products_;                                // what the pairs' are short of kappa by
  Rest rest_, first_rest_;                           // now, and at the start
  Eigen::Array<double, Eigen::Dynamic, 3> inverse_;  // of D: nn, tn, tt
  PaddedVector phi_, gaps_;
  double scale_ = 1, kappa_ = 1, rho_ = 0, least_rho_ = 0;
};

}  // namespace lcpbench
