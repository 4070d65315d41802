#pragma once

#include <algorithm>
#include <cmath>

#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/lcp/solver.h"

/// Internal to solvers/.
namespace lcpbench {

/// Passes over rows that read the clock as they go: once per kEntriesPerClockRead multiply-adds, about 20 us.
class PacedPasses {
 public:
  static constexpr Index kEntriesPerClockRead = Index{1} << 15;

  PacedPasses(const LcpOptions& options, const RowKernel& rows, Index n)
      : deadline_(options),
        limited_(std::isfinite(options.time_limit_s)),
        n_(n),
        chunk_(std::max<Index>(1, kEntriesPerClockRead / rows.EntriesPerRow())) {}

  /// Calls pass(begin, end) on ranges that cover all rows, from the last range on if `backward`. False, and not all
  /// rows done, when the time is up.
  template <typename Pass>
  bool Run(bool backward, Pass&& pass) {
    for (Index done = 0; done < n_;) {
      const Index take = std::min(n_ - done, chunk_ - unread_);
      if (backward) {
        pass(n_ - done - take, n_ - done);
      } else {
        pass(done, done + take);
      }
      done += take;
      unread_ += take;
      if (unread_ >= chunk_ && Expired()) return false;
    }
    return true;
  }

  /// Reads the clock, where there is a limit.
  bool Expired() {
    unread_ = 0;
    return limited_ && deadline_.Expired();
  }

 private:
  Deadline deadline_;
  bool limited_;
  Index n_;
  Index chunk_;
  Index unread_ = 0;  // rows since the last clock read
};

}  // namespace lcpbench
