#include "solvers/rows/fixed_size_kernel.h"
#include "solvers/rows/profile_kernel.h"

namespace lcpbench {

extern const RowsKernel kRowsKernelAvx512{&SolveFewRows, &FactorizeProfile, &SolveProfile};

}  // namespace lcpbench
