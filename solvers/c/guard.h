#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

#include "solvers/c/lcpbench.h"
#include "support/input_error.h"

namespace lcpbench {

/// The error code of the exception that is being handled; its message becomes that of lcpbench_last_error(), after the
/// name of the function. To be called within a catch clause.
lcpbench_error ErrorOfCurrentException(const char* function) noexcept;

/// Runs `body` so that no exception crosses the C interface.
template <typename Body>
lcpbench_error Guard(const char* function, Body&& body) noexcept {
  try {
    std::forward<Body>(body)();
    return LCPBENCH_OK;
  } catch (...) {
    return ErrorOfCurrentException(function);
  }
}

/// @throws InputError naming the argument
void RequireNotNull(const void* pointer, const char* name, const char* expected);

/// Sizes beyond this are uninitialised memory, not a later version's struct.
inline constexpr std::size_t kLargestStruct = 65536;

/// @param size      what the caller's header has as the size of the struct
/// @param smallest  its size in version 0.1
/// @throws InputError unless smallest <= size <= kLargestStruct
void RequireStructSize(std::size_t size, std::size_t smallest, const char* name);

/// Writes as much of `source` as the caller's struct has room for, and zeros where that is larger.
template <typename Struct>
void CopyOut(const Struct& source, Struct* target, std::size_t size) {
  std::memcpy(target, &source, std::min(size, sizeof source));
  if (size > sizeof source) std::memset(reinterpret_cast<char*>(target) + sizeof source, 0, size - sizeof source);
}

}  // namespace lcpbench
