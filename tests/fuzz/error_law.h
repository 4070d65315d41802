#pragma once

#include <functional>
#include <string>

#include "support/input_error.h"

namespace lcpbench {

/// What is wrong with the error text of bad input: nothing, "", if it is one line that begins with `beginning`.
inline std::string BrokenErrorLaw(const std::string& error, const std::string& beginning) {
  if (error.find('\n') != std::string::npos) return "an error of several lines: " + error;
  if (!error.starts_with(beginning)) return "an error that does not begin with its place: " + error;
  return "";
}

/// What `check` says of bytes that are read; of bytes that are not, what is wrong with the InputError.
///
/// @param check  sets its argument when the bytes were read: from then on no InputError is due
inline std::string BrokenReadingLaw(const std::string& beginning,
                                    const std::function<std::string(bool* is_read)>& check) {
  bool is_read = false;
  try {
    return check(&is_read);
  } catch (const InputError& error) {
    if (is_read) return std::string("what was read is not written, or refused: ") + error.what();
    return BrokenErrorLaw(error.what(), beginning);
  }
}

}  // namespace lcpbench
