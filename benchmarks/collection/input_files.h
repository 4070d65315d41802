#pragma once

#include <functional>
#include <istream>
#include <string>
#include <vector>

namespace lcpbench {

/// Calls `handle(line, "file:line")` for every non-empty line of a file ("-" is standard input), plain or compressed by
/// gzip, told apart by the first byte.
/// @throws InputError where the file cannot be read or has no line, and what `handle` throws
void ReadEachLine(const std::string& path,
                  const std::function<void(const std::string& line, const std::string& where)>& handle);

/// The same for several files, going on after mistakes: a line or file that is refused with InputError is told on
/// standard error, one line each, and the next one is taken, so that nothing already computed is lost. A file without
/// any line is refused as well.
/// @return 0, or 2 when something was refused
int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle);

}  // namespace lcpbench
