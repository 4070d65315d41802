#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lcpbench {

/// Row-major, so that row i of A or J is contiguous: Gauss-Seidel and verification walk rows.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
/// Rows, columns and sizes: signed, as Eigen's.
using Index = Eigen::Index;

/// The form in which a problem was given; the other forms are derived from it, with rounding.
enum class MatrixForm { kDense, kSparse, kFactors };

/// The law of a row (docs/friction.md section 1).
enum class RowKind : unsigned char { kUnilateral, kBilateral, kFriction, kBounded };

/// A tangent row of a contact with Coulomb friction: |f| <= mu f_normal; w > 0 needs f = -mu f_normal, w < 0 needs
/// f = mu f_normal. With slip = s, which is +-1, the contact slides in a known direction (acceleration level only): f =
/// -s mu f_normal, and w is free.
struct FrictionRow {
  Index row = 0;         ///< of the tangent
  Index normal = 0;      ///< the contact's unilateral row
  double mu = 0;         ///< coefficient of friction, finite, >= 0; changes with the scales of the two rows
  signed char slip = 0;  ///< 0: a friction row; +-1: a sliding row
  bool operator==(const FrictionRow&) const = default;  ///< exact
};

/// lower <= f <= upper; w > 0 needs f = lower, w < 0 needs f = upper.
struct BoundedRow {
  Index row = 0;                                       ///< which
  double lower = 0;                                    ///< may be -infinity
  double upper = 0;                                    ///< >= lower, may be +infinity
  bool operator==(const BoundedRow&) const = default;  ///< exact
};

/// What f may be: [0, inf) on a unilateral row (contact), any number on a bilateral one (joint), and the laws above on
/// friction and bounded rows. By default every row is unilateral.
struct RowBounds {
  std::vector<unsigned char> bilateral = {};  ///< n; 1: the row is bilateral. Empty: none is
  std::vector<FrictionRow> friction = {};     ///< friction and sliding rows, in any order; ascending in LcpProblem
  std::vector<BoundedRow> bounded = {};       ///< in any order; ascending in LcpProblem

  /// Unilateral and bilateral rows only.
  bool is_plain() const { return friction.empty() && bounded.empty(); }

  /// n rows, bilateral where listed and unilateral elsewhere.
  /// @throws InputError if an index is outside [0, n) or listed twice
  static RowBounds WithBilateralRows(Index n, const std::vector<Index>& bilateral);
};

/// What is *proved* about A, and how J is laid out. False or empty means "not known", never "known to be false".
struct MatrixFacts {
  bool symmetric = false;              ///< A = A^T
  bool positive_semidefinite = false;  ///< f.A f >= 0 for every f
  std::optional<Index> rank;           ///< of A
  std::optional<bool> f_unique;        ///< whether at most one f solves the problem
  /// Columns of J per body: 3 (bodies in the plane) or 6 (in space, in principal axes). Columns p k to p k + p - 1 are
  /// those of body k.
  int columns_per_body = 3;
};

/// What ProblemArrays says, read where it is kept: in a caller's arrays, or in an LcpProblem (LcpProblem::view). Valid
/// as long as these are.
struct ProblemView {
  std::string_view id;                       ///< of ProblemArrays, as all that follows
  MatrixForm form = MatrixForm::kFactors;    ///< which of the arrays below are used
  Index rows = 0;                            ///< n
  Index columns = 0;                         ///< of J
  std::span<const int> row_start;            ///< of kSparse and kFactors
  std::span<const int> column;               ///< of these, too
  std::span<const double> value;             ///< of A or J
  std::span<const double> inverse_mass;      ///< of kFactors
  std::span<const double> b;                 ///< n
  std::span<const unsigned char> bilateral;  ///< n, or none
  std::span<const FrictionRow> friction;     ///< of an LcpProblem by ascending row
  std::span<const BoundedRow> bounded;       ///< of an LcpProblem by ascending row
  MatrixFacts facts;                         ///< what is proved about A
  bool is_checked = false;                   ///< an LcpProblem's: all fits, and numbers are finite
  std::span<const std::int32_t> body = {};   ///< an LcpProblem's: what FindTwoBodies found, else none
};

