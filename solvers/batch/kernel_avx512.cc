#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupAvx512(BatchGroup* group) { SolveGroup(group); }
void SolveRowsAvx512(RowGroup* group) { SolveRows(group); }

}  // namespace lcpbench
