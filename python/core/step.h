#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// The classes StepSolver, StepAnswer and BatchAnswer.
void BindStep(nb::module_& module);

}  // namespace lcpbench::python
