#pragma once

#include <ostream>
#include <string_view>
#include <vector>

namespace lcpbench {

/// Instruction sets that kernels are compiled for, apart from what the rest of the library is compiled for. kBest: the
/// widest of those that this machine has.
enum class InstructionSet { kBest, kSse2, kAvx2, kAvx512 };

/// "best", "sse2", "avx2", "avx512".
std::string_view ToString(InstructionSet set);
/// The set of one of these names; kBest for others.
InstructionSet InstructionSetOf(std::string_view name);
/// Writes the name by which tests and messages call it.
inline std::ostream& operator<<(std::ostream& out, InstructionSet set) { return out << ToString(set); }

/// What this machine has, narrowest first; never empty.
std::vector<InstructionSet> AvailableInstructionSets();

/// Internal to solvers/: a kernel as it is compiled for each instruction set.
template <typename Kernel>
struct KernelTable {
  Kernel sse2;    ///< for every x86-64
  Kernel avx2;    ///< with FMA
  Kernel avx512;  ///< F, DQ and VL
};
/// `set`, or the widest that this machine has for kBest.
/// @throws InputError if this machine lacks the instructions
InstructionSet FindInstructionSet(InstructionSet set);
/// @throws InputError if this machine lacks the instructions
template <typename Kernel>
const Kernel& FindKernel(const KernelTable<Kernel>& table, InstructionSet set) {
  const InstructionSet found = FindInstructionSet(set);
  if (found == InstructionSet::kSse2) return table.sse2;
  return found == InstructionSet::kAvx2 ? table.avx2 : table.avx512;
}

}  // namespace lcpbench
