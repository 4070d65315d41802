#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupAvx2(BatchGroup* group) { SolveGroup(group); }
void SolveRowsAvx2(RowGroup* group) { SolveRows(group); }

}  // namespace lcpbench
