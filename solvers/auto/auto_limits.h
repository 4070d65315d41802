#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The numbers by which `auto` decides which method goes when, and how far. kAutoLimits has unit and meaning of each,
/// docs/solvers/auto.md shows them. Every one is a setting of `auto`, for trials (report/report.py thresholds). Numbers
/// that belong to a method, as sizes of its arrays, stand beside it.
struct AutoLimits {
  static constexpr Index kTableau = 128;  ///< SmallPivoting::kMaxRows

  /// \cond  what each is says kAutoLimits
  // What is read in place, and what is divided.
  Index step_rows = 20000;
  Index dense_rows = 1000;
  Index island_rows = 2000;
  Index undivided_rows = 16;
  Index narrow_band = 45;
  Index tableau_rows = 64;
  Index hard_tableau_rows = kTableau;
  double dominant_share = 0.75;
  Index rows_per_cut = 16;
  // Backends.
  Index large_rows = 900;
  double dear_factorization = 6;
  double psor_factorizations = 4;
  double nncg_before_bpp = 6;
  double nncg_before_newton = 12;
  Index least_nncg = 16;
  double sparse_nncg_per_root = 8;
  Index sparse_nncg_patience = 48;
  Index packing_rows = 5000;
  double packing_cycles = 0.25;
  Index bpp_factorizations = 24;
  Index newton_factorizations = 150;
  Index hybrid_rows = 500;
  Index hybrid_least_sweeps = 100;
  Index hybrid_most_sweeps = 600;
  Index analysed_rows = 20000;
  double guess_factorization = 17;
  double guess_sweeps = 90;
  double start_share = 0.5;
  Index dantzig_rows = 5000;
  // Islands with friction, sliding or bounded rows.
  Index warm_steps = 3;
  Index mode_contacts = 16;
  Index mode_steps = 8;
  Index all_modes_contacts = 3;
  Index large_island_rows = 129;
  double fine_tolerance = 1e-7;
  double first_sweeps_per_root = 6;
  double loose_tolerance = 1e-4;
  double sweeps_per_root = 40;
  Index last_sweeps = 20000;
  double newton_rho = 1e-5;
  Index shift_rounds = 2;
  Index path_steps = 2000;
  Index bounds_rounds = 4;
  double bounds_time_share = 0.2;
  Index newton_steps = 30;
  Index lemke_contacts = 128;
  Index proximal_points = 1000;
  // What is still open.
  Index exact_rows = 200;
  Index exact_contacts = 8;
  Index exact_mode_rows = 32;
  Index exact_modes = 256;
  /// \endcond
};

/// What `auto` has without settings.
inline constexpr AutoLimits kDefaultLimits{};

/// One of them.
struct AutoLimit {
  std::string_view name;                                           ///< of the setting
  std::variant<Index AutoLimits::*, double AutoLimits::*> member;  ///< that has it
  double least;                                                    ///< of its values, itself included
  double most;                                                     ///< the same
  std::string_view unit;                                           ///< of its values
  std::string_view meaning;                                        ///< in words

  /// Its value.
  double Of(const AutoLimits& limits) const {
    return std::visit([&](const auto of) { return static_cast<double>(limits.*of); }, member);
  }
  /// @param value  in the range; a fraction of a count is dropped
  void Set(double value, AutoLimits* limits) const {
    const auto set = [&]<typename Number>(Number AutoLimits::*const of) { limits->*of = static_cast<Number>(value); };
    std::visit(set, member);
  }
};

