#include "solvers/batch/lanes_sse2.h"
#include "solvers/batch/tableau_kernel.h"

namespace lcpbench {

void SolveGroupSse2(BatchGroup* group) { SolveGroup<LanesSse2>(group); }

}  // namespace lcpbench
