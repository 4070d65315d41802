#include "solvers/pivoting/row_tableau.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "solvers/linear_algebra/tableau_rules.h"
#include "support/array_index.h"

namespace lcpbench {

void RowTableau::Reserve(Index max_rows, Index max_bodies) {
  tableau_.ReserveRows(std::min(max_rows, SmallPivoting::kMaxRows), max_bodies);
  judge_.Reserve(max_rows, max_bodies);
}

RowTableau::End RowTableau::Solve(const StepRows& rows, Part part, double tolerance, SmallPivoting::Request request,
                                  double* f, double* w, double* rho) {
  using Judgement = SmallPivoting::Answer::Judgement;
  request.row_limit = tableau::kMargin * std::sqrt(tolerance);
  // One row is a division, whatever the rule.
  if (part.size() == 1 && one_.Solve(rows, part, tolerance, request.row_limit, f, w, rho)) return End::kSolved;
  const SmallPivoting::Answer found = tableau_.SolveRows(rows, part, request, f, w);
  const Judgement judgement = found.Judge(tolerance);
  *rho = found.rho;
  if (judgement == Judgement::kRight) return End::kSolved;
  if (judgement == Judgement::kUnclear && Passes(rows, part, tolerance, f, w, rho)) return End::kSolved;
  return std::isfinite(found.rho) ? End::kInexact : End::kGaveUp;
}

bool RowTableau::SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, bool self_check,
                             LcpResult* result) {
  const Index n = arrays.rows;
  if (arrays.form != MatrixForm::kFactors || n > SmallPivoting::kMaxRows || !copy_.Take(arrays)) return false;
  const StepRows& rows = copy_.rows();
  Reserve(n, rows.bodies);
  if (all_.empty()) {
    all_.resize(At(SmallPivoting::kMaxRows));
    std::iota(all_.begin(), all_.end(), 0);
    gaps_.resize(all_.size());
  }
  std::optional<Deadline> deadline;
  if (Deadline::IsNeeded(options) && n > SmallPivoting::kRowsWithoutClock) deadline.emplace(options);
  SmallPivoting::Request request;
  request.deadline = deadline.has_value() ? &*deadline : nullptr;
  request.self_check = self_check;
  double rho = 0;
  if (Solve(rows, {all_.data(), At(n)}, options.tolerance, request, result->f.data(), gaps_.data(), &rho) !=
      End::kSolved) {
    result->f.setZero();
    return false;
  }
  result->status = LcpStatus::kSolved;
  result->iterations = pivots();
  return true;
}

}  // namespace lcpbench
