#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/instruction_set.h"

namespace lcpbench {

/// Many small problems from an engine's arrays to forces, one per SIMD lane: A is assembled in the lanes from the
/// rows, then solved by principal pivoting on a symmetric tableau and checked (docs/solvers/batch.md).
///
/// The problems are taken in blocks, in which equal sizes share a group, so that memory is read about in order and
/// once. What is left of all blocks shares groups with the next sizes, filled up by rows of zeros.
///
/// Lanes pass nothing with numbers that are not finite, negative inverse masses, bodies out of range or a matrix near
/// the ends of the doubles' range; who receives the rest must look at its input.
///
/// Solve allocates nothing. One object serves one thread at a time.
class RowBatch {
 public:
  static constexpr Index kMaxRows = 64;  ///< of a problem in lanes; 32 but with AVX-512
  /// Problems of a block: enough that the groups of a size, one after another, find their instructions in the
  /// first-level cache, and few enough that what lies beside a problem is still in some cache when its turn comes.
  static constexpr std::size_t kBlock = 512;

  /// What becomes of the problems, in no order, each once.
  class Receiver {
   public:
    virtual ~Receiver() = default;
    /// Problem k is solved, its f written. `rho` is an upper bound, at most 4 times too large.
    virtual void Take(std::int32_t problem, int pivots, double rho) = 0;
    /// Problem k is not for lanes, or did not pass. Its f may be written.
    virtual void Leave(std::int32_t problem) = 0;
  };

  /// @throws InputError if this machine lacks the instructions
  explicit RowBatch(InstructionSet instructions);
  ~RowBatch();

  /// Solves problems, a block at a time, until `next`, the first one that no block has yet, is at their end; batches
  /// that share it share the problems.
  /// Problem k has the rows start[k] to start[k + 1] - 1; sizes and arrays have been checked, numbers have not.
  void Solve(const StepRows& rows, std::span<const std::int32_t> start, double tolerance,
             std::atomic<std::size_t>* next, double* f, Receiver* receiver);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lcpbench
