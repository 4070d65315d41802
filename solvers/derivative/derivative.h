#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A direction in the data of a problem; what is left out does not change. Entries that J or A do not store may change.
struct ProblemChange {
  std::optional<SparseMatrix> A = {};                ///< n x n, not necessarily symmetric
  std::optional<SparseMatrix> J = {};                ///< n x pN, of problems by factors only
  std::optional<Eigen::VectorXd> inverse_mass = {};  ///< pN, of problems by factors only
  std::optional<Eigen::VectorXd> b = {};             ///< n
  std::optional<Eigen::VectorXd> mu = {};            ///< a number for each of LcpProblem::friction_rows()
};

/// The one-sided derivative along a direction: (f(t) - f) / t and (w(t) - w) / t for t -> 0, t > 0.
struct SolutionChange {
  /// kSolved; kInfeasible where there is no solution near f along the direction; else the problem of the degenerate
  /// rows was not solved.
  LcpStatus status = LcpStatus::kNotRun;
  Eigen::VectorXd f;   ///< n; NaN where status is not kSolved, and where f jumps
  Eigen::VectorXd w;   ///< n; NaN where status is not kSolved
  std::string detail;  ///< the reason in words
};

/// The gradient of a number L in the data.
struct ProblemGradient {
  Eigen::VectorXd b;      ///< n
  Eigen::VectorXd mu;     ///< a number for each of LcpProblem::friction_rows()
  Eigen::MatrixXd left;   ///< n x 1, or n x 2: dL/dA_ij = (left right^T)_ij, each entry by itself
  Eigen::MatrixXd right;  ///< see left

  /// The derivative in the entries of A, n x n; where A stays symmetric, its symmetric part says the same.
  Eigen::MatrixXd A() const { return left * right.transpose(); }
  /// The derivative in the entries of J, n x pN, also in those that are 0.
  Eigen::MatrixXd J(const LcpProblem& problem) const;
  /// pN.  O(nnz J)
  Eigen::VectorXd InverseMass(const LcpProblem& problem) const;
};

/// What counts as zero; all are in (0, 1).
struct DerivativeOptions {
  double tolerance = 1e-6;  ///< tier that f must pass (verify.h)
  /// Scaled forces D^1/2 f, their distances from bounds, and scaled gaps D^-1/2 w up to this part of the largest scaled
  /// force of the island (of its largest gap where no force acts) are 0.
  double degeneracy_tolerance = 1e-8;
  /// Equations whose scaled matrix has a condition above the reciprocal depend on each other.
  double rank_tolerance = 1e-10;
};

/// Derivatives of a solution f, w in A (or J and M^-1), b and mu.
///
/// With r = dA f + db, the rows E with w = 0, unknown forces y, and friction that slips, f_t = -s mu f_n, df = B y + c
/// with c_t = -s f_n dmu:
///     (A_E B) dy = -(r + A c)_E,   dw = A df + r,   dA = dJ M^-1 J^T + J dM^-1 J^T + J M^-1 dJ^T;
/// Vjp is the transpose. f and w alone decide what a row does. [docs/solvers/derivative.md]
///
/// *Degenerate* rows are at a corner of their law: f_i = w_i = 0 of a contact, f at a bound without slip. There, df and
/// dw are one-sided: they solve a problem of the same kinds of rows, in which rows that are not degenerate are
/// equations; `auto` solves it. [Facchinei, Pang 2003, sec. 5.4] Vjp is then the transpose of the derivative where all
/// degenerate rows stay at their bounds (contacts open, friction slips): an element of the B-subdifferential.
///
/// *Forces that are not unique* are replaced by those of least norm (least_norm.h) where the problem is plain and PSD.
/// Their derivative exists along directions that keep closed rows consistent, as changes of velocities, forces and
/// positions of bodies do; along changes of b and M^-1 that do not, f jumps, and dw exists. On other problems the
/// derivative is that of the nearest forces in the modes of f: the least |dy|_2.
///
/// Cost: an LU factor of A_E B, dense up to ModeFactor::kMostDense unknowns, above sparse, and two triangular solves a
/// product. Jvp at degenerate points: a solve and a factor. Forces that are not unique: O(n^3), n^2 numbers.
/// Copies share; several threads may call. For uses see [Amos, Kolter 2017; de Avila Belbute-Peres et al. 2018; Werling
/// et al. 2021].
class Derivative {
 public:
  /// Whose derivative it is.
  enum class Forces {
    kUnique,     ///< of the only f; of problems that are not plain: of the only one in its modes
    kLeastNorm,  ///< of the f of least norm: closed rows, or rows that may close, depend on each other
    kNearest,    ///< of the nearest f in its modes: their equations depend on each other
  };

  /// @param f  n forces that solve the problem
  /// @throws InputError for options out of range, f of another size, or forces that do not pass options.tolerance
  Derivative(const LcpProblem& problem, const Eigen::VectorXd& f, const DerivativeOptions& options = {});

  bool strictly_complementary() const;          ///< no row is degenerate
  Forces forces() const;                        ///< see Forces
  const std::vector<char>& degenerate() const;  ///< n; 1: the row is
  const Eigen::VectorXd& f() const;             ///< n: the given forces after one more solve, or those of least norm
  const Eigen::VectorXd& w() const;             ///< n: A f + b

  /// df and dw along a direction.
  /// @throws InputError for a change of another size or form, or of mu = 0 to less
  SolutionChange Jvp(const ProblemChange& change) const;
  /// The gradient of a number L from its gradients in f and w.
  /// @param f_bar, w_bar  n; empty: 0. @throws InputError for other sizes
  ProblemGradient Vjp(const Eigen::VectorXd& f_bar, const Eigen::VectorXd& w_bar) const;

 private:
  struct Point;
  std::shared_ptr<const Point> point_;
};

}  // namespace lcpbench
