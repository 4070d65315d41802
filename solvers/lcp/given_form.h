#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/: what solvers need that read a problem in its given form and never ask for A.
namespace lcpbench {

/// An upper bound on the entries of A = J M^-1 J^T, and the cost of forming it: the sum over bodies of (rows on the
/// body)^2. Rows on the same two bodies count twice. O(nnz J).
inline Index BoundEntriesOfA(const LcpProblem& problem) {
  const SparseMatrix& J = problem.J();
  std::vector<Index> rows_on(static_cast<size_t>((J.cols() + 2) / 3), 0);
  for (Index i = 0; i < J.rows(); ++i) {
    Index last = -1;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.col() / 3 == last || problem.inverse_mass()[it.col()] == 0) continue;
      last = it.col() / 3;
      ++rows_on[static_cast<size_t>(last)];
    }
  }
  Index entries = 0;
  for (const Index count : rows_on) entries += count * count;
  return entries;
}

/// Whether f meets a tier, by the problem's given form (same formulas as verify.h) in extended precision, so that the
/// answer does not hang on the rounding of one evaluation. Unlike ResidualEstimate it asks for no form of A that the
/// problem was not given in. Allocates in Reset only, unless columns are made when needed.
class GivenFormTest {
 public:
  /// When J by columns is made, which only rows need whose residual is not small by itself.
  enum class Columns { kNow, kWhenNeeded };

  /// The problem that f is tested for from here on; it must outlive its use here.
  void Reset(const LcpProblem& problem, Columns columns = Columns::kNow) {
    problem_ = problem;
    has_columns_ = false;
    const Index n = problem.size();
    w_.assign(At(n), 0);
    if (problem.has_factors()) {
      if (columns == Columns::kNow) MakeColumns();
      body_.assign(At(problem.J().cols()), 0);
      entry_.assign(At(n), 0);
      stamped_.assign(At(n), 0);
      stamp_ = 0;
      touched_.reserve(At(n));
    }
  }

  /// From here on with the b of a problem that shares the matrix of the one given to Reset.
  void SetB(const LcpProblem& problem) { problem_ = problem; }

  /// rho at f.  O(nnz of the given form).
  long double Rho(const Eigen::VectorXd& f) {
    const LcpProblem& problem = *problem_;
    const Eigen::VectorXd& D = problem.DiagonalA();
    ComputeW(f);
    long double r_squared = 0;
    long double b_squared = 0;
    for (Index i = 0; i < f.size(); ++i) {
      const long double d = D[i] == 0 ? 1.0L : std::abs(static_cast<long double>(D[i]));
      const long double force = std::sqrt(d) * f[i];
      const long double gap = w_[At(i)] / std::sqrt(d);
      const long double r = problem.is_bilateral(i) ? gap : std::min(gap, force);
      r_squared += r * r;
      b_squared += problem.b()[i] * (problem.b()[i] / d);
    }
    return std::sqrt(b_squared == 0 ? r_squared : r_squared / b_squared);
  }

  /// rho <= tolerance and backward error <= sqrt(tolerance).  As Rho, plus the entries of those rows of A whose
  /// residual is not small by itself.
  bool Meets(double tolerance, const Eigen::VectorXd& f) {
    if (!(Rho(f) <= tolerance)) return false;
    for (Index i = 0; i < f.size(); ++i) {
      if (!RowMeets(tolerance, f, i)) return false;
    }
    return true;
  }

  /// Whether row i alone has a backward error <= sqrt(tolerance) at the f of the last Rho or Meets.
  bool RowMeets(double tolerance, const Eigen::VectorXd& f, Index i) {
    const LcpProblem& problem = *problem_;
    const long double limit = std::sqrt(static_cast<long double>(tolerance));
    const long double b = problem.b()[i];
    const long double w = w_[At(i)];
    const long double force = std::abs(static_cast<long double>(problem.DiagonalA()[i])) * f[i];
    const long double defect = std::abs(problem.is_bilateral(i) ? w : std::min(w, force));
    // (|A| |f|)_i is at least both |A f|_i and |A_ii f_i|: most rows pass by that alone.
    const long double least = std::max(std::abs(w - b), std::abs(force));
    return defect <= limit * (least + std::abs(b)) || defect <= limit * (Magnitude(i, f) + std::abs(b));
  }

