#include "solvers/rows/kernel.h"

namespace lcpbench {

const RowsKernel& FindRowsKernel(InstructionSet instructions) {
  static constexpr KernelTable<const RowsKernel*> kKernels{&kRowsKernelSse2, &kRowsKernelAvx2, &kRowsKernelAvx512};
  return *FindKernel(kKernels, instructions);
}

}  // namespace lcpbench