/// All of them, in the order of the members.
inline constexpr std::array kAutoLimits = {
    AutoLimit{"step_rows", &AutoLimits::step_rows, 0, 1e6, "rows", "of a step, or of a sparse A, read in place"},
    AutoLimit{"dense_rows", &AutoLimits::dense_rows, 0, 1e5, "rows",
              "of a dense A read in place; above, a blocked factor pays"},
    AutoLimit{"island_rows", &AutoLimits::island_rows, 0, 1e5, "rows",
              "of an island of a step; one with a larger island is left to the other stages"},
    AutoLimit{"undivided_rows", &AutoLimits::undivided_rows, 0, AutoLimits::kTableau, "rows",
              "of a step that is tried before islands are looked for"},
    AutoLimit{"narrow_band", &AutoLimits::narrow_band, 0, 1e5, "bandwidth",
              "of a sparse A whose factor within the band is cheaper than sweeps"},
    AutoLimit{"tableau_rows", &AutoLimits::tableau_rows, 0, AutoLimits::kTableau, "rows",
              "up to which a dense tableau is tried first"},
    AutoLimit{"hard_tableau_rows", &AutoLimits::hard_tableau_rows, 0, AutoLimits::kTableau, "rows",
              "the same where rows outnumber the bodies' degrees of freedom, or A is nearly full: other methods find "
              "that harder"},
    AutoLimit{"dominant_share", &AutoLimits::dominant_share, 0, 1, "of all rows",
              "in islands that are too large for a tableau, above which dividing does not pay"},
    AutoLimit{"rows_per_cut", &AutoLimits::rows_per_cut, 1, 1e9, "rows",
              "one idle row in so many may cut an island into pieces of a tableau's size: the longest piece of a chain "
              "cut at random is some ln(cuts) times the mean one"},
    AutoLimit{"large_rows", &AutoLimits::large_rows, 0, 1e9, "rows",
              "above which `hybrid` is faster than the semismooth Newton method on every redundant family"},
    AutoLimit{"dear_factorization", &AutoLimits::dear_factorization, 0, 1e9, "iterations of `nncg`",
              "a factorization that costs more is put off"},
    AutoLimit{"psor_factorizations", &AutoLimits::psor_factorizations, 0, 1e9, "factorizations",
              "what `psor` may cost, which is asked only where it is the cheapest"},
    AutoLimit{"nncg_before_bpp", &AutoLimits::nncg_before_bpp, 0, 1e9, "factorizations",
              "what `nncg` may cost before `bpp`: about what that needs where it does well"},
    AutoLimit{"nncg_before_newton", &AutoLimits::nncg_before_newton, 0, 1e9, "factorizations",
              "what `nncg` may cost before the Newton method: half of what that needs on redundant rows"},
    AutoLimit{"least_nncg", &AutoLimits::least_nncg, 0, 1e9, "iterations", "that `nncg` has in any case"},
    AutoLimit{"sparse_nncg_per_root", &AutoLimits::sparse_nncg_per_root, 0, 1e9, "iterations by √n",
              "of `nncg` on a wide sparse A; on grids they grow so"},
    AutoLimit{"sparse_nncg_patience", &AutoLimits::sparse_nncg_patience, 0, 1e9, "iterations",
              "before the rate of that `nncg` is looked at: it rises once the active set is nearly found"},
    AutoLimit{
        "packing_rows", &AutoLimits::packing_rows, 0, 1e9, "rows",
        "from which on packings are swept first; below, block pivoting is set up in so short a time that it pays"},
    AutoLimit{"packing_cycles", &AutoLimits::packing_cycles, 0, 1e9, "cycles per body",
              "above which it is a packing; up to here a factor has so little fill that `bpp` is the fastest"},
    AutoLimit{"bpp_factorizations", &AutoLimits::bpp_factorizations, 0, 1e9, "factorizations",
              "of `bpp`, which has met cycles where it needs more"},
    AutoLimit{"newton_factorizations", &AutoLimits::newton_factorizations, 1, 1e9, "factorizations",
              "of the semismooth Newton method, which needs 10 to 70 up to 1000 rows"},
    AutoLimit{"hybrid_rows", &AutoLimits::hybrid_rows, 0, 1e9, "rows",
              "from which on `hybrid` sweeps first; below, a factorization takes no longer than a few sweeps"},
    AutoLimit{"hybrid_least_sweeps", &AutoLimits::hybrid_least_sweeps, 0, 1e5, "iterations",
              "of the sweeps of `hybrid` in any case"},
    AutoLimit{"hybrid_most_sweeps", &AutoLimits::hybrid_most_sweeps, 0, 1e5, "iterations",
              "of the same while their rate promises an answer; 0: the interior point at once"},
    AutoLimit{"analysed_rows", &AutoLimits::analysed_rows, 0, 1e9, "rows",
              "above which `hybrid` orders and analyses only where its sweeps do not arrive"},
    AutoLimit{"guess_factorization", &AutoLimits::guess_factorization, 0, 1e9, "iterations of `nncg`",
              "that a factorization may cost for `hybrid` to try the active set of a start first"},
    AutoLimit{"guess_sweeps", &AutoLimits::guess_sweeps, 0, 1e9, "iterations of `nncg`",
              "that all pivots from there may cost"},
    AutoLimit{"start_share", &AutoLimits::start_share, 0, 1, "of rho of f = 0",
              "below which the rho of a start must lie for `hybrid` to use it"},
    AutoLimit{"dantzig_rows", &AutoLimits::dantzig_rows, 0, 1e5, "rows",
              "of `dantzig`: its A takes 0.2 GB then, and a solve minutes"},
    AutoLimit{"warm_steps", &AutoLimits::warm_steps, 0, 2000, "steps", "of Newton's method from the modes of a start"},
    AutoLimit{"mode_contacts", &AutoLimits::mode_contacts, 0, 1e9, "contacts",
              "up to which full Newton steps from 0 come before the relaxation"},
    AutoLimit{"mode_steps", &AutoLimits::mode_steps, 0, 2000, "steps", "of these"},
    AutoLimit{"all_modes_contacts", &AutoLimits::all_modes_contacts, 0, 6, "contacts",
              "up to which all modes are tried"},
    AutoLimit{"large_island_rows", &AutoLimits::large_island_rows, 1, 1e9, "rows",
              "from which on islands are swept first: the relaxation may take longer than all these sweeps"},
    AutoLimit{"fine_tolerance", &AutoLimits::fine_tolerance, 0, 1, "tolerance",
              "below which large islands are not swept first"},
    AutoLimit{"first_sweeps_per_root", &AutoLimits::first_sweeps_per_root, 0, 1e9, "sweeps a digit by √n",
              "of the first sweeps of large islands: forces travel a row or so a sweep"},
    AutoLimit{"loose_tolerance", &AutoLimits::loose_tolerance, 0, 1, "tolerance",
              "below which sweeps do not go on before Newton steps, but come after all others"},
    AutoLimit{"sweeps_per_root", &AutoLimits::sweeps_per_root, 0, 1e9, "sweeps by √n", "that go on there"},
    AutoLimit{"last_sweeps", &AutoLimits::last_sweeps, 0, 1e9, "sweeps", "that come after all others"},
    AutoLimit{"newton_rho", &AutoLimits::newton_rho, 0, 1, "rho",
              "of sweeps below which their modes may be the answer's, and Newton steps are tried"},
    AutoLimit{"shift_rounds", &AutoLimits::shift_rounds, 1, 2000, "rounds", "of the relaxation"},
    AutoLimit{"path_steps", &AutoLimits::path_steps, 0, 2000, "steps", "of the central path"},
    AutoLimit{"bounds_rounds", &AutoLimits::bounds_rounds, 0, 2000, "rounds", "of lagged bounds"},
    AutoLimit{"bounds_time_share", &AutoLimits::bounds_time_share, 0, 1, "of the time left", "for lagged bounds"},
    AutoLimit{"newton_steps", &AutoLimits::newton_steps, 0, 2000, "steps",
              "of mode-newton on islands that are not large"},
    AutoLimit{"lemke_contacts", &AutoLimits::lemke_contacts, 0, 1e9, "contacts", "up to which Lemke's path is tried"},
    AutoLimit{"proximal_points", &AutoLimits::proximal_points, 0, 2000, "points", "of the last method of these"},
    AutoLimit{"exact_rows", &AutoLimits::exact_rows, 0, 1e5, "rows", "of exact solves"},
    AutoLimit{"exact_contacts", &AutoLimits::exact_contacts, 0, 100, "contacts",
              "of exact solves with friction, sliding or bounded rows, or of an A that is not semidefinite"},
    AutoLimit{"exact_mode_rows", &AutoLimits::exact_mode_rows, 0, 1000, "rows",
              "of these; a step of their path is O(n³) rational operations"},
    AutoLimit{"exact_modes", &AutoLimits::exact_modes, 0, 1e6, "modes",
              "of these that are all tried, in about a second; above, a path is followed"},
};
static_assert(sizeof(AutoLimits) == 8 * kAutoLimits.size());  // none is left out

/// Words in which {name} stands for the default of a limit.
std::string WithDefaults(std::string_view words);
/// The table for docs/solvers/auto.md, as `lcpbench list limits` prints it.
std::string AutoLimitsAsMarkdown();

}  // namespace lcpbench
