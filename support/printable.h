#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lcpbench {

/// Text of others (names, lines of files, messages of programs) as it may stand in one line on a terminal: control
/// characters, U+2028, U+2029 and bytes that are not UTF-8 [RFC 3629] are written \n, \t, \r or \xNN, byte by byte; the
/// rest stays.
std::string Printable(std::string_view text);

/// The same of at most `longest` bytes, with "..." in the place of others.
std::string Excerpt(std::string_view text, std::size_t longest);

}  // namespace lcpbench
