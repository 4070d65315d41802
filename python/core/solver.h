#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// The functions solve and available_solvers, and the class Solver.
void BindSolvers(nb::module_& module);

}  // namespace lcpbench::python
