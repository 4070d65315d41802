#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Problems are compared within classes of their number of rows, everywhere: in campaigns, README, report and
/// `lcpbench recommend`. Result files carry the table (campaign.json), so that readers need no copy of it.
struct SizeClass {
  std::string_view key;  ///< of files and tables
  Index least;           ///< rows
  Index most;            ///< rows
  /// How many problems a stream of this class has at least: the collection's own and, to fill up, others of the same
  /// recipes with further seeds. 0: problems are timed one by one, without a stream.
  int stream;
};

inline constexpr std::array kSizeClasses{
    SizeClass{"1", 0, 1, 1000},
    SizeClass{"2-3", 2, 3, 1000},
    SizeClass{"4-6", 4, 6, 1000},
    SizeClass{"7-12", 7, 12, 1000},
    SizeClass{"13-30", 13, 30, 1000},
    SizeClass{"31-100", 31, 100, 256},
    SizeClass{"101-300", 101, 300, 64},
    SizeClass{"301-1000", 301, 1000, 64},
    SizeClass{"1001-1e4", 1001, 10'000, 0},
    SizeClass{"1e4-1e5", 10'001, 100'000, 0},
    SizeClass{"1e5-1e6", 100'001, std::numeric_limits<Index>::max(), 0},
};

/// The class of a problem with so many rows. One without rows belongs to the first.
constexpr const SizeClass& SizeClassOf(Index rows) {
  for (const SizeClass& size_class : kSizeClasses) {
    if (rows <= size_class.most) return size_class;
  }
  return kSizeClasses.back();
}

/// A number and how it was got; or none, and why.
template <typename Value>
struct Measured {
  std::optional<Value> value;
  std::string method;
};

/// What a problem is, whatever its answer.
struct ProblemProperties {
  Index rows = 0;
  Index bilateral = 0;
  Index friction = 0;  ///< rows with friction, sliding ones among them
  Index bounded = 0;   ///< rows between two bounds
  Index bodies = 0;    ///< that can move and that a row touches; 0 without factors
  Index nonzeros_A = 0;
  std::optional<Index> nonzeros_J;
  Measured<Index> rank;
  /// The number of eigenvalues of A above rounding: less than the rank where rows are dependent but for rounding.
  std::optional<Index> numerical_rank;
  /// The largest of those eigenvalues by the smallest.
  Measured<double> condition;
  std::optional<double> redundancy;  ///< 1 - rank / rows, where the rank is known
  std::optional<double> mass_ratio;  ///< largest mass of those bodies by the smallest; factors only
  std::map<std::string, int> kinds;  ///< constraints by kind (CountKinds); empty where no scene is known

  bool is_plain() const { return friction == 0 && bounded == 0; }
};

/// Up to this many rows conditions are by all singular values, and ranks without factors are measured.
inline constexpr Index kMostRowsDense = 2000;
/// Up to this many rows conditions are estimated where A is nonsingular; above there are none.
inline constexpr Index kMostRowsEstimated = 20'000;

/// O(rows^2 columns) up to kMostRowsDense, then what a sparse factorization of A costs, and then O(entries of A).
ProblemProperties MeasureProperties(const LcpProblem& problem);

/// How the answer lies: by exact zeros of w and f where these are proved, else by `negligible`.
struct AnswerProperties {
  double fraction_active = 0;  ///< unilateral rows with w = 0, by unilateral rows
  Index degenerate = 0;        ///< unilateral rows with w = f = 0
  Index friction_forces = 0;   ///< friction rows, sliding ones among them, with f != 0
  /// Shares of the friction rows: with f = 0 on their normal row, and of the others with w = 0 (stick) and w != 0
  /// (slip; sliding rows always). None without friction rows.
  std::optional<double> open, stick, slip;
};

/// @param negligible  D^-1/2 w, D^1/2 f at most this are 0
AnswerProperties MeasureAnswer(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w,
                               double negligible);

/// What a solver need not be good at: "f = 0" where that is the answer (b >= 0, b = 0 on bilateral rows), "all rows
/// active" where w = 0 on all rows, so that -A^+ b or another solution of linear equations is one, "no active contact"
/// where w > 0 on all unilateral rows, so that the bilateral ones decide the answer alone. With friction rows: "f = 0",
/// and "no friction force" where f = 0 on all of these, so that a plain problem has the answer. Empty: none of these.
std::string Triviality(const LcpProblem& problem, const AnswerProperties& answer);

}  // namespace lcpbench