/// A problem as a caller's arrays hold it: what an engine has in memory before any solver is asked, and where the time
/// that a user pays begins (fresh_pass.h). Nothing here has been checked; LcpProblem::FromArrays does that.
///
/// By form: kDense has `value` with n n numbers of A, row after row; kSparse the compressed rows of A, both triangles;
/// kFactors those of J and the inverse masses, A = J M^-1 J^T. Compressed rows: row_start has n + 1 numbers, `column`
/// and `value` row_start[n], columns ascending within a row.
struct ProblemArrays {
  /// A name for files and error texts.
  std::string id;
  /// Which of the arrays below are used.
  MatrixForm form = MatrixForm::kFactors;
  Index rows = 0;     ///< n
  Index columns = 0;  ///< of J; n in the other forms
  /// n + 1 numbers.
  std::vector<int> row_start;
  /// Ascending within a row.
  std::vector<int> column;
  /// Entries of J, or of A.
  std::vector<double> value;
  std::vector<double> inverse_mass;      ///< of kFactors, a number per column of J, >= 0
  std::vector<double> b;                 ///< n
  std::vector<unsigned char> bilateral;  ///< n; 1: w = 0 and f free (a joint). Empty: no row is
  std::vector<FrictionRow> friction;     ///< as RowBounds
  std::vector<BoundedRow> bounded;       ///< as RowBounds
  MatrixFacts facts;                     ///< what the caller has proved about A

  /// The arrays of a problem's given form.
  static ProblemArrays Of(const class LcpProblem& problem);
  /// What a caller holds is taken wherever a view is. NOLINTNEXTLINE(google-explicit-constructor)
  operator ProblemView() const {
    return {id, form, rows, columns, row_start, column, value, inverse_mass, b, bilateral, friction, bounded, facts};
  }
};

/// Find f and w with
///     w = A f + b,   unilateral rows: f >= 0, w >= 0, f w = 0;   bilateral rows: w = 0, f free;
/// friction, sliding and bounded rows as FrictionRow and BoundedRow say. A problem without these is *plain*.
/// [Baraff 1994, sec. 4; Cottle, Pang, Stone, The Linear Complementarity Problem]
///
/// As frictionless contact: f are normal forces [N], w gap accelerations [m/s^2], A = J M^-1 J^T [1/kg] the Delassus
/// matrix and b the gap accelerations at zero force. An edge's curvature enters b (its normal turns), never A.
///
/// Three given forms: A dense (n x n), A sparse (n x n), or factors J (n x pN, row order as assembled; p = 3 columns a
/// body in the plane, 6 in space) with the inverse mass diagonal (pN, >= 0) and A = J M^-1 J^T. The given form *is* the
/// problem: verification uses it. It is kept as arrays, in one piece of memory (view()); Eigen's forms of it are made
/// on the first request and kept. So are DenseA() and SparseA(), which are its roundings (so that their cost can be
/// measured apart from a solve), bitwise symmetric where the problem is given by factors.
///
/// Immutable; copies share storage; safe to read from several threads. n = 0 is valid.
/// All constructors throw InputError, naming the argument, on a shape that does not fit, NaN or infinity, a negative
/// inverse mass, a row whose A_ii = J_i M^-1 J_i^T is beyond the range of doubles, a row outside [0, n) or of two
/// kinds, a friction row whose normal row is not unilateral or whose mu is negative or not finite, or bounds without a
/// number between them.
class LcpProblem {
 public:
  /// @param id  a name for files and error texts
  /// @param A   n x n; symmetry is not assumed
  static LcpProblem FromDense(std::string id, Eigen::MatrixXd A, Eigen::VectorXd b, RowBounds bounds = {},
                              MatrixFacts facts = {});
  /// @param A  n x n, both triangles stored
  static LcpProblem FromSparse(std::string id, SparseMatrix A, Eigen::VectorXd b, RowBounds bounds = {},
                               MatrixFacts facts = {});
  /// Symmetry and positive semidefiniteness follow from the form and are set in facts().
  static LcpProblem FromFactors(std::string id, SparseMatrix J, Eigen::VectorXd inverse_mass, Eigen::VectorXd b,
                                RowBounds bounds = {}, MatrixFacts facts = {});
  /// From a caller's arrays, which are checked and copied: what a fresh time begins with.
  static LcpProblem FromArrays(const ProblemView& arrays);

