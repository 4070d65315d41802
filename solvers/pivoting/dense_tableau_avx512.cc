#include "solvers/pivoting/dense_tableau.h"

namespace lcpbench {

bool SolveTableauAvx512(TableauWork* work) { return DenseTableau(work).Solve(); }

}  // namespace lcpbench
