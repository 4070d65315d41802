#pragma once

#include <cstring>
#include <stdexcept>
#include <string>

namespace lcpbench {

/// Output is lost: a full disk, a closed standard output. No InputError, as it ends the whole command. The command
/// prints what() on standard error and exits with kLostOutput; where the reader of a pipe has gone, it says nothing.
class OutputError : public std::runtime_error {
 public:
  /// @param error  as errno, why
  OutputError(const std::string& name, int error)
      : std::runtime_error(name + ": writing failed: " + std::strerror(error)), error_(error) {}

  int error() const { return error_; }

 private:
  int error_;
};

}  // namespace lcpbench
