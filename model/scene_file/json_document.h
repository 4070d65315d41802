#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace lcpbench {

/// Arrays and objects in each other beyond this are refused: no file of ours is half as deep.
inline constexpr std::size_t kMaxJsonDepth = 32;

/// A JSON document [RFC 8259] written by hand: unlike the plain parser it refuses a key that stands twice in one object
/// (one of the two would be lost unseen). Time and memory proportional to the text, recursion none.
/// @throws InputError, one line: where, then line and column of what is not JSON, or the JSON pointer of a repeated
///         key, of a value nested deeper than kMaxJsonDepth, of a number beyond the range of double
nlohmann::json ParseJsonDocument(std::string_view text, const std::string& where);

}  // namespace lcpbench
