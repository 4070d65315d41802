#include "solvers/peers/tier_settings.h"

#include <stdexcept>
#include <string>

namespace lcpbench {
namespace {

constexpr std::array kTableTiers{1e-3, 1e-6, 1e-9};
// A requested 1e-6 may arrive with the last digit off.
constexpr double kSlack = 1 + 1e-9;

constexpr TierSettings kTable[] = {
    {"dart-pgs", {1e-3, 1e-6, 1e-9}, 1e6, "largest relative change of a force in one sweep"},
    {"clp", {1e-3, 1e-6, 1e-9}, 0, "primal and dual tolerance alike"},
    {"siconos-newton-fb", {1e-5, 1e-8, 1e-10}, 1e6, "||min(f, w)|| over ||b||"},
    {"siconos-pgs", {1e-4, 1e-7, 1e-10}, 1e9, "||min(f, w)|| over ||b||"},
    {"siconos-nsgs-sbm", {1e-4, 1e-7, 1e-10}, 1e9, "||min(f, w)|| over ||b||"},
    {"petsc-rsls", {1e-3, 1e-6, 1e-9}, 1e6, "norm of w on the free rows, relative to the start"},
    {"petsc-ssls", {1e-6, 1e-8, 1e-11}, 1e6, "norm of the Fischer-Burmeister function, relative to the start"},
    {"tao-bntr", {1e-3, 1e-6, 1e-9}, 1e6, "projected gradient, relative to the start"},
    {"tao-tron", {1e-3, 1e-6, 1e-9}, 1e6, "projected gradient, relative to the start"},
};

const TierSettings& Row(std::string_view key) {
  for (const TierSettings& row : kTable) {
    if (row.key == key) return row;
  }
  throw std::logic_error("no tier settings for " + std::string(key));
}

}  // namespace

std::span<const TierSettings> TierTable() { return kTable; }

double TierTolerance(std::string_view key, double tolerance) {
  const TierSettings& row = Row(key);
  std::size_t tier = 0;
  while (tier + 1 < kTableTiers.size() && kTableTiers[tier] > tolerance * kSlack) ++tier;
  return row.tolerances[tier];
}

double TierIterations(std::string_view key) { return Row(key).most_iterations; }

}  // namespace lcpbench
