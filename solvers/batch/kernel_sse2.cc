#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupSse2(BatchGroup* group) { SolveGroup(group); }
void SolveRowsSse2(RowGroup* group) { SolveRows(group); }

}  // namespace lcpbench
