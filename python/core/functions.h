#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// serve: a function of Python as the solver at the other end of a campaign's socket.
void BindFunctions(nb::module_& module);

}  // namespace lcpbench::python
