#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/step_rows.h"

/// Internal to solvers/: a problem in the units that row methods work in. The forms of a problem, and who makes which
/// of which (Ladder: solvers/rows/, all else: where LcpProblem is solved):
///
///     caller's arrays ── ProblemArrays ──▶ LcpProblem: J M^-1 J^T, dense or sparse A; all solvers take it
///           │                 │                 │
///           │                 ├─▶ MatrixArrays  ├─▶ ScaledProblem + AssembledRows, FactorRows: sweeps on any problem
///           │                 │   (dense or     ├─▶ ScaledVectors + ActiveBlock: block pivoting, interior points
///           │            TwoBodyCopy  banded A) └─▶ PermutedLcp, tableau: pivoting
///           ▼                 ▼                 │
///        StepRows: two bodies a row, in place   │
///           │                                   │
///           ├─▶ FixedSizeBpp, tableau: A in registers or dense, by the bodies that rows share
///           └─▶ ScaledProblem + ScaledRows           two bodies a row, scaled: sweeps
///                      └─▶ ProfileFactor: A~ = G G^T within its profile
namespace lcpbench {

/// An LCP in units in which diag A = 1 and 1 <= |b| < 2, so that no step divides and nothing depends on the units of
/// the given problem. (b is scaled by a power of two, so that the iterates' bits do not depend on the rounding of |b|.)
/// Row k here is row order[k] of the given problem; all arrays run over k, and have `size` numbers or more.
struct ScaledProblem {
  Index size = 0;
  std::vector<Index> order;  ///< empty: the given order
  Array b;
  double b_norm = 1;   ///< |b| here, 1 where b = 0: rho is the norm of the natural residual over this
  Array unit;          ///< f_k of the given problem per f_k here
  Array inverse_root;  ///< (A_kk)^-1/2 of the given problem, 1 where A_kk = 0
  /// Rows that step differently: a bilateral row is not projected (floor -inf), a row without diagonal does not step
  /// (gain 0; for PSD A the whole row is 0). Most problems have neither (`mixed` false): then nothing reads these.
  bool mixed = false;
  bool has_idle = false;  ///< there are rows without diagonal
  Array floor;            ///< 0 or -infinity
  Array gain;             ///< 1 or 0

  /// Room for steps of up to `max_rows` rows: Take allocates nothing up to there.
  void Reserve(Index max_rows);
  /// All but b and its units.  O(n) and the diagonal of A.
  void Reset(const LcpProblem& problem, std::vector<Index> order);
  /// The same of the rows `order` of a step, but for inverse_root, which ScaledRows::Take writes.
  void Take(const StepRows& rows);
  /// b, b_norm and unit, of the problem or step that was taken, or of one that shares its matrix.  O(n)
  void SetB(const double* given_b);

  Index Given(Index k) const { return order.empty() ? k : order[static_cast<size_t>(k)]; }
  bool IsFree(Index k) const { return mixed && floor[k] != 0; }

  /// The start of a solve: zero, or `given` clipped to the bounds.
  /// @param given  by row of the given problem, or nullptr
  void Start(const double* given, Array* f) const;
  /// @param given  by row of the given problem
  void ToGiven(const Array& f, double* given) const;
};

/// The numbers of a body of p in vector registers.
template <Index p>
using BodyLanes = std::conditional_t<p == 3, Lanes, WideLanes>;
template <Index p>
inline constexpr Index kBodyWidth = p == 3 ? kLanes : 2 * kLanes;

/// The numbers of a body alone: without what stands in their padding.
template <Index p>
LCPBENCH_ALWAYS_INLINE BodyLanes<p> BodyPart(const BodyLanes<p>& lanes) {
  if constexpr (p == 3) {
    return Masked(lanes, LaneMask{-1, -1, -1, 0});
  } else {
    return Masked(lanes, WideLaneMask{-1, -1, -1, -1, -1, -1, 0, 0});
  }
}

/// Rows on at most two bodies each of p = 3 or 6 numbers, scaled to A_kk = 1 and bodies to unit mass:
///     A~ = G G^T,   G = D^-1/2 J M^-1/2,
/// so that one copy of G serves the product and the update, and no inverse mass is read. A row is one cache line (p =
/// 3; two where p = 6) with everything that a sweep needs but f:
///     [first block | b | second block | where its bodies are]   p = 3
///     [first block | b | 0 | second block | bodies | 0]         p = 6
/// The *image* of f, the velocities y = G^T f, has kBodyWidth<p> numbers per body; the one behind the body's own is the
/// constant 1, the factor of b. Rows on one body (the other is fixed) use one of a few spare bodies as their second,
/// with factors 0: several, so that neighbouring rows do not wait for each other's store.
class ScaledRows {
  static constexpr Index kSpares = 8;

