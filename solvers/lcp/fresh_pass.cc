#include "solvers/lcp/fresh_pass.h"

#include <algorithm>
#include <utility>

namespace lcpbench {

PassReply RunPass(const SolverFactory& make, std::span<const ProblemArrays> problems, const PassRequest& request) {
  const std::unique_ptr<LcpSolver> solver = make();
  LcpOptions options;
  options.tolerance = request.tolerance;
  options.time_limit_s = request.time_limit_s;
  options.time_parts = request.kind == PassKind::kParts;
  const std::size_t count = request.order.size();
  const std::size_t together = request.kind == PassKind::kFresh ? std::min<std::size_t>(request.group, count) : 1;
  std::vector<LcpResult> results(std::max<std::size_t>(together, 1));
  for (const std::uint32_t index : request.warm_up) solver->SolveArrays(problems[index], options, &results.front());

  PassReply reply;
  reply.reserve(count);
  double spent = 0;
  for (std::size_t k = 0; k < count && spent <= request.budget_s;) {
    const std::size_t group = std::min(count - k, results.size());
    PassEntry entry;
    if (request.kind == PassKind::kFresh) {
      const double start = SteadyNow();
      for (std::size_t i = 0; i < group; ++i) solver->SolveArrays(problems[request.order[k + i]], options, &results[i]);
      entry.seconds = (SteadyNow() - start) / static_cast<double>(group);
    } else if (request.kind == PassKind::kParts) {
      const double start = SteadyNow();
      const LcpProblem problem = LcpProblem::FromArrays(problems[request.order[k]]);
      const double made = SteadyNow();
      solver->Prepare(problem);
      const double prepared = SteadyNow();
      solver->Solve(problem, options, &results.front());
      const double solved = SteadyNow();
      entry.seconds = solved - start;
      entry.problem_s = made - start;
      entry.prepare_s = prepared - made;
      entry.convert_s = std::max(0.0, results.front().own_convert_s);
      entry.solve_s = std::max(0.0, solved - prepared - entry.convert_s);
    } else {
      const LcpProblem problem = LcpProblem::FromArrays(problems[request.order[k]]);
      solver->Solve(problem, options, &results.front());
      Eigen::VectorXd b = request.other_b[k];
      const double start = SteadyNow();
      solver->Solve(problem.WithB(std::move(b)), options, &results.front());
      entry.seconds = SteadyNow() - start;
    }
    for (std::size_t i = 0; i < group; ++i) {
      entry.status = results[i].status;
      entry.f = results[i].f;
      reply.push_back(entry);
      spent += entry.seconds;
    }
    k += group;
  }
  return reply;
}

}  // namespace lcpbench
