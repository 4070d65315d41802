#include "solvers/auto/auto_rules.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/friction/few_contacts.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/fixed_size_bpp.h"

namespace lcpbench {
namespace {

using Facts = AutoFacts;

constexpr double kPsorTime = 0.5;  // of a sweep, in nncg iterations

std::int64_t If(bool holds) { return holds ? kOwnLimit : 0; }

// How many iterations cost as much as so many factorizations.
std::int64_t NncgIterations(const Facts& facts, double factorizations) {
  const double iterations = factorizations * facts.factor_time / facts.iteration_time;
  return std::max(facts.limits->least_nncg, static_cast<std::int64_t>(iterations));
}

bool HasFullRank(const Facts& facts) { return !facts.tableau_failed && !facts.is_redundant; }
bool HasDearFactor(const Facts& facts) {
  return HasFullRank(facts) && facts.factor_time > facts.limits->dear_factorization * facts.iteration_time;
}

bool IsLargeIsland(const Facts& facts) { return facts.has_problem && facts.rows >= facts.limits->large_island_rows; }
std::int64_t SweepsOfLargeIsland(const Facts& facts, double per_root) {
  const bool holds = IsLargeIsland(facts) && facts.tolerance >= facts.limits->fine_tolerance;
  return holds ? static_cast<std::int64_t>(per_root * std::sqrt(static_cast<double>(facts.rows))) : 0;
}

static_assert(AutoLimits::kTableau == SmallPivoting::kMaxRows);

using enum AutoStage;
using enum AutoMethod;
constexpr std::array kRules = {
    AutoRule{kRows, FixedSizeBpp::kMostRows, "", kFixedSizeBpp},
    AutoRule{kRows, SmallPivoting::kMaxRows, "", kPrincipalPivoting},
    AutoRule{kRows, &AutoLimits::island_rows, "", kProfilePivoting,
             [](const Facts& facts) { return If(!facts.is_undivided); }},

    AutoRule{kLaws, 2 * FewContacts::kMostContacts, "1 to 6 contacts and nothing else, read in place", kFixedSizeModes,
             nullptr, "5 steps"},
    AutoRule{kLaws, kAnyRows, "no row can stick", kNoFriction,
             [](const Facts& facts) { return If(facts.has_problem && !facts.can_stick && facts.can_relax); }},
    AutoRule{kLaws, kAnyRows, "`initial_f`", kWarmModes,
             [](const Facts& facts) { return facts.has_start ? facts.limits->warm_steps : 0; }, "{warm_steps} steps"},
    AutoRule{
        kLaws, ModeFactor::kMostDense, "up to {mode_contacts} contacts", kModes,
        [](const Facts& facts) { return facts.contacts <= facts.limits->mode_contacts ? facts.limits->mode_steps : 0; },
        "{mode_steps} steps"},
    AutoRule{kLaws, ModeSteps::kFewRows, "up to {all_modes_contacts} contacts, no bounded rows", kAllModes,
             [](const Facts& facts) {
               return If(facts.contacts <= facts.limits->all_modes_contacts && !facts.has_bounded);
             }},
    AutoRule{kLaws, kAnyRows, "from {large_island_rows} rows on, at tolerances from {fine_tolerance} on", kSweeps,
             [](const Facts& facts) {
               return SweepsOfLargeIsland(facts, -facts.limits->first_sweeps_per_root * std::log10(facts.tolerance));
             },
             "{first_sweeps_per_root} √n sweeps a digit, while their rate promises an answer"},
    AutoRule{kLaws, kAnyRows, "one friction row a contact, none slides, no bounded rows", kRelaxation,
             [](const Facts& facts) {
               return !facts.can_relax ? 0 : IsLargeIsland(facts) ? 1 : facts.limits->shift_rounds;
             },
             "{shift_rounds} rounds; from {large_island_rows} rows on 1"},
    AutoRule{kLaws, kAnyRows, "the relaxation has no answer", kRay,
             [](const Facts& facts) { return If(facts.has_problem && facts.relaxation_failed); }},
    AutoRule{kLaws, kAnyRows, "from {large_island_rows} rows on, at tolerances from {loose_tolerance} on", kSweeps,
             [](const Facts& facts) {
               return facts.tolerance >= facts.limits->loose_tolerance
                          ? SweepsOfLargeIsland(facts, facts.limits->sweeps_per_root)
                          : 0;
             },
             "{sweeps_per_root} √n sweeps, while their rate promises an answer"},
    AutoRule{kLaws, kAnyRows,
             "from {large_island_rows} rows on, one friction row a contact, none slides, no bounded rows, J given",
             kCoulombPath,
             [](const Facts& facts) { return IsLargeIsland(facts) && facts.can_relax ? facts.limits->path_steps : 0; },
             "{path_steps} steps"},
    AutoRule{
        kLaws, kAnyRows, "from {large_island_rows} rows on, several friction rows a contact", kLaggedBounds,
        [](const Facts& facts) { return IsLargeIsland(facts) && !facts.is_paired ? facts.limits->bounds_rounds : 0; },
        "{bounds_rounds} rounds"},
    AutoRule{
        kLaws, kAnyRows, "from {large_island_rows} rows on, and others than those that are relaxed", kModeNewton,
        [](const Facts& facts) { return facts.can_relax && !IsLargeIsland(facts) ? 0 : facts.limits->newton_steps; },
        "{newton_steps} steps; from {large_island_rows} rows on its own limit"},
    AutoRule{kLaws, kAnyRows, "from {large_island_rows} rows on", kSweeps,
             [](const Facts& facts) { return IsLargeIsland(facts) ? facts.limits->last_sweeps : 0; },
             "{last_sweeps} sweeps, while their rate promises an answer"},
    AutoRule{kLaws, kAnyRows, "from {large_island_rows} rows on, and the first round is solved", kRelaxation,
             [](const Facts& facts) {
               const bool holds = IsLargeIsland(facts) && facts.can_relax && !facts.relaxation_failed;
               return holds ? facts.limits->shift_rounds - 1 : 0;
             },
             "{shift_rounds} rounds with the first"},
    AutoRule{kLaws, kAnyRows, "up to {lemke_contacts} contacts, one friction row each", kLemke,
             [](const Facts& facts) { return If(facts.is_paired && facts.contacts <= facts.limits->lemke_contacts); }},
    AutoRule{kLaws, kAnyRows, "", kProximalPoints, [](const Facts& facts) { return facts.limits->proximal_points; },
             "{proximal_points} points"},
    AutoRule{kLaws, kAnyRows, "", kRay, [](const Facts& facts) { return If(facts.has_problem); }},

    AutoRule{kMatrix, SmallPivoting::kMaxRows, "up to `tableau_rows`; `hard_tableau_rows` where the band is half of A",
             kPrincipalPivoting, [](const Facts& facts) { return If(facts.rows <= facts.tableau_rows); }},
    AutoRule{kMatrix, &AutoLimits::dense_rows, "A given dense", kBandPivoting,
             [](const Facts& facts) { return If(facts.is_dense); }},
    AutoRule{kMatrix, &AutoLimits::step_rows, "A given sparse, bandwidth up to {narrow_band}", kBandPivoting,
             [](const Facts& facts) { return If(!facts.is_dense && facts.bandwidth <= facts.limits->narrow_band); }},

    AutoRule{kProblem, SmallPivoting::kMaxRows,
             "up to `tableau_rows`; `hard_tableau_rows` where rows are redundant or the factor is dense",
             kPrincipalPivoting,
             [](const Facts& facts) { return If(!facts.tableau_failed && facts.rows <= facts.tableau_rows); }},
    AutoRule{kProblem, kAnyRows,
             "more than that, and at most a share of {dominant_share} of the rows lie in islands of more", kIslands,
             [](const Facts& facts) { return If(facts.rows > facts.tableau_rows && facts.may_divide); }},

    AutoRule{kBackends, kAnyRows,
             "full rank, and a factorization costs more than {dear_factorization} iterations of `nncg`", kPsor,
             [](const Facts& facts) {
               const double iterations = facts.limits->psor_factorizations * facts.factor_time / facts.iteration_time;
               return HasDearFactor(facts) ? static_cast<std::int64_t>(iterations / kPsorTime) : 0;
             },
             "{psor_factorizations} factorizations"},
    AutoRule{kBackends, kAnyRows, "the same", kNncg,
             [](const Facts& facts) {
               return HasDearFactor(facts) ? NncgIterations(facts, facts.limits->nncg_before_bpp) : 0;
             },
             "{nncg_before_bpp} factorizations"},
    AutoRule{
        kBackends, kAnyRows,
        "full rank, more than {large_rows} rows, A given sparse with a bandwidth above {narrow_band}", kPatientNncg,
        [](const Facts& facts) {
          const double iterations = facts.limits->sparse_nncg_per_root * std::sqrt(static_cast<double>(facts.rows));
          return facts.is_wide_sparse ? static_cast<std::int64_t>(iterations) : 0;
        },
        "{sparse_nncg_per_root} √n iterations"},
    AutoRule{kBackends, kAnyRows,
             "full rank, from {packing_rows} rows on, J given, more than {packing_cycles} cycles per body", kNncg,
             [](const Facts& facts) { return facts.is_packing ? facts.hybrid_sweeps : 0; },
             "{hybrid_most_sweeps} iterations"},
    AutoRule{kBackends, &AutoLimits::large_rows, "redundant rows", kNncg,
             [](const Facts& facts) {
               const bool holds = facts.is_redundant && !facts.tableau_failed;
               return holds ? NncgIterations(facts, facts.limits->nncg_before_newton) : 0;
             },
             "{nncg_before_newton} factorizations"},
    AutoRule{kBackends, kAnyRows, "full rank, and no packing as above", kBpp,
             [](const Facts& facts) {
               return HasFullRank(facts) && !facts.is_packing ? facts.limits->bpp_factorizations : 0;
             },
             "{bpp_factorizations} factorizations"},
    AutoRule{kBackends, &AutoLimits::large_rows,
             "`bpp` has met dependent rows, its factor is not dense, and `nncg` was not asked", kNncg,
             [](const Facts& facts) {
               const bool holds = facts.has_dependent_rows && !facts.has_dense_factor && !facts.has_swept;
               return holds ? NncgIterations(facts, facts.limits->nncg_before_newton) : 0;
             },
             "{nncg_before_newton} factorizations"},
    AutoRule{kBackends, kAnyRows, "up to {large_rows} rows, or A given dense", kSemismoothNewton,
             [](const Facts& facts) { return If(!facts.is_large); }},
    AutoRule{kBackends, kAnyRows, "`hybrid`, from {hybrid_rows} rows on, and there is a start", kGuess,
             [](const Facts& facts) { return If(facts.has_start && facts.hybrid_sweeps > 0); },
             "the active set of the start, in the time of {guess_sweeps} iterations of `nncg`"},
    AutoRule{kBackends, kAnyRows, "`hybrid`, from {hybrid_rows} rows on", kHybridNncg,
             [](const Facts& facts) { return facts.hybrid_sweeps; }, "{hybrid_most_sweeps}"},
    AutoRule{kBackends, kAnyRows, "`hybrid`", kIpm},
    AutoRule{kBackends, kAnyRows, "more than {large_rows} rows", kSemismoothNewton,
             [](const Facts& facts) { return If(facts.is_large); }},
    AutoRule{kBackends, &AutoLimits::dantzig_rows, "", kDantzig},

    AutoRule{kLast, &AutoLimits::exact_rows, "with friction, sliding or bounded rows: up to {exact_contacts} contacts",
             kExact},
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
    const Index most = rule->most_rows.In(kDefaultLimits);
    text.append("| ").append(most == kAnyRows ? "any" : "≤ " + std::to_string(most));
    text.append(" | ")
        .append(WithDefaults(rule->when))
        .append(" | ")
        .append(quote)
        .append(KeyOf(rule->method))
        .append(quote);
    text.append(" | ").append(WithDefaults(rule->limit)).append(" |\n");
  }
  return text;
}

}  // namespace lcpbench