  /// The same matrix and bounds with another b: whatever has been derived of A is shared with this problem.
  /// @param b  n, finite
  LcpProblem WithB(Eigen::VectorXd b) const;
  /// The same matrix and b with other kinds of rows; the given form is copied.
  LcpProblem WithBounds(RowBounds bounds) const;
  /// The problem of sums of rows, P A P^T, in the same form: P J from factors. Rank and uniqueness are not known of it.
  /// @param P, b, bounds  m x n; m numbers, and kinds of m rows
  LcpProblem WithRows(const SparseMatrix& P, Eigen::VectorXd b, RowBounds bounds) const;
  /// True for problems with the same matrix and bounds in one storage: copies, and those that WithB made.
  bool SharesMatrixWith(const LcpProblem& other) const { return matrix_ == other.matrix_; }

  /// The name it was given.
  const std::string& id() const;
  /// The number of rows n.
  Index size() const;
  /// The form that verification uses.
  MatrixForm given_form() const;
  /// Given as J and inverse masses.
  bool has_factors() const { return given_form() == MatrixForm::kFactors; }
  /// What is proved about A.
  const MatrixFacts& facts() const;

  /// The given form, in place: nothing is made.
  ProblemView view() const;
  /// n numbers.
  const Eigen::VectorXd& b() const;
  /// b in place.
  std::span<const double> loads() const;
  /// n x pN; std::logic_error unless has_factors().
  const SparseMatrix& J() const;
  /// pN; std::logic_error unless has_factors().
  const Eigen::VectorXd& inverse_mass() const;
  /// p, see MatrixFacts.
  int columns_per_body() const { return facts().columns_per_body; }
  /// True if every row of J has its nonzeros in at most two bodies' columns with inverse mass > 0 somewhere in them:
  /// the two-body fast path. False without factors.
  bool has_two_body_rows() const;

  /// n x n. From factors: O(sum over columns of (column count)^2) plus n^2 to fill; from sparse: n^2.
  /// @throws MemoryRefusal where n^2 numbers are more than there is memory
  const Eigen::MatrixXd& DenseA() const;
  /// n x n with both triangles, column indices sorted, the diagonal always stored (so also where it is zero).
  /// From factors: O(sum over columns of (column count)^2); columns of zero inverse mass do not count.
  const SparseMatrix& SparseA() const;
  /// diag A, from the given form; O(nnz).
  const Eigen::VectorXd& DiagonalA() const;
  /// max |A_ij - A_ji| / sqrt(|A_ii A_jj|) (denominator 1 where it is 0); 0 from factors. Measured once.
  double Asymmetry() const;
  /// Asymmetry() <= 1e-10: symmetric but for rounding. Solvers for symmetric A then read either triangle.
  bool IsNumericallySymmetric() const { return Asymmetry() <= kSymmetryTolerance; }
  static constexpr double kSymmetryTolerance = 1e-10;  ///< of Asymmetry()

  /// w = A f + b by the given form, in double.  O(nnz of the form).
  void ComputeW(const Eigen::VectorXd& f, Eigen::VectorXd* w) const;

