#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace lcpbench {

/// Memory that this process may still take [bytes]: the least of what the machine has available, what its control group
/// leaves (cgroup v2), and what its address space limit leaves. Infinite where none of them is known. Linux.
double AvailableMemory();

/// A method would need more memory than there is. LcpSolver::Solve turns it into LcpStatus::kUnsupported.
class MemoryRefusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// To be called before something large is allocated, so that a refusal with figures takes the place of a kill by the
/// system. Amounts below kAlwaysAllowed are not looked at.
/// @param what  "the factor of A", say: "the factor of A needs 12.3 GB, 8.1 GB are available"
/// @throws MemoryRefusal
void RequireMemory(double bytes, const std::string& what);
/// As RequireMemory, of so many dense n x n matrices of doubles.
void RequireDenseMatrices(std::int64_t n, int count);
/// As RequireMemory, of so many compressed n x n matrices with that many entries.
void RequireSparseMatrices(std::int64_t n, double entries, int count);
inline constexpr double kAlwaysAllowed = 64e6;  ///< bytes

}  // namespace lcpbench
