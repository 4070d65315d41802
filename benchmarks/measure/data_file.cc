#include "benchmarks/measure/data_file.h"

#include <filesystem>

#include "build_info.h"
#include "support/input_error.h"
#include "support/program_folder.h"

namespace lcpbench {

std::string DataFile(const std::string& name) {
  const std::string installed = ProgramFolder() + "/" + kDataFolderFromProgram;
  for (const std::string& folder : {std::string("data"), installed, std::string(kDataFolder)}) {
    std::string path = folder + "/" + name + ".json";
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError("data/" + name + ".json: not there, nor in " + kDataFolder);
}

}  // namespace lcpbench
