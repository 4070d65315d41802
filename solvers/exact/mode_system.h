#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_input.h"
#include "solvers/exact/flint_matrix.h"
#include "solvers/exact/polyhedron.h"
#include "solvers/lcp/law.h"

namespace lcpbench {

/// factor.x + constant on forces x and gaps: sums of some f_i, w_i times factors. Internal to solvers/exact/.
/// @tparam Number  double, or a rational
template <typename Number>
struct LinearTerm {
  Index row;
  bool is_gap;  ///< w, not f
  Number factor;
};
/// The sum of the terms plus `constant` is 0, or >= 0.
template <typename Number>
struct LinearLaw {
  std::vector<LinearTerm<Number>> terms;
  Number constant;
  bool is_equation;
};
using LawTerm = LinearTerm<Rational>;
using Law = LinearLaw<Rational>;

/// The side of every row: inside where w = 0, upper where the mode is `-`.
std::vector<RangeSide> SidesOf(const std::string& modes);

/// The linear laws of one mode string.
std::vector<Law> LawsOf(const ExactLcp& problem, const std::string& modes);
std::vector<LinearLaw<double>> LawsOf(const std::vector<FrictionRow>& friction, const std::vector<BoundedRow>& bounded,
                                      const std::string& modes);

/// The value of a law's sum.
/// @param is_direction  the constant does not count
Rational ValueOf(const Law& law, const RationalVector& f, const RationalVector& w, bool is_direction = false);

/// A f + b; A f of a direction.
RationalVector GapsOf(const ExactLcp& problem, const RationalVector& f, bool is_direction = false);

/// The forces that meet all equations of a mode: `point` plus combinations of `directions`, with their gaps.
struct ModeSpace {
  RationalVector f, w;
  std::vector<RationalVector> f_directions, w_directions;
};

/// The equations of all modes of a problem, which is not owned.
class ModeSystem {
 public:
  explicit ModeSystem(const ExactLcp& problem);

  /// Nothing where no forces meet the equations.  O(m^3) operations on integers for m equations of gaps; many of
  /// them modulo primes or by p-adic lifting [FLINT]
  std::optional<ModeSpace> SpaceOf(const std::string& modes) const;

  /// Those of the problem in integers, each in units of its own.
  const IntegerMatrix& A() const { return A_; }
  const IntegerMatrix& b() const { return b_; }

 private:
  const ExactLcp& problem_;
  BigInteger matrix_unit_, load_unit_;
  IntegerMatrix A_, b_;  // A matrix_unit_, b load_unit_
};

/// The points of `space` that meet the inequalities, and equations, of `laws`: coordinates are those of its directions.
Polyhedron PointsOf(const ModeSpace& space, const std::vector<Law>& laws);

}  // namespace lcpbench