 public:
  /// Room for steps.
  void Reserve(Index max_rows, Index max_bodies);
  /// Rows of a step in the order of `scaled`, whose inverse_root is written; allocates up to what was reserved nothing.
  /// False if A_kk = 0 in double.  O(n)
  /// @param given  by body here, that of the step
  /// @param place  by body of the step, that here; < 0: cannot move
  bool Take(const StepRows& step, std::span<const std::int32_t> given, const std::int32_t* place,
            ScaledProblem* scaled);

  Index columns_per_body() const { return p_; }  ///< p
  Index size() const { return size_; }           ///< n
  Index bodies() const { return bodies_; }       ///< without spare ones
  /// Numbers of an image of so many bodies, at most.
  static Index MostImage(Index bodies) { return (bodies + kSpares) * kBodyWidth<6>; }
  Index image_size() const { return (bodies_ + kSpares) * width(); }
  bool is_spare(int offset) const { return offset >= bodies_ * width(); }

  /// Row k, 2 kBodyWidth<p> numbers at a cache line.
  const double* row(Index k) const { return rows_.data() + k * 2 * width(); }
  double* row(Index k) { return rows_.data() + k * 2 * width(); }
  /// Where in an image the row's bodies begin; the second one may be spare.
  template <Index p>
  LCPBENCH_ALWAYS_INLINE static std::array<int, 2> Offsets(const double* row) {
    std::array<int, 2> offsets;
    static_assert(sizeof offsets == sizeof(double));
    std::memcpy(&offsets, row + kBodyWidth<p> + p, sizeof offsets);
    return offsets;
  }
  /// Finds the sets of consecutive rows that share no body.  O(n), allocates
  void FindSets();
  /// Where each of these sets ends; empty where there is little to gain by them, or they were not looked for.
  const std::vector<Index>& set_end() const { return set_end_; }

  /// >= 0
  std::int32_t first_body(Index k) const { return body(k, 0); }
  /// -1: none
  std::int32_t second_body(Index k) const { return body(k, 1); }

 private:
  Index width() const { return p_ == 3 ? kBodyWidth<3> : kBodyWidth<6>; }
  std::int32_t body(Index k, size_t side) const {
    const double* const s = row(k);
    const int offset = (p_ == 3 ? Offsets<3>(s) : Offsets<6>(s))[side];
    return is_spare(offset) ? -1 : offset >> (p_ == 3 ? 2 : 3);
  }
  void LayOut(Index p, Index size, Index bodies);
  void PlaceBodies(Index k, Index first, Index second);
  template <Index p, typename Real>
  bool TakeOf(const StepRows& step, const Real* J, const std::int32_t* place, ScaledProblem* scaled);

  Index p_ = 3, size_ = 0, bodies_ = 0;
  Array rows_;
  Array root_mass_;              // M^-1/2, p numbers per body
  std::vector<Index> last_set_;  // of FindSets, by body: the last set with a row on it
  std::vector<Index> set_end_;
};

}  // namespace lcpbench
