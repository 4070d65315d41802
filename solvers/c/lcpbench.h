#ifndef LCPBENCH_H_
#define LCPBENCH_H_

/// @file
/// LCPBench's solvers and its verifier for C and for every language that calls C (Python's ctypes, Julia's ccall).
/// Find f and w with
///     w = A f + b,   unilateral rows: f >= 0, w >= 0, f w = 0;   bilateral rows: w = 0, f free;
/// and rows with friction or bounds (lcpbench_friction_row, lcpbench_bounded_row).
/// As frictionless contact: f are normal forces [N], w gap accelerations [m/s^2], positive where bodies separate,
/// A = J M^-1 J^T [1/kg] and b the gap accelerations at zero force [m/s^2]: the sign of b is that of w.
///
/// Use: `#include <lcpbench.h>`, link with `-llcpbench` (`pkg-config lcpbench`), or in CMake with lcpbench::c. The
/// header is C99, docs/embedding.md of the sources has an example. Rows, columns and indices count from 0.
///
/// Errors. A call that can fail returns lcpbench_error. LCPBENCH_OK is 0; anything else is a mistake of the caller or a
/// lack of memory, lcpbench_last_error() says in one line what is wrong and names the argument, and nothing was
/// written to outputs. A problem that is hard or has no solution is a lcpbench_status, not an error. No C++
/// exception leaves the library.
///
/// Pointers are not NULL, unless it is said that they may be. What a `create` function hands out belongs to the caller,
/// who gives it to the `free` function of its type, which takes NULL too. Arrays and strings that are passed in are
/// copied, or read only, before the call returns. Pointers that are handed out say how long they live.
///
/// Threads. Problems are immutable and may be used by several threads at once. A solver or a step solver serves one
/// thread at a time; distinct ones are independent. All other functions may be called from any thread at any time, but
/// for lcpbench_limit_library_threads.
///
/// Structs. They begin with their size, which the caller sets, also where the library writes the rest:
/// `lcpbench_answer answer = {.size = sizeof answer};`. A member that is 0 or NULL stands for its default, or for
/// "none". Structs may get more members at their ends, values of enumerations and functions may be added: a larger
/// struct of a later version is taken if the members that this version does not know are 0.

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define LCPBENCH_API __attribute__((visibility("default")))
#else
#define LCPBENCH_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// How a call went. Enumerations are int32_t, so that they have one size in every language.
typedef int32_t lcpbench_error;
/// Values of lcpbench_error.
enum {
  LCPBENCH_OK = 0,
  LCPBENCH_INVALID_ARGUMENT = 1,  ///< an argument is NULL, NaN, out of range, unknown, or does not fit the others
  LCPBENCH_OUT_OF_MEMORY = 2,     ///< what was asked for needs more memory than there is
  LCPBENCH_INTERNAL_ERROR = 3     ///< a fault of this library; please report the message
};

/// How a solve ended, in the solver's own words: a claim that lcpbench_verify judges.
typedef int32_t lcpbench_status;
/// Values of lcpbench_status.
enum {
  LCPBENCH_NOT_RUN = 0,  ///< no solve, no claim
  LCPBENCH_SOLVED = 1,   ///< the solver believes that f meets the requested tolerance
  /// No f exists: the solver found a Farkas ray, which is a proof for the numbers as given, or one within rounding
  /// only. Then a problem whose numbers differ in their last digits has no solution, and one of this problem, if there
  /// is any, has huge forces. lcpbench_verdict tells which, and lcpbench_answer of a step.
  LCPBENCH_INFEASIBLE = 2,
  LCPBENCH_ITERATION_LIMIT = 3,    ///< stopped by max_iterations or the solver's own default limit
  LCPBENCH_TIME_LIMIT = 4,         ///< stopped by time_limit_s
  LCPBENCH_NUMERICAL_FAILURE = 5,  ///< breakdown, stagnation above the tolerance, or cycling; detail says which
  LCPBENCH_UNSUPPORTED = 6         ///< the problem is outside what the solver takes; detail says why
};

