#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lcpbench {

/// Names and versions of the numerical libraries that the solvers of this build are linked with, BLAS as loaded at run
/// time included.
std::vector<std::pair<std::string, std::string>> LibraryVersions();

}  // namespace lcpbench
