#pragma once

#include <string>
#include <vector>

namespace lcpbench {

/// The first words of a command line that runs a Python program of ours: the interpreter, which is $LCPBENCH_PYTHON,
/// else Debian's, which its NumPy, pandas, SciPy, h5py and matplotlib belong to and which need not be the first on
/// PATH, without the caller's PYTHONPATH and PYTHONHOME, which may be meant for another; and the program. That of an
/// installed command is the one installed with it.
/// @param from_program  where it is installed, from the running program's folder
/// @param in_source     where it is in the source tree
/// @throws InputError where it is at neither place
std::vector<std::string> PythonCommand(const std::string& from_program, const std::string& in_source);

}  // namespace lcpbench