/// In which form a problem is given; it has no default.
typedef int32_t lcpbench_form;
/// Values of lcpbench_form.
enum {
  LCPBENCH_DENSE = 1,   ///< A with all its numbers
  LCPBENCH_SPARSE = 2,  ///< A compressed, both triangles stored
  /// A = J M^-1 J^T, which is symmetric positive semidefinite, by a compressed J and the inverse masses. The better
  /// form for rigid bodies: many solvers never form A. Rows of J whose entries lie in the columns of at most two bodies
  /// are the fastest, other J are welcome.
  LCPBENCH_FACTORS = 3,
  /// The same A from the arrays of an engine: rows of J that act on two bodies at most. The form of a step.
  LCPBENCH_TWO_BODIES = 4
};

/// Values of the array `kinds`, one byte a row.
enum {
  LCPBENCH_UNILATERAL = 0,  ///< f >= 0, w >= 0, f w = 0: a contact
  LCPBENCH_BILATERAL = 1    ///< w = 0, f free: a joint
};

/// A tangent row of a contact with Coulomb friction: |f| <= mu f_normal; w > 0 needs f = -mu f_normal, w < 0 needs
/// f = mu f_normal. f acts along the tangent on the row's first body, w is the slip.
typedef struct lcpbench_friction_row {
  int64_t row;     ///< in [0, n), unilateral by `kinds` and listed once
  int64_t normal;  ///< the contact's unilateral row
  double mu;       ///< coefficient of friction, finite, >= 0
  int64_t slip;    ///< 0; +1 or -1: the contact slides that way, f = -slip mu f_normal and w is free
} lcpbench_friction_row;

/// lower <= f <= upper; w > 0 needs f = lower, w < 0 needs f = upper.
typedef struct lcpbench_bounded_row {
  int64_t row;   ///< in [0, n), unilateral by `kinds` and listed once
  double lower;  ///< may be -infinity
  double upper;  ///< >= lower, may be infinity
} lcpbench_bounded_row;

/// A problem as the caller's arrays hold it. Numbers of arrays are finite. Members that the form does not name are not
/// read; arrays of no numbers may be NULL, and n = 0 is a valid problem.
typedef struct lcpbench_problem_data {
  size_t size;         ///< sizeof(lcpbench_problem_data)
  lcpbench_form form;  ///< of A
  /// Dense, 0: A_ij at values[i + j n], 1: at values[i n + j]. Sparse, factors, 0: A or J compressed by columns (CSC),
  /// 1: by rows (CSR): starts[k] .. starts[k + 1] - 1 are the places of column (or row) k in `indices` (the row, or
  /// column, of each entry) and `values`; the order within a column (or row) is free.
  int32_t by_rows;
  int64_t rows;     ///< n, 0 <= n < 2^31
  int64_t columns;  ///< factors: of J (degrees of freedom), 0 <= columns < 2^31
  int64_t bodies;   ///< two bodies: of which inverse_mass tells, 0 <= bodies < 2^31
  /// Factors, two bodies: p = 3 (0 stands for it), in the plane: body k has the columns 3k, 3k + 1 (its translation)
  /// and 3k + 2 (its rotation); 6, in space: 6k to 6k + 2 (its translations) and 6k + 3 to 6k + 5 (its rotations about
  /// its principal axes, so that M^-1 is diagonal).
  int32_t columns_per_body;
  /// Dense, sparse, 1: A = A^T is known; 0: it is not. An A that is said to be symmetric and is not is refused.
  int32_t symmetric;
  int32_t positive_semidefinite;  ///< dense, sparse, 1: f.A f >= 0 for every f is known; 0: it is not
  /// Dense: the n n numbers of A, symmetric or not; compressed: `entries` numbers; two bodies: 2 p n numbers, of each
  /// row of J the p of its first body, then those of its second.
  const double* values;
  const float* values_single;  ///< two bodies: the same in single precision, in place of `values`; summed in double
  const int32_t* body;  ///< two bodies: 2 n numbers in [-1, bodies), the bodies of each row; -1: none (the ground)
  int64_t problems;     ///< two bodies: where `starts` is not NULL, of how many problems these are the rows, >= 0
  int64_t entries;      ///< compressed: stored entries, 0 <= entries < 2^31
  /// Compressed: a number a column (or row) and one more, not falling, from 0 to `entries`. Two bodies: NULL, or a
  /// number a problem and one more, not falling, from 0 to n: problem k has the rows starts[k] .. starts[k + 1] - 1.
  const int32_t* starts;
  const int32_t* indices;  ///< compressed: `entries` rows (or columns), none twice in one column (or row)
  /// Factors, two bodies: a number >= 0 a column of J, the diagonal of M^-1: 1/kg for translations, 1/(kg m^2) for
  /// rotations; 0 for what cannot move.
  const double* inverse_mass;
  const double* b;       ///< n numbers; from factors J M^-1 (external forces) plus the velocity-product terms
  const uint8_t* kinds;  ///< n bytes, LCPBENCH_UNILATERAL or LCPBENCH_BILATERAL; NULL: every row is unilateral
  /// `friction_count` structs. Solvers that do not take a kind of row answer LCPBENCH_UNSUPPORTED.
  const lcpbench_friction_row* friction;
  int64_t friction_count;               ///< >= 0
  const lcpbench_bounded_row* bounded;  ///< `bounded_count` structs
  int64_t bounded_count;                ///< >= 0
} lcpbench_problem_data;

