#pragma once

#include <ostream>
#include <string_view>
#include <vector>

namespace lcpbench {

/// Instruction sets that the kernels of batches are compiled for. kBest: the widest of those that this machine has.
enum class BatchInstructions { kBest, kSse2, kAvx2, kAvx512 };

/// "best", "sse2", "avx2", "avx512".
std::string_view ToString(BatchInstructions instructions);
/// Writes the name by which tests and messages call it.
inline std::ostream& operator<<(std::ostream& out, BatchInstructions instructions) {
  return out << ToString(instructions);
}

/// What this machine has, narrowest first; never empty.
std::vector<BatchInstructions> AvailableBatchInstructions();

/// Internal to solvers/batch/: the kernels of one instruction set.
struct BatchKernels;
/// @throws InputError if this machine lacks the instructions
const BatchKernels& FindBatchKernels(BatchInstructions instructions);

}  // namespace lcpbench
