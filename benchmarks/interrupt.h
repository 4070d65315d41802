#pragma once

#include <csignal>

namespace lcpbench {

/// While one lives, the first Ctrl-C (SIGINT) or SIGTERM is noted instead of ending the program, so that what was
/// computed can be brought to an orderly end; the second one ends it.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// True once a signal came.
  static bool Requested();
  /// The exit status of a program that the signal ended: 128 + its number.
  static int ExitStatus();

 private:
  struct sigaction interrupt_before_;
  struct sigaction terminate_before_;
};

}  // namespace lcpbench
