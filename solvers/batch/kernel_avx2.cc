#include "solvers/batch/lanes_avx2.h"
#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupAvx2(BatchGroup* group) { SolveGroup<LanesAvx2>(group); }

}  // namespace lcpbench
