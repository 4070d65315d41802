#pragma once

#include <cstddef>
#include <cstdint>

namespace lcpbench {

/// A signed index, as Eigen's are, where a container of the standard library wants its own kind.
constexpr std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace lcpbench
