#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "solvers/lcp/law.h"
#include "solvers/lcp/problem.h"
#include "support/array_index.h"

namespace lcpbench {

/// w = A f + b, rho and backward errors of candidates f, by the problem's given form: where all solvers take them from.
/// Same formulas as verify.h, which is written apart from this so that the verdict stays independent. Allocates in
/// Reset only, unless Rows says otherwise.
/// @tparam Real  what sums are made in: double for estimates, long double where an answer must not hang on the rounding
///               of one evaluation
template <typename Real>
class Residual {
 public:
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;  ///< n numbers

  /// What (|A| |f|)_i is summed from.
  enum class Rows {
    kGiven,            ///< the given form; from factors through the columns of J, so that no form of A is made
    kGivenWhenNeeded,  ///< the same, all workspace made by the first call that needs it: Reset costs nothing
    kDense,            ///< DenseA(); A is symmetric
    kSparse,           ///< SparseA()
  };

  Residual() = default;
  /// For a single answer.
  explicit Residual(const LcpProblem& problem) { Reset(problem, Rows::kGivenWhenNeeded); }

  /// O(nnz of the given form)
  void Reset(const LcpProblem& problem, Rows rows = Rows::kGiven) {
    problem_ = problem;
    rows_ = rows;
    has_columns_ = false;
    if (rows == Rows::kGivenWhenNeeded) return;
    MakeRoom();
    if (rows == Rows::kDense) problem.DenseA();
    if (rows == Rows::kSparse) problem.SparseA();
    if (rows == Rows::kGiven && problem.has_factors()) MakeColumns();
  }
  /// The workspace of Rho(f), which Reset makes unless Rows is kGivenWhenNeeded.
  void MakeRoom() {
    Grow(problem_->size(), &w_);
    if (problem_->has_factors()) Grow(problem_->J().cols(), &body_);
  }
  /// From here on with the b of a problem that shares the matrix of the one given to Reset.
  void SetB(const LcpProblem& problem) { problem_ = problem; }
  /// Whose answers are judged.
  const LcpProblem& problem() const { return *problem_; }

  /// *w (n numbers) = A f + b.  O(nnz of the given form)
  void ComputeW(const Eigen::VectorXd& f, Vector* w) {
    const LcpProblem& problem = *problem_;
    const Eigen::VectorXd& b = problem.b();
    if (problem.has_factors()) {
      const SparseMatrix& J = problem.J();
      Grow(J.cols(), &body_);
      body_.head(J.cols()).setZero();
      for (Index i = 0; i < f.size(); ++i) {
        if (f[i] == 0) continue;
        for (SparseMatrix::InnerIterator it(J, i); it; ++it) body_[it.col()] += static_cast<Real>(it.value()) * f[i];
      }
      for (Index k = 0; k < J.cols(); ++k) body_[k] *= problem.inverse_mass()[k];
      for (Index i = 0; i < f.size(); ++i) {
        Real sum = 0;
        for (SparseMatrix::InnerIterator it(J, i); it; ++it) sum += it.value() * body_[it.col()];
        (*w)[i] = sum + b[i];
      }
    } else if constexpr (std::is_same_v<Real, double>) {
      problem.ComputeW(f, w);
    } else if (problem.given_form() == MatrixForm::kDense) {
      w->head(f.size()) = b.cast<Real>();
      for (Index j = 0; j < f.size(); ++j) {
        if (f[j] != 0) w->head(f.size()) += problem.DenseA().col(j).cast<Real>() * static_cast<Real>(f[j]);
      }
    } else {
      for (Index i = 0; i < f.size(); ++i) {
        Real sum = b[i];
        for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
          sum += static_cast<Real>(it.value()) * f[it.col()];
        }
        (*w)[i] = sum;
      }
    }
  }

  /// rho at f with w = A f + b given.  O(n)
  Real Rho(const Eigen::VectorXd& f, const Vector& w) const {
    const Eigen::VectorXd& D = problem_->DiagonalA();
    const Eigen::VectorXd& b = problem_->b();
    Joints joints(*problem_);
    LawSums<Real> sums;
    for (Index i = 0; i < f.size(); ++i) sums.Add(std::abs(D[i]), b[i], w[i], f[i], joints.Has(i));
    return sums.rho();
  }
  /// rho at f.  O(nnz of the given form)
  Real Rho(const Eigen::VectorXd& f) {
    MakeRoom();
    ComputeW(f, &w_);
    return Rho(f, w_);
  }
  /// (A f + b)_i for the f given to the last Rho(f) or Meets(tolerance, f).
  Real w(Index i) const { return w_[i]; }

  /// The largest backward error at f, w; NaN where it is that of a row.  O(n + entries of the rows that have a defect)
  Real BackwardError(const Eigen::VectorXd& f, const Vector& w) {
    const Eigen::VectorXd& D = problem_->DiagonalA();
    const Eigen::VectorXd& b = problem_->b();
    Joints joints(*problem_);
    Real worst = 0;
    for (Index i = 0; i < f.size() && !std::isnan(worst); ++i) {
      const Real force = std::abs(static_cast<Real>(D[i])) * f[i];
      const Real defect = std::abs(LawSums<Real>::Defect(w[i], force, joints.Has(i)));
      if (defect == 0) continue;
      const Real error = defect / (std::abs(static_cast<Real>(b[i])) + Magnitude(i, f));
      if (!(error <= worst)) worst = error;
    }
    return worst;
  }

