#include "solvers/batch/instructions.h"

#include <array>
#include <string>

#include "solvers/batch/kernel.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct InstructionSet {
  BatchInstructions instructions;
  std::string_view name;
  BatchKernels kernels;
  bool (*is_available)();
};

// The widest last.
constexpr std::array kSets{
    InstructionSet{BatchInstructions::kSse2, "sse2", {2, &SolveGroupSse2}, [] { return true; }},
    InstructionSet{BatchInstructions::kAvx2,
                   "avx2",
                   {4, &SolveGroupAvx2},
                   [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; }},
    InstructionSet{BatchInstructions::kAvx512,
                   "avx512",
                   {8, &SolveGroupAvx512},
                   [] {
                     return __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("avx512f") != 0 &&
                            __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
                   }},
};

}  // namespace

const BatchKernels& FindBatchKernels(BatchInstructions instructions) {
  for (auto set = kSets.rbegin(); set != kSets.rend(); ++set) {
    const bool is_wanted = instructions == BatchInstructions::kBest || set->instructions == instructions;
    if (is_wanted && set->is_available()) return set->kernels;
  }
  throw InputError("batch: this machine has no " + std::string(ToString(instructions)));
}

std::string_view ToString(BatchInstructions instructions) {
  for (const InstructionSet& set : kSets) {
    if (set.instructions == instructions) return set.name;
  }
  return "best";
}

std::vector<BatchInstructions> AvailableBatchInstructions() {
  std::vector<BatchInstructions> available;
  for (const InstructionSet& set : kSets) {
    if (set.is_available()) available.push_back(set.instructions);
  }
  return available;
}

}  // namespace lcpbench
