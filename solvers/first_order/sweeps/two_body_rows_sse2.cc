#include "solvers/first_order/sweeps/two_body_rows.h"

namespace lcpbench {

RowKernel* NewTwoBodyRowsSse2(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows) {
  return NewRows(scaled, p, in_sets, rows);
}

}  // namespace lcpbench
