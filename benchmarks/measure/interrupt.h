#pragma once

#include <csignal>

namespace lcpbench {

/// Thrown by Interruption::Check, for the one who keeps the Interruption to catch.
struct Interrupted {};

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
  /// Ends what is under way, where that takes long: throws Interrupted once a signal came.
  static void Check();
  /// The exit status of a program that the signal ended: 128 + its number.
  static int ExitStatus();

 private:
  struct sigaction interrupt_before_;
  struct sigaction terminate_before_;
};

}  // namespace lcpbench
