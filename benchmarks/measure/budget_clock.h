#pragma once

#include <string>

#include "support/clock.h"
#include "support/number_text.h"

namespace lcpbench {

/// Thrown out of a motion's check when its time is over: a single step may take long.
struct BudgetSpent {};

/// Wall clock that a motion may take, from now on.
class BudgetClock {
 public:
  explicit BudgetClock(double budget_s) : budget_s_(budget_s), end_(SteadyNow() + budget_s) {}
  /// @throws BudgetSpent when it is over
  void Check() const {
    if (SteadyNow() > end_) throw BudgetSpent();
  }
  std::string Reason() const { return "not finished within " + NumberText(budget_s_) + " s"; }

 private:
  double budget_s_;
  double end_;
};

}  // namespace lcpbench
