#pragma once

#include <string>

namespace lcpbench {

/// As in problem_laws.h, for the bytes of an HDF5 file. Apart from those, so that they need no HDF5.
std::string BrokenFclibLaw(const std::string& bytes);

}  // namespace lcpbench
