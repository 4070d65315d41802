#include "solvers/auto/auto_portfolio.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solvers/auto/band_pivoting.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/cost_model.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/linear_algebra/kept_order.h"

namespace lcpbench {
namespace {

// What nncg may cost before the others take over, in factorizations: about what block pivoting needs where it does
// well, and half of what the Newton method needs on redundant rows.
constexpr double kFactorizationsOfBpp = 6;
constexpr double kFactorizationsOfNewton = 12;
// The same for psor, which is asked only where it is the cheapest; and its sweep, in nncg iterations.
constexpr double kFactorizationsForPsor = 4;
constexpr double kPsorTime = 0.5;
// nncg goes before block pivoting if a factorization costs as much as so many of its iterations.
constexpr double kProbeRatio = 6;
constexpr std::int64_t kLeastNncgIterations = 16;
// Block pivoting that needs more than this has met cycles, which cost it more than the Newton method.
constexpr std::int64_t kMostFactorizationsOfBpp = 24;

// Of large problems: up to here a factor has so little fill that block pivoting is the fastest; above, sweeps arrive
// before block pivoting would be set up. The scene families lie below 0.13 or above 0.5.
constexpr double kFewCycles = 0.25;
// Of a sparse A that is given: nncg iterations before block pivoting is set up, for the root of the number of rows, in
// proportion to which they grow on grids; and how many pass before their rate is looked at, because it rises once the
// active set is nearly found.
constexpr double kSweepsPerRootOfRows = 8;
constexpr std::int64_t kHopefulSweepsOfGiven = 48;
// Below, block pivoting is set up in so short a time that it pays where the same rows are solved again and again.
constexpr Index kLeastRowsOfSweepsAlone = 5000;
// A dense A of 0.2 GB, and minutes.
constexpr Index kMostRowsOfDantzig = 5000;

#ifdef LCPBENCH_WITH_SUITESPARSE
constexpr bool kHasHybrid = true;
// What the sweeps of large packings may take: before hybrid as within it.
constexpr std::int64_t kSweepsOfLarge = HybridOptions{}.most_iterations;
#else
constexpr bool kHasHybrid = false;
constexpr std::int64_t kSweepsOfLarge = 0;
#endif

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
bool IsNarrow(const LcpProblem& problem) {
  const SparseMatrix& A = problem.SparseA();
  for (Index i = 0; i < A.rows(); ++i) {
    const Index last = A.innerIndexPtr()[A.outerIndexPtr()[i + 1] - 1];  // the diagonal is always stored
    if (!BandPivoting::IsNarrow(last - i)) return false;
  }
  return true;
}

}  // namespace

AutoPortfolio::AutoPortfolio(std::int64_t newton_factorizations, bool self_check)
    : newton_factorizations_(newton_factorizations),
      psor_({.relaxation = PgsOptions::kFirstOfAdaptive,
             .adaptive = true,
             .end_when_hopeless = true,
             .self_check = self_check}),
      nncg_({.end_when_hopeless = true, .self_check = self_check}),
      nncg_of_given_({.end_when_hopeless = true, .least_iterations = kHopefulSweepsOfGiven, .self_check = self_check}),
      bpp_({.end_when_singular = true, .self_check = self_check}),
      newton_({.self_check = self_check}),
#ifdef LCPBENCH_WITH_SUITESPARSE
      hybrid_({.self_check = self_check}),
#endif
      dantzig_([self_check] {
        DantzigOptions options;
        options.self_check = self_check;
        return options;
      }()) {
}

// Up to which number of iterations nncg may go for the price of so many factorizations.
std::int64_t AutoPortfolio::NncgLimit(double factorizations, double step_time) const {
  return std::max(kLeastNncgIterations, static_cast<std::int64_t>(factorizations * step_time / nncg_time_));
}

bool AutoPortfolio::PrepareBpp(const LcpProblem& problem) {
  try {
    bpp_.Prepare(problem);
    has_bpp_ = true;
  } catch (const MemoryRefusal&) {
    // Others need less.
  }
  return has_bpp_;
}

bool AutoPortfolio::IsLarge(const LcpProblem& problem) {
  return kHasHybrid && problem.size() > kSmallRows && problem.given_form() != MatrixForm::kDense;
}

void AutoPortfolio::Classify(const LcpProblem& problem) {
  is_redundant_ = RowsOutnumberDegreesOfFreedom(problem);
  is_large_ = IsLarge(problem);
  suits_tableau_ = is_redundant_;
}

void AutoPortfolio::Prepare(const LcpProblem& problem) {
  Classify(problem);
  nncg_time_ = CostModel::Sweep(problem);
  nncg_limit_ = 0;
  psor_limit_ = 0;
  has_bpp_ = false;
  sweeps_alone_ = is_large_ && !is_redundant_ && problem.given_form() == MatrixForm::kSparse && !IsNarrow(problem);
  if (sweeps_alone_) {
    const auto rows = static_cast<double>(problem.size());
    nncg_limit_ = static_cast<std::int64_t>(kSweepsPerRootOfRows * std::sqrt(rows));
  } else if (is_redundant_ && is_large_) {
    // Sweeps and their limits are hybrid's own.
  } else if (is_large_ && problem.size() >= kLeastRowsOfSweepsAlone && problem.has_factors() &&
             problem.has_two_body_rows() && CyclesPerBody(problem) > kFewCycles) {
    nncg_limit_ = kSweepsOfLarge;
  } else if (is_redundant_) {
    newton_.Prepare(problem);
    nncg_limit_ = NncgLimit(kFactorizationsOfNewton, newton_.StepTime());
  } else if (PrepareBpp(problem)) {
    suits_tableau_ = bpp_.is_dense();
    if (bpp_.StepTime() > kProbeRatio * nncg_time_) {
      nncg_limit_ = NncgLimit(kFactorizationsOfBpp, bpp_.StepTime());
      psor_limit_ = static_cast<std::int64_t>(kFactorizationsForPsor * bpp_.StepTime() / (kPsorTime * nncg_time_));
      psor_.Prepare(problem);
    }
  }
  if (nncg_limit_ > 0) (sweeps_alone_ ? nncg_of_given_ : nncg_).Prepare(problem);
  start_.setZero(problem.size());
}

// True if there is nothing left to try: solved and passed, proved infeasible, or out of time.
bool AutoPortfolio::Try(LcpSolver* solver, std::string_view name, std::int64_t limit, LcpResult* result) {
  LcpOptions rest = *options_;
  rest.time_limit_s = deadline_->Remaining();
  if (limit > 0) rest.max_iterations = rest.max_iterations > 0 ? std::min(rest.max_iterations, limit) : limit;
  if (has_start_) rest.initial_f = &start_;
  if (!(rest.time_limit_s > 0)) {
    result->status = LcpStatus::kTimeLimit;
    return true;
  }
  const std::string before = std::move(result->detail);
  solver->Solve(*problem_, rest, result);
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

// Residuals are taken here and not where points are remembered: mostly the next backend arrives.
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

// Psor or nncg. What they leave is where the next ones start.
bool AutoPortfolio::TrySweeps(LcpSolver* solver, std::string_view name, std::int64_t limit, LcpResult* result) {
  if (Try(solver, name, limit, result)) return true;
  if (result->f.allFinite()) {
    start_ = result->f;
    has_start_ = true;
  }
  return false;
}

bool AutoPortfolio::TryBpp(LcpResult* result) {
  if (Try(&bpp_, "bpp", kMostFactorizationsOfBpp, result)) return true;
  // What it has when it runs out of factorizations is mostly right but for a few rows.
  if (is_large_ && result->iterations > 1 && result->f.allFinite()) {
    start_ = result->f;
    has_start_ = true;
  }
  const bool is_singular = result->iterations == 1 && result->status == LcpStatus::kNumericalFailure;
  // A sweep over a dense A costs too much of its factorization; hybrid has sweeps of its own.
  if (!is_singular || nncg_limit_ > 0 || bpp_.is_dense() || is_large_) return false;
  return TrySweeps(&nncg_, "nncg", NncgLimit(kFactorizationsOfNewton, bpp_.StepTime()), result);
}

void AutoPortfolio::Solve(const LcpProblem& problem, const LcpOptions& options, Choice choice, const Deadline& deadline,
                          LcpResult* result) {
  problem_ = &problem;
  options_ = &options;
  deadline_ = &deadline;
  has_start_ = options.initial_f != nullptr;
  if (has_start_) start_ = *options.initial_f;
  reached_count_ = 0;
  if (!result->f.isZero(0)) Remember(result->f);
  AskAll(choice, result);
  const bool arrived = result->status == LcpStatus::kSolved || result->status == LcpStatus::kInfeasible;
  if (!arrived && reached_count_ > 0) TakeTheBest(result);
}

void AutoPortfolio::AskAll(Choice choice, LcpResult* result) {
  if (choice == Choice::kByCost) {
    if (psor_limit_ > 0 && TrySweeps(&psor_, "psor", psor_limit_, result)) return;
    NncgSolver& nncg = sweeps_alone_ ? nncg_of_given_ : nncg_;
    if (nncg_limit_ > 0 && TrySweeps(&nncg, "nncg", nncg_limit_, result)) return;
    if (sweeps_alone_ && !has_bpp_) PrepareBpp(*problem_);
    if (has_bpp_ && TryBpp(result)) return;
  }
  const bool begins_with_hybrid = choice == Choice::kByCost && is_large_;
  if (begins_with_hybrid ? TryHybrid(result) : TryNewton(result)) return;
  has_start_ = options_->initial_f != nullptr;
  if (has_start_) start_ = *options_->initial_f;
  if (begins_with_hybrid ? TryNewton(result) : TryHybrid(result)) return;
  if (problem_->size() <= kMostRowsOfDantzig) Try(&dantzig_, "dantzig", 0, result);
}

bool AutoPortfolio::TryNewton(LcpResult* result) {
  return Try(&newton_, "semismooth-newton", newton_factorizations_, result);
}

bool AutoPortfolio::TryHybrid(LcpResult* result) {
#ifdef LCPBENCH_WITH_SUITESPARSE
  return Try(&hybrid_, "hybrid", 0, result);
#else
  static_cast<void>(result);
  return false;
#endif
}

}  // namespace lcpbench
