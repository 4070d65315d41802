#include "solvers/pivoting/dense_tableau.h"

namespace lcpbench {

bool SolveTableauSse2(TableauWork* work) { return DenseTableau(work).Solve(); }

}  // namespace lcpbench
