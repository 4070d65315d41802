#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// The function derivative, and the classes Derivative, SolutionChange and Gradient.
void BindDerivative(nb::module_& module);

}  // namespace lcpbench::python
