#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/instruction_set.h"
#include "solvers/linear_algebra/sides_of_bodies.h"
#include "solvers/pivoting/tableau_work.h"
#include "solvers/rows/fixed_size_bpp.h"
#include "solvers/rows/matrix_arrays.h"
#include "solvers/rows/row_judge.h"

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
/// Other rules for the next pivot make it Dantzig's or Lemke's method on the same tableau (TableauRule).
///
/// One and two rows have closed forms, which principal pivoting tries first.
///
/// A is loaded here; a kernel (DenseTableau), compiled for each instruction set and chosen at run time, does the rest.
/// It scales by powers of two that bring A_ii into [1, 4) and the largest |b_i| into [1, 2), so that no unit matters
/// and nothing is rounded by it.
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

  /// @throws InputError if this machine lacks the instructions
  explicit SmallPivoting(InstructionSet instructions = InstructionSet::kBest,
                         TableauRule rule = TableauRule::kMostViolated);
  SmallPivoting(const SmallPivoting&) = delete;
  SmallPivoting& operator=(const SmallPivoting&) = delete;

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
  };
  struct Answer {
    double rho;  ///< in double; infinity if it gave up
    /// What rounding can hide of the rho of the given form: w_i / A_ii^1/2 is off by at most 2 (n + 8) epsilon
    /// |D^1/2 f|_1, also where A_ij is a rounded sum, because (|J| M^-1 |J|^T)_ij <= (A_ii A_jj)^1/2.
    double rounding;
    bool rows_meet;       ///< row_limit, in double
    bool rows_are_clear;  ///< and rounding of A hides no row that misses it by more than SmallPivoting's callers allow

    enum class Judgement {
      kRight,
      kUnclear,  ///< the given form decides
      kWrong,
    };
    /// By rho and what rounding may hide of it.
    Judgement Judge(double tolerance) const;
  };

  /// Writes the basic point's forces, refined once against A where that helps, to `f` (n entries, in the problem's
  /// units, f_C >= 0). Reads DenseA() and DiagonalA().
  Answer Solve(const LcpProblem& problem, const Request& request, Eigen::VectorXd* f);

  /// The same for the LCP of `rows` (ascending) alone. Reads SparseA() and DiagonalA(), writes the entries `rows` of f.
  Answer SolvePart(const LcpProblem& problem, std::span<const Index> rows, const Request& request, Eigen::VectorXd* f);

  /// How SolveRows ended.
  enum class End {
    kSolved,   ///< f passed
    kInexact,  ///< f is finite, and misses the tolerance
    kGaveUp,   ///< f is not to be used
  };
  /// The same for the rows `part` (ascending; they share no moving body with others) of an engine's arrays, which have
  /// been checked, judged by these rows where rounding leaves it open. A is assembled straight into the tableau.
  /// ReserveRows comes before.
  /// @param request  its row_limit is not read
  /// @param f, w     entries `part` are written: forces, and A f + b where solved
  /// @param rho      written
  End SolveRows(const StepRows& all, std::span<const std::int32_t> part, double tolerance, Request request,
                RowJudge* judge, double* f, double* w, double* rho);

  /// The same for A as arrays give it.
  Answer SolveMatrix(const MatrixArrays& A, const Request& request, double* f);

  /// The same for m rows of a symmetric A in one piece.
  /// @param bilateral  m, 1: a joint
  Answer SolveDense(Index m, const double* A, const double* diagonal, const double* b, const unsigned char* bilateral,
                    const Request& request, double* f);

  /// Pivots of the last Solve; guessed active sets that were tried count as one each.
  int pivots() const { return work_.pivots; }

 private:
  template <typename Given, typename Joint, typename Fill>
  void Load(Index n, const Given& given, const double* diagonal, const double* b, const Joint& is_joint,
            const Fill& fill);
  void SetSize(Index n);
  double* RowOfA(Index i) { return work_.matrix + i * work_.stride; }
  template <typename Given>
  Answer SolveLoaded(const Given& given, const Request& request, double* f, double* w);

  const FixedSizeBpp one_;  // row, which is a division whatever the rule
  const TableauKernel& of_few_rows_;
  const TableauKernel& of_many_rows_;
  const TableauKernel* kernel_ = nullptr;  // of the rows that are loaded
  TableauWork work_;
  Eigen::VectorXd numbers_;       // what work_ points to
  std::vector<int> integers_;     // the same
  std::vector<int> local_;        // by row of the whole problem: its place in the part where it last was in one
  std::vector<double> jacobian_;  // of SolveRows
  SidesOfBodies sides_;           // the same: of the rows loaded so far
};

}  // namespace lcpbench
