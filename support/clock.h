#pragma once

namespace lcpbench {

/// Seconds of a monotonic clock.
double SteadyNow();

}  // namespace lcpbench
