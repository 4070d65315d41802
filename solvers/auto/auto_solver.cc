#include "solvers/auto/auto_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/auto/auto_portfolio.h"
#include "solvers/auto/islands.h"
#include "solvers/lcp/given_form.h"
#include "solvers/lcp/verify.h"
#include "solvers/pivoting/small_pivoting.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Above this rho a tableau counts as failed, whatever the tolerance: other backends do better.
constexpr double kTableauRho = 1e-9;
// Backward errors in double of at most this part of what is allowed pass in extended precision, too.
constexpr double kMargin = 0.1;
// Where the rows that remain are more than this part of all, the whole problem is as cheap, and is set up already.
constexpr double kWorthDividing = 0.75;
// Fewer idle rows than one in so many are not likely to cut an island into pieces of a tableau's size: the longest
// piece of a chain cut at random is some ln(cuts) times the mean one.
constexpr Index kRowsPerCut = 16;

// What is known of a tableau's answer in double.
enum class Known { kRight, kUnclear, kWrong };

Known Judge(const SmallPivoting::Answer& answer, double tolerance) {
  if (!(answer.rho <= kTableauRho && answer.rho <= tolerance && answer.rows_meet)) return Known::kWrong;
  return answer.rho + answer.rounding <= tolerance ? Known::kRight : Known::kUnclear;
}

}  // namespace

struct AutoSolver::Parts {
  explicit Parts(const AutoOptions& auto_options)
      : own(auto_options), whole(auto_options.newton_factorisations, auto_options.self_check) {}

  void PrepareWhole(const LcpProblem& problem) {
    whole.Prepare(problem);
    whole_is_ready = true;
  }
  SmallPivoting::Request RequestFor(const LcpOptions& options, const Deadline* deadline) const {
    return {kMargin * std::sqrt(options.tolerance), options.initial_f, deadline, own.self_check};
  }
  bool TryTableau(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline, LcpResult* result);
  bool TryIslands(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);
  void SolveRest(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);

  AutoOptions own;
  Index tableau_rows = 0;  // of the prepared problem
  SmallPivoting tableau;
  AutoPortfolio whole;  // for all rows
  bool whole_is_ready = false;
  bool divides = false;  // whether islands are looked for at all

  GivenFormTest test;  // of problems of one tableau

  // Of problems that are too large for one tableau.
  IdleRows idle_rows;
  Islands islands;
  bool has_islands = false;  // even with all rows
  Index few_idle_rows = 1;   // fewer cannot cut one island into small ones
  std::vector<Index> rest;
  Eigen::VectorXd rest_start;
  AnswerJudge judge;
};

bool AutoSolver::Parts::TryTableau(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline,
                                   LcpResult* result) {
  const Known known = Judge(tableau.Solve(problem, RequestFor(options, deadline), &result->f), options.tolerance);
  if (known == Known::kWrong) return false;
  if (known == Known::kUnclear) {
    test.SetB(problem);
    if (!test.Meets(options.tolerance, result->f)) return false;
  }
  result->status = LcpStatus::kSolved;
  result->iterations = tableau.pivots();
  result->detail = "tableau";
  return true;
}

// Small islands by tableau, the rest by a portfolio of its own. False if dividing does not pay or led to nothing.
bool AutoSolver::Parts::TryIslands(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                                   LcpResult* result) {
  if (!divides) return false;
  const Index idle = idle_rows.Find(problem);
  if (idle < few_idle_rows && !has_islands) return false;
  islands.Find(problem.SparseA(), idle_rows.keep());
  const double worth = kWorthDividing * static_cast<double>(problem.size());
  Index large_rows = 0;
  for (Index k = 0; k < islands.count(); ++k) {
    const auto rows = static_cast<Index>(islands.rows(k).size());
    if (rows > tableau_rows) large_rows += rows;
  }
  if (static_cast<double>(large_rows) > worth) return false;
  rest.clear();
  std::int64_t pivots = 0;
  for (Index k = 0; k < islands.count(); ++k) {
    const std::span<const Index> rows = islands.rows(k);
    const bool solved = static_cast<Index>(rows.size()) <= tableau_rows &&
                        Judge(tableau.SolvePart(problem, rows, RequestFor(options, &deadline), &result->f),
                              options.tolerance) != Known::kWrong;  // what is unclear is judged with the whole
    if (solved) {
      pivots += tableau.pivots();
    } else {
      rest.insert(rest.end(), rows.begin(), rows.end());
    }
    if (deadline.Expired()) {
      result->status = LcpStatus::kTimeLimit;
      return true;
    }
  }
  result->detail = std::to_string(islands.count()) + " islands, largest " + std::to_string(islands.largest()) +
                   " rows, " + std::to_string(idle) + " idle rows";
  result->iterations = pivots;
  result->status = LcpStatus::kSolved;
  if (!rest.empty()) SolveRest(problem, options, deadline, result);
  if (result->status != LcpStatus::kSolved) return result->status != LcpStatus::kNumericalFailure;
  if (!own.self_check) return true;
  // All parts passed; what joins them, and rows left out, have not been looked at.
  judge.SetB(problem);
  judge.Start(options.tolerance);
  judge.candidate() = result->f;
  judge.Publish(result);
  if (judge.tier() <= options.tolerance) return true;
  result->status = LcpStatus::kNumericalFailure;
  return false;
}

