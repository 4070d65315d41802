#pragma once

#include <string>

namespace lcpbench {

/// The folder that the running program's file lies in: what is installed with a program is found from there, wherever
/// the whole was moved. "." where the system does not tell.
std::string ProgramFolder();

}  // namespace lcpbench
