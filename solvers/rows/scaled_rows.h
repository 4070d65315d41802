#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// The numbers of a body, p of them padded to a vector register.
template <Index p>
inline constexpr Index kBodyWidth = p == 3 ? 4 : 8;
template <Index p>
using BodyVector [[gnu::vector_size(static_cast<std::size_t>(kBodyWidth<p>) * sizeof(double)),
                   gnu::aligned(alignof(double)), gnu::may_alias]] = double;

template <Index p>
const BodyVector<p>& BodyAt(const double* y, Index body) {
  return *reinterpret_cast<const BodyVector<p>*>(y + body * kBodyWidth<p>);
}
template <Index p>
BodyVector<p>& BodyAt(double* y, Index body) {
  return *reinterpret_cast<BodyVector<p>*>(y + body * kBodyWidth<p>);
}
template <Index p>
double SumOf(const BodyVector<p>& v) {
  if constexpr (p == 3) return (v[0] + v[2]) + v[1];
  return ((v[0] + v[4]) + v[2]) + ((v[1] + v[5]) + v[3]);
}

/// The rows of one island, scaled to A_ii = 1 and bodies to unit mass:
///     A~ = G G^T,   G = D^-1/2 J M^-1/2,   b~ = D^-1/2 b,   D = diag A,   f = D^-1/2 x,   w~ = A~ x + b~ = D^-1/2 w,
/// so that one array of 2 p numbers a row serves sweeps (y = G^T x, w~ = G y + b~) and products. Bodies that can move
/// are numbered in breadth-first order from a body far from the first one [Cuthill, McKee 1969], rows ordered by the
/// later one of their bodies, so that A~ has a narrow profile. Only Reserve allocates.
class ScaledRows {
 public:
  /// For islands of up to `max_rows` rows, of steps with up to `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);

  /// False, with nothing to be read, if a row acts on no body that can move, or A_ii is 0 in double.  O(n p)
  /// @param all   checked (CheckRows), not extreme
  /// @param part  the island's rows
  bool Load(const StepRows& all, std::span<const std::int32_t> part);

  Index size() const { return n_; }                                   ///< n, rows of the island; 0 where Load failed
  Index bodies() const { return bodies_; }                            ///< that can move
  std::int32_t given(Index i) const { return given_[At(i)]; }         ///< the row of the step that row i is
  bool is_joint(Index i) const { return is_joint_[At(i)] != 0; }      ///< bilateral
  std::int32_t first_body(Index i) const { return first_[At(i)]; }    ///< >= 0
  std::int32_t second_body(Index i) const { return second_[At(i)]; }  ///< -1: none
  const double* b() const { return b_.data(); }                       ///< b~
  double scale(Index i) const { return scale_[i]; }                   ///< D_ii^-1/2
  double b_norm() const { return b_norm_; }                           ///< |b~|_2; 1 where b = 0
  /// Both sides of row i of G, kBodyWidth<p> numbers each.
  template <Index p>
  const double* G(Index i) const {
    return G_.data() + i * 2 * kBodyWidth<p>;
  }

  /// w~_i for y = G^T x.
  template <Index p>
  double Gap(Index i, const double* y) const {
    BodyVector<p> sum = BodyAt<p>(G<p>(i), 0) * BodyAt<p>(y, first_[At(i)]);
    if (second_[At(i)] >= 0) sum += BodyAt<p>(G<p>(i), 1) * BodyAt<p>(y, second_[At(i)]);
    return b_[i] + SumOf<p>(sum);
  }
  /// y += G^T e_i x.
  template <Index p>
  void AddRow(Index i, double x, double* y) const {
    BodyAt<p>(y, first_[At(i)]) += x * BodyAt<p>(G<p>(i), 0);
    if (second_[At(i)] >= 0) BodyAt<p>(y, second_[At(i)]) += x * BodyAt<p>(G<p>(i), 1);
  }
  /// y = G^T x, the scaled momenta: bodies() kBodyWidth<p> numbers.
  template <Index p>
  void ComputeMomenta(const double* x, double* y) const {
    std::fill_n(y, bodies_ * kBodyWidth<p>, 0.0);
    for (Index i = 0; i < n_; ++i) {
      if (x[i] != 0) AddRow<p>(i, x[i], y);
    }
  }

 private:
  static std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }
  bool NumberBodies(const StepRows& all, std::span<const std::int32_t> part);
  void ListRowsOfBodies();
  void OrderBodies();
  void OrderRows();
  template <Index p, typename Real>
  bool ScaleRows(const StepRows& all, const Real* J, std::span<const std::int32_t> part);

  Index n_ = 0, bodies_ = 0;
  double b_norm_ = 1;
  // By row, in order.
  std::vector<std::int32_t> given_, first_, second_;
  std::vector<unsigned char> is_joint_;
  Eigen::VectorXd G_, b_, scale_;
  // While bodies have the numbers in which rows of `part` name them first: by row of `part` its bodies, by body of the
  // step its number (-1 between calls), by number the body of the step and its place in the order.
  std::vector<std::int32_t> part_first_, part_second_, number_, body_of_number_, place_;
  std::vector<std::int32_t> rows_of_body_, rows_begin_, rows_end_;  // by number: rows of `part`
  std::vector<std::int32_t> queue_;                                 // of the breadth-first search
  std::vector<std::int32_t> order_, order_end_;  // rows of `part`, in order; by place their end so far
  Eigen::VectorXd root_mass_;                    // M^-1/2, by place
};

}  // namespace lcpbench
