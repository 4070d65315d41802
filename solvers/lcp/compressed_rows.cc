#include "solvers/lcp/compressed_rows.h"

#include <cstddef>

namespace lcpbench {
namespace {

std::string Found(const char* name, std::size_t k, int found, const std::string& expected) {
  return std::string(name) + "[" + std::to_string(k) + "] is " + std::to_string(found) + ", " + expected;
}

}  // namespace

std::string WhyNotStarts(std::span<const int> starts, std::int64_t end, const char* name, const char* end_name) {
  if (starts.front() != 0) return Found(name, 0, starts.front(), "expected 0");
  for (std::size_t i = 1; i < starts.size(); ++i) {
    if (starts[i] >= starts[i - 1]) continue;
    return Found(name, i, starts[i], "less than the " + std::to_string(starts[i - 1]) + " before it");
  }
  if (starts.back() == end) return {};
  return Found(name, starts.size() - 1, starts.back(),
               std::string("expected ") + end_name + " = " + std::to_string(end));
}

std::string WhyNotColumns(std::span<const int> starts, std::span<const int> indices, std::int64_t columns,
                          const char* name) {
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    int last = -1;
    for (auto k = static_cast<std::size_t>(starts[i]); k < static_cast<std::size_t>(starts[i + 1]); ++k) {
      if (indices[k] < 0 || indices[k] >= columns) {
        return Found(name, k, indices[k], "expected a column in [0, " + std::to_string(columns) + ")");
      }
      if (indices[k] <= last) {
        return Found(name, k, indices[k],
                     "not above the " + std::to_string(last) + " before it in row " + std::to_string(i));
      }
      last = indices[k];
    }
  }
  return {};
}

}  // namespace lcpbench
