#pragma once

#include <string>

namespace lcpbench {

/// NAME.json of data/. @throws InputError where it is neither in the working directory's, nor in that
/// installed with the program, nor in the source tree's
std::string DataFile(const std::string& name);

}  // namespace lcpbench
