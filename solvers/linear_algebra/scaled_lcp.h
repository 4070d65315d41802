#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/linear_algebra/padded_vector.h"

/// Internal to solvers/: scaling by powers of two, which rounds nothing.
namespace lcpbench {

inline constexpr int kExponentBias = 1023;
inline constexpr int kMantissaBits = 52;

/// e for x = m 2^e, 1 <= m < 2; subnormal numbers give the lowest e.
inline std::int64_t Exponent(double x) {
  return static_cast<std::int64_t>((std::bit_cast<std::uint64_t>(x) >> kMantissaBits) & 0x7ff) - kExponentBias;
}

/// 2^exponent, exponent in [-1022, 1023].
inline double PowerOfTwo(std::int64_t exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(kExponentBias + exponent) << kMantissaBits);
}

/// s such that s^2 d is in [1, 4), for d > 0.
inline double ScaleOfDiagonal(double d) { return PowerOfTwo(-(Exponent(d) >> 1)); }

/// t such that t x is in [1, 2) for x > 0; 1 for 0. The reciprocal of the largest exponents is subnormal; such x
/// overflow elsewhere.
inline double ScaleOfLargest(double x) {
  return x > 0 ? PowerOfTwo(std::clamp<std::int64_t>(-Exponent(x), -1022, 1023)) : 1.0;
}

/// out[i] += sum over columns j < columns of A_ij x_j, for i in [begin, end), A by columns. Groups of zero x_j are
/// skipped; x and out may be parts of one array that do not meet.
void AddColumns(const double* A, Eigen::Index stride, Eigen::Index begin, Eigen::Index end, Eigen::Index columns,
                const double* x, double* out);

/// The vectors of an LCP in scaled units, by row of the problem: S A S, S b / t, S^-1 f / t with S = diag(scale) and
/// t = b_unit, for methods that leave A to an ActiveBlock. Internal to solvers/.
///
/// Load takes powers of two: S_ii that bring A_ii into [1, 4), and one t that brings the largest |b_i| into [1, 2), as
/// PermutedLcp; nothing is rounded. ScaledSystem takes S = D^-1/2 and a t for each part of A that nothing connects.
/// Rows with A_ii = 0 neither act nor are judged: b_i = 0, A_ii = 1 there, and FindZeroRowRay looks at them.
struct ScaledVectors {
  /// Allocates, and reads the bounds.
  void Reset(const LcpProblem& problem);
  /// False, half loaded, if an A_ii < 0.  O(n)
  bool Load(const LcpProblem& problem) { return Load(problem.DiagonalA(), problem.b()); }
  /// The same of A that no LcpProblem holds, with the joints in `bilateral`. Rows may be filled up by some with A_ii =
  /// 0 and b_i = 0.
  /// @param d, given  A_ii, and b in given units
  bool Load(const Eigen::VectorXd& d, const Eigen::VectorXd& given);
  /// Room for `rows` rows, none of them a joint. Allocates.
  void Reset(Eigen::Index rows);

  bool is_joint(Eigen::Index i) const { return bilateral[static_cast<size_t>(i)] != 0; }
  bool acts(Eigen::Index i) const { return can_act[static_cast<size_t>(i)] != 0; }
  /// rho of forces f and w = A f + b.  O(n)
  double Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;

  double GivenForce(Eigen::Index i, double f) const { return f * (scale[i] * b_unit[i]); }
  double ScaledForce(Eigen::Index i, double given) const { return given / (scale[i] * b_unit[i]); }
  double ScaledGap(Eigen::Index i, double given) const { return given / (b_unit[i] / scale[i]); }
  /// Clips forces in given units: f >= 0 but for joints, and 0 for rows that do not act.
  void Clip(const Eigen::VectorXd& given, Eigen::VectorXd* f) const;

  Eigen::VectorXd scale, diagonal, b, b_unit;
  std::vector<char> can_act;  ///< takes part, with A_ii > 0
  std::vector<char> bilateral;
  double b_norm = 1;  ///< |D^-1/2 b|_2 in given units, D_ii = 1 where A_ii = 0; 1 when b = 0
};

