#pragma once

#include <string>

namespace lcpbench {

/// The shortest text that reads back as the same double.
std::string NumberText(double value);

}  // namespace lcpbench
