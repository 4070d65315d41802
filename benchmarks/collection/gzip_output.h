#pragma once

#include <string>

namespace lcpbench {

/// Writes `text` compressed by gzip, without name and time: the same text gives the same bytes.
/// @throws InputError where the file cannot be written
void WriteGzipFile(const std::string& path, const std::string& text);

}  // namespace lcpbench
