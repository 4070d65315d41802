#include "benchmarks/measure/allocation_count.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LCPBENCH_COUNTS_ALLOCATIONS
namespace {
bool is_counting = false;
std::atomic<long> allocations = 0;
void (*without_memory)() = nullptr;
void Count() {
  if (is_counting) allocations.fetch_add(1, std::memory_order_relaxed);
}
void* Given(void* memory, std::size_t size) {
  if (memory == nullptr && size > 0 && without_memory != nullptr) without_memory();
  return memory;
}
}  // namespace
#ifdef __clang__
// These are the C library's own names.
#pragma clang diagnostic ignored "-Wreserved-identifier"
#endif
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  Count();
  return Given(__libc_malloc(size), size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  Count();
  return Given(__libc_calloc(count, size), count * size);
}
void* realloc(void* old, std::size_t size) noexcept {
  Count();
  return Given(__libc_realloc(old, size), size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  Count();
  return Given(__libc_memalign(alignment, size), size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  Count();
  return Given(__libc_memalign(alignment, size), size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) noexcept {
  Count();
  void* memory = Given(__libc_memalign(alignment, size), size);
  if (memory == nullptr) return ENOMEM;
  *result = memory;
  return 0;
}
}
#endif

namespace lcpbench {

#ifdef LCPBENCH_COUNTS_ALLOCATIONS
bool AllocationsAreCounted() { return true; }
long AllocationCount() { return allocations; }
void CountAllocations(bool on) { is_counting = on; }
void EndWithoutMemory(void (*end)()) { without_memory = end; }
#else
bool AllocationsAreCounted() { return false; }
long AllocationCount() { return 0; }
void CountAllocations(bool /*on*/) {}
void EndWithoutMemory(void (* /*end*/)()) {}
#endif

}  // namespace lcpbench
