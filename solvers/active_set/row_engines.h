#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "solvers/active_set/block_pivoting.h"
#include "solvers/rows/two_body_copy.h"

namespace lcpbench {

/// What an active-set method does with a caller's arrays: rows with at most two moving bodies each are read in place of
/// an LcpProblem, and an engine of the method solves them with a dense active block. There is one for each of a few
/// sizes, to which rows are filled up, so that no solve allocates but the first of its size. Internal to solvers/.
///
/// An Engine has
///     void PrepareRows(Index size);                         PivotingSetup::PrepareRows
///     bool SolveRows(const RowTask&, LcpResult*);           false: not solved
template <typename Engine>
class RowEngines {
 public:
  /// With more rows a dense block is no longer the cheapest one.
  static constexpr Index kMostRows = 128;

  /// False, with f of zeros, where the arrays are not of this kind, the caller limits iterations, or the engine does
  /// not solve them: they need an LcpProblem.
  /// @param make  makes a std::unique_ptr<Engine>
  template <typename Make>
  bool Solve(const ProblemArrays& arrays, const LcpOptions& options, const Make& make, LcpResult* result) {
    const Index n = arrays.rows;
    if (n > kMostRows || options.max_iterations > 0 || !copy_.Take(arrays)) return false;
    const StepRows& rows = copy_.rows();
    judge_.Reserve(n, rows.bodies);
    if (all_.empty()) {
      all_.resize(static_cast<std::size_t>(kMostRows));
      std::iota(all_.begin(), all_.end(), 0);
    }
    std::optional<Deadline> deadline;
    if (std::isfinite(options.time_limit_s) && n > kRowsWithoutClock) deadline.emplace(options);
    std::size_t k = 0;
    while (kSizes[k] < n) ++k;
    if (engines_[k] == nullptr) {
      engines_[k] = make();
      engines_[k]->PrepareRows(kSizes[k]);
    }
    const RowTask task{
        rows, {all_.data(), static_cast<std::size_t>(n)}, judge_, options, deadline.has_value() ? &*deadline : nullptr};
    return engines_[k]->SolveRows(task, result);
  }

 private:
  // Up to so many rows a solve takes some ten microseconds.
  static constexpr Index kRowsWithoutClock = 24;
  static constexpr std::array<Index, 8> kSizes = {8, 16, 24, 32, 48, 64, 96, kMostRows};

  TwoBodyCopy copy_;
  RowJudge judge_;
  std::vector<std::int32_t> all_;
  std::array<std::unique_ptr<Engine>, kSizes.size()> engines_;
};

}  // namespace lcpbench
