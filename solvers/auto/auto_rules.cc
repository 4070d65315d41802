#include "solvers/auto/auto_rules.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/auto/exact_rule.h"
#include "solvers/auto/hybrid.h"
#include "solvers/friction/few_contacts.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/fixed_size_bpp.h"

namespace lcpbench {
namespace {

using Facts = AutoFacts;

// A factorization that costs so many nncg iterations is put off.
constexpr double kDearFactor = 6;
// What nncg may cost before others take over, in factorizations: about what block pivoting needs where it does well,
// and half of what the Newton method needs on redundant rows. psor is asked only where it is the cheapest.
constexpr double kFactorizationsOfBpp = 6;
constexpr double kFactorizationsOfNewton = 12;
constexpr double kFactorizationsForPsor = 4;
constexpr double kPsorTime = 0.5;  // of a sweep, in nncg iterations
constexpr std::int64_t kLeastNncgIterations = 16;
// On grids the iterations of nncg grow with the root of the number of rows.
constexpr double kSweepsPerRootOfRows = 8;
// Block pivoting that needs more than this has met cycles, which cost it more than the Newton method.
constexpr std::int64_t kMostFactorizationsOfBpp = 24;
// Its A takes 0.2 GB, and a solve minutes.
constexpr Index kMostRowsOfDantzig = 5000;

std::int64_t If(bool holds) { return holds ? kOwnLimit : 0; }

// How many iterations cost as much as so many factorizations.
std::int64_t NncgIterations(const Facts& facts, double factorizations) {
  const double iterations = factorizations * facts.factor_time / facts.iteration_time;
  return std::max(kLeastNncgIterations, static_cast<std::int64_t>(iterations));
}

bool HasFullRank(const Facts& facts) { return !facts.tableau_failed && !facts.is_redundant; }
bool HasDearFactor(const Facts& facts) {
  return HasFullRank(facts) && facts.factor_time > kDearFactor * facts.iteration_time;
}

// Islands with laws: of how many contacts Newton steps from 0 come before the relaxation, and of how many all modes and
// Lemke's path are tried.
constexpr Index kContactsOfModes = 16, kContactsOfAllModes = 3, kContactsOfLemke = 128;
// Large ones are swept first: the relaxation, a plain problem of as many rows, may take longer than all these sweeps.
// Forces travel a row or so a sweep. What needs more is mostly a stack, which the relaxation answers; at loose
// tolerances sweeps then go on before Newton steps, at fine ones they come after all others.
constexpr Index kLargeIsland = 129;
constexpr double kFineTolerance = 1e-7, kLooseTolerance = 1e-4;
constexpr double kSweepsPerRoot = 40, kFirstSweepsPerRoot = 6;
constexpr std::int64_t kLastSweeps = 20000;
constexpr int kRoundsOfShift = 4;
constexpr std::int64_t kStepsOfPath = 2000, kRoundsOfBounds = 4;

bool IsLargeIsland(const Facts& facts) { return facts.has_problem && facts.rows >= kLargeIsland; }
std::int64_t SweepsOfLargeIsland(const Facts& facts, double per_root) {
  const bool holds = IsLargeIsland(facts) && facts.tolerance >= kFineTolerance;
  return holds ? static_cast<std::int64_t>(per_root * std::sqrt(static_cast<double>(facts.rows))) : 0;
}

// The words of the table below have these numbers.
static_assert(Facts::IsNarrow(45) && !Facts::IsNarrow(46) && Facts::kMostRowsInOneIsland == 0.75 &&
              Facts::kSmallRows == 900 && kDearFactor == 6 && kFactorizationsForPsor == 4 &&
              kFactorizationsOfBpp == 6 && kFactorizationsOfNewton == 12 && kSweepsPerRootOfRows == 8 &&
              kMostFactorizationsOfBpp == 24 && kContactsOfModes == 16 && kContactsOfAllModes == 3 &&
              kContactsOfLemke == 128 && kLargeIsland == 129 && kFineTolerance == 1e-7 && kLooseTolerance == 1e-4 &&
              kSweepsPerRoot == 40 && kFirstSweepsPerRoot == 6 && kRoundsOfShift == 4 && kLastSweeps == 20000 &&
              kStepsOfPath == 2000 && kRoundsOfBounds == 4 && kMostContactsOfExact == 8 &&
              Facts::kLeastRowsOfHybridNncg == 500 && HybridOptions{}.most_iterations == 600);

using enum AutoStage;
using enum AutoMethod;
constexpr std::array kRules = {
    AutoRule{kRows, FixedSizeBpp::kMostRows, "", kFixedSizeBpp},
    AutoRule{kRows, SmallPivoting::kMaxRows, "", kPrincipalPivoting},
    AutoRule{kRows, Facts::kMostIslandRows, "", kProfilePivoting,
             [](const Facts& facts) { return If(!facts.is_undivided); }},

    AutoRule{kLaws, 2 * FewContacts::kMostContacts, "1 to 6 contacts and nothing else, read in place", kFixedSizeModes,
             nullptr, "5 steps"},
    AutoRule{kLaws, kAnyRows, "no row can stick", kNoFriction,
             [](const Facts& facts) { return If(facts.has_problem && !facts.can_stick && facts.can_relax); }},
    AutoRule{kLaws, kAnyRows, "`initial_f`", kWarmModes,
             [](const Facts& facts) { return std::int64_t{facts.has_start ? 3 : 0}; }, "3 steps"},
    AutoRule{kLaws, ModeFactor::kMostDense, "up to 16 contacts", kModes,
             [](const Facts& facts) { return std::int64_t{facts.contacts <= kContactsOfModes ? 8 : 0}; }, "8 steps"},
    AutoRule{kLaws, ModeSteps::kFewRows, "up to 3 contacts, no bounded rows", kAllModes,
             [](const Facts& facts) { return If(facts.contacts <= kContactsOfAllModes && !facts.has_bounded); }},
    AutoRule{kLaws, kAnyRows, "from 129 rows on, at tolerances from 1e-7 on", kSweeps,
             [](const Facts& facts) {
               return SweepsOfLargeIsland(facts, -kFirstSweepsPerRoot * std::log10(facts.tolerance));
             },
             "6 √n sweeps a digit, while their rate promises an answer"},
    AutoRule{kLaws, kAnyRows, "one friction row a contact, none slides, no bounded rows", kRelaxation,
             [](const Facts& facts) {
               return std::int64_t{!facts.can_relax ? 0 : IsLargeIsland(facts) ? 1 : kRoundsOfShift};
             },
             "4 rounds; from 129 rows on 1"},
    AutoRule{kLaws, kAnyRows, "the relaxation has no answer", kRay,
             [](const Facts& facts) { return If(facts.has_problem && facts.relaxation_failed); }},
    AutoRule{kLaws, kAnyRows, "from 129 rows on, at tolerances from 1e-4 on", kSweeps,
             [](const Facts& facts) {
               return facts.tolerance >= kLooseTolerance ? SweepsOfLargeIsland(facts, kSweepsPerRoot) : 0;
             },
             "40 √n sweeps, while their rate promises an answer"},
    AutoRule{
        kLaws, kAnyRows, "from 129 rows on, one friction row a contact, none slides, no bounded rows, J given",
        kCoulombPath,
        [](const Facts& facts) { return std::int64_t{IsLargeIsland(facts) && facts.can_relax ? kStepsOfPath : 0}; },
        "2000 steps"},
    AutoRule{
        kLaws, kAnyRows, "from 129 rows on, several friction rows a contact", kLaggedBounds,
        [](const Facts& facts) { return std::int64_t{IsLargeIsland(facts) && !facts.is_paired ? kRoundsOfBounds : 0}; },
        "4 rounds"},
    AutoRule{kLaws, kAnyRows, "from 129 rows on, and others than those that are relaxed", kModeNewton,
             [](const Facts& facts) { return std::int64_t{facts.can_relax && !IsLargeIsland(facts) ? 0 : 30}; },
             "30 steps; from 129 rows on its own limit"},
    AutoRule{kLaws, kAnyRows, "from 129 rows on", kSweeps,
             [](const Facts& facts) { return IsLargeIsland(facts) ? kLastSweeps : 0; },
             "20000 sweeps, while their rate promises an answer"},
    AutoRule{kLaws, kAnyRows, "from 129 rows on, and the first round is solved", kRelaxation,
             [](const Facts& facts) {
               const bool holds = IsLargeIsland(facts) && facts.can_relax && !facts.relaxation_failed;
               return std::int64_t{holds ? kRoundsOfShift - 1 : 0};
             },
             "3 rounds"},
    AutoRule{kLaws, kAnyRows, "up to 128 contacts, one friction row each", kLemke,
             [](const Facts& facts) { return If(facts.is_paired && facts.contacts <= kContactsOfLemke); }},
    AutoRule{kLaws, kAnyRows, "", kProximalPoints, [](const Facts&) { return std::int64_t{1000}; }, "1000 points"},
    AutoRule{kLaws, kAnyRows, "", kRay, [](const Facts& facts) { return If(facts.has_problem); }},

    AutoRule{kMatrix, SmallPivoting::kMaxRows, "up to `tableau_rows`; `hard_tableau_rows` where the band is half of A",
             kPrincipalPivoting, [](const Facts& facts) { return If(facts.rows <= facts.tableau_rows); }},
    AutoRule{kMatrix, Facts::kMostDenseRows, "A given dense", kBandPivoting,
             [](const Facts& facts) { return If(facts.is_dense); }},
    AutoRule{kMatrix, Facts::kMostStepRows, "A given sparse, bandwidth up to 45", kBandPivoting,
             [](const Facts& facts) { return If(!facts.is_dense && Facts::IsNarrow(facts.bandwidth)); }},

    AutoRule{kProblem, SmallPivoting::kMaxRows,
             "up to `tableau_rows`; `hard_tableau_rows` where rows are redundant or the factor is dense",
             kPrincipalPivoting,
             [](const Facts& facts) { return If(!facts.tableau_failed && facts.rows <= facts.tableau_rows); }},
    AutoRule{kProblem, kAnyRows, "more than that, and at most 75 % of the rows lie in islands of more", kIslands,
             [](const Facts& facts) { return If(facts.rows > facts.tableau_rows && facts.may_divide); }},

    AutoRule{kBackends, kAnyRows, "full rank, and a factorization costs more than 6 iterations of `nncg`", kPsor,
             [](const Facts& facts) {
               const double iterations = kFactorizationsForPsor * facts.factor_time / facts.iteration_time;
               return HasDearFactor(facts) ? static_cast<std::int64_t>(iterations / kPsorTime) : 0;
             },
             "4 factorizations"},
    AutoRule{kBackends, kAnyRows, "the same", kNncg,
             [](const Facts& facts) { return HasDearFactor(facts) ? NncgIterations(facts, kFactorizationsOfBpp) : 0; },
             "6 factorizations"},
    AutoRule{kBackends, kAnyRows, "full rank, more than 900 rows, A given sparse with a bandwidth above 45",
             kPatientNncg,
             [](const Facts& facts) {
               const double iterations = kSweepsPerRootOfRows * std::sqrt(static_cast<double>(facts.rows));
               return facts.is_wide_sparse ? static_cast<std::int64_t>(iterations) : 0;
             },
             "8 √n iterations"},
    AutoRule{kBackends, kAnyRows, "full rank, from 5000 rows on, J given, more than 0.25 cycles per body", kNncg,
             [](const Facts& facts) { return facts.is_packing ? facts.hybrid_sweeps : 0; }, "600 iterations"},
    AutoRule{kBackends, Facts::kSmallRows, "redundant rows", kNncg,
             [](const Facts& facts) {
               const bool holds = facts.is_redundant && !facts.tableau_failed;
               return holds ? NncgIterations(facts, kFactorizationsOfNewton) : 0;
             },
             "12 factorizations"},
    AutoRule{kBackends, kAnyRows, "full rank, and no packing as above", kBpp,
             [](const Facts& facts) { return HasFullRank(facts) && !facts.is_packing ? kMostFactorizationsOfBpp : 0; },
             "24 factorizations"},
    AutoRule{kBackends, Facts::kSmallRows,
             "`bpp` has met dependent rows, its factor is not dense, and `nncg` was not asked", kNncg,
             [](const Facts& facts) {
               const bool holds = facts.has_dependent_rows && !facts.has_dense_factor && !facts.has_swept;
               return holds ? NncgIterations(facts, kFactorizationsOfNewton) : 0;
             },
             "12 factorizations"},
    AutoRule{kBackends, kAnyRows, "up to 900 rows, or A given dense", kSemismoothNewton,
             [](const Facts& facts) { return If(!facts.is_large); }},
    AutoRule{kBackends, kAnyRows, "`hybrid`, from 500 rows on, and there is a start", kGuess,
             [](const Facts& facts) { return If(facts.has_start && facts.hybrid_sweeps > 0); },
             "the active set of the start, in the time of 90 iterations of `nncg`"},
    AutoRule{kBackends, kAnyRows, "`hybrid`, from 500 rows on", kHybridNncg,
             [](const Facts& facts) { return facts.hybrid_sweeps; }, "`most_iterations`, 600"},
    AutoRule{kBackends, kAnyRows, "`hybrid`", kIpm},
    AutoRule{kBackends, kAnyRows, "more than 900 rows", kSemismoothNewton,
             [](const Facts& facts) { return If(facts.is_large); }},
    AutoRule{kBackends, kMostRowsOfDantzig, "", kDantzig},

    AutoRule{kLast, kMostRowsOfExact, "with friction, sliding or bounded rows: up to 8 contacts", kExact},
};

// A stage's rules stand together.
constexpr std::span<const AutoRule> Find(AutoStage stage) {
  const auto is_of_stage = [stage](const AutoRule& rule) { return rule.stage == stage; };
  const auto first = std::find_if(kRules.begin(), kRules.end(), is_of_stage);
  return {first, std::find_if_not(first, kRules.end(), is_of_stage)};
}
constexpr std::array kRulesOfStages = {Find(kRows),    Find(kLaws),     Find(kMatrix),
                                       Find(kProblem), Find(kBackends), Find(kLast)};

constexpr std::string_view TitleOf(AutoStage stage) {
  switch (stage) {
    case kRows:
      return "Island by island, of steps with rows on at most two moving bodies each";
    case kLaws:
      return "Island by island, of problems with friction, sliding or bounded rows";
    case kMatrix:
      return "A given as a matrix";
    case kProblem:
      return "Other problems, and what is left open";
    case kBackends:
      return "The same, by backends";
    case kLast:
      return "What is still open, with friction or without";
  }
  return {};
}

}  // namespace

std::string_view KeyOf(AutoMethod method) {
  switch (method) {
    case kFixedSizeBpp:
      return "fixed-size-bpp";
    case kPrincipalPivoting:
      return "principal-pivoting";
    case kProfilePivoting:
      return "profile-pivoting";
    case kBandPivoting:
      return "band-pivoting";
    case kIslands:
      return "islands";
    case kPsor:
      return "psor";
    case kNncg:
    case kPatientNncg:
    case kHybridNncg:
      return "nncg";
    case kBpp:
      return "bpp";
    case kSemismoothNewton:
      return "semismooth-newton";
    case kGuess:
    case kIpm:
      return "ipm";
    case kDantzig:
      return "dantzig";
    case kFixedSizeModes:
      return "fixed-size modes";
    case kNoFriction:
      return "the plain problem of the other rows";
    case kWarmModes:
      return "warm modes";
    case kModes:
      return "modes";
    case kAllModes:
      return "all modes";
    case kSweeps:
      return "sweeps";
    case kRelaxation:
      return "relaxation, shifted from the second round on, with 8 Newton steps after each";
    case kModeNewton:
      return "mode-newton";
    case kCoulombPath:
      return "central path";
    case kLaggedBounds:
      return "lagged-bounds";
    case kLemke:
      return "lemke";
    case kProximalPoints:
      return "proximal points";
    case kRay:
      return "a ray without friction";
    case kExact:
      return "exact";
  }
  return {};
}

std::span<const AutoRule> AutoRulesOf(AutoStage stage) { return kRulesOfStages[static_cast<std::size_t>(stage)]; }

std::string AutoRulesAsMarkdown() {
  std::string text = "| rows | condition | method | at most |\n| ---: | --- | --- | --- |\n";
  const auto* before = kRules.end();
  for (const AutoRule* rule = kRules.begin(); rule != kRules.end(); before = rule++) {
    if (before == kRules.end() || before->stage != rule->stage) {
      text.append("| | **").append(TitleOf(rule->stage)).append("** | | |\n");
    }
    const bool has_words = rule->stage == kLaws || rule->method == kIslands;
    const std::string_view quote = has_words ? "" : "`";
    text.append("| ").append(rule->most_rows == kAnyRows ? "any" : "≤ " + std::to_string(rule->most_rows));
    text.append(" | ").append(rule->when).append(" | ").append(quote).append(KeyOf(rule->method)).append(quote);
    text.append(" | ").append(rule->limit).append(" |\n");
  }
  return text;
}

}  // namespace lcpbench
