#pragma once

#include <vector>

#include "model/contact/system.h"
#include "model/scene_file/body_reader.h"
#include "support/json_field.h"

namespace lcpbench {

/// Reads "joints"; scene_file.h lists the forms. @throws InputError naming the JSON path
std::vector<Constraint> ReadJoints(const JsonField& field, const SceneBodies& bodies);

}  // namespace lcpbench
