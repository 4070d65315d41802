#include "benchmarks/large_cell.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <memory>

#include "benchmarks/body_system.h"
#include "benchmarks/growth_report.h"
#include "benchmarks/mass_spread.h"
#include "benchmarks/peak_memory.h"
#include "benchmarks/solver_pool.h"
#include "model/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

constexpr int kMostRuns = 5;

// u |D^-1/2 |J| M^-1 |J|^T |f||_2 / |D^-1/2 b|_2.
double Floor(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const SparseMatrix J = problem.J().cwiseAbs();
  const Eigen::VectorXd body = problem.inverse_mass().cwiseProduct(J.transpose() * f.cwiseAbs());
  const Eigen::VectorXd root =
      problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1.0 : std::sqrt(std::abs(d)); });
  const double b_norm = problem.b().cwiseQuotient(root).norm();
  const double sum = (J * body).cwiseQuotient(root).norm();
  return std::numeric_limits<double>::epsilon() / 2 * (b_norm == 0 ? sum : sum / b_norm);
}

double OrNegative(double value) { return std::isfinite(value) ? value : -1; }

void WriteAnswer(const std::string& path, const Eigen::VectorXd& f) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(f.data()), static_cast<std::streamsize>(sizeof(double)) * f.size());
  if (!file) throw InputError(path + ": writing the answer failed");
}

Eigen::VectorXd ReadAnswer(const std::string& path, Index size) {
  Eigen::VectorXd f(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(f.data()), static_cast<std::streamsize>(sizeof(double)) * size);
  if (!file) throw InputError(path + ": expected an answer of " + std::to_string(size) + " rows");
  return f;
}

double PeakOfWorkers() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

// Of the processor, by all threads of this process [s].
double ProcessTime() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Times {
  double setup_s = 0;
  double solve_s = 0;
  double total() const { return setup_s + solve_s; }
};

Times SolveOnce(LcpSolver* solver, const LcpProblem& problem, const LcpOptions& options, double (*now)(),
                LcpResult* result) {
  Times times;
  const double start = now();
  solver->Prepare(problem);
  const double prepared = now();
  solver->Solve(problem, options, result);
  times.solve_s = result->own_solve_s >= 0 ? result->own_solve_s : now() - prepared;
  times.setup_s = prepared - start;
  return times;
}

std::string VerdictText(const LcpResult& result, const Verdict& verdict) {
  if (verdict.passes) return "verified";
  if (verdict.false_success) return "false success";
  if (verdict.false_infeasible) return "false infeasible";
  return std::string(ToString(result.status));
}

}  // namespace

LcpProblem LargeProblem::Make() const {
  LcpProblem problem = AssembleContactLcp(GenerateScene(family, size, seed)).problem;
  return mass_ratio > 1 ? SpreadMasses(problem, mass_ratio, seed) : problem;
}

SolveOutcome RunSolveCell(const SolveCell& cell) {
  const LcpProblem problem = cell.problem.Make();
  const SolverEntry& entry = FindSolver(cell.solver);
  auto pool = std::make_unique<SolverPool>();  // starting a worker is no part of solving
  LcpSolver* solver = &pool->Get(entry);
  LcpOptions options;
  options.tolerance = cell.tolerance;
  options.time_limit_s = cell.time_limit_s;
  double (*const now)() = cell.cpu_time ? &ProcessTime : &SteadyNow;
  SolveOutcome outcome;
  LcpResult result;
  ResetPeak();
  Times times = SolveOnce(solver, problem.CopyOfGivenForm(), options, now, &result);
  outcome.peak_bytes = PeakBytes();
  for (int run = 1; run < kMostRuns && times.total() < kRepeatBelow; ++run) {
    const LcpProblem copy = problem.CopyOfGivenForm();
    solver = &pool->Get(entry);
    LcpResult again;
    const Times next = SolveOnce(solver, copy, options, now, &again);
    if (next.total() < times.total()) times = next;
  }
  pool.reset();
  if (entry.origin != SolverOrigin::kOwn) outcome.peak_bytes = PeakOfWorkers();

  const Verdict verdict = Verify(problem, result, cell.tolerance);
  outcome.verified = verdict.passes;
  outcome.verdict = VerdictText(result, verdict);
  outcome.detail = verdict.passes || result.detail.empty() ? verdict.reason : result.detail;
  outcome.setup_s = times.setup_s;
  outcome.solve_s = times.solve_s;
  outcome.iterations = result.iterations;
  outcome.rho = OrNegative(verdict.metrics.rho);
  outcome.backward_error = OrNegative(verdict.metrics.backward_error);
  outcome.floor = OrNegative(Floor(problem, result.f));
  if (verdict.passes && !cell.answer_file.empty()) WriteAnswer(cell.answer_file, result.f);
  return outcome;
}

OracleOutcome RunOracleCell(const OracleCell& cell) {
  const LcpProblem problem = cell.problem.Make();
  const Eigen::VectorXd f = ReadAnswer(cell.answer_file, problem.size());
  const Eigen::VectorXd w = ComputeMetrics(problem, f).w;
  const std::vector<Index> active = ActiveRows(problem, f, w);
  double (*const now)() = cell.cpu_time ? &ProcessTime : &SteadyNow;
  const std::optional<Factorisation> best = Cheapest(TimeBodySpace(problem, active, now));
  if (!best.has_value()) throw InputError("K needs CHOLMOD, which is not in this build");
  OracleOutcome outcome;
  outcome.bodies = MakeBodySystem(problem, active).bodies();
  outcome.active = static_cast<Index>(active.size());
  outcome.best = *best;
  if (problem.size() <= kLargestContactSpace) outcome.contact_s = TimeContactSpace(problem, active, now);
  return outcome;
}

}  // namespace lcpbench
