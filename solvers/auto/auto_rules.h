#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "solvers/auto/auto_limits.h"
#include "solvers/lcp/problem.h"

/// How `auto` decides: one table, read from the top. Every rule whose condition holds is asked in turn until one of the
/// methods gives an answer that passes; nothing else chooses a method. docs/solvers/auto.md shows the table as
/// `lcpbench list rules` prints it. Internal to solvers/.
namespace lcpbench {

/// What `auto` asks. All but kIslands, kExact and those of AutoStage::kLaws are solvers of the registry.
enum class AutoMethod : std::uint8_t {
  kFixedSizeBpp,       ///< FixedSizeBpp
  kPrincipalPivoting,  ///< SmallPivoting
  kProfilePivoting,    ///< ProfilePivoting
  kBandPivoting,       ///< BandPivoting
  kIslands,            ///< rows that carry no force left out, each small island by SmallPivoting, the rest by backends
  kPsor,               ///< PgsSolver
  kNncg,               ///< NncgSolver
  kPatientNncg,        ///< the same, whose rate is looked at later
  kBpp,                ///< BppSolver
  kSemismoothNewton,   ///< SemismoothNewtonSolver
  kGuess,              ///< IpmSolver::WarmStart::kGuessOnly, the first of HybridSolver
  kHybridNncg,         ///< NncgSolver, as long as HybridOptions let it
  kIpm,                ///< IpmSolver, the last of HybridSolver
  kDantzig,            ///< DantzigSolver
  kFixedSizeModes,     ///< FewContacts
  kNoFriction,         ///< the plain problem of the other rows
  kWarmModes,          ///< ModeSteps::Warm
  kModes,              ///< ModeSteps::TakeFullSteps
  kAllModes,           ///< ModeSteps::TryAll
  kSweeps,             ///< ModeSteps::Sweep
  kRelaxation,         ///< ShiftRounds
  kModeNewton,         ///< ModeSteps::TakeDampedSteps
  kCoulombPath,        ///< CoulombPath
  kLaggedBounds,       ///< LaggedBoundsSolver
  kLemke,              ///< NormalMapPath::Cover
  kProximalPoints,     ///< NormalMapPath::Approach
  kRay,                ///< of the problem without friction
  kExact,              ///< TryExact
};

/// The registry's key, or words.
std::string_view KeyOf(AutoMethod method);

/// Which rules apply. A problem passes the stages in this order, from the first one that takes it on.
enum class AutoStage : std::uint8_t {
  kRows,      ///< one island of rows on at most two moving bodies each, read in place
  kLaws,      ///< one island of a problem with friction, sliding or bounded rows
  kMatrix,    ///< a symmetric dense or sparse A, read in place
  kProblem,   ///< an LcpProblem: what the stages before do not take or leave open
  kBackends,  ///< an LcpProblem, or the islands that kProblem leaves open
  kLast,      ///< an LcpProblem with any rows, of which no answer passes
};

/// What rules look at. Each stage fills in what its rules need.
struct AutoFacts {
  const AutoLimits* limits = &kDefaultLimits;  ///< outlive the facts
  Index rows = 0;                              ///< n, or of the island
  bool is_undivided = false;                   ///< kRows: a small step, islands not looked for
  Index tableau_rows = 0;  ///< AutoLimits::tableau_rows, or hard_tableau_rows of redundant or full problems
  // kLaws.
  double tolerance = 0;
  Index contacts = 0;              ///< unilateral rows
  bool can_stick = false;          ///< a friction row with mu > 0 that does not slide
  bool can_relax = false;          ///< up to one friction row a contact, none slides, no bounded rows
  bool is_paired = false;          ///< up to one friction row a contact
  bool has_bounded = false;        ///< bounded rows
  bool has_start = false;          ///< initial_f is given; kBackends: or a method has ended at a start for the next
  bool has_problem = false;        ///< an LcpProblem, not read in place
  bool relaxation_failed = false;  ///< the relaxation has no answer
  // kMatrix.
  bool is_dense = false;  ///< A is given as a dense matrix
  Index bandwidth = 0;    ///< max |i - j| over entries
  // kProblem and kBackends.
  bool tableau_failed = false;      ///< a tableau has left the problem open
  bool may_divide = false;          ///< islands have not been found to be too large
  bool is_redundant = false;        ///< rows outnumber degrees of freedom, so that A is singular
  bool is_large = false;            ///< more than large_rows, not given as a dense matrix, and `ipm` in this build
  bool is_wide_sparse = false;      ///< large, not redundant, A given sparse with a band too wide for a factor
  bool is_packing = false;          ///< large, not redundant, by factors, with many cycles in the graph of bodies
  bool has_dense_factor = false;    ///< block pivoting's
  bool has_dependent_rows = false;  ///< block pivoting has met them
  bool has_swept = false;           ///< nncg has been asked
  std::int64_t hybrid_sweeps = 0;   ///< that HybridOptions grant nncg; 0 for few rows
  double iteration_time = 1;        ///< of nncg [ns], predicted
  double factor_time = 0;           ///< of a factorization of what follows nncg [ns], predicted; 0: not known
};

/// AutoRule::grants of a method that keeps to its own limit.
inline constexpr std::int64_t kOwnLimit = std::numeric_limits<std::int64_t>::max();
/// AutoRule::most_rows of a rule for any number.
inline constexpr Index kAnyRows = std::numeric_limits<Index>::max();

/// A number of rows: of a method, or a limit.
struct AutoRows {
  constexpr AutoRows(Index rows) : fixed(rows) {}  // NOLINT(google-explicit-constructor): for the table
  constexpr AutoRows(Index AutoLimits::*rows) : fixed(0), limit(rows) {}  // NOLINT(google-explicit-constructor)
  Index In(const AutoLimits& limits) const { return limit == nullptr ? fixed : limits.*limit; }

  Index fixed;
  Index AutoLimits::*limit = nullptr;
};

/// One line of the table. In words, {name} stands for the default of a limit.
struct AutoRule {
  AutoStage stage;
  AutoRows most_rows;     ///< the rule holds up to so many rows
  std::string_view when;  ///< what else must hold, in words
  AutoMethod method;
  /// Iterations that the method is granted, in its own unit; 0 where the rule does not hold. nullptr: kOwnLimit.
  std::int64_t (*grants)(const AutoFacts& facts) = nullptr;
  std::string_view limit = {};  ///< of the iterations, in words

  /// 0 where the rule does not hold.
  std::int64_t Grants(const AutoFacts& facts) const {
    if (facts.rows > most_rows.In(*facts.limits)) return 0;
    return grants == nullptr ? kOwnLimit : grants(facts);
  }
};

/// The rules of a stage, in the order in which they are asked.
std::span<const AutoRule> AutoRulesOf(AutoStage stage);

/// The table for docs/solvers/auto.md, as `lcpbench list rules` prints it.
std::string AutoRulesAsMarkdown();

}  // namespace lcpbench
