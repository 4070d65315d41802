#pragma once

namespace lcpbench {

// Status 1 is a result: a regression, a difference, a motion that came to an end early; also an internal error.

/// Exit status for a user's mistake.
inline constexpr int kMisuse = 2;
/// Exit status where output could not be written to its end: a full disk, a closed standard output.
inline constexpr int kLostOutput = 3;
/// Exit status where the reader of a pipe has gone: a shell's for a program that SIGPIPE ended.
inline constexpr int kBrokenPipe = 128 + 13;

}  // namespace lcpbench
