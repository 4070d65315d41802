#include "solvers/c/guard.h"

#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>

#include "solvers/lcp/memory_budget.h"

namespace lcpbench {
namespace {

// An array, so that telling of exhausted memory needs none. Longer messages are cut.
thread_local char last_error[2048] = "";

lcpbench_error Fail(lcpbench_error error, const char* function, const char* message) {
  std::snprintf(last_error, sizeof last_error, "%s: %s", function, message);
  return error;
}

}  // namespace

lcpbench_error ErrorOfCurrentException(const char* function) noexcept {
  try {
    throw;
  } catch (const InputError& error) {
    return Fail(LCPBENCH_INVALID_ARGUMENT, function, error.what());
  } catch (const MemoryRefusal& error) {
    return Fail(LCPBENCH_OUT_OF_MEMORY, function, error.what());
  } catch (const std::bad_alloc&) {
    return Fail(LCPBENCH_OUT_OF_MEMORY, function, "out of memory");
  } catch (const std::length_error& error) {
    return Fail(LCPBENCH_OUT_OF_MEMORY, function, error.what());
  } catch (const std::exception& error) {
    return Fail(LCPBENCH_INTERNAL_ERROR, function, error.what());
  } catch (...) {
    return Fail(LCPBENCH_INTERNAL_ERROR, function, "an exception of an unknown type");
  }
}

void RequireNotNull(const void* pointer, const char* name, const char* expected) {
  if (pointer == nullptr) throw InputError(std::string(name) + " is NULL, expected " + expected);
}

void RequireStructSize(std::size_t size, std::size_t smallest, const char* name) {
  if (size < smallest || size > kLargestStruct) {
    throw InputError("size is " + std::to_string(size) + ", expected sizeof(" + name + "), " +
                     std::to_string(smallest) + " or more");
  }
}

}  // namespace lcpbench

const char* lcpbench_last_error() { return lcpbench::last_error; }

const char* lcpbench_version() { return LCPBENCH_VERSION; }
