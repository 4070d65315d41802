#pragma once

#include "solvers/dense_active_block.h"
#include "solvers/sparse_active_block.h"

namespace lcpbench {

/// Both forms of an ActiveBlock, of which the cheaper one for a problem is used. Internal to solvers/.
class ActiveBlockChoice {
 public:
  /// Analyzes the problem by the forms that are allowed, at least one, and returns the one of the smaller factor_time.
  /// Matrices that are nearly full are not analyzed as sparse ones where they may be dense.
  ActiveBlock* Analyze(const LcpProblem& problem, bool may_be_sparse, bool may_be_dense);
  bool is_dense(const ActiveBlock* chosen) const { return chosen == &dense_; }
  /// Nanoseconds that a Factor of all `rows`, a Solve and what a method does with it take, roughly: for comparison with
  /// methods that do not factor.
  double StepTime(const ActiveBlock* chosen, Index rows) const;

 private:
  SparseActiveBlock sparse_;
  DenseActiveBlock dense_;
};

}  // namespace lcpbench
