#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_input.h"
#include "solvers/exact/polyhedron.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A mode string has a character a row [docs/friction.md section 1]: `O` open, `C` closed (unilateral); `o` normal row
/// open, `S` stick, `+` slip with w >= 0, `-` slip with w <= 0, `k` sliding (friction); `S` w = 0, `+` at lower, `-` at
/// upper (bounded); `B` bilateral. In each mode all laws are linear: its solutions are a polyhedron, and those of the
/// problem the union over all modes.

/// A polyhedron of solutions f, of one mode string.
struct ModePiece {
  std::string modes;
  Index dimension = 0;
  Polyhedron f;
};

/// An answer, exact in every number, and what is known besides.
struct ExactAnswer {
  enum class Status {
    kSolved,
    kInfeasible,
    kNotSemidefinite,  ///< A is not PSD: no guarantee
    kTimeLimit,
    kUnknown,
  };
  Status status = Status::kUnknown;
  RationalVector f, w;  ///< a solution; of SolveExactly with independent active rows
  std::optional<bool> f_unique, w_unique;
  /// The ray of an infeasible problem: y >= 0 on unilateral rows, free on bilateral ones, 0 on friction rows, on
  /// bounded rows of the signs whose bound is infinite; A^T y = 0, b.y = -1 [Farkas]. Empty: infeasible by modes only.
  RationalVector ray;
  std::int64_t steps = 0;  ///< exact solves with a basis; by modes, those that were tried, or steps of the path
  std::string detail;      ///< what is not known, and why

  // By Certify.
  bool certified = false;  ///< f and its modes, or the lack of any, are proved
  std::string fault;       ///< FindFault

  // By SolveExactly.
  /// The solution of least Euclidean norm; empty where `detail` says why.
  RationalVector f_least_norm;
  /// l with f_least_norm - A l >= 0 on unilateral rows with w = 0, = 0 there where f > 0 and on bilateral rows; l = 0
  /// where w > 0: the proof of least norm (its Lagrange multipliers).
  RationalVector multipliers;
  Index nullity_on_active = 0;    ///< of A on the rows with w = 0
  std::vector<Index> degenerate;  ///< unilateral rows with w = 0 and least-norm f = 0
  std::optional<Index> rank;      ///< of A
  /// Ranks and nullities are proved; else each is right but with a probability below 2^-50 (two random primes).
  bool rank_is_proved = false;

  // By SolveByModes.
  std::string modes;  ///< of f
  /// All modes were tried: `pieces` are known, and no solution means that there is none. By Certify also `certified`.
  bool complete = false;
  std::vector<ModePiece> pieces;  ///< all solutions; no piece is contained in another
  Index components = 0;           ///< connected components of their union

  bool is_solved() const { return status == Status::kSolved; }
};
const char* ToString(ExactAnswer::Status status);

/// What is known in doubles: forces, or a ray of an infeasible problem; either may be empty.
struct ExactGuess {
  Eigen::VectorXd f;
  Eigen::VectorXd ray;
};

struct ExactOptions {
  double time_limit_s = 3600;    ///< looked at between exact solves, and between modes
  double (*now)() = &SteadyNow;  ///< the clock of the time limit

  // Of SolveExactly.
  /// Ranks are proved up to this many rows; uniqueness of f, where it takes a program of its own, likewise.
  Index most_rows_of_proofs = 120;
  /// Only what a solver is asked for: status, w and f, or the ray. Ranks, the least-norm f, degenerate rows and
  /// uniqueness are left at their defaults; the answer is as exact as ever.
  bool answer_only = false;
  /// A solution in doubles of a problem, by any solver: where the exact method starts. Its answer is not
  /// trusted. Without one the start is f = 0.
  std::function<ExactGuess(const LcpProblem& problem)> guess = {};

  // Of SolveByModes.
  /// All modes are tried where there are no more: those of 6 contacts with one tangent row each; 65536 are those of 8.
  std::int64_t most_modes = 4096;
  /// Called above most_modes: modes that are tried first, in turn; not trusted.
  std::function<std::vector<std::string>()> guessed_modes = {};
  bool follows_path = true;  ///< where no guess is right; seconds to hours
};

/// Solves a plain problem with symmetric positive semidefinite A, by exact pivots from the active set of the guess, or
/// from one that Lemke's method finds in 60 digits where that is not right almost at once (redundant rows): blocks of
/// all violated rows while their number falls, then the criss-cross method with least indices, which ends from any
/// basis for sufficient matrices, PSD ones among them [den Hertog, Roos, Terlaky, The linear complementarity problem,
/// sufficient matrices, and the criss-cross method, Linear Algebra Appl. 187, 1993]. Systems are solved by p-adic
/// lifting [Dixon 1982, by FLINT]: O(n^3) word operations and O(n^2) of the length of the answer, some hundred bits a
/// row.
ExactAnswer SolveExactly(const ExactLcp& problem, const ExactOptions& options);

/// Checks an answer in exact arithmetic from the definitions alone: equations, the laws of its modes, the conditions of
/// a plain problem's ray, and of the least-norm f that it solves. Empty where the answer is right, else what is wrong.
std::string FindFault(const ExactLcp& problem, const ExactAnswer& answer);

/// What is wrong with f as a solution in these modes, and with its gaps if any are claimed; "" where it is one.
std::string FindFaultOfModes(const ExactLcp& problem, const std::string& modes, const RationalVector& f,
                             const RationalVector* claimed_w = nullptr);

/// The modes of forces in doubles, by the sides of D^1/2 f - D^-1/2 w [Alart, Curnier 1991].
std::string ModesOf(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
