#include "solvers/peers/tier_settings.h"

#include <stdexcept>
#include <string>

namespace lcpbench {
namespace {

constexpr std::array kTableTiers{1e-3, 1e-6, 1e-9};
// A requested 1e-6 may arrive with the last digit off.
constexpr double kSlack = 1 + 1e-9;

constexpr std::array kTable{
    TierOption{"dart-pgs",
               "relative-tolerance",
               {1e-3, 1e-6, 1e-9},
               "largest relative change of a force in one sweep; by the rule: 163, 162 and 163 of 163 pass"},
    TierOption{"dart-pgs", "sweeps", {1e6, 1e6, 1e6}, "its own 30 suffice for few problems: the time limit decides"},
    TierOption{"clp",
               "tolerance",
               {1e-3, 1e-6, 1e-9},
               "primal and dual tolerance alike (its own: 1e-7); by the rule: 163, 163 and 162 of 163 pass"},
    TierOption{
        "siconos-newton-fb", "tolerance", {1e-3, 1e-6, 1e-9}, "the ladder's loosest value that passes, see the rule"},
    TierOption{"siconos-newton-fb", "iterations", {1e6, 1e6, 1e6}, "its own 1000: the time limit decides"},
    TierOption{"siconos-pgs", "tolerance", {1e-3, 1e-6, 1e-9}, "the ladder's loosest value that passes, see the rule"},
    TierOption{"siconos-pgs", "iterations", {1e9, 1e9, 1e9}, "its own 10000: the time limit decides"},
    TierOption{
        "siconos-nsgs-sbm", "tolerance", {1e-3, 1e-6, 1e-9}, "the ladder's loosest value that passes, see the rule"},
    TierOption{"siconos-nsgs-sbm", "iterations", {1e9, 1e9, 1e9}, "its own 1000: the time limit decides"},
    TierOption{"petsc-rsls", "tolerance", {1e-3, 1e-6, 1e-9}, "tuning"},
    TierOption{"petsc-rsls", "iterations", {1e6, 1e6, 1e6}, "its own 50: the time limit decides"},
    TierOption{"petsc-ssls", "tolerance", {1e-3, 1e-6, 1e-9}, "tuning"},
    TierOption{"petsc-ssls", "iterations", {1e6, 1e6, 1e6}, "its own 50: the time limit decides"},
    TierOption{"tao-bntr", "tolerance", {1e-3, 1e-6, 1e-9}, "tuning"},
    TierOption{"tao-bntr", "iterations", {1e6, 1e6, 1e6}, "its own 50: the time limit decides"},
    TierOption{"tao-tron", "tolerance", {1e-3, 1e-6, 1e-9}, "tuning"},
    TierOption{"tao-tron", "iterations", {1e6, 1e6, 1e6}, "its own 50: the time limit decides"},
};

}  // namespace

std::span<const TierOption> TierTable() { return kTable; }

double TierValue(std::string_view key, std::string_view option, double tolerance) {
  for (const TierOption& row : kTable) {
    if (row.key != key || row.option != option) continue;
    for (std::size_t tier = 0; tier < kTableTiers.size(); ++tier) {
      if (kTableTiers[tier] <= tolerance * kSlack) return row.values[tier];
    }
    return row.values.back();
  }
  throw std::logic_error("no tier settings for " + std::string(key) + ", " + std::string(option));
}

}  // namespace lcpbench