/// An LCP. Immutable, so that all solvers may share it. It is what was given, bit for bit: the verifier judges by the
/// numbers passed in, not by a form that was derived from them.
typedef struct lcpbench_problem lcpbench_problem;

/// A solver with its settings and its workspace, which is kept from solve to solve.
typedef struct lcpbench_solver lcpbench_solver;

/// The version of the library, "0.2.0". Lives as long as the library.
LCPBENCH_API const char* lcpbench_version(void);

/// One line on the last call that failed in this thread: function, argument, what was found and what was expected; ""
/// where none has. Valid until the next call that fails in this thread.
LCPBENCH_API const char* lcpbench_last_error(void);

/// The key of a status as files have it: "solved", "iteration_limit", ... Lives as long as the library.
/// @param status  any value; "unknown" for one that is not an enumerator
LCPBENCH_API const char* lcpbench_status_key(lcpbench_status status);

/// Checks and copies a problem.  O(numbers in `data`)
/// @param data     the problem
/// @param problem  the new problem, to be freed by lcpbench_problem_free
LCPBENCH_API lcpbench_error lcpbench_problem_create(const lcpbench_problem_data* data, lcpbench_problem** problem);

/// Frees a problem. Solvers and answers that have met it stay valid.
LCPBENCH_API void lcpbench_problem_free(lcpbench_problem* problem);

/// One row of the table of solvers. Strings live as long as the library.
typedef struct lcpbench_solver_info {
  size_t size;             ///< sizeof(lcpbench_solver_info)
  const char* key;         ///< what lcpbench_solver_create takes: "auto", "dantzig", "pgs", ...
  const char* method;      ///< one line
  const char* source;      ///< paper or library
  const char* licence;     ///< SPDX expression: of our code, or of the peer's library
  int32_t available;       ///< 0: not in this build, lcpbench_solver_create refuses it
  int32_t uses_tolerance;  ///< 0: a direct method, which ends at the same answer whatever the tolerance
  int32_t is_peer;         ///< 1: another project's solver, which runs in a worker process of its own
} lcpbench_solver_info;

/// How many solvers there are, those that are not in this build included.
LCPBENCH_API size_t lcpbench_solver_count(void);

/// A row of the table of solvers, own ones first.
/// @param index  in [0, lcpbench_solver_count())
/// @param info   the row, written but for its size
LCPBENCH_API lcpbench_error lcpbench_solver_describe(size_t index, lcpbench_solver_info* info);

