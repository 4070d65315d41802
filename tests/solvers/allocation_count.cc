#include "tests/solvers/allocation_count.h"

#include <atomic>
#include <cstdlib>

// Counts allocations of this program: Eigen takes its memory from malloc, not from operator new. Sanitizers bring an
// allocator of their own.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LCPBENCH_COUNTS_ALLOCATIONS
namespace {
std::atomic<long> allocations = 0;
}
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* old, std::size_t size);               // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#endif

namespace lcpbench {

#ifdef LCPBENCH_COUNTS_ALLOCATIONS
bool AllocationsAreCounted() { return true; }
long AllocationCount() { return allocations; }
#else
bool AllocationsAreCounted() { return false; }
long AllocationCount() { return 0; }
#endif

}  // namespace lcpbench
