#pragma once

#include <vector>

#include "model/json_field.h"
#include "model/scene_file/body_reader.h"
#include "model/system.h"

namespace lcpbench {

/// Reads "joints"; scene_file.h lists the forms. @throws InputError naming the JSON path
std::vector<Constraint> ReadJoints(const JsonField& field, const SceneBodies& bodies);

}  // namespace lcpbench
