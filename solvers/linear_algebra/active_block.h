#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/dense_ldlt.h"

namespace lcpbench {

/// A symmetric positive semidefinite matrix A with the Cholesky factor of a shifted principal block
///     K_FF = A_FF + shift D_FF,   D = diag A, shift > 0,
/// for methods that change F by many rows at a time. Two forms: SparseActiveBlock and DenseActiveBlock. Vectors are by
/// row of the problem. Internal to solvers/. Only Analyze allocates.
class ActiveBlock {
 public:
  virtual ~ActiveBlock() = default;

  /// What depends on the structure of A only.
  virtual void Analyze(const LcpProblem& problem) = 0;
  /// Takes the values S A S, S = diag(scale). To be called before a first Factor.
  virtual void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) = 0;

  /// F := rows with active[i] != 0, all with A_ii > 0. Mathematically every pivot is at least shift A_ii; rounding is
  /// held to that, so factoring cannot fail. The clock is read every kWorkPerClockRead multiply-adds.
  /// @param deadline  nullptr for none
  /// @returns false if the deadline passed meanwhile; there is no factor then
  virtual bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) = 0;
  /// Some 10 us of them.
  static constexpr double kWorkPerClockRead = 1 << 15;
  /// x_F := K_FF^-1 x_F, other entries := 0.
  virtual void Solve(double* x) = 0;
  /// y := A x.
  virtual void Multiply(const double* x, double* y) const = 0;
  /// Nanoseconds that a Factor of all rows and what goes with it take, roughly, for a choice between forms. Measured
  /// with AVX-512 on one machine; the ratio of the two forms matters only.
  virtual double factor_time() const = 0;
  /// Rows of the last factor that depend on others: whose pivot is little more than the shift.  O(n)
  virtual Index CountDependentRows() const = 0;
  static constexpr double kDependentPivot = 10;  ///< in shift A_ii
};

/// ActiveBlock on the dense A: a DenseLdlt from scratch.
class DenseActiveBlock final : public ActiveBlock {
 public:
  void Analyze(const LcpProblem& problem) override;
  void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) override;
  bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) override;
  void Solve(double* x) override;
  void Multiply(const double* x, double* y) const override;
  Index CountDependentRows() const override;
  /// In the place of Analyze, for matrices of n rows. Allocates.
  void Reserve(Index n);
  /// In the place of Load: A of up to n rows of a step, filled up by zeros, in given units, which Scale ends.
  void Assemble(const StepRows& rows);
  double given_diagonal(Index i) const { return A_(i, i); }  ///< between Assemble and Scale
  void Scale(const Eigen::VectorXd& scale);                  ///< A := S A S
  double factor_time() const override { return FactorTime(n_); }
  /// The same without an analysis, which allocates three n x n arrays.
  static double FactorTime(Index n);

 private:
  Index n_ = 0;
  double shift_ = 0;
  Eigen::MatrixXd A_;               // S A S, and below it at least one row of zeros
  std::vector<std::int32_t> rows_;  // F, filled up to whole lanes by the first row of zeros
  DenseLdlt factor_;
  Eigen::VectorXd x_;
};

/// ActiveBlock on the sparse A: L D L^T in an approximate minimum degree order, with one symbolic analysis for all F.
///
/// Rows are computed one after the other (up-looking [Davis 2006, sec. 4.7]) on the pattern of the factor of the whole
/// A: a row outside F is a row of zeros. Row r depends on its descendants in the elimination tree only, so a Factor
/// after a small change of F computes the changed rows and their ancestors anew and keeps the others. Columns of equal
/// structure are handled up to four together, which shares the indices and the accumulator.
///
/// In a sequence (LcpSolver::SetInSequence) the analysis is kept for a next problem of the same pattern.
class SparseActiveBlock final : public ActiveBlock {
 public:
  void Analyze(const LcpProblem& problem) override;
  void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) override;
  bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) override;
  void Solve(double* x) override;
  void Multiply(const double* x, double* y) const override;
  double factor_time() const override;
  Index CountDependentRows() const override;

 private:
  bool HasPattern(const SparseMatrix& A) const;
  void Order(const SparseMatrix& A);
  void Permute(const SparseMatrix& A);
  void FindPatterns();
  void ComputeRow(int r);

  // The pattern of the A analysed last, by rows.
  std::vector<int> outer_, inner_;

  // A in elimination order: the diagonal, and the entries left of it by rows.
  int n_ = 0;
  std::vector<int> order_;                    // place in the elimination order -> row of the problem
  std::vector<int> start_, column_, source_;  // of row r: [start_[r], start_[r+1]); source_: entry of SparseA()
  std::vector<int> diagonal_source_;
  std::vector<double> values_, diagonal_;

  // L: by columns with ascending rows, and for each row the places of its entries.
  std::vector<int> parent_;
  std::vector<int> column_start_, rows_;
  std::vector<int> row_start_, row_columns_, row_places_;
  std::vector<int> chain_;  // how many columns from this one on have its structure, 1 to 4
  std::vector<double> lower_, pivots_;
  double factor_work_ = 0;  // multiply-adds

  // State.
  double shift_ = 0;  // 0: nothing factored yet
  std::vector<char> active_, dirty_;
  std::vector<double> y_;
  mutable std::vector<double> in_, out_;
};

/// The forms of an ActiveBlock, of which the cheapest one for a problem is used. Internal to solvers/.
class ActiveBlockChoice {
 public:
  struct Allowed {
    bool sparse = true;
    bool dense = true;
  };

  /// Analyzes the problem by the forms that are allowed, at least one, and returns the one of the least factor_time.
  /// Matrices that are nearly full are not analyzed as sparse ones where they may be dense.
  ActiveBlock* Analyze(const LcpProblem& problem, Allowed allowed);
  bool is_dense(const ActiveBlock* chosen) const { return chosen == &dense_; }
  /// Nanoseconds that a Factor of all `rows`, a Solve and what a method does with it take, roughly: for comparison with
  /// methods that do not factor.
  double StepTime(const ActiveBlock* chosen, Index rows) const;

 private:
  SparseActiveBlock sparse_;
  DenseActiveBlock dense_;
};

}  // namespace lcpbench