void AutoSolver::Parts::SolveRest(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                                  LcpResult* result) {
  std::sort(rest.begin(), rest.end());
  const LcpProblem part = Subproblem(problem, rest);
  const auto m = static_cast<Index>(rest.size());
  LcpOptions part_options = options;
  if (options.initial_f != nullptr) {
    rest_start.resize(m);
    for (Index k = 0; k < m; ++k) rest_start[k] = (*options.initial_f)[rest[static_cast<size_t>(k)]];
    part_options.initial_f = &rest_start;
  }
  AutoPortfolio portfolio(own.newton_factorisations, own.self_check);
  portfolio.Prepare(part);
  LcpResult answer;
  answer.f.setZero(m);
  portfolio.Solve(part, part_options, AutoPortfolio::Choice::kByCost, deadline, &answer);
  result->status = answer.status;
  result->iterations += answer.iterations;
  result->detail += "; " + answer.detail;
  for (Index k = 0; k < m; ++k) result->f[rest[static_cast<size_t>(k)]] = answer.f[k];
  if (answer.status != LcpStatus::kInfeasible) return;
  Eigen::VectorXd ray = Eigen::VectorXd::Zero(problem.size());
  for (Index k = 0; k < m; ++k) ray[rest[static_cast<size_t>(k)]] = (*answer.farkas_ray)[k];
  if (VerifyFarkasRay(problem, ray).accepted) {
    result->farkas_ray = std::move(ray);
  } else {
    result->status = LcpStatus::kNumericalFailure;
  }
}

AutoOptions AutoOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("auto", settings);
  AutoOptions options;
  const auto read_rows = [&](const char* name, Index* rows) {
    *rows = static_cast<Index>(
        reader.Number(name, static_cast<double>(*rows), 0, static_cast<double>(SmallPivoting::kMaxRows)));
  };
  read_rows("tableau_rows", &options.tableau_rows);
  read_rows("hard_tableau_rows", &options.hard_tableau_rows);
  options.newton_factorisations = static_cast<std::int64_t>(
      reader.Number("newton_factorisations", static_cast<double>(options.newton_factorisations), 1, 1e9));
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

AutoSolver::AutoSolver(AutoOptions options) : options_(options), parts_(std::make_unique<Parts>(options)) {
  if (options.newton_factorisations < 1) throw InputError("auto: newton_factorisations must be >= 1");
  for (const Index rows : {options.tableau_rows, options.hard_tableau_rows}) {
    if (rows < 0 || rows > SmallPivoting::kMaxRows) {
      throw InputError("auto: rows for a tableau must be in [0, " + std::to_string(SmallPivoting::kMaxRows) + "]");
    }
  }
}
AutoSolver::~AutoSolver() = default;

std::string AutoSolver::WhyUnsupported(const LcpProblem& problem) const {
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric";
}

void AutoSolver::Reserve(Index max_rows) { parts_->tableau.Reserve(std::min(max_rows, options_.tableau_rows)); }

void AutoSolver::DoPrepare(const LcpProblem& problem) {
  Parts& parts = *parts_;
  const Index n = problem.size();
  parts.tableau_rows = options_.tableau_rows;
  parts.whole_is_ready = false;
  parts.divides = n > options_.tableau_rows;
  const bool looks_first = AutoPortfolio::IsLarge(problem) && problem.has_factors();
  if (n > options_.tableau_rows) {
    if (looks_first) {
      parts.islands.FindByColumns(problem.J(), problem.inverse_mass());
      parts.divides = static_cast<double>(parts.islands.largest()) <= kWorthDividing * static_cast<double>(n);
    }
    if (looks_first && parts.divides) {
      parts.whole.Classify(problem);  // set up only if the islands turn out to be too large
    } else {
      parts.PrepareWhole(problem);
    }
    if (parts.whole.suits_tableau()) {
      parts.tableau_rows = std::max(parts.tableau_rows, options_.hard_tableau_rows);
    }
  }
  if (n <= parts.tableau_rows) {
    problem.DenseA();
    parts.tableau.Reserve(n);
    parts.test.Reset(problem, GivenFormTest::Columns::kWhenNeeded);
    return;
  }
  if (!parts.divides) return;
  parts.tableau.Reserve(parts.tableau_rows, n);
  parts.idle_rows.Prepare(problem);
  parts.rest.reserve(static_cast<size_t>(n));
  parts.judge.Reset(problem, false);
  parts.islands.Reserve(n);
  if (!looks_first) parts.islands.Find(problem.SparseA(), parts.idle_rows.keep());
  parts.has_islands = static_cast<double>(parts.islands.largest()) <= kWorthDividing * static_cast<double>(n);
  parts.few_idle_rows = n / kRowsPerCut;
}

void AutoSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  Parts& parts = *parts_;
  const bool may_choose = options.max_iterations == 0;  // the unit of a limit is the backend's
  // Reading the clock costs a tenth of the smallest problems, which a tableau ends in no time.
  std::optional<Deadline> limit;
  auto choice = AutoPortfolio::Choice::kByCost;
  if (std::isfinite(options.time_limit_s) && problem.size() > SmallPivoting::kRowsWithoutClock) limit.emplace(options);
  if (problem.size() <= parts.tableau_rows) {
    if (may_choose && parts.TryTableau(problem, options, limit.has_value() ? &*limit : nullptr, result)) return;
    choice = AutoPortfolio::Choice::kRobust;
  }
  const Deadline deadline = limit.value_or(Deadline(options));
  if (problem.size() > parts.tableau_rows && may_choose && parts.TryIslands(problem, options, deadline, result)) return;
  if (!parts.whole_is_ready && choice == AutoPortfolio::Choice::kByCost) parts.PrepareWhole(problem);
  parts.whole.Solve(problem, options, choice, deadline, result);
}

}  // namespace lcpbench
