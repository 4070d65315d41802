#pragma once

namespace lcpbench {

/// Allocations of this program so far, by whatever way; -1 where they cannot be counted (sanitizers bring an allocator
/// of their own).
long AllocationCount();

}  // namespace lcpbench