  /// The same with the w of the last Rho(f).
  Real BackwardError(const Eigen::VectorXd& f) { return BackwardError(f, w_); }

  /// Whether f passes a tier: rho <= tolerance and every backward error <= sqrt(tolerance).  As Rho(f), plus the
  /// entries of those rows of A whose residual is not small by itself.
  bool Meets(double tolerance, const Eigen::VectorXd& f) {
    if (!(Rho(f) <= tolerance)) return false;
    for (Index i = 0; i < f.size(); ++i) {
      if (!RowMeets(tolerance, f, i)) return false;
    }
    return true;
  }
  /// The same with w given.
  bool Meets(double tolerance, const Eigen::VectorXd& f, const Vector& w) {
    return Rho(f, w) <= tolerance && BackwardError(f, w) <= std::sqrt(static_cast<Real>(tolerance));
  }
  /// Whether row i alone has a backward error <= sqrt(tolerance) at the f of the last Rho(f) or Meets(tolerance, f).
  bool RowMeets(double tolerance, const Eigen::VectorXd& f, Index i) {
    const Real limit = std::sqrt(static_cast<Real>(tolerance));
    const Real b = problem_->b()[i];
    const Real force = std::abs(static_cast<Real>(problem_->DiagonalA()[i])) * f[i];
    const Real defect = std::abs(LawSums<Real>::Defect(w_[i], force, problem_->is_bilateral(i)));
    // (|A| |f|)_i is at least both |A f|_i and |A_ii f_i|: most rows pass by that alone.
    const Real least = std::max(std::abs(w_[i] - b), std::abs(force));
    return defect <= limit * (least + std::abs(b)) || defect <= limit * (Magnitude(i, f) + std::abs(b));
  }

 private:
  // Which rows are bilateral, asked in ascending order.
  class Joints {
   public:
    explicit Joints(const LcpProblem& problem)
        : next_(problem.bilateral_rows().data()), end_(next_ + problem.bilateral_rows().size()) {}
    bool Has(Index i) {
      if (next_ == end_ || *next_ != i) return false;
      ++next_;
      return true;
    }

   private:
    const Index* next_;
    const Index* end_;
  };

  // Room stays for the next problem: a fresh solve of a small problem costs little more than its allocations.
  static void Grow(Index size, Vector* v) {
    if (v->size() < size) v->resize(size);
  }
  void MakeColumns() {
    columns_ = problem_->J();
    has_columns_ = true;
    Grow(problem_->size(), &entry_);
    stamped_.assign(At(problem_->size()), 0);
    stamp_ = 0;
    touched_.reserve(At(problem_->size()));
  }

  // (|A| |f|)_i
  Real Magnitude(Index i, const Eigen::VectorXd& f) {
    const LcpProblem& problem = *problem_;
    if (rows_ == Rows::kDense) {  // column i is row i, and contiguous
      return problem.DenseA().col(i).template cast<Real>().cwiseAbs().dot(f.template cast<Real>().cwiseAbs());
    }
    Real sum = 0;
    if (rows_ == Rows::kSparse || problem.given_form() == MatrixForm::kSparse) {
      for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
        sum += std::abs(static_cast<Real>(it.value()) * f[it.col()]);
      }
    } else if (problem.given_form() == MatrixForm::kDense) {
      for (Index j = 0; j < f.size(); ++j) sum += std::abs(static_cast<Real>(problem.DenseA()(i, j)) * f[j]);
    } else {
      if (!has_columns_) MakeColumns();
      touched_.clear();
      ++stamp_;
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
        const Real scaled = static_cast<Real>(it.value()) * problem.inverse_mass()[it.col()];
        if (scaled == 0) continue;
        for (typename decltype(columns_)::InnerIterator jt(columns_, it.col()); jt; ++jt) {
          const Index j = jt.row();
          if (stamped_[At(j)] != stamp_) {
            stamped_[At(j)] = stamp_;
            entry_[j] = 0;
            touched_.push_back(j);
          }
          entry_[j] += scaled * jt.value();
        }
      }
      for (const Index j : touched_) sum += std::abs(entry_[j] * f[j]);
    }
    return sum;
  }

  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  Rows rows_ = Rows::kGiven;
  Vector w_, body_;  // n numbers, one per column of J; more where an earlier problem was larger
  // For rows of A = J M^-1 J^T, one at a time:
  Eigen::SparseMatrix<double, Eigen::ColMajor, int> columns_;
  bool has_columns_ = false;
  Vector entry_;
  std::vector<Index> touched_;
  std::vector<std::int64_t> stamped_;  // == stamp_: entry_ is of the row at hand
  std::int64_t stamp_ = 0;
};

using ResidualEstimate = Residual<double>;    ///< in double
using GivenFormTest = Residual<long double>;  ///< in extended precision: its Meets decides what a solver claims

}  // namespace lcpbench
