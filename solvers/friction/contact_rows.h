#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/lcp/law.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/scaled_lcp.h"
#include "solvers/linear_algebra/sides_of_bodies.h"

/// Internal to solvers/.
namespace lcpbench {

/// A problem with friction in scaled variables, phi = D^1/2 f and omega = D^-1/2 w with D = diag A (1 where that is 0):
/// omega = A phi + b. What all methods of this folder start from [docs/friction.md sections 4, 5].
///
/// Vectors have n numbers or more, of which the first n count: workspace that is long enough is never made anew.
class ContactRows {
 public:
  /// O(nnz A); allocates.
  void Prepare(const LcpProblem& problem);
  /// The same for the rows `part` of a step, ascending, which share no moving body with other rows. The rows of the
  /// laws are counted in the part. A is dense: for up to some hundred rows.  O(rows^2); allocates for a larger part
  /// only
  void Prepare(const StepRows& step, std::span<const std::int32_t> part, std::span<const FrictionRow> friction,
               std::span<const BoundedRow> bounded);
  /// For parts of up to so many rows and bodies with a lesser number than that.
  void Reserve(Index max_rows, Index max_bodies);
  /// From here on with the b of a problem that shares the matrix of the prepared one.  O(n)
  void SetB(const LcpProblem& problem);

  Index size() const { return static_cast<Index>(root_.size()); }           ///< n
  double root(Index row) const { return root_[static_cast<size_t>(row)]; }  ///< D^1/2
  /// The rows law by law, mu and bounds scaled: mu (D_t / D_n)^1/2.
  Laws laws() const { return {joints_, normals_, friction_, bounded_}; }
  /// The friction rows of a normal row.
  std::span<const FrictionRow> FrictionOf(Index normal) const {
    const auto found = std::ranges::equal_range(friction_, normal, {}, &FrictionRow::normal);
    return {found.begin(), found.end()};
  }
  auto b() const { return b_.head(size()); }  ///< n, scaled
  /// Plain and friction rows only, up to one a contact: what the relaxation takes.
  bool can_relax() const { return bounded_.empty() && !is_sliding_ && is_paired_; }
  bool is_paired() const { return is_paired_; }  ///< up to one friction row a contact

  /// Calls visit(column, entry) over the scaled row.
  template <typename Visit>
  void VisitRow(Index row, const Visit& visit) const {
    if (is_dense_) {
      const double* const entry = DenseRow(row);
      const Index end = end_[static_cast<size_t>(row)];
      for (Index j = start_[static_cast<size_t>(row)]; j < end; ++j) visit(j, entry[j]);
      return;
    }
    for (Index e = start_[static_cast<size_t>(row)]; e < start_[static_cast<size_t>(row) + 1]; ++e) {
      visit(column_[static_cast<size_t>(e)], value_[static_cast<size_t>(e)]);
    }
  }
  /// Whether A is dense: the n entries of a row, which are 0 but from its start to its end.
  bool is_dense() const { return is_dense_; }
  const double* DenseRow(Index row) const { return dense_.data() + row * stride_; }
  Index start(Index row) const { return start_[static_cast<size_t>(row)]; }
  Index end(Index row) const { return end_[static_cast<size_t>(row)]; }
  /// G = D^-1/2 J M^-1/2, n x columns that a row acts on: A = G G^T. nullptr where the problem is not given by factors.
  /// O(nnz J) at the first call after Prepare.
  const SparseMatrix* OnBodies() const;
  /// omega_i at phi.
  double Gap(Index row, const PaddedVector& phi) const {
    double sum = b_[row];
    VisitRow(row, [&](Index j, double a) { sum += a * phi[j]; });
    return sum;
  }
  /// *product = A phi.  O(nnz A)
  void Multiply(const PaddedVector& phi, PaddedVector* product) const;
  /// *omega = A phi + b.  O(nnz A)
  void ComputeGaps(const PaddedVector& phi, PaddedVector* omega) const;
  /// rho of docs/friction.md section 4.  O(n)
  double Rho(const PaddedVector& phi, const PaddedVector& omega) const;
  /// The side of every row, by phi - omega; an open contact has the range [0, 0] on its friction rows.  O(n)
  void FindSides(const PaddedVector& phi, const PaddedVector& omega, std::vector<RangeSide>* sides) const;
  /// Forces brought within the laws.
  void ToScaled(const Eigen::VectorXd& f, PaddedVector* phi) const;
  /// Forces in the problem's units that obey the laws of forces exactly: 0 where a contact is open, or closed by no
  /// more than the rounding of its loads, +-mu f_n where it slips.
  void ToForces(const PaddedVector& phi, const PaddedVector& omega, PaddedVector* f) const;
  /// Whether f passes the tier, by rho and backward error in double with what rounding can hide of them. What is more
  /// than ten times beyond the tolerance is wrong.
  /// @param rho  written, where it is finite
  LawSums<double>::Known Judge(const Eigen::VectorXd& f, double tolerance, double* rho) const;
  /// *w = A f + b, in the problem's units.  O(nnz A)
  void ComputeGapsOf(const Eigen::VectorXd& f, PaddedVector* w) const;

 private:
  template <bool kWithLoads, bool kWithMagnitudes>
  void SumRows(const PaddedVector& phi, double* sums, double* magnitudes) const;
  void TakeMatrix(const LcpProblem& problem);
  template <int p, typename Real>
  void Assemble(const StepRows& step, const Real* J, std::span<const std::int32_t> part);
  void SetRoots(Index n, const double* diagonal, Index stride);
  void SetLaws(std::span<const FrictionRow> friction, std::span<const BoundedRow> bounded);
  void SetScale();
  std::optional<LcpProblem> problem_;  // prepared, for OnBodies
  mutable SparseMatrix on_bodies_;     // no columns: not made
  // D^-1/2 A D^-1/2 by compressed rows; or, dense_, by rows of stride_ numbers, of which row i has entries between the
  // columns start_[i] and end_[i].
  bool is_dense_ = false;
  Index stride_ = 0;
  std::vector<Index> first_of_register_, end_of_register_;  // the same of Lanes::kWidth rows together
  PaddedVector dense_;
  std::vector<Index> start_, end_;
  std::vector<int> column_;
  std::vector<double> value_;
  std::vector<double> root_, inverse_root_;  // D^1/2, D^-1/2
  SidesOfBodies sides_;                      // of Assemble, as jacobian_: 2 p numbers a row
  std::vector<double> jacobian_;
  std::vector<RowKind> kind_;
  std::vector<Index> joints_, normals_;
  std::vector<FrictionRow> friction_;  // by normal rows
  std::vector<BoundedRow> bounded_;
  std::vector<double> given_mu_;  // of friction_, as the problem has them
  bool is_sliding_ = false, is_paired_ = true;
  PaddedVector b_;
  std::vector<double> load_;                      // by normal row: the largest |b| of its contact
  double scale_ = 1;                              // S
  mutable PaddedVector phi_, omega_, magnitude_;  // of Judge
};

}  // namespace lcpbench
