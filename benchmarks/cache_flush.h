#pragma once

#include <cstddef>
#include <vector>

namespace lcpbench {

/// Drives what a solver works on out of the caches of the processor it runs on, as an engine does between two steps:
/// walks a buffer of twice the largest cache.
class CacheFlush {
 public:
  CacheFlush();
  /// Some milliseconds.
  void Run();
  std::size_t bytes() const { return buffer_.size(); }

 private:
  std::vector<unsigned char> buffer_;
};

}  // namespace lcpbench
