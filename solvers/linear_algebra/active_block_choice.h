#pragma once

#include <memory>

#include "solvers/linear_algebra/active_block.h"

namespace lcpbench {

/// The forms of an ActiveBlock, of which the cheapest one for a problem is used. Internal to solvers/.
class ActiveBlockChoice {
 public:
  struct Allowed {
    bool sparse = true;
    bool dense = true;
    /// Through the bodies (BodyActiveBlock), for problems that have the form for it, in builds with CHOLMOD.
    bool bodies = false;
  };

  /// Analyzes the problem by the forms that are allowed, at least one of sparse and dense, and returns the one of the
  /// least factor_time. Matrices that are nearly full are not analyzed as sparse ones where they may be dense; and A is
  /// not analyzed at all where the graph of bodies promises much less fill.
  ActiveBlock* Analyze(const LcpProblem& problem, Allowed allowed);
  bool is_dense(const ActiveBlock* chosen) const { return chosen == &dense_; }
  bool is_through_bodies(const ActiveBlock* chosen) const { return chosen == bodies_.get(); }
  /// Nanoseconds that a Factor of all `rows`, a Solve and what a method does with it take, roughly: for comparison with
  /// methods that do not factor.
  double StepTime(const ActiveBlock* chosen, Index rows) const;

  /// Whether BodyActiveBlock is in this build and the problem has the form for it.
  static bool HasBodies(const LcpProblem& problem);

 private:
  SparseActiveBlock sparse_;
  DenseActiveBlock dense_;
  std::unique_ptr<ActiveBlock> bodies_;
};

}  // namespace lcpbench
