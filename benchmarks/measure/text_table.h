#pragma once

#include <string>
#include <vector>

namespace lcpbench {

/// Three digits in the unit that fits: "4.12 µs"; "-" where it is not finite.
std::string TimeText(double seconds);

/// Lines of columns that are as wide as their widest cell.
std::string FormatTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace lcpbench