  /// w = A f + b of the last Rho or Meets.
  long double w(Index i) const { return w_[At(i)]; }

 private:
  static size_t At(Index i) { return static_cast<size_t>(i); }

  void MakeColumns() {
    columns_ = problem_->J();
    has_columns_ = true;
  }

  void ComputeW(const Eigen::VectorXd& f) {
    const LcpProblem& problem = *problem_;
    for (Index i = 0; i < f.size(); ++i) w_[At(i)] = problem.b()[i];
    switch (problem.given_form()) {
      case MatrixForm::kDense: {
        const Eigen::MatrixXd& A = problem.DenseA();
        for (Index j = 0; j < f.size(); ++j) {
          if (f[j] == 0) continue;
          for (Index i = 0; i < f.size(); ++i) w_[At(i)] += static_cast<long double>(A(i, j)) * f[j];
        }
        break;
      }
      case MatrixForm::kSparse:
        for (Index i = 0; i < f.size(); ++i) {
          for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
            w_[At(i)] += static_cast<long double>(it.value()) * f[it.col()];
          }
        }
        break;
      case MatrixForm::kFactors: {
        std::fill(body_.begin(), body_.end(), 0.0L);
        for (Index i = 0; i < f.size(); ++i) {
          for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
            body_[At(it.col())] += static_cast<long double>(it.value()) * f[i];
          }
        }
        for (Index k = 0; k < problem.J().cols(); ++k) body_[At(k)] *= problem.inverse_mass()[k];
        for (Index i = 0; i < f.size(); ++i) {
          for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
            w_[At(i)] += it.value() * body_[At(it.col())];
          }
        }
        break;
      }
    }
  }

  // (|A| |f|)_i
  long double Magnitude(Index i, const Eigen::VectorXd& f) {
    const LcpProblem& problem = *problem_;
    long double sum = 0;
    switch (problem.given_form()) {
      case MatrixForm::kDense:
        for (Index j = 0; j < f.size(); ++j) sum += std::abs(static_cast<long double>(problem.DenseA()(i, j)) * f[j]);
        break;
      case MatrixForm::kSparse:
        for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
          sum += std::abs(static_cast<long double>(it.value()) * f[it.col()]);
        }
        break;
      case MatrixForm::kFactors:
        if (!has_columns_) MakeColumns();
        touched_.clear();
        ++stamp_;
        for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
          const long double scaled = static_cast<long double>(it.value()) * problem.inverse_mass()[it.col()];
          if (scaled == 0) continue;
          for (decltype(columns_)::InnerIterator jt(columns_, it.col()); jt; ++jt) {
            const auto j = At(jt.row());
            if (stamped_[j] != stamp_) {
              stamped_[j] = stamp_;
              entry_[j] = 0;
              touched_.push_back(jt.row());
            }
            entry_[j] += scaled * jt.value();
          }
        }
        for (const Index j : touched_) sum += std::abs(entry_[At(j)] * f[j]);
        break;
    }
    return sum;
  }

  std::optional<LcpProblem> problem_;  // a copy: what Prepare was given may be gone
  Eigen::SparseMatrix<double, Eigen::ColMajor, int> columns_;
  bool has_columns_ = false;
  std::vector<long double> w_, body_, entry_;
  std::vector<Index> touched_;
  std::vector<std::int64_t> stamped_;  // == stamp_: entry_ is of the row at hand
  std::int64_t stamp_ = 0;
};

}  // namespace lcpbench
