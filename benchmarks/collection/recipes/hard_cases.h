#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "model/contact/system.h"

namespace lcpbench {

/// A seeded system that is meant to break something, for the collection's tier `pathological`. Its numbers are chosen
/// so that what is said of it holds exactly for the doubles of J and b.
struct HardCase {
  std::string_view key;
  std::string_view purpose;  ///< what it is meant to break, one sentence
  /// Exactly `rows` rows where the case can, else one more or less. The same bits for the same seed on every machine.
  ContactSystem (*generate)(int rows, std::uint64_t seed);
};

std::span<const HardCase> AllHardCases();

}  // namespace lcpbench
