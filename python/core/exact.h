#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// The function certify and the class Certificate.
void BindExact(nb::module_& module);

}  // namespace lcpbench::python
