#pragma once

#include <functional>
#include <string>
#include <vector>

namespace lcpbench {

/// Runs `act`; what it refuses with InputError is told on standard error, in one line. @return 0, or 2 then
int TellRefusal(const std::function<void()>& act);

/// ReadEachLine (gzip_file.h) for several files, going on after a line or file that is refused, which is told as by
/// TellRefusal, so that nothing already computed is lost. A file whose first line is no JSON object is a wrong one:
/// that is told, and nothing more is read of it. Of others each reason is told once, at most ten of them, then how many
/// more lines there are. @return 0, or 2 when something was refused
int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle);

}  // namespace lcpbench
