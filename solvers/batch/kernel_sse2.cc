#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupSse2(BatchGroup* group) { SolveGroup(group); }

}  // namespace lcpbench
