#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/io/hdf5_reader.h"

namespace lcpbench {

/// What the child sends for every request, in their order, as one byte each; then kEnd. After kPresent and kRefused
/// come the number of bytes (std::uint64_t) and the bytes: values as int or double, a text, or a message without the
/// file's name, after which nothing comes.
enum class Hdf5Answer : unsigned char { kAbsent, kPresent, kRefused, kEnd };

struct Hdf5ChildLimits {
  std::uint64_t memory = 0;  ///< bytes beyond what the child is born with
  std::uint64_t time_s = 0;  ///< of the processor
};

/// What a forked child does for ReadHdf5: reads the datasets of a file of `file_size` bytes and writes them to `pipe`.
[[noreturn]] void RunHdf5Child(int pipe, const std::string& path, const std::vector<Hdf5Request>& requests,
                               std::uint64_t file_size, const Hdf5ChildLimits& limits);

}  // namespace lcpbench
