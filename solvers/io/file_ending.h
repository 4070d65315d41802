#pragma once

#include <string>

namespace lcpbench {

/// A file's name taken apart at its ending, which tells its format whatever the case of its letters; any text format
/// may be compressed by gzip, and its name then ends in .gz besides. "dir/UP.MTX.gz" is
struct FileEnding {
  std::string stem;      ///< "dir/UP"
  std::string ending;    ///< ".MTX.gz"
  std::string format;    ///< ".mtx"; "" where there is none
  bool is_gzip = false;  ///< whether it ends in .gz
};
/// Takes a path apart.
FileEnding EndingOf(const std::string& path);

/// The id of a problem whose file does not give one: its name without folders and ending.
std::string IdOfFile(const std::string& path);

}  // namespace lcpbench
