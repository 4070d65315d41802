#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_factor.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/lcp/engine_solver.h"

/// Internal to solvers/.
namespace lcpbench {

/// Paths of the normal map [Robinson 1992; Dirkse, Ferris 1995]. Of x = phi - omega, forces are piecewise linear, phi =
/// P(x), and N(x) = A P(x) + b + eps (P(x) - center) - P(x) + x is 0 at the answer of A + eps about the center. A path
/// N(x) = z s is followed to z = 0, through folds, across the walls of modes, where Newton steps with a line search end
/// where |N| has a local minimum.
///
/// Beyond a wall the derivative of N differs by a matrix of rank one, so that a crossing costs one solve by the factor
/// of the sides, which is made anew after some crossings.  O(nnz of the factor + n crossings) each
class NormalMapPath {
 public:
  /// How a path ended.
  enum class End {
    kReached,   ///< z = 0, within rounding
    kRay,       ///< no wall ahead: a secondary ray, which proves nothing about the problem
    kSingular,  ///< the sides' equations are singular to rounding
    kLimit,     ///< of crossings, or of the answer's iterations or time
  };

  /// For problems of up to so many rows, up to ModeFactor::kMostDense of which are unknowns.
  void Reserve(Index max_rows);
  /// The method of mode-newton from *phi: a few sweeps, Newton steps with sweeps where they stall, proximal points.
  /// @return true where an answer passes
  bool ApproachByNewton(const ContactRows& rows, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer);
  /// Proximal points, up to so many from *phi, which is the last one afterwards: s = N(center) from z = 1. eps falls
  /// where paths are short, and grows where they wander.
  /// @return true where an answer passes
  bool Approach(const ContactRows& rows, int points, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer);
  /// Lemke's paths [Lemke 1965; Eaves 1976; docs/friction.md section 5]: s = -d, d in the interior of the dual cones,
  /// from the z at which all contacts may be open, without a center. Of some d, each end polished and judged; then the
  /// same on A + 1e-7 and A + 1e-10, whose rows do not depend on each other, with Newton's method after it. *phi: room.
  /// @return true where an answer passes
  bool Cover(const ContactRows& rows, unsigned seeds, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer);
  /// How the latest path ended.
  End end() const { return end_; }

 private:
  // The first wall ahead: the row comes to another side.
  struct Wall {
    Index row = -1;
    RangeSide next = RangeSide::kLower;
    double step;  // infinite: none
  };
  // N' of a crossing is N' before + p v^T, v = e_row + along e_other; `pivot` is 1 + v . N'^-1 p.
  struct Crossing {
    Index row, other;
    double along, pivot;

    double Of(const PaddedVector& x) const { return x[row] + (other < 0 ? 0 : along * x[other]); }
  };

  void Start(const ContactRows& rows, double eps);
  End FollowFrom(const ContactRows& rows, double z, int most_crossings, PaddedVector* phi, FrictionAnswer* answer);
  End FollowToCenter(const ContactRows& rows, double eps, int most_crossings, PaddedVector* phi,
                     FrictionAnswer* answer);
  End FollowCover(const ContactRows& rows, unsigned seed, double eps, PaddedVector* phi, FrictionAnswer* answer);
  void DrawCover(const ContactRows& rows, unsigned seed);
  void ForcesOf(const ContactRows& rows);
  void ComputeNormalMap(const ContactRows& rows, PaddedVector* value);
  bool Factorize(const ContactRows& rows, double z);
  void Solve(const ContactRows& rows, PaddedVector* y);
  template <typename Test>
  void VisitWalls(const ContactRows& rows, const Test& test) const;
  Wall FirstWall(const ContactRows& rows, double sign) const;
  Crossing Jump(const ContactRows& rows, const Wall& wall);
  void AddColumn(const ContactRows& rows, Index row, double factor);
  bool Cross(const ContactRows& rows, const Wall& wall, double* sign);

  ModeFactor factor_;
  End end_ = End::kLimit;
  double eps_ = 0;
  std::vector<RangeSide> sides_;
  std::vector<const FrictionRow*> friction_;  // n: of a friction row, and the first of a normal row
  std::vector<Crossing> crossings_;           // since the factor was made
  PaddedVector columns_;                      // N'^-1 p of each
  PaddedVector center_, x_, phi_, gaps_, start_, direction_, column_;  // n or more
};

/// The solver `lemke` for problems that are not plain: NormalMapPath::Cover with three d. Own limit 50 n + 1000
/// crossings a path; a secondary ray is kNumericalFailure, as it proves nothing.
struct ModeLemkeOptions {};
using ModeLemkeSolver = EngineSolver<ModeLemkeOptions, class ModeLemkeEngine>;
extern template class EngineSolver<ModeLemkeOptions, ModeLemkeEngine>;

}  // namespace lcpbench
