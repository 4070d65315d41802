#include "solvers/linear_algebra/instruction_set.h"

#include <array>
#include <string>

#include "support/input_error.h"

namespace lcpbench {
namespace {

struct Known {
  InstructionSet set;
  std::string_view name;
  bool (*is_available)();
};

// The widest last, as kBest has it, too.
constexpr std::array kKnown{
    Known{InstructionSet::kSse2, "sse2", [] { return true; }},
    Known{InstructionSet::kAvx2, "avx2",
          [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; }},
    Known{InstructionSet::kAvx512, "avx512",
          [] {
            return __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("avx512f") != 0 &&
                   __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
          }},
};

}  // namespace

InstructionSet FindInstructionSet(InstructionSet set) {
  for (auto known = kKnown.rbegin(); known != kKnown.rend(); ++known) {
    const bool is_wanted = set == InstructionSet::kBest || known->set == set;
    if (is_wanted && known->is_available()) return known->set;
  }
  throw InputError("this machine has no " + std::string(ToString(set)));
}

std::string_view ToString(InstructionSet set) {
  for (const Known& known : kKnown) {
    if (known.set == set) return known.name;
  }
  return "best";
}

InstructionSet InstructionSetOf(std::string_view name) {
  for (const Known& known : kKnown) {
    if (known.name == name) return known.set;
  }
  return InstructionSet::kBest;
}

std::vector<InstructionSet> AvailableInstructionSets() {
  std::vector<InstructionSet> available;
  for (const Known& known : kKnown) {
    if (known.is_available()) available.push_back(known.set);
  }
  return available;
}

}  // namespace lcpbench
