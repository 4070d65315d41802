#pragma once

namespace lcpbench {

/// Linux: from here on PeakBytes() counts anew. Freed memory is given back first.
void ResetPeak();
/// The most memory of this process that was resident at a time since ResetPeak() [bytes]; 0 where unknown.
double PeakBytes();

}  // namespace lcpbench