/// A solver by its key, with the default settings but for those given.
/// @param key       "auto" chooses a method by the problem
/// @param settings  options of the method, none twice: "relaxation=1.3 form=assembled", as `lcpbench solve --set` takes
///                  them, with numbers in C notation whatever the locale. The solver's C++ header describes them
///                  (solvers/first_order/pgs.h, say). NULL: none
/// @param solver    the new solver, to be freed by lcpbench_solver_free
/// LCPBENCH_INVALID_ARGUMENT for a key that is unknown or not in this build, and for settings that the method does not
/// have or allow.
LCPBENCH_API lcpbench_error lcpbench_solver_create(const char* key, const char* settings, lcpbench_solver** solver);

/// What depends on the structure of the problem only (forms of A that the method reads, workspace, symbolic analysis),
/// so that it is no part of the solve. lcpbench_solve does it where the caller did not. A second call with the same
/// problem costs nothing. LCPBENCH_OUT_OF_MEMORY where a method would need more memory than there is; a problem that
/// the solver does not take is left to lcpbench_solve, whose status says so.
LCPBENCH_API lcpbench_error lcpbench_solver_prepare(lcpbench_solver* solver, const lcpbench_problem* problem);

/// Frees a solver, and ends its worker process where it has one.
LCPBENCH_API void lcpbench_solver_free(lcpbench_solver* solver);

/// What every solver understands.
typedef struct lcpbench_solve_options {
  size_t size;              ///< sizeof(lcpbench_solve_options)
  double tolerance;         ///< requested bound on rho (see lcpbench_verdict), in (0, 1); 0: 1e-9
  double time_limit_s;      ///< wall-clock limit [s], > 0; 0: no limit
  int64_t max_iterations;   ///< in the solver's unit (pivots, sweeps, Newton steps); 0: the solver's own limit
  const double* initial_f;  ///< warm start, finite; NULL: a cold start
  int64_t initial_f_size;   ///< entries of initial_f: the problem's n
  /// In (0, 1), 1e-12 where in doubt: a solved answer has the f of least Euclidean norm |f|_2, in the units given,
  /// which is unique where f is not (redundant contacts), and passes the tolerance. Eigenvalues of D^-1/2 A D^-1/2 on
  /// the rows with w = 0 up to this part of the largest count as 0. For symmetric positive semidefinite A of up to 1000
  /// rows, O(n^3). 0: any solution.
  double rank_tolerance;
} lcpbench_solve_options;

/// An answer: a solve writes it but for its size, lcpbench_verify reads it, also one that the caller has filled in.
typedef struct lcpbench_answer {
  size_t size;             ///< sizeof(lcpbench_answer)
  lcpbench_status status;  ///< how the solve ended, as the solver claims
  int32_t relaxed;         ///< 1: the claim is about the model of the solver "relaxation", in which slip separates
  int64_t n;               ///< entries of f and of the ray: the problem's n
  const double* f;         ///< the forces: the best iterate, also where the solver failed; zeros where it had none
  const double* ray;       ///< proof that there is no solution: y >= 0 on unilateral rows, A y = 0, b.y < 0; NULL: none
  int64_t iterations;      ///< pivots, sweeps or Newton steps, as the solver's header defines them
  int64_t nullity;         ///< with rank_tolerance: free directions of f; -1: f is not of least norm, detail says why
  const char* detail;  ///< the reason in words, with an external library's own code; "" where there is nothing to say
  /// Residual of f (see lcpbench_verdict) of a step, as the solver measured it: the largest among groups of rows that
  /// do not act on each other, which that over all rows does not exceed. Infinite where it was not measured, as by
  /// lcpbench_solve, or is beyond double; never NaN.
  double rho;
  /// Where a step is LCPBENCH_INFEASIBLE: any solution has |D^1/2 f|_1 of this or more, D = diag A. Infinite where that
  /// is proved, which infeasible_proved says; else 0.
  double force_min;
  int64_t infeasible_proved;  ///< of a step, 1: LCPBENCH_INFEASIBLE is proved for the numbers as given; else 0
  int64_t fallbacks;          ///< of the step solver since its creation: solves left to solvers that allocate
  /// n: the claim is about the model in which these bound |f| on friction rows, as codes of physics engines that
  /// compute the bounds once have it; NULL: it is not.
  const double* friction_bounds;
} lcpbench_answer;

