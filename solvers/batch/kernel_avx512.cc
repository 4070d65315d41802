#include "solvers/batch/lanes_avx512.h"
#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupAvx512(BatchGroup* group) { SolveGroup<LanesAvx512>(group); }

}  // namespace lcpbench
