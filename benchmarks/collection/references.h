#pragma once

#include <map>
#include <optional>
#include <string>

#include "benchmarks/collection/manifest.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

// The known answers of the collection: how they are made, and read from a manifest's file.

/// A share of |D^-1/2 b|_2: some roundings of rows that depend on each other.
inline constexpr double kRounding = 0x1p-44;

struct ExamineOptions {
  /// Up to this many rows answers are proved in exact arithmetic, above they are refined and bounded.
  Index exact_up_to = 250;
  /// Up to this many rows Lemke's path along modes is followed exactly where no answer in doubles has the right ones.
  Index path_up_to = 40;
  /// Up to this many rows answers with friction or bounded rows are proved by their modes in doubles, at n^3; above,
  /// how near a problem is that they solve exactly.
  Index modes_up_to = 2000;
  /// Above this many rows there is no reference, and how the answer lies is known to a solver's tolerance only.
  Index bounded_up_to = 20'000;
  double time_limit_s = 300;       ///< for one exact answer (it is bounded then) and one bounded one
  double large_time_limit_s = 60;  ///< for a solver's answer above bounded_up_to
};

/// What examining a problem brings.
struct Examined {
  ManifestEntry entry;         ///< but for its family and where it comes from
  std::string reference_line;  ///< of the file of references; "" for none
};

/// Solves, proves or bounds, and measures one problem. Everything is judged here; solvers only help to find the answer.
/// A problem without a solution, as its doubles say it, for which a solution of a problem nearby is known, with b
/// another by kRounding at most, counts as solved: its rows contradict each other by roundings.
/// Where A is not positive semidefinite, only answers that SolveByEnumeration proves are known.
/// @param known_f  an answer that is said to be exact, which is checked
/// @throws InputError where it is not
Examined Examine(const LcpProblem& problem, const ExamineOptions& options,
                 const std::optional<Eigen::VectorXd>& known_f = std::nullopt);

/// A known answer of the collection.
struct KnownAnswer {
  /// With the rounding floor of f: that of an answer proved before any campaign, in which no judged solver has a say.
  LcpReference reference;
  Eigen::VectorXd f;  ///< also where it is not unique; empty of problems without a solution
};

/// The answers of a manifest's file of references. Numbers are parsed when they are wanted.
class References {
 public:
  /// @throws InputError where the file cannot be read
  References(const Manifest& manifest, const std::string& folder);

  /// Nothing where the file has no answer. @throws InputError for a line that does not answer this problem
  std::optional<KnownAnswer> Find(const LcpProblem& problem) const;

  /// The file's line, "" where it has none.
  std::string Line(const std::string& id) const;

 private:
  std::string name_;
  std::map<std::string, std::string> lines_;  // by id
};

}  // namespace lcpbench
