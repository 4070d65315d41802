#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "solvers/exact/exact_lcp.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// What doubles prove of one mode string.
struct ModeEnclosure {
  /// About the exact solution of the equations of the mode, where K_m is proved to be nonsingular.
  enum class Signs {
    kUnknown,
    kViolated,  ///< one of its inequalities does not hold: no solution has these modes
    kStrict,    ///< all of its inequalities are strict: exactly one solution has these modes
  };
  Signs signs = Signs::kUnknown;
  Eigen::VectorXd f;  ///< n: forces of the mode, nearly; empty where K_m is singular to rounding
  /// |D^1/2 (f - f*)|_inf <= error, f* being the exact forces of the mode; infinite where K_m may be singular.
  double error = std::numeric_limits<double>::infinity();
};

/// A problem in doubles, with bounds of what they were rounded by: proofs about its modes that rounding cannot break.
///
/// With S = diag s, powers of two that bring the diagonal of S A S to [1/2, 2), K = K_m of S A S (docs/friction.md
/// section 5) and any R near K^-1: where a = |I - R K|_inf < 1, K is nonsingular and |K^-1|_inf <= |R|_inf / (1 - a),
/// so that the exact unknowns are within |K^-1|_inf |w_E|_inf of any x whose gaps on the equations are w_E. All norms
/// include bounds of the rounding of K, R K and w [Higham, Accuracy and Stability of Numerical Algorithms, 2002,
/// section 3.1] and of the entries of A = J M^-1 J^T, which are below 2 after scaling, by Cauchy's inequality for |J|
/// too.
class RoundedModes {
 public:
  /// O(n^2) numbers.
  explicit RoundedModes(const ExactLcp& problem);
  explicit RoundedModes(const LcpProblem& problem);

  /// @param modes  as of ExactAnswer. O(m^3 + n^2) for m equations w = 0
  ModeEnclosure Enclose(const std::string& modes) const;

 private:
  struct Equations;

  void Scale();
  bool MakeEquations(const std::string& modes, Equations* equations) const;
  void JudgeSigns(const std::string& modes, const Equations& equations, const Eigen::VectorXd& gaps,
                  const Eigen::VectorXd& gap_errors, ModeEnclosure* enclosure) const;

  bool is_usable_ = true;   // all numbers are far from the limits of doubles
  Eigen::VectorXd scale_;   // s
  Eigen::MatrixXd A_;       // S A S
  Eigen::VectorXd b_;       // S b
  double entry_error_ = 0;  // of A_
  double largest_ = 0;      // entry of A_
  std::vector<char> bilateral_;
  std::vector<FrictionRow> friction_;  // mu s_n / s_t
  std::vector<BoundedRow> bounded_;    // bounds / s
};

/// Which problem f solves, as far as doubles prove it.
struct ModeProof {
  /// How much is proved.
  enum class Proof {
    kModes,          ///< the problem as given has a solution in these modes, and no other in them; f is near to it
    kNearbyProblem,  ///< f solves exactly the problem with another b and other mu
  };
  Proof proof = Proof::kNearbyProblem;
  std::string modes;  ///< as of ExactAnswer
  Eigen::VectorXd f;  ///< n
  /// |D^1/2 (f - f*)|_inf <= f_bound, of kModes; f* is the solution in these modes.
  double f_bound = std::numeric_limits<double>::infinity();
  /// The distances of kNearbyProblem, evaluated without rounding, then rounded up: |D^-1/2 (b~ - b)|_2, D = diag A with
  /// 1 where that is 0, and the largest |mu~ - mu| / mu. Infinite where f has signs that no mu~ makes right.
  double b_shift = 0, mu_shift = 0;

  /// More is proved, or of a problem that is nearer.
  bool IsBetterThan(const ModeProof& other) const;
};
const char* ToString(ModeProof::Proof proof);

/// Newton's method along modes in doubles from these forces, until modes are proved or repeat: then the f of the least
/// shift.  O(n^3) a step, a second for 1000 rows
/// @param start  n finite numbers, not trusted; from 0 where it is anything else
ModeProof ProveModes(const LcpProblem& problem, const Eigen::VectorXd& start);

/// b~ and mu~ of ModeProof::kNearbyProblem for these forces, which are clipped to f_n >= 0 and bounds first.
ModeProof ProveNearby(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
