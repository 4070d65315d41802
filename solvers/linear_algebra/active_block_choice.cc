#include "solvers/linear_algebra/active_block_choice.h"

#include <utility>

#include "solvers/linear_algebra/cost_model.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/linear_algebra/body_active_block.h"
#endif

namespace lcpbench {
namespace {

// Fuller matrices of more rows than this are not analysed as sparse ones at all.
constexpr double kSparseFill = 0.4;
constexpr Eigen::Index kAnalysedRows = 48;
#ifdef LCPBENCH_WITH_SUITESPARSE
// Where A has more entries per row than this, bodies carry so many rows that their graph is the sparser one; where
// fewer, A is, and the other form is not analysed. Smaller problems are not worth two analyses.
constexpr double kFullRows = 10;
constexpr double kSparseRows = 10;
constexpr Eigen::Index kLeastRowsForBodies = 1000;
#endif

}  // namespace

double ActiveBlockChoice::StepTime(const ActiveBlock* chosen, Index rows) const {
  if (chosen == bodies_.get()) return chosen->factor_time();
  if (is_dense(chosen)) return CostModel::kDenseStep * chosen->factor_time();
  return CostModel::kSparseStep * chosen->factor_time() + CostModel::kSparseStepRow * static_cast<double>(rows);
}

bool ActiveBlockChoice::HasBodies(const LcpProblem& problem) {
#ifdef LCPBENCH_WITH_SUITESPARSE
  return BodySpace::Suits(problem);
#else
  return problem.size() < 0;
#endif
}

ActiveBlock* ActiveBlockChoice::Analyze(const LcpProblem& problem, Allowed allowed) {
  const Eigen::Index n = problem.size();
  std::unique_ptr<ActiveBlock> before = std::move(bodies_);
#ifdef LCPBENCH_WITH_SUITESPARSE
  const bool alone = !allowed.sparse && !allowed.dense;
  if (allowed.bodies && HasBodies(problem) && (alone || n >= kLeastRowsForBodies)) {
    const double entries = static_cast<double>(BoundEntriesOfA(problem)) / static_cast<double>(n);
    if (alone || entries >= kSparseRows) {
      bodies_ = before != nullptr ? std::move(before) : std::make_unique<BodyActiveBlock>();
      bodies_->Analyze(problem);
      if (alone || entries >= kFullRows) return bodies_.get();
    }
  }
#endif
  if (allowed.sparse && allowed.dense && n > kAnalysedRows) {
    const auto entries = static_cast<double>(n) * static_cast<double>(n);
    allowed.sparse = static_cast<double>(problem.SparseA().nonZeros()) <= kSparseFill * entries;
  }
  if (allowed.sparse) {
    sparse_.Analyze(problem);
    if (!allowed.dense || sparse_.factor_time() <= DenseActiveBlock::FactorTime(n)) {
      const bool through_bodies = bodies_ != nullptr && bodies_->factor_time() < sparse_.factor_time();
      return through_bodies ? bodies_.get() : &sparse_;
    }
  }
  dense_.Analyze(problem);
  return &dense_;
}

}  // namespace lcpbench
