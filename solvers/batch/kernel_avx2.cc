#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupAvx2(BatchGroup* group) { SolveGroup(group); }

}  // namespace lcpbench
