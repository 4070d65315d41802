#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupAvx512(BatchGroup* group) { SolveGroup(group); }

}  // namespace lcpbench
