#pragma once

#include <functional>
#include <string>
#include <vector>

namespace lcpbench {

/// Runs `act`; an InputError becomes one line on standard error. @return 0, or 2 then
int TellRefusal(const std::function<void()>& act);

/// ReadEachLine (gzip_file.h) for several files, going on after a line or file that is refused (reported as by
/// TellRefusal), so that nothing already computed is lost. A file whose first line is not a JSON object is a
/// wrong one: one line says so, and the rest is not read. In other files each reason is reported once, ten at most,
/// then the number of further lines. @return 0, or 2 when something was refused
int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle);

}  // namespace lcpbench
