#pragma once

#include <string>

namespace lcpbench {

/// What is wrong with the error text of bad input: nothing, "", if it is one line that begins with `beginning`.
inline std::string BrokenErrorLaw(const std::string& error, const std::string& beginning) {
  if (error.find('\n') != std::string::npos) return "an error of several lines: " + error;
  if (!error.starts_with(beginning)) return "an error that does not begin with its place: " + error;
  return "";
}

}  // namespace lcpbench
