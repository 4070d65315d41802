#pragma once

#include <cstdint>
#include <limits>

#include "support/clock.h"

namespace lcpbench {

/// The large pieces of work that solvers have done in this thread so far, counted where they are done: for tests that
/// compare two ways to the same answer by what they did and not by the clock.
struct WorkCounts {
  std::int64_t factorizations = 0;  ///< numeric: whole factors and CHOLMOD's updates, as FactorClock times them
  std::int64_t analyses = 0;        ///< symbolic, each with its order; of Ipopt the objects built for a program

  /// The counts of the calling thread, so far.
  static WorkCounts& OfThread() {
    static thread_local WorkCounts counts;
    return counts;
  }

  /// What was done since `before`.
  WorkCounts operator-(const WorkCounts& before) const {
    return {factorizations - before.factorizations, analyses - before.analyses};
  }
  /// The same work.
  bool operator==(const WorkCounts&) const = default;
};

/// How long a solve spends in numeric factorizations (LcpOptions::time_factorizations), by thread. Off otherwise, so
/// that small solves do not pay for clock reads. Whole factors count, and CHOLMOD's updates of them; symbolic analysis,
/// solves with a factor, and what pivoting methods do row by row do not.
class FactorClock {
 public:
  /// For the length of a solve. Within another session, that of a solver which asks this one, it does nothing.
  class Session {
   public:
    /// @param wanted  false: nothing is counted
    explicit Session(bool wanted) : is_outermost_(wanted && !on_) {
      if (!is_outermost_) return;
      on_ = true;
      seconds_ = 0;
    }
    ~Session() {
      if (is_outermost_) on_ = false;
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// So far; NaN where a library could not tell.
    static double seconds() { return seconds_; }

   private:
    bool is_outermost_;
  };

  /// Around a factorization, which WorkCounts counts, too. Of nested ones the outermost is timed.
  class Scope {
   public:
    Scope() : counts_(on_ && !within_), start_(counts_ ? SteadyNow() : 0) {
      within_ = within_ || counts_;
      ++WorkCounts::OfThread().factorizations;
    }
    ~Scope() {
      if (!counts_) return;
      within_ = false;
      seconds_ += SteadyNow() - start_;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    bool counts_;
    double start_;
  };

  /// For a library that factorizes inside and does not say how long.
  static void CannotTell() { seconds_ = std::numeric_limits<double>::quiet_NaN(); }

 private:
  static inline thread_local bool on_ = false;
  static inline thread_local bool within_ = false;
  static inline thread_local double seconds_ = 0;
};

}  // namespace lcpbench