/// Solves. A solve that fails is LCPBENCH_OK with a status that says so. Nothing carries over from one solve to the
/// next but workspace: repeated solves of one problem with the same options give the same bits.
/// @param options  NULL: the defaults
/// @param answer   left as it was where an argument is refused. Its pointers belong to the solver: valid until its next
///                 solve that is not refused, or until it is freed
LCPBENCH_API lcpbench_error lcpbench_solve(lcpbench_solver* solver, const lcpbench_problem* problem,
                                           const lcpbench_solve_options* options, lcpbench_answer* answer);

/// Limits the threads of the BLAS and OpenMP libraries below the solvers, for the whole process. Call it before other
/// threads solve.
/// @param threads   >= 1
/// @param reported  what BLAS says afterwards, 0 where it cannot tell; may be NULL
LCPBENCH_API lcpbench_error lcpbench_limit_library_threads(int32_t threads, int32_t* reported);

/// From an engine's arrays to forces, for the LCP of one time step: what the solver "auto" does, without a
/// lcpbench_problem. The arrays of a problem of the form LCPBENCH_TWO_BODIES are read in place and must not change
/// during a call. Up to the sizes that its options have, lcpbench_step_solve allocates nothing, but for what
/// lcpbench_answer.fallbacks counts and for refused arguments: with friction rows mostly where an island (rows that
/// share bodies) has more than 128 rows, and always with bounded rows and no friction. Nothing but workspace carries
/// over from one solve to the next: the same rows and start give the same bits.
typedef struct lcpbench_step lcpbench_step;

/// Options of a step solver.
typedef struct lcpbench_step_options {
  size_t size;          ///< sizeof(lcpbench_step_options)
  double tolerance;     ///< requested bound on rho (see lcpbench_verdict), in (0, 1); 0: 1e-9
  double time_limit_s;  ///< wall-clock limit of one solve [s], > 0; 0: no limit
  int64_t threads;      ///< for many problems, in [1, 1024], the caller's among them; 0: 1
  int64_t max_rows;     ///< workspace for so many rows, 0 <= max_rows < 2^31; more are welcome, and allocate once
  int64_t max_bodies;   ///< the same for bodies
} lcpbench_step_options;

/// A step solver with its workspace.
/// @param options  NULL: the defaults
/// @param step     the new step solver, to be freed by lcpbench_step_free
LCPBENCH_API lcpbench_error lcpbench_step_create(const lcpbench_step_options* options, lcpbench_step** step);

/// Solves a step, or many problems where data->starts says which rows are whose. Bodies that can move belong to one
/// problem each, as do a friction row and its normal row. With friction or bounded rows each problem is solved as if
/// alone, in the same bits, side by side in threads. A solve that fails is LCPBENCH_OK with a status that says so.
/// @param data       of the form LCPBENCH_TWO_BODIES. Inverse masses of bodies that no row names are not read
/// @param initial_f  warm start: n numbers, finite, 0 for new rows, in another array than f; NULL: a cold start, which
///                   many problems have
/// @param f          n numbers, written: the forces, the best there are where the status is not LCPBENCH_SOLVED
/// @param w          n numbers, written: A f + b, in double; NULL: not wanted, as of many problems
/// @param answers    one a problem, written, all of the size that the first one has; their f are within `f`
LCPBENCH_API lcpbench_error lcpbench_step_solve(lcpbench_step* step, const lcpbench_problem_data* data,
                                                const double* initial_f, double* f, double* w,
                                                lcpbench_answer* answers);

/// Frees a step solver.
LCPBENCH_API void lcpbench_step_free(lcpbench_step* step);