/// A dense working copy of an LCP for pivoting methods: scaled, and with rows and columns in an order of the method's
/// choosing, so that the rows of one kind (active, watched, ...) are contiguous and products with blocks of A are plain
/// loops over columns.
///
/// Scaling: A~ = S A S, b~ = t S b, f~ = t S^-1 f, w~ = t S w, with powers of two S_ii that bring A_ii into [1, 4) and
/// t that brings the largest |b~_i| into [1, 2). No entry is rounded: a singular A stays exactly singular, and problems
/// that differ by powers of two (of A, of b, of single rows) take identical steps. A~_ii is not 1, so tolerances must
/// be relative to it.
///
/// "Position" is the current place of a row, row[p] its index in the problem. Initial order: bilateral rows, unilateral
/// rows that are guessed to be active, the other unilateral rows, rows with A_ii = 0; the last kind is not part of A.
/// Memory: one n x n copy. Only Reserve allocates.
struct PermutedLcp {
  using Index = Eigen::Index;

  void Reserve(Index max_rows);

  /// Which unilateral rows are guessed to be active.
  struct Guess {
    /// Not nullptr: rows with D^1/2 f above kGuessThreshold times the largest (an interior point leaves no zeros).
    const Eigen::VectorXd* forces = nullptr;
    /// Without forces: rows with b < 0, or none.
    bool negative_b = false;
  };

  enum class Loaded { kDone, kNegativeDiagonal, kOutOfTime };

  /// O(n^2). Nothing is loaded unless kDone.
  /// @param problem   its DenseA() is read as it stands, so one triangle does not speak for the other
  /// @param deadline  nullptr for none; looked at every some 10 us
  Loaded Load(const LcpProblem& problem, const Guess& guess, const Deadline* deadline);
  static constexpr double kGuessThreshold = 1e-10;

  /// Exchanges the rows and columns at two positions.  O(n)
  void Swap(Index p, Index q);

  double* column(Index p) { return A.data() + p * stride; }
  const double* column(Index p) const { return A.data() + p * stride; }

  /// As above, for positions.
  void AddColumns(Index begin, Index end, Index columns, const double* x, double* out) const {
    lcpbench::AddColumns(A.data(), stride, begin, end, columns, x, out);
  }

  struct Sum {
    double value;      ///< w_p = b_p + sum over j < columns of A_pj f_j
    double magnitude;  ///< the same sum of absolute values: rounding of w_p is of the order epsilon times this
  };
  /// Reads column p for row p (equal up to LcpProblem::kSymmetryTolerance).  O(columns)
  Sum FreshW(Index p, Index columns) const;

  /// The units of the problem as given.
  double GivenForce(Index p) const { return f[p] * (scale[row[static_cast<size_t>(p)]] / b_scale); }
  double ScaledW(Index p, double given) const { return given * b_scale * scale[row[static_cast<size_t>(p)]]; }
  /// |w_p| / (sqrt(A_pp) |D^-1/2 b|_2), the share that row p alone would have in rho.
  double ResidualShare(Index p, double w_p) const;

  Index n = 0;
  Index nonzero = 0;    ///< rows with A_ii > 0: positions [0, nonzero)
  Index bilateral = 0;  ///< bilateral rows among them: initial positions [0, bilateral)
  Index guessed = 0;    ///< unilateral rows guessed to be active: initial positions behind them
  Index stride = 0;
  double b_scale = 1;                 ///< t
  double b_norm = 1;                  ///< |D^-1/2 b|_2 in given units, D_ii = 1 where A_ii = 0; 1 when b = 0
  Eigen::VectorXd A;                  ///< column p starts at p * stride
  Eigen::VectorXd diagonal, b, f, w;  ///< by position
  Eigen::VectorXd scale;              ///< S, by row of the problem
  std::vector<Index> row;             ///< position -> row of the problem

 private:
  void Order(const LcpProblem& problem, const Guess& guess);

  std::vector<unsigned char> kind_;  // by row of the problem, while Load orders them
  std::vector<Index> moved_;         // positions that do not begin with the row of their number
};

}  // namespace lcpbench
