#pragma once

#include "model/contact/loads.h"
#include "model/scene_file/body_reader.h"
#include "support/json_field.h"

namespace lcpbench {

/// Reads "loads", without gravity, which stands at the top of the file; scene_file.h lists the forms.
/// @param bodies  whose forces and torques are used to try the loads out, and 0 afterwards
/// @throws InputError naming the JSON path, also for loads that loads.h refuses at the start of the motion
Loads ReadLoads(const JsonField& field, SceneBodies* bodies);

}  // namespace lcpbench