/// An independent judgement of an answer, the same for every solver. D = diag A, 1 where A_ii = 0; C are the unilateral
/// rows, B the bilateral ones. w is computed anew from the problem as given, in extended precision. An answer passes
/// tier T if and only if f is finite, rho <= T and backward_error <= sqrt(T). All measures are infinite where f is not
/// finite.
typedef struct lcpbench_verdict {
  size_t size;               ///< sizeof(lcpbench_verdict)
  double requested;          ///< the tier asked for
  int32_t passes;            ///< 1: the answer passes that tier
  int32_t false_success;     ///< 1: LCPBENCH_SOLVED was claimed and the answer does not pass
  int32_t false_infeasible;  ///< 1: LCPBENCH_INFEASIBLE was claimed, but f passes and no ray is accepted
  int32_t has_ray;           ///< 1: a Farkas ray was judged
  int32_t ray_accepted;      ///< 1: by the ray there is no solution (symmetric A only), by a proof or within rounding
  int32_t ray_proved;        ///< 1: by a proof: y^T A = 0, from factors J^T y = 0, and b.y < 0 without any rounding
  double best_tier;          ///< the smallest of 1e-9, 1e-6, 1e-3 that passes; 0 where none does
  /// |r|_2 / |D^-1/2 b|_2 with r_i = min(D_ii^1/2 f_i, D_ii^-1/2 w_i) on C, D_ii^-1/2 w_i on B; |r|_2 itself where
  /// b = 0. Independent of units.
  double rho;
  double backward_error;        ///< max |min(A_ii f_i, w_i)| / (|A||f| + |b|)_i on C, |w_i| / (...) on B
  double natural_residual;      ///< max |min(f_i, w_i)| on C, |w_i| on B: mixes units
  double primal_infeasibility;  ///< max over C of max(0, -f_i) [N]
  double dual_infeasibility;    ///< max over C of max(0, -w_i), over B of |w_i| [m/s^2]
  double complementarity;       ///< max over C of |f_i w_i|
  double gap;                   ///< |f.w| over all rows
  double energy_bound;          ///< bound on (f - f*).A (f - f*), f* the answer for a b moved by energy_shift;
                                ///< -1 where A is not known to be symmetric positive semidefinite
  double energy_shift;          ///< |D^-1/2 (moved b - b)|_2; -1 as energy_bound
  double answer_floor;          ///< by how much rounding f to double alone can change rho
  double ray_b_dot_y;           ///< b.y of the ray, 0 without one
  /// Residual of the ray, 0 without one: from factors the largest |J^T y|_k / (|J^T||y|)_k, else |D^-1/2 A y|_inf /
  /// |D^-1/2 |A||y||_inf.
  double ray_null_residual;
  char reason[256];      ///< one line: why the answer does not pass; "" where it does
  char ray_reason[256];  ///< one line: why the ray is not accepted; "" where it is, and without one
  double ray_force_min;  ///< any solution has |D^1/2 f|_1 of this or more; infinite where proved, 0 without a ray
  /// Parts of the error over S, as rho is, of problems with friction or bounded rows; else -1 (docs/friction.md of the
  /// sources, section 4).
  double penetration;
  double adhesion;       ///< see penetration
  double separation;     ///< see penetration: force at a contact that opens
  double cone;           ///< see penetration
  double dissipation;    ///< see penetration: friction that does not oppose slip, or does not use its bound
  double joints;         ///< see penetration
  double beyond_bounds;  ///< see penetration
  double model_rho;      ///< residual of an answer to its own model (relaxed, friction_bounds); -1: Coulomb's law
} lcpbench_verdict;

/// Judges an answer: of a solve, or from anywhere.  O(entries of A), from factors one pass over those of J M^-1 J^T
/// @param problem    the one that was solved
/// @param answer     its f is judged, also where it is not finite, and its ray where it has one; its status is a claim,
///                   which decides over false_success and false_infeasible only
/// @param tolerance  the tier T, in (0, 1)
/// @param verdict    the judgement, written but for its size
/// @param w          n numbers, written: A f + b, NaN where f is not finite; may be NULL
LCPBENCH_API lcpbench_error lcpbench_verify(const lcpbench_problem* problem, const lcpbench_answer* answer,
                                            double tolerance, lcpbench_verdict* verdict, double* w);

#ifdef __cplusplus
}
#endif

#endif /* LCPBENCH_H_ */
