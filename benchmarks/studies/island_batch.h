#pragma once

#include <cstdint>
#include <vector>

#include "benchmarks/studies/step_arrays.h"
#include "solvers/step/step_solver.h"

namespace lcpbench {

/// Many small problems in one piece of memory, as an engine has them after it has found its islands: half of them
/// generated scenes of all families, half random rows; sizes evenly mixed, each with bodies of its own. Scenes that
/// have no answer once J is rounded to single precision (self-stress and a load on it) are left out, in both
/// precisions.
struct IslandBatch {
  StepArrays arrays;
  std::vector<std::int32_t> start;       ///< by problem, as StepSolver::SolveBatch
  std::vector<std::int32_t> local_body;  ///< as arrays.body, the bodies of each problem counted from 0
  std::vector<std::int32_t> first_body;  ///< by problem
  std::vector<double> f;
  std::vector<StepAnswer> answers;

  /// @param p  3: in the plane, 6: in space; scenes lie in a plane of it then
  IslandBatch(int p, std::int32_t problems, int most_rows);

  /// Problem k alone, its bodies counted from 0.
  /// @param all  a view of `arrays`
  StepRows RowsOf(std::size_t k, const StepRows& all) const;
  /// How many of the answers the verifier refuses, on J as the solver had it.
  double CountRefused(bool single) const;
  /// Every number once in order, and f written: the least that memory asks for.
  void ReadAllOnce(bool single);

 private:
  void Add(const StepArrays& problem);
};

}  // namespace lcpbench
