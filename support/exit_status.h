#pragma once

namespace lcpbench {

/// Exit status for a user's mistake.
inline constexpr int kMisuse = 2;

}  // namespace lcpbench
