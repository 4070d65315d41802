#pragma once

#include "python/core/arrays.h"

namespace lcpbench::python {

/// The class Scene: one instant of a scene family or a scene file, its problem, picture and motion.
void BindScenes(nb::module_& module);

}  // namespace lcpbench::python
