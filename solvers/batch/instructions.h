#pragma once

#include "solvers/batch/kernel.h"
#include "solvers/batch/solve_batch.h"

/// Internal to solvers/batch/.
namespace lcpbench {

struct BatchKernelEntry {
  BatchInstructions instructions;
  int lanes;
  BatchKernel kernel;
};

/// @throws InputError if this machine lacks them
BatchKernelEntry FindBatchKernel(BatchInstructions instructions);

}  // namespace lcpbench
