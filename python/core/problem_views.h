#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// What a problem is made of, as members of the class Problem, for functions that solve it.
void BindProblemViews(nb::module_& module);

}  // namespace lcpbench::python
