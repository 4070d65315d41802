#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_factor.h"
#include "solvers/friction/mode_steps.h"

/// Internal to solvers/.
namespace lcpbench {

/// Proximal points by paths of the normal map [Robinson 1992; Dirkse, Ferris 1995]. Of x = phi - omega, forces are
/// piecewise linear, phi = P(x), and N(x) = A P(x) + b + eps (P(x) - center) - P(x) + x is 0 at the answer of A + eps
/// about the center. From the center, where N = r, the path N(x) = z r is followed from z = 1 to 0, through folds,
/// across the walls of modes. Newton steps with a line search end where |N| has a local minimum; a path does not.
///
/// Beyond a wall the derivative of N differs by a matrix of rank one, so that a crossing costs one solve by the factor
/// of the modes, which is made anew after some crossings.  O(nnz of the factor + n crossings) each
class ModePath {
 public:
  /// Up to so many points from *phi, which is the last one afterwards. eps falls where paths are short, and grows where
  /// they wander.
  /// @return true where an answer passes
  bool Approach(const ContactRows& rows, int points, ModeSteps* newton, Eigen::VectorXd* phi, FrictionAnswer* answer);

 private:
  // The first wall ahead: the mode at `place` becomes `next`.
  struct Wall {
    std::size_t place;
    RowMode next;
    double step;  // infinite: none
  };
  // N' of a crossing is N' before + p v^T, v = e_row + along e_other; `pivot` is 1 + v . N'^-1 p.
  struct Crossing {
    Index row, other;
    double along, pivot;

    double Of(const Eigen::VectorXd& x) const { return x[row] + (other < 0 ? 0 : along * x[other]); }
  };

  bool Follow(const ContactRows& rows, double eps, int most_crossings, Eigen::VectorXd* phi, FrictionAnswer* answer);
  void ForcesOf(const ContactRows& rows);
  void ComputeNormalMap(const ContactRows& rows, Eigen::VectorXd* value);
  bool Factorize(const ContactRows& rows, double z);
  void Solve(const ContactRows& rows, Eigen::VectorXd* y);
  Wall FirstWall(const ContactRows& rows, double sign) const;
  Crossing Jump(const ContactRows& rows, const Wall& wall);
  void AddColumn(const ContactRows& rows, Index row, double factor);
  bool Cross(const ContactRows& rows, const Wall& wall, double* sign);

  ModeFactor factor_;
  double eps_ = 0;
  std::vector<RowMode> modes_;
  std::vector<Crossing> crossings_;  // since the factor was made
  Eigen::MatrixXd columns_;          // N'^-1 p of each
  Eigen::VectorXd center_, x_, phi_, gaps_, start_, direction_, column_;
};

}  // namespace lcpbench
