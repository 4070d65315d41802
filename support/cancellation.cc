#include "support/cancellation.h"

#include "support/clock.h"

namespace lcpbench {

void Cancellation::Scope::Look() {
  const double now = SteadyNow();
  if (now < next_ && !is_over_) return;
  const bool is_first = next_ == 0;
  next_ = now + kPeriod;
  is_over_ = is_over_ || (!is_first && happened_(context_));
  if (is_over_) throw Cancelled();
}

}  // namespace lcpbench
