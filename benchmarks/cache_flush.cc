#include "benchmarks/cache_flush.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace lcpbench {
namespace {

constexpr std::size_t kLine = 64;
// Where the system does not say how large its caches are.
constexpr std::size_t kAssumedCache = std::size_t{64} << 20U;

// Of this machine as Google Benchmark sees it. sysconf names what the processor has in all, which a virtual machine may
// share with many others.
std::size_t LargestCache() {
  int largest = 0;
  for (const auto& cache : benchmark::CPUInfo::Get().caches) largest = std::max(largest, cache.size);
  return largest > 0 ? static_cast<std::size_t>(largest) : kAssumedCache;
}

}  // namespace

CacheFlush::CacheFlush() : buffer_(2 * LargestCache()) {}

void CacheFlush::Run() {
  // Written, so that lines are owned by this processor.
  volatile unsigned char* const bytes = buffer_.data();
  for (std::size_t k = 0; k < buffer_.size(); k += kLine) bytes[k] = static_cast<unsigned char>(bytes[k] + 1);
}

}  // namespace lcpbench
