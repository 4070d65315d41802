#include "solvers/lcp/fresh_pass.h"

#include <algorithm>

namespace lcpbench {
namespace {

class Pass {
 public:
  Pass(const SolverFactory& make, std::span<const ProblemArrays> problems, const PassRequest& request)
      : solver_(make()), problems_(problems), request_(request) {
    options_.tolerance = request.tolerance;
    options_.time_limit_s = request.time_limit_s;
    options_.time_parts = request.kind == PassKind::kParts;
    results_.resize(std::max<std::size_t>(request.group, 1));
  }

  PassReply Run() {
    for (const std::uint32_t index : request_.warm_up) SolveFresh(index, &results_.front());
    double spent = 0;
    const std::size_t count = request_.order.size();
    reply_.reserve(count);
    for (std::size_t k = 0; k < count && spent <= request_.budget_s;) {
      const std::size_t end = std::min(count, k + (request_.kind == PassKind::kFresh ? results_.size() : 1));
      switch (request_.kind) {
        case PassKind::kFresh:
          spent += TimeGroup(k, end);
          break;
        case PassKind::kParts:
          spent += TimeParts(k);
          break;
        case PassKind::kAgain:
          spent += TimeAgain(k);
          break;
      }
      k = end;
    }
    return std::move(reply_);
  }

 private:
  void SolveFresh(std::uint32_t index, LcpResult* result) { solver_->SolveArrays(problems_[index], options_, result); }

  PassEntry EntryOf(const LcpResult& result, double seconds) const {
    PassEntry entry;
    entry.seconds = seconds;
    entry.status = result.status;
    entry.f = result.f;
    return entry;
  }

  double TimeGroup(std::size_t begin, std::size_t end) {
    const double start = SteadyNow();
    for (std::size_t k = begin; k < end; ++k) SolveFresh(request_.order[k], &results_[k - begin]);
    const double all = SteadyNow() - start;
    for (std::size_t k = begin; k < end; ++k) {
      reply_.push_back(EntryOf(results_[k - begin], all / static_cast<double>(end - begin)));
    }
    return all;
  }

  double TimeParts(std::size_t k) {
    LcpResult& result = results_.front();
    const double start = SteadyNow();
    const LcpProblem problem = LcpProblem::FromArrays(problems_[request_.order[k]]);
    const double made = SteadyNow();
    solver_->Prepare(problem);
    const double prepared = SteadyNow();
    solver_->Solve(problem, options_, &result);
    const double solved = SteadyNow();
    PassEntry entry = EntryOf(result, solved - start);
    entry.problem_s = made - start;
    entry.prepare_s = prepared - made;
    entry.convert_s = std::max(0.0, result.own_convert_s);
    entry.solve_s = std::max(0.0, solved - prepared - entry.convert_s);
    reply_.push_back(std::move(entry));
    return solved - start;
  }

  double TimeAgain(std::size_t k) {
    LcpResult& result = results_.front();
    const LcpProblem problem = LcpProblem::FromArrays(problems_[request_.order[k]]);
    solver_->Solve(problem, options_, &result);
    Eigen::VectorXd b = request_.other_b[k];
    const double start = SteadyNow();
    solver_->Solve(problem.WithB(std::move(b)), options_, &result);
    const double solved = SteadyNow();
    reply_.push_back(EntryOf(result, solved - start));
    return solved - start;
  }

  std::unique_ptr<LcpSolver> solver_;
  std::span<const ProblemArrays> problems_;
  const PassRequest& request_;
  LcpOptions options_;
  std::vector<LcpResult> results_;
  PassReply reply_;
};

}  // namespace

PassReply RunPass(const SolverFactory& make, std::span<const ProblemArrays> problems, const PassRequest& request) {
  return Pass(make, problems, request).Run();
}

}  // namespace lcpbench
