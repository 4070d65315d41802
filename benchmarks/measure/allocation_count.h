#pragma once

namespace lcpbench {

// Counts what this program and the libraries in it allocate by malloc and its relatives, which Eigen and operator new
// call. A program counts if allocation_count.cc is linked into it, also one in C.
extern "C" {

/// Allocations so far, by all threads.
long AllocationCount();

/// False where they cannot be counted: sanitizers bring an allocator of their own.
bool AllocationsAreCounted();

/// Off at the start, and where something is timed: an allocation then costs two branches, not an atomic addition.
void CountAllocations(bool on);

/// From now on `end` is called where an allocation fails, before std::bad_alloc is thrown: libraries end the process
/// then, and who catches it may take it for a result. Nothing where allocations are not counted.
void EndWithoutMemory(void (*end)());
}

}  // namespace lcpbench
