#pragma once

#include <stdexcept>
#include <string>

namespace lcpbench {

/// A user's mistake: a bad file, an unknown name, an impossible option. what() is one line that names the file, line or
/// field and what was expected. The command prints it on standard error and exits with status 2.
class InputError : public std::runtime_error {
 public:
  /// @param message  one line, without its end
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace lcpbench