  /// For another problem with the same kinds of rows.
  const RowBounds& bounds() const;
  /// Whether products of two or three numbers of A, J and the inverse masses, which solvers make, may leave the range
  /// of doubles: above 2^64 in J and the inverse masses, an A_ii (not 0) beyond 2^+-192, above 2^192 in A.
  bool has_extreme_matrix() const;
  /// The same of b: above 2^128, or below 2^-300 but not 0.
  bool has_extreme_b() const { return has_extreme_b_; }

  /// f free, w = 0: a joint.
  bool is_bilateral(Index row) const;
  /// Ascending.
  const std::vector<Index>& bilateral_rows() const;
  /// The law of a row; O(1) where the problem is plain, else O(log n). Sliding rows are of kind kFriction.
  RowKind kind(Index row) const;
  /// By ascending row.
  const std::vector<FrictionRow>& friction_rows() const;
  /// By ascending row.
  const std::vector<BoundedRow>& bounded_rows() const;
  /// Without friction, sliding and bounded rows: the problem that all solvers take.
  bool is_plain() const;

  /// The same given problem without its derived forms, so that forming them can be timed again.
  LcpProblem CopyOfGivenForm() const;

 private:
  struct Derived;
  struct Matrix;

  explicit LcpProblem(std::shared_ptr<const Matrix> matrix, bool has_extreme_b)
      : matrix_(std::move(matrix)), has_extreme_b_(has_extreme_b) {}
  /// @param given  whose shapes fit
  /// @param has_checked_columns  no compressed rows, or such as Eigen makes
  static LcpProblem Make(const ProblemView& given, bool has_checked_columns = true);

  std::shared_ptr<const Matrix> matrix_;
  std::shared_ptr<const Eigen::VectorXd> b_;  // of WithB; nullptr: that of the arrays
  bool has_extreme_b_ = false;
};

/// The same problem, given by its dense or its sparse A.
LcpProblem InForm(const LcpProblem& problem, MatrixForm form);

/// With (A + A^T) / 2, symmetric bit for bit; a problem by factors as it is.
/// @param facts  what is proved about that matrix, besides that it is symmetric
LcpProblem Symmetrized(const LcpProblem& problem, MatrixFacts facts = {});

/// Writes A into n rows of `stride` >= n numbers each, padding zero, row after row. From factors no form of A is made:
/// this is the one dense assembly that own solvers and peers pay for: entry (i, j) sums m_k (J_ik J_jk) over ascending
/// k, so that A is bitwise symmetric and equal to that of LcpProblem::SparseA. O(n stride + sum over columns of (column
/// count)^2).
/// @param arrays  checked already (LcpProblem::FromArrays does)
void AssembleDenseA(const ProblemView& arrays, double* A, Index stride);
/// The same.
inline void AssembleDenseA(const LcpProblem& problem, double* A, Index stride) {
  AssembleDenseA(problem.view(), A, stride);
}

/// An upper bound on the entries of A = J M^-1 J^T, and the cost of forming it: the sum over bodies of (rows on the
/// body)^2. Rows on the same two bodies count twice. O(nnz J).
Index BoundEntriesOfA(const LcpProblem& problem);

/// What is known of the answer from outside (exact arithmetic, say). Kept apart from the problem, so that no solver can
/// read it. w is unique for PSD A even when f is not, but not where there is friction.
struct LcpReference {
  /// Whether there is a solution.
  enum class Status { kUnknown, kSolved, kInfeasible };
  Status status = Status::kUnknown;  ///< of the problem, not of a solve
  std::optional<Eigen::VectorXd> w;  ///< n, of every solution; only where w is unique
  /// Only where f is unique.
  std::optional<Eigen::VectorXd> f;
  /// The problem's rounding floor (verify.h): that of an answer known from elsewhere than the judged solver.
  /// Verdicts are then relative to max(tier, floor), see PassesTier; what is not a finite number >= 0 counts as
  /// unknown.
  std::optional<double> floor = std::nullopt;
  /// A solution is known to exist (docs/friction.md section 2, fact 1), though none may be known.
  bool solvable = false;
};

}  // namespace lcpbench
