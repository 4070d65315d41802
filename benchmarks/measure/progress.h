#pragma once

#include <csignal>
#include <string>

namespace lcpbench {

/// A progress bar on standard error with elapsed and remaining time. On a terminal one line that redraws itself;
/// elsewhere (a log) one line per tenth.
class ProgressBar {
 public:
  /// @param total  the sum of the weights of all steps, > 0
  ProgressBar(std::string title, double total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// A step of this weight is done; `label` says what comes or came.
  void Advance(double weight, const std::string& label);

 private:
  void Draw(const std::string& label);

  std::string title_;
  double total_;
  double done_ = 0;
  double start_;
  double last_drawn_ = -1;
  int last_tenth_ = -1;
  bool terminal_;
};

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
