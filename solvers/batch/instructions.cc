#include "solvers/batch/instructions.h"

#include <string>

#include "support/input_error.h"

namespace lcpbench {
namespace {

bool HasAvx2() { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; }
bool HasAvx512() {
  return HasAvx2() && __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
}

}  // namespace

std::string_view ToString(BatchInstructions instructions) {
  switch (instructions) {
    case BatchInstructions::kBest:
      return "best";
    case BatchInstructions::kSse2:
      return "sse2";
    case BatchInstructions::kAvx2:
      return "avx2";
    case BatchInstructions::kAvx512:
      return "avx512";
  }
  return "unknown";
}

std::vector<BatchInstructions> AvailableBatchInstructions() {
  std::vector<BatchInstructions> available = {BatchInstructions::kSse2};
  if (HasAvx2()) available.push_back(BatchInstructions::kAvx2);
  if (HasAvx512()) available.push_back(BatchInstructions::kAvx512);
  return available;
}

BatchKernelEntry FindBatchKernel(BatchInstructions instructions) {
  const std::vector<BatchInstructions> available = AvailableBatchInstructions();
  if (instructions == BatchInstructions::kBest) instructions = available.back();
  for (const BatchInstructions entry : available) {
    if (entry != instructions) continue;
    switch (instructions) {
      case BatchInstructions::kAvx512:
        return {instructions, 8, &SolveGroupAvx512};
      case BatchInstructions::kAvx2:
        return {instructions, 4, &SolveGroupAvx2};
      default:
        return {instructions, 2, &SolveGroupSse2};
    }
  }
  throw InputError("batch: this machine has no " + std::string(ToString(instructions)));
}

}  // namespace lcpbench
