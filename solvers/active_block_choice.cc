#include "solvers/active_block_choice.h"

namespace lcpbench {
namespace {

// Fuller matrices of more rows than this are not analysed as sparse ones at all.
constexpr double kSparseFill = 0.4;
constexpr Eigen::Index kAnalysedRows = 48;
// Steps of bpp on scenes and random dense matrices of 100 to 1000 rows, in factor_time and by row.
constexpr double kDenseStep = 0.5;
constexpr double kSparseStep = 2;
constexpr double kSparseStepPerRow = 25;

}  // namespace

double ActiveBlockChoice::StepTime(const ActiveBlock* chosen, Index rows) const {
  if (is_dense(chosen)) return kDenseStep * chosen->factor_time();
  return kSparseStep * chosen->factor_time() + kSparseStepPerRow * static_cast<double>(rows);
}

ActiveBlock* ActiveBlockChoice::Analyze(const LcpProblem& problem, bool may_be_sparse, bool may_be_dense) {
  const Eigen::Index n = problem.size();
  if (may_be_sparse && may_be_dense && n > kAnalysedRows) {
    const auto entries = static_cast<double>(n) * static_cast<double>(n);
    may_be_sparse = static_cast<double>(problem.SparseA().nonZeros()) <= kSparseFill * entries;
  }
  if (may_be_sparse) {
    sparse_.Analyze(problem);
    if (!may_be_dense || sparse_.factor_time() <= DenseActiveBlock::FactorTime(n)) return &sparse_;
  }
  dense_.Analyze(problem);
  return &dense_;
}

}  // namespace lcpbench
