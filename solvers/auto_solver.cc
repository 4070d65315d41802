#include "solvers/auto_solver.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "solvers/dantzig.h"
#include "solvers/given_form.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "solvers/semismooth_newton.h"
#include "solvers/small_pivoting.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/suitesparse.h"
#endif

namespace lcpbench {
namespace {

// A rho in double of at most this part of the tolerance passes in extended precision, too: rounding of n <= 128 terms
// is far below the difference. Above 1e-13 other backends may do better.
constexpr double kMargin = 0.1;
constexpr double kTableauRho = 1e-12;

}  // namespace

struct AutoSolver::Backends {
  SmallPivoting tableau;
  SemismoothNewtonSolver newton;
#ifdef LCPBENCH_WITH_SUITESPARSE
  SuitesparseSolver interior;
#endif
  DantzigSolver dantzig;
  GivenFormTest test;

  bool TryTableau(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  bool Try(LcpSolver* solver, std::string_view name, const LcpProblem& problem, const LcpOptions& options,
           const Deadline& deadline, LcpResult* result);
};

bool AutoSolver::Backends::TryTableau(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const double rho = tableau.Solve(problem, &result->f);
  if (!(rho <= std::min(kTableauRho, kMargin * options.tolerance))) return false;
  if (!tableau.RowsMeet(kMargin * std::sqrt(options.tolerance))) return false;
  result->status = LcpStatus::kSolved;
  result->iterations = tableau.pivots();
  result->detail = "tableau";
  return true;
}

// True if there is nothing left to try: solved and passed, proved infeasible, or out of time.
bool AutoSolver::Backends::Try(LcpSolver* solver, std::string_view name, const LcpProblem& problem,
                               const LcpOptions& options, const Deadline& deadline, LcpResult* result) {
  LcpOptions rest = options;
  rest.time_limit_s = deadline.Remaining();
  if (!(rest.time_limit_s > 0)) {
    result->status = LcpStatus::kTimeLimit;
    return true;
  }
  const std::string before = std::move(result->detail);
  solver->Solve(problem, rest, result);
  const std::string said = std::move(result->detail);
  result->detail = before;
  if (!before.empty()) result->detail += "; ";
  result->detail += name;
  if (!said.empty()) result->detail.append(": ").append(said);
  switch (result->status) {
    case LcpStatus::kSolved:
      if (solver == &newton) return true;  // claims it after this very test only
      test.Reset(problem);
      if (test.Meets(options.tolerance, result->f)) return true;
      result->status = LcpStatus::kNumericalFailure;
      return false;
    case LcpStatus::kInfeasible:
      return result->farkas_ray.has_value() && VerifyFarkasRay(problem, *result->farkas_ray).accepted;
    case LcpStatus::kTimeLimit:
      return true;
    default:
      return false;
  }
}

AutoOptions AutoOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("auto", settings);
  AutoOptions options;
  options.tableau_rows = static_cast<Index>(reader.Number("tableau_rows", static_cast<double>(options.tableau_rows), 0,
                                                          static_cast<double>(SmallPivoting::kMaxRows)));
  options.newton_factorisations = static_cast<std::int64_t>(
      reader.Number("newton_factorisations", static_cast<double>(options.newton_factorisations), 1, 1e9));
  reader.Finish();
  return options;
}

AutoSolver::AutoSolver(AutoOptions options) : options_(options), backends_(std::make_unique<Backends>()) {
  if (options.newton_factorisations < 1) throw InputError("auto: newton_factorisations must be >= 1");
  if (options.tableau_rows < 0 || options.tableau_rows > SmallPivoting::kMaxRows) {
    throw InputError("auto: tableau_rows must be in [0, " + std::to_string(SmallPivoting::kMaxRows) + "]");
  }
}
AutoSolver::~AutoSolver() = default;

std::string AutoSolver::WhyUnsupported(const LcpProblem& problem) const {
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric";
}

void AutoSolver::Reserve(Index max_rows) { backends_->tableau.Reserve(std::min(max_rows, options_.tableau_rows)); }

void AutoSolver::DoPrepare(const LcpProblem& problem) {
  if (problem.size() <= options_.tableau_rows) {
    problem.DenseA();
    backends_->tableau.Reserve(problem.size());
  } else {
    backends_->newton.Prepare(problem);
  }
}

void AutoSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const bool small = problem.size() <= options_.tableau_rows;
  if (small && options.max_iterations == 0 && backends_->TryTableau(problem, options, result)) return;
  const Deadline deadline(options);
  LcpOptions granted = options;
  if (granted.max_iterations == 0) granted.max_iterations = options_.newton_factorisations;
  if (backends_->Try(&backends_->newton, "semismooth-newton", problem, granted, deadline, result)) return;
#ifdef LCPBENCH_WITH_SUITESPARSE
  if (backends_->Try(&backends_->interior, "suitesparse", problem, options, deadline, result)) return;
#endif
  backends_->Try(&backends_->dantzig, "dantzig", problem, options, deadline, result);
}

}  // namespace lcpbench
