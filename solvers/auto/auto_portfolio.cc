#include "solvers/auto/auto_portfolio.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/cost_model.h"
#include "solvers/linear_algebra/islands.h"

namespace lcpbench {
namespace {

#ifdef LCPBENCH_WITH_SUITESPARSE
constexpr bool kHasIpm = true;
#else
constexpr bool kHasIpm = false;
#endif

// False where that needs more memory than there is: other methods need less.
bool HasPrepared(LcpSolver* solver, const LcpProblem& problem) {
  try {
    solver->Prepare(problem);
    return true;
  } catch (const MemoryRefusal&) {
    return false;
  }
}

bool IsOfHybrid(AutoMethod method) { return method >= AutoMethod::kGuess && method <= AutoMethod::kIpm; }

// More rows than columns of J that can move anything: A = J M^-1 J^T is singular. False where that is not known.
bool RowsOutnumberDegreesOfFreedom(const LcpProblem& problem) {
  if (problem.facts().rank.has_value()) return *problem.facts().rank < problem.size();
  if (!problem.has_factors()) return false;
  const SparseMatrix& J = problem.J();
  std::vector<char> is_free(static_cast<size_t>(J.cols()), 0);
  Index degrees_of_freedom = 0;
  for (Index i = 0; i < J.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      char& seen = is_free[static_cast<size_t>(it.col())];
      if (seen != 0 || it.value() == 0 || problem.inverse_mass()[it.col()] == 0) continue;
      seen = 1;
      ++degrees_of_freedom;
    }
  }
  return problem.size() > degrees_of_freedom;
}

// Cycles in the graph of bodies and pairs that share a row, by body: 0 for trees and chains, whose factor has no fill;
// about 1 in a packing of discs. Rows of one body, or of one pair more, make no cycle. O(nnz J log)
double CyclesPerBody(const LcpProblem& problem) {
  std::vector<std::pair<int, int>> pairs;
  for (Index i = 0; i < problem.size(); ++i) {
    const auto [first, second] = BodiesOfRow(problem, i);
    if (second >= 0) pairs.push_back(std::minmax({first, second}));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  const Index bodies = problem.J().cols() / problem.columns_per_body() + 1;
  DisjointSets joined;
  joined.Reset(bodies);
  const auto cycles = std::count_if(pairs.begin(), pairs.end(),
                                    [&](const auto& pair) { return !joined.Join(pair.first, pair.second); });
  return static_cast<double>(cycles) / static_cast<double>(bodies);
}

// Whether a factor within the band of A takes so few operations that no sweep is cheaper.
bool IsNarrow(const LcpProblem& problem, Index narrow_band) {
  const SparseMatrix& A = problem.SparseA();
  for (Index i = 0; i < A.rows(); ++i) {
    const Index last = A.innerIndexPtr()[A.outerIndexPtr()[i + 1] - 1];  // the diagonal is always stored
    if (last - i > narrow_band) return false;
  }
  return true;
}

}  // namespace

AutoPortfolio::AutoPortfolio(const HybridOptions& hybrid) : AutoPortfolio(hybrid, kDefaultLimits, true) {}

AutoPortfolio::AutoPortfolio(const AutoLimits& limits)
    : AutoPortfolio({.least_iterations = static_cast<int>(limits.hybrid_least_sweeps),
                     .most_iterations = static_cast<int>(limits.hybrid_most_sweeps)},
                    limits, false) {}

AutoPortfolio::AutoPortfolio(const HybridOptions& hybrid, const AutoLimits& limits, bool is_hybrid)
    : hybrid_(hybrid),
      limits_(limits),
      is_hybrid_(is_hybrid),
      psor_({.relaxation = PgsOptions::kFirstOfAdaptive, .adaptive = true, .end_when_hopeless = true}),
      nncg_({.end_when_hopeless = true}),
      patient_nncg_({.end_when_hopeless = true, .least_iterations = limits.sparse_nncg_patience}),
      hybrid_nncg_({.end_when_hopeless = true, .least_iterations = hybrid.least_iterations}),
      bpp_({.end_when_singular = true}) {}

void AutoPortfolio::Classify(const LcpProblem& problem) {
  facts_ = {.limits = &limits_, .rows = problem.size()};
  facts_.is_redundant = RowsOutnumberDegreesOfFreedom(problem);
  facts_.is_large = kHasIpm && problem.size() > limits_.large_rows && problem.given_form() != MatrixForm::kDense;
  if (kHasIpm && problem.size() >= limits_.hybrid_rows && hybrid_.most_iterations > 0) {
    facts_.hybrid_sweeps = std::max(hybrid_.least_iterations, hybrid_.most_iterations);
  }
  start_.setZero(problem.size());
}

void AutoPortfolio::Prepare(const LcpProblem& problem) {
  Classify(problem);
#ifdef LCPBENCH_WITH_SUITESPARSE
  if (is_hybrid_) return PrepareHybrid(problem);
#endif
  facts_.iteration_time = CostModel::Sweep(problem);
  const bool is_sound = facts_.is_large && !facts_.is_redundant;
  facts_.is_wide_sparse =
      is_sound && problem.given_form() == MatrixForm::kSparse && !IsNarrow(problem, limits_.narrow_band);
  facts_.is_packing = is_sound && problem.size() >= limits_.packing_rows && problem.has_factors() &&
                      problem.has_two_body_rows() && CyclesPerBody(problem) > limits_.packing_cycles;
  if (facts_.is_wide_sparse) return patient_nncg_.Prepare(problem);
  if (facts_.is_packing) return nncg_.Prepare(problem);
  if (facts_.is_redundant && !facts_.is_large) {
    newton_.Prepare(problem);
    facts_.factor_time = newton_.StepTime();
  } else if (!facts_.is_redundant && HasPrepared(&bpp_, problem)) {
    facts_.has_dense_factor = bpp_.is_dense();
    facts_.factor_time = bpp_.StepTime();
  }
  bool sweeps = false;
  for (const AutoRule& rule : AutoRulesOf(AutoStage::kBackends)) {
    if (rule.Grants(facts_) == 0) continue;
    if (rule.method == AutoMethod::kPsor) psor_.Prepare(problem);
    sweeps = sweeps || rule.method == AutoMethod::kNncg;
  }
  if (sweeps) nncg_.Prepare(problem);
}

// True if there is nothing left to try: solved and passed, proved infeasible, or out of time.
bool AutoPortfolio::RunBackend(LcpSolver* solver, std::string_view name, std::int64_t limit, LcpResult* result) {
  LcpOptions rest = *options_;
  rest.time_limit_s = deadline_->Remaining();
  if (rest.max_iterations > 0) limit = std::min(limit, rest.max_iterations - iterations_);
  if (limit != kOwnLimit) rest.max_iterations = limit;
  rest.initial_f = facts_.has_start ? &start_ : nullptr;
  if (limit <= 0 || !(rest.time_limit_s > 0)) {
    result->status = limit <= 0 ? LcpStatus::kIterationLimit : LcpStatus::kTimeLimit;
    return true;
  }
  const std::string before = std::move(result->detail);
  solver->Solve(*problem_, rest, result);
  result->iterations = iterations_ += result->iterations;
  const std::string said = std::move(result->detail);
  result->detail = before;
  if (!before.empty()) result->detail += "; ";
  result->detail += name;
  if (!said.empty()) result->detail.append(": ").append(said);
  if (result->status == LcpStatus::kSolved || result->status == LcpStatus::kInfeasible ||
      result->status == LcpStatus::kTimeLimit) {
    return true;  // each of them has judged its answer or ray
  }
  Remember(result->f);
  return false;
}

void AutoPortfolio::Remember(const Eigen::VectorXd& f) {
  if (reached_count_ == reached_.size()) reached_.emplace_back();
  reached_[reached_count_++] = f;
}

// Residuals are taken here and not where points are remembered: mostly the next method arrives.
void AutoPortfolio::TakeTheBest(LcpResult* result) {
  test_.Reset(*problem_, GivenFormTest::Rows::kGivenWhenNeeded);
  long double least = test_.Rho(result->f);
  for (std::size_t k = 0; k < reached_count_; ++k) {
    const long double rho = test_.Rho(reached_[k]);
    if (!(rho < least) && !std::isnan(least)) continue;
    least = rho;
    result->f = reached_[k];
  }
}

// Where the next method starts: at f, or cold.
void AutoPortfolio::StartAt(const Eigen::VectorXd* f) {
  facts_.has_start = f != nullptr;
  if (f != nullptr) start_ = *f;
}

// The next method starts at the forces that sweeps have reached.
bool AutoPortfolio::TrySweeps(LcpSolver* solver, std::string_view name, std::int64_t granted, LcpResult* result) {
  if (RunBackend(solver, name, granted, result)) return true;
  if (result->f.allFinite()) StartAt(&result->f);
  return false;
}

bool AutoPortfolio::TryBpp(std::int64_t granted, LcpResult* result) {
  if (!HasPrepared(&bpp_, *problem_)) return false;
  const std::int64_t before = iterations_;
  if (RunBackend(&bpp_, "bpp", granted, result)) return true;
  const std::int64_t taken = iterations_ - before;
  // What it has when it runs out of factorizations is mostly right but for a few rows.
  if (facts_.is_large && taken > 1 && result->f.allFinite()) StartAt(&result->f);
  facts_.has_dependent_rows = taken == 1 && result->status == LcpStatus::kNumericalFailure;
  return false;
}

// Asks a method after which the next one starts anew.
bool AutoPortfolio::TryFromStart(LcpSolver* solver, std::string_view name, std::int64_t granted, LcpResult* result) {
  if (RunBackend(solver, name, granted, result)) return true;
  StartAt(options_->initial_f);
  return false;
}

bool AutoPortfolio::TryMethod(AutoMethod method, std::int64_t granted, LcpResult* result) {
  const std::string_view name = KeyOf(method);
  switch (method) {
    case AutoMethod::kPsor:
      return TrySweeps(&psor_, name, granted, result);
    case AutoMethod::kNncg:
    case AutoMethod::kPatientNncg:
      facts_.has_swept = true;
      return TrySweeps(method == AutoMethod::kNncg ? &nncg_ : &patient_nncg_, name, granted, result);
    case AutoMethod::kBpp:
      return TryBpp(granted, result);
    case AutoMethod::kSemismoothNewton:
      return TryFromStart(&newton_, name, limits_.newton_factorizations, result);
    case AutoMethod::kHybridNncg:
      return TrySweeps(&hybrid_nncg_, name, granted, result);
    case AutoMethod::kGuess:
    case AutoMethod::kIpm:
#ifdef LCPBENCH_WITH_SUITESPARSE
      if (method == AutoMethod::kGuess) return TryGuess(name, result);
      ipm_.UseWarmStart(facts_.hybrid_sweeps > 0 ? IpmSolver::WarmStart::kAfterSweeps : IpmSolver::WarmStart::kFull);
      return TryFromStart(&ipm_, name, granted, result);
#else
      return false;
#endif
    default:
      return RunBackend(&dantzig_, name, granted, result);
  }
}

void AutoPortfolio::Solve(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                          LcpResult* result) {
  problem_ = &problem;
  options_ = &options;
  deadline_ = &deadline;
  facts_.has_swept = facts_.has_dependent_rows = false;
  StartAt(options.initial_f);
  reached_count_ = 0;
  iterations_ = 0;
  if (!result->f.isZero(0)) Remember(result->f);
  for (const AutoRule& rule : AutoRulesOf(AutoStage::kBackends)) {
    if (is_hybrid_ && !IsOfHybrid(rule.method)) continue;
    const std::int64_t granted = rule.Grants(facts_);
    if (granted > 0 && TryMethod(rule.method, granted, result)) break;
  }
  const bool arrived = result->status == LcpStatus::kSolved || result->status == LcpStatus::kInfeasible;
  if (!arrived && reached_count_ > 0) TakeTheBest(result);
}

void HybridOptions::Read(SettingsReader* reader) {
  constexpr double kMost = 100000;
  least_iterations = static_cast<int>(reader->Number("least_iterations", least_iterations, 0, kMost));
  most_iterations = static_cast<int>(reader->Number("most_iterations", most_iterations, 0, kMost));
}

#ifdef LCPBENCH_WITH_SUITESPARSE
void AutoPortfolio::PrepareHybrid(const LcpProblem& problem) {
  if (facts_.hybrid_sweeps > 0) hybrid_nncg_.Prepare(problem);
  if (facts_.hybrid_sweeps == 0 || problem.size() <= limits_.analysed_rows) ipm_.Prepare(problem);
}

// A start that says nothing is passed over. Of others the active set is tried, where factorizations are cheap.
bool AutoPortfolio::TryGuess(std::string_view name, LcpResult* result) {
  test_.Reset(*problem_, GivenFormTest::Rows::kGivenWhenNeeded);
  const long double rho = test_.Rho(start_);
  if (!(rho < limits_.start_share * test_.Rho(Eigen::VectorXd::Zero(start_.size())))) StartAt(nullptr);
  if (!facts_.has_start || start_.size() > limits_.analysed_rows || !HasPrepared(&ipm_, *problem_)) return false;
  const IpmStatistics& factor = ipm_.statistics();
  const double sweeps = CostModel::SweepsPerFactorization(*problem_, factor.factor_flops, factor.fill);
  if (sweeps > limits_.guess_factorization) return false;
  ipm_.UseWarmStart(IpmSolver::WarmStart::kGuessOnly);
  return TrySweeps(&ipm_, name, static_cast<std::int64_t>(limits_.guess_sweeps / sweeps), result);
}

std::string AutoPortfolio::WhyUnsupported(const LcpProblem& problem) const { return ipm_.WhyUnsupported(problem); }
const IpmStatistics& AutoPortfolio::statistics() const { return ipm_.statistics(); }
const IpmStatistics& HybridSolver::statistics() const { return engine_->statistics(); }

template class EngineSolver<HybridOptions, AutoPortfolio>;
#endif

}  // namespace lcpbench
