#pragma once

namespace lcpbench {

/// Allocations of this program so far, by malloc and its relatives, which Eigen and operator new call.
long AllocationCount();

/// False where they cannot be counted: sanitizers bring an allocator of their own.
bool AllocationsAreCounted();

}  // namespace lcpbench
