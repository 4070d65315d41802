#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/pivoting/vector_register.h"

namespace lcpbench {

/// Principal pivoting on a dense tableau, for problems of a few dozen rows, where every other method spends its time on
/// bookkeeping.
///
/// The tableau is the principal transform of (A, b) for the active set F [Tucker 1963; Cottle, Pang, Stone, sec. 4.1]:
/// its last column holds f_F and w_N of the basic point, its F block A_FF^-1. One pivot moves one row into or out of F
/// and is a rank-one update of the rows that it reaches: zeros in the pivot's column, plenty in contact problems, cost
/// nothing once rows are long enough for the question to pay. Bilateral rows enter first and stay. Then the row with
/// the most negative f A_ii^1/2 or w / A_ii^1/2 is moved, until there is none; after `2 n` moves the violated row of
/// least index is [Murty 1974], which is finite for positive definite A.
///
/// One and two rows have closed forms, which are tried first.
///
/// All vectors and rows are padded to whole vector registers by zeros, in a scaling by powers of two that brings A_ii
/// into [1, 4) and the largest |b_i| into [1, 2), so that no unit matters and nothing is rounded by it.
///
/// Rows that depend on F are left alone while others are violated; then the most violated of them takes the place of
/// the row whose force it drives to 0 first [Keller 1973].
///
/// Not robust by itself, and it knows: Gauss-Jordan transforms are less stable than factors, and on singular A there is
/// no guarantee. The caller checks the answer and has others to ask.
///
/// Cost: O(n^2) per pivot at most, 0.7 n to n pivots typically. Only Reserve allocates.
class SmallPivoting {
 public:
  using Index = Eigen::Index;
  static constexpr Index kMaxRows = 128;
  /// Up to this many rows no clock is read: 6 n + 20 pivots, the most there are, take some ten microseconds.
  static constexpr Index kRowsWithoutClock = 24;
  /// Up to this many rows A is assembled by vector registers over all pairs of rows, above by lists of rows per body.
  static constexpr Index kLaneRows = 16;

  /// For up to `max_rows` <= kMaxRows rows at a time; for SolvePart also the rows of the whole problem.
  void Reserve(Index max_rows, Index problem_rows = 0);
  /// The same for SolveRows.
  void ReserveRows(Index max_rows, Index max_bodies);

  struct Request {
    /// What every row's backward error shall be at most; forces that are nothing but rounding are set to 0 for it.
    double row_limit = 1e-6;
    /// nullptr, or forces whose positive ones tell the active set: if A_FF f_F = -b_F gives the answer for it, or after
    /// changing sides of violated rows once, there is no tableau.
    const double* initial_f = nullptr;
    /// nullptr for none; Solve gives up when it has expired. Not read up to kRowsWithoutClock.
    const Deadline* deadline = nullptr;
    /// false: the basic point is the answer, neither measured nor refined, and rho is 0 unless it gave up.
    bool self_check = true;
  };
  struct Answer {
    double rho;  ///< in double; infinity if it gave up
    /// What rounding can hide of the rho of the given form: w_i / A_ii^1/2 is off by at most 2 (n + 8) epsilon
    /// |D^1/2 f|_1, also where A_ij is a rounded sum, because (|J| M^-1 |J|^T)_ij <= (A_ii A_jj)^1/2.
    double rounding;
    bool rows_meet;  ///< row_limit, in double

    enum class Judgement {
      kRight,
      kUnclear,  ///< the given form decides
      kWrong,
    };
    Judgement Judge(double tolerance) const;
  };

  /// Writes the basic point's forces, refined once against A where that helps, to `f` (n entries, in the problem's
  /// units, f_C >= 0). Reads DenseA() and DiagonalA().
  Answer Solve(const LcpProblem& problem, const Request& request, Eigen::VectorXd* f) {
    return SolveLoaded(
        LoadDense(problem), [](Index i) { return i; }, request, f->data(), nullptr);
  }

  /// The same for the LCP of `rows` (ascending) alone. Reads SparseA() and DiagonalA(), writes the entries `rows` of f.
  Answer SolvePart(const LcpProblem& problem, std::span<const Index> rows, const Request& request, Eigen::VectorXd* f) {
    return SolveLoaded(
        LoadPart(problem, rows), [rows](Index i) { return rows[static_cast<size_t>(i)]; }, request, f->data(), nullptr);
  }

  /// The same for the rows `part` (ascending) of an engine's arrays, which have been checked; A is assembled straight
  /// into the tableau. Writes the entries `part` of f and w. ReserveRows comes before.
  Answer SolveRows(const StepRows& all, std::span<const std::int32_t> part, const Request& request, double* f,
                   double* w) {
    return SolveLoaded(
        LoadRows(all, part), [part](Index i) { return Index{part[static_cast<size_t>(i)]}; }, request, f, w);
  }

