#include "solvers/peers/tier_settings.h"

#include <stdexcept>
#include <string>

namespace lcpbench {
namespace {

constexpr std::array kTiers3{1e-3, 1e-6, 1e-9};
// A requested 1e-6 may arrive with the last digit off.
constexpr double kSlack = 1 + 1e-9;

constexpr std::array kTable{
    TierOption{"dart-pgs", "relative-tolerance", {1e-3, 1e-6, 1e-9}, "TBD"},
    TierOption{"dart-pgs", "sweeps", {1e6, 1e6, 1e6}, "its own 30 rarely suffice; the time limit decides"},
    TierOption{"clp", "tolerance", {1e-3, 1e-6, 1e-9}, "TBD"},
};

}  // namespace

std::span<const TierOption> TierTable() { return kTable; }

double TierValue(std::string_view key, std::string_view option, double tolerance) {
  for (const TierOption& row : kTable) {
    if (row.key != key || row.option != option) continue;
    for (std::size_t tier = 0; tier < kTiers3.size(); ++tier) {
      if (kTiers3[tier] <= tolerance * kSlack) return row.values[tier];
    }
    return row.values.back();
  }
  throw std::logic_error("no tier settings for " + std::string(key) + ", " + std::string(option));
}

}  // namespace lcpbench
