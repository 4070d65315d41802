#pragma once

#include <sys/time.h>

#include <algorithm>
#include <cmath>
#include <csignal>

namespace lcpbench {

/// For libraries whose loops read no clock, but a limit that can be changed from outside: while it lives, a signal
/// calls `action` once, `seconds` from its construction on. One at a time.
class Alarm {
 public:
  /// @param action  may do no more than a signal handler may: write a number, say
  Alarm(double seconds, void (*action)(void*), void* target) {
    constexpr double kLongest = 1e6;  // s; no limit
    if (!(seconds < kLongest)) return;
    action_ = action;
    target_ = target;
    static const bool is_installed = [] {
      struct sigaction handler = {};
      handler.sa_handler = [](int) { action_(target_); };
      handler.sa_flags = SA_RESTART;
      return sigaction(SIGALRM, &handler, nullptr) == 0;
    }();
    is_set_ = is_installed;
    constexpr double kMicro = 1e6;
    const double rounded = std::max(1.0, std::floor(seconds * kMicro));  // 0 would be never
    const double whole = std::floor(rounded / kMicro);
    SetTimer(static_cast<time_t>(whole), static_cast<suseconds_t>(rounded - whole * kMicro));
  }
  ~Alarm() {
    if (is_set_) SetTimer(0, 0);
  }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

 private:
  static void SetTimer(time_t seconds, suseconds_t microseconds) {
    itimerval timer = {};
    timer.it_value = {seconds, microseconds};
    setitimer(ITIMER_REAL, &timer, nullptr);
  }
  static inline void (*action_)(void*) = nullptr;
  static inline void* target_ = nullptr;
  bool is_set_ = false;
};

}  // namespace lcpbench
