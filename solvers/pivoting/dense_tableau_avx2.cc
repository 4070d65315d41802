#include "solvers/pivoting/dense_tableau.h"

namespace lcpbench {

bool SolveTableauAvx2(TableauWork* work) { return DenseTableau(work).Solve(); }

}  // namespace lcpbench
