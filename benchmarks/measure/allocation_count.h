#pragma once

namespace lcpbench {

// Counts what this program and the libraries in it allocate by malloc and its relatives, which Eigen and operator new
// call. A program counts if allocation_count.cc is linked into it.

/// Allocations so far, by all threads.
long AllocationCount();

/// False where they cannot be counted: sanitizers bring an allocator of their own.
bool AllocationsAreCounted();

/// Off at the start, and where something is timed: an allocation then costs a branch more than without counting, not
/// an atomic addition.
void CountAllocations(bool on);

}  // namespace lcpbench