  /// The same for a symmetric A that arrays give, dense or by compressed rows; they have been checked.
  /// @param diagonal  of A, n numbers
  Answer SolveArrays(const ProblemArrays& arrays, const double* diagonal, const Request& request, double* f) {
    return SolveLoaded(
        LoadArrays(arrays, diagonal), [](Index i) { return i; }, request, f, nullptr);
  }

  /// Pivots of the last Solve; guessed active sets that were tried count as one each.
  int pivots() const { return pivots_; }

 private:
  bool LoadDense(const LcpProblem& problem);
  bool LoadPart(const LcpProblem& problem, std::span<const Index> rows);
  bool LoadRows(const StepRows& all, std::span<const std::int32_t> part);
  bool LoadArrays(const ProblemArrays& arrays, const double* diagonal);
  template <Index p, typename Real>
  bool LoadRowsOf(const StepRows& all, const Real* J, std::span<const std::int32_t> part);
  template <Index p>
  void AssembleByRegisters();
  template <Index p>
  void AssembleByBodies();
  void SetSize(Index n);
  bool Scale();
  template <typename Given>
  Answer SolveLoaded(bool is_loaded, const Given& given, const Request& request, double* f, double* w);
  template <typename Given>
  void Store(const Given& given, double* f, double* w) const;
  Answer Finish(const Request& request);
  double Run(const Deadline* deadline);
  bool RowsMeet(double limit) const;
  bool SolveInClosedForm();
  double TryGuess();
  void SolveGuess();
  bool FindActiveSet(const Deadline* deadline);
  // Loops over `count` registers a row are unrolled; 0: any number.
  template <int count>
  bool DrivePivots(const Deadline* deadline);
  template <int count>
  bool Pivot(Index r);
  // A pivot: the tableau's row after it, and the column that it is of.
  struct PivotRow {
    Index r;
    const double* p;
  };
  template <int count>
  void EliminateBoth(const PivotRow& first, const PivotRow& second, std::uint64_t second_rows);
  static void EliminateOne(double* row, Index stride, const PivotRow& pivot);
  void CatchUp();
  template <int count>
  bool Exchange();
  template <int count>
  Index MostViolated() const;
  template <int count>
  Index Registers() const {
    return count > 0 ? count : stride_ / kRegister;
  }
  Index FirstViolated() const;
  void FindForces();
  double Rho();
  void Refine();
  bool violated(Index i) const { return q_[i] * weight_[i] < -noise_; }

  Index n_ = 0;
  Index stride_ = 0;  // n in whole registers
  int pivots_ = 0;
  double b_scale_ = 1;
  double inverse_b_scale_ = 1;
  double b_norm_ = 1;
  double noise_ = 0;                             // violations below this are rounding
  Eigen::VectorXd matrix_, tableau_;             // row i from i * stride_
  Eigen::VectorXd diagonal_, b_, q_;             // q: last column of the tableau
  Eigen::VectorXd scale_, root_, inverse_root_;  // root: A_ii^1/2
  // By row: what q is compared in, 0 where it may have any sign; +1 in F and -1 outside; the least force.
  Eigen::VectorXd weight_, sign_, least_force_;
  Eigen::VectorXd force_, w_, pivot_row_, correction_;
  Index waiting_ = -1;              // the pivot that only q_ and its own row know of; -1: none
  std::uint64_t waiting_rows_ = 0;  // up to 64 rows, a bit for each that it changes
  Eigen::VectorXd waiting_row_;
  Eigen::VectorXd blocked_weight_;     // the weight of a row that may not be moved for now, else 0
  std::vector<Index> joints_, guess_;  // guess_: active rows, ascending
  std::vector<int> local_;             // by row of the whole problem: its place in the part where it last was in one

  // Of SolveRows. Up to kLaneRows rows J lies by components, a component's rows side by side; above by rows.
  Eigen::VectorXd jacobian_, momentum_;  // scaled J, and J M^-1
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>
      body_of_;                              // of each row its first body, then (from stride_ on) its second; -1: none
  std::vector<std::int32_t> last_, before_;  // by body: its last (row, side) so far; by (row, side): the one before
};

/// Row i of what is solved is row given(i) of the problem.
template <typename Given>
SmallPivoting::Answer SmallPivoting::SolveLoaded(bool is_loaded, const Given& given, const Request& request, double* f,
                                                 double* w) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  pivots_ = 0;
  if (!is_loaded) return {kInfinity, kInfinity, false};
  guess_.clear();
  for (Index i = 0; i < n_ && request.initial_f != nullptr; ++i) {
    if (least_force_[i] < 0 || request.initial_f[given(i)] > 0) guess_.push_back(i);
  }
  const Answer answer = Finish(request);
  Store(given, f, w);
  return answer;
}

template <typename Given>
void SmallPivoting::Store(const Given& given, double* f, double* w) const {
  for (Index i = 0; i < n_; ++i) f[given(i)] = force_[i] * (scale_[i] * inverse_b_scale_);
  for (Index i = 0; i < n_ && w != nullptr; ++i) w[given(i)] = w_[i] * (inverse_b_scale_ / scale_[i]);
}

}  // namespace lcpbench
