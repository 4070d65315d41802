#include "solvers/auto/auto_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/auto/auto_portfolio.h"
#include "solvers/auto/band_pivoting.h"
#include "solvers/auto/matrix_arrays.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/pivoting/tableau_rules.h"
#include "solvers/rows/row_solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Where the rows that remain are more than this part of all, the whole problem is as cheap, and is set up already.
constexpr double kWorthDividing = 0.75;
// Fewer idle rows than one in so many are not likely to cut an island into pieces of a tableau's size: the longest
// piece of a chain cut at random is some ln(cuts) times the mean one.
constexpr Index kRowsPerCut = 16;

// Larger steps have islands that RowSolver leaves open anyway, and cost more to look at.
constexpr Index kMostStepRows = 20000;

// What is known of a tableau's answer in double.
enum class Known { kRight, kUnclear, kWrong };

Known Judge(const SmallPivoting::Answer& answer, double tolerance) {
  if (!(answer.rho <= tableau::kMostRho && answer.rho <= tolerance && answer.rows_meet)) return Known::kWrong;
  return answer.rho + answer.rounding <= tolerance ? Known::kRight : Known::kUnclear;
}

}  // namespace

AutoOptions AutoOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("auto", settings);
  AutoOptions options;
  const auto read_rows = [&](const char* name, Index* rows) {
    *rows = static_cast<Index>(
        reader.Number(name, static_cast<double>(*rows), 0, static_cast<double>(SmallPivoting::kMaxRows)));
  };
  read_rows("tableau_rows", &options.tableau_rows);
  read_rows("hard_tableau_rows", &options.hard_tableau_rows);
  options.newton_factorizations = static_cast<std::int64_t>(
      reader.Number("newton_factorizations", static_cast<double>(options.newton_factorizations), 1, 1e9));
  options.self_check = reader.SelfCheck();
  options.instructions = InstructionSetOf(reader.Choice("instructions", "best", {"best", "sse2", "avx2", "avx512"}));
  reader.Finish();
  return options;
}

class AutoEngine {
 public:
  explicit AutoEngine(const AutoOptions& options)
      : options_(options),
        tableau_(options.instructions),
        whole_(options.newton_factorizations, options.self_check),
        rows_(options.instructions) {
    if (options.newton_factorizations < 1) throw InputError("auto: newton_factorizations must be >= 1");
    for (const Index rows : {options.tableau_rows, options.hard_tableau_rows}) {
      if (rows < 0 || rows > SmallPivoting::kMaxRows) {
        throw InputError("auto: rows for a tableau must be in [0, " + std::to_string(SmallPivoting::kMaxRows) + "]");
      }
    }
  }

  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNotSymmetric(problem); }
  void Reserve(Index max_rows) { tableau_.Reserve(std::min(max_rows, options_.tableau_rows)); }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  bool SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);

 private:
  // Whether RowSolver may be asked; max_iterations is in the unit of a backend.
  bool MayAskRows(Index rows) const {
    return options_.self_check && options_.tableau_rows > 0 && rows <= kMostStepRows;
  }
  bool TryRows(const StepRows& rows, const LcpOptions& options, LcpResult* result);
  void PrepareLongWay(const LcpProblem& problem);
  void PrepareWhole(const LcpProblem& problem) {
    whole_.Prepare(problem);
    whole_is_ready_ = true;
  }
  SmallPivoting::Request RequestFor(const LcpOptions& options, const Deadline* deadline) const {
    const double* initial_f = options.initial_f == nullptr ? nullptr : options.initial_f->data();
    return {tableau::kMargin * std::sqrt(options.tolerance), initial_f, deadline, options_.self_check};
  }
  bool TryTableau(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline, LcpResult* result);
  bool TryTableauOfArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);
  bool SolveMatrix(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);
  bool TryIslands(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);
  void SolveRest(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);

  const AutoOptions options_;
  Index tableau_rows_ = 0;  // of the prepared problem
  SmallPivoting tableau_;
  AutoPortfolio whole_;  // for all rows
  bool whole_is_ready_ = false;
  bool divides_ = false;  // whether islands are looked for at all

  GivenFormTest test_;  // of problems of one tableau

  // Of arrays, and of problems by factors.
  ProblemArrays given_;  // of the prepared problem, which step_ reads
  TwoBodyCopy step_;
  bool has_step_ = false;           // of the prepared problem
  bool long_way_is_ready_ = false;  // for what RowSolver leaves open
  RowSolver rows_;
  Eigen::VectorXd gaps_;
  MatrixArrays matrix_;
  BandPivoting band_;

  // Of problems that are too large for one tableau.
  IdleRows idle_rows_;
  Islands islands_;
  bool has_islands_ = false;  // even with all rows
  Index few_idle_rows_ = 1;   // fewer cannot cut one island into small ones
  std::vector<Index> rest_;
  Eigen::VectorXd rest_start_;
  AnswerJudge judge_;
};

bool AutoEngine::TryTableau(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline,
                            LcpResult* result) {
  const Known known = Judge(tableau_.Solve(problem, RequestFor(options, deadline), &result->f), options.tolerance);
  if (known == Known::kWrong) return false;
  if (known == Known::kUnclear) {
    test_.SetB(problem);
    if (!test_.Meets(options.tolerance, result->f)) return false;
  }
  result->status = LcpStatus::kSolved;
  result->iterations = tableau_.pivots();
  result->detail = "tableau";
  return true;
}

// Small islands by tableau, the rest by a portfolio of its own. False if dividing does not pay or led to nothing.
bool AutoEngine::TryIslands(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                            LcpResult* result) {
  if (!divides_) return false;
  const Index idle = idle_rows_.Find(problem);
  if (idle < few_idle_rows_ && !has_islands_) return false;
  islands_.Find(problem.SparseA(), idle_rows_.keep());
  const double worth = kWorthDividing * static_cast<double>(problem.size());
  Index large_rows = 0;
  for (Index k = 0; k < islands_.count(); ++k) {
    const auto rows = static_cast<Index>(islands_.rows(k).size());
    if (rows > tableau_rows_) large_rows += rows;
  }
  if (static_cast<double>(large_rows) > worth) return false;
  rest_.clear();
  std::int64_t pivots = 0;
  for (Index k = 0; k < islands_.count(); ++k) {
    const std::span<const Index> rows = islands_.rows(k);
    const bool solved = static_cast<Index>(rows.size()) <= tableau_rows_ &&
                        Judge(tableau_.SolvePart(problem, rows, RequestFor(options, &deadline), &result->f),
                              options.tolerance) != Known::kWrong;  // what is unclear is judged with the whole
    if (solved) {
      pivots += tableau_.pivots();
    } else {
      rest_.insert(rest_.end(), rows.begin(), rows.end());
    }
    if (deadline.Expired()) {
      result->status = LcpStatus::kTimeLimit;
      return true;
    }
  }
  result->detail = std::to_string(islands_.count()) + " islands, largest " + std::to_string(islands_.largest()) +
                   " rows, " + std::to_string(idle) + " idle rows";
  result->iterations = pivots;
  result->status = LcpStatus::kSolved;
  if (!rest_.empty()) SolveRest(problem, options, deadline, result);
  if (result->status != LcpStatus::kSolved) return result->status != LcpStatus::kNumericalFailure;
  if (!options_.self_check) return true;
  // All parts passed; what joins them, and rows left out, have not been looked at.
  judge_.SetB(problem);
  judge_.Start(options.tolerance);
  judge_.candidate() = result->f;
  judge_.Publish(result);
  if (judge_.tier() <= options.tolerance) return true;
  result->status = LcpStatus::kNumericalFailure;
  return false;
}

void AutoEngine::SolveRest(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                           LcpResult* result) {
  std::sort(rest_.begin(), rest_.end());
  const LcpProblem part = Subproblem(problem, rest_);
  const auto m = static_cast<Index>(rest_.size());
  LcpOptions part_options = options;
  if (options.initial_f != nullptr) {
    rest_start_.resize(m);
    for (Index k = 0; k < m; ++k) rest_start_[k] = (*options.initial_f)[rest_[static_cast<size_t>(k)]];
    part_options.initial_f = &rest_start_;
  }
  AutoPortfolio portfolio(options_.newton_factorizations, options_.self_check);
  portfolio.Prepare(part);
  LcpResult answer;
  answer.f.setZero(m);
  portfolio.Solve(part, part_options, AutoPortfolio::Choice::kByCost, deadline, &answer);
  result->status = answer.status;
  result->iterations += answer.iterations;
  result->detail += "; " + answer.detail;
  for (Index k = 0; k < m; ++k) result->f[rest_[static_cast<size_t>(k)]] = answer.f[k];
  if (answer.status != LcpStatus::kInfeasible) return;
  Eigen::VectorXd ray = Eigen::VectorXd::Zero(problem.size());
  for (Index k = 0; k < m; ++k) ray[rest_[static_cast<size_t>(k)]] = (*answer.farkas_ray)[k];
  if (VerifyFarkasRay(problem, ray).accepted) {
    result->farkas_ray = std::move(ray);
  } else {
    result->status = LcpStatus::kNumericalFailure;
  }
}

// As from arrays: nothing else is prepared before RowSolver leaves something open.
void AutoEngine::Prepare(const LcpProblem& problem) {
  has_step_ = false;
  if (problem.has_factors() && MayAskRows(problem.size())) {
    given_ = ProblemArrays::Of(problem);
    std::fill(given_.b.begin(), given_.b.end(), 0.0);  // that of Solve's problem takes its place
    has_step_ = step_.Take(given_);
    if (has_step_) rows_.Reserve(step_.rows().rows, step_.rows().bodies);
  }
  long_way_is_ready_ = !has_step_;
  if (!has_step_) PrepareLongWay(problem);
}

void AutoEngine::PrepareLongWay(const LcpProblem& problem) {
  const Index n = problem.size();
  tableau_rows_ = options_.tableau_rows;
  whole_is_ready_ = false;
  divides_ = n > options_.tableau_rows;
  const bool looks_first = AutoPortfolio::IsLarge(problem) && problem.has_factors();
  if (n > options_.tableau_rows) {
    if (looks_first) {
      islands_.FindByColumns(problem.J(), problem.inverse_mass());
      divides_ = static_cast<double>(islands_.largest()) <= kWorthDividing * static_cast<double>(n);
    }
    if (looks_first && divides_) {
      whole_.Classify(problem);  // set up only if the islands turn out to be too large
    } else {
      PrepareWhole(problem);
    }
    if (whole_.suits_tableau()) {
      tableau_rows_ = std::max(tableau_rows_, options_.hard_tableau_rows);
    }
  }
  if (n <= tableau_rows_) {
    problem.DenseA();
    tableau_.Reserve(n);
    test_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
    return;
  }
  if (!divides_) return;
  tableau_.Reserve(tableau_rows_, n);
  idle_rows_.Prepare(problem);
  rest_.reserve(static_cast<size_t>(n));
  judge_.Reset(problem, false);
  islands_.Reserve(n);
  if (!looks_first) islands_.Find(problem.SparseA(), idle_rows_.keep());
  has_islands_ = static_cast<double>(islands_.largest()) <= kWorthDividing * static_cast<double>(n);
  few_idle_rows_ = n / kRowsPerCut;
}

void AutoEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const bool may_choose = options.max_iterations == 0;  // the unit of a limit is the backend's
  // Reading the clock costs a tenth of the smallest problems, which a tableau ends in no time.
  std::optional<Deadline> limit;
  if (std::isfinite(options.time_limit_s) && problem.size() > SmallPivoting::kRowsWithoutClock) limit.emplace(options);
  if (has_step_ && may_choose) {
    StepRows rows = step_.rows();
    rows.b = problem.b().data();
    if (TryRows(rows, options, result)) return;
  }
  if (!long_way_is_ready_) PrepareLongWay(problem);
  long_way_is_ready_ = true;
  auto choice = AutoPortfolio::Choice::kByCost;
  if (problem.size() <= tableau_rows_) {
    if (may_choose && TryTableau(problem, options, limit.has_value() ? &*limit : nullptr, result)) return;
    choice = AutoPortfolio::Choice::kRobust;
  }
  const Deadline deadline = limit.value_or(Deadline(options));
  if (problem.size() > tableau_rows_ && may_choose && TryIslands(problem, options, deadline, result)) return;
  if (!whole_is_ready_ && choice == AutoPortfolio::Choice::kByCost) PrepareWhole(problem);
  whole_.Solve(problem, options, choice, deadline, result);
}

bool AutoEngine::TryTableauOfArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  std::optional<Deadline> limit;
  if (std::isfinite(options.time_limit_s) && arrays.rows > SmallPivoting::kRowsWithoutClock) limit.emplace(options);
  tableau_.Reserve(arrays.rows);
  const SmallPivoting::Request request = RequestFor(options, limit.has_value() ? &*limit : nullptr);
  const double* const diagonal = matrix_.diagonal().data();
  const Known known = Judge(tableau_.SolveArrays(arrays, diagonal, request, result->f.data()), options.tolerance);
  if (known == Known::kWrong) return false;
  if (known == Known::kUnclear || !matrix_.is_exactly_symmetric()) {
    const LcpProblem problem = LcpProblem::FromArrays(arrays);
    test_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
    if (!test_.Meets(options.tolerance, result->f)) return false;
  }
  result->status = LcpStatus::kSolved;
  result->iterations = tableau_.pivots();
  result->detail = "tableau";
  return true;
}

// A given as a matrix: a tableau or a band straight from the arrays. What they leave open goes the long way. The band
// comes second where forces of very different size lie side by side, of which a tableau takes the small ones for
// rounding.
bool AutoEngine::SolveMatrix(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  if (!matrix_.Take(arrays)) return false;
  const bool is_wide = 2 * matrix_.bandwidth() >= arrays.rows;
  const Index tableau_rows =
      is_wide ? std::max(options_.tableau_rows, options_.hard_tableau_rows) : options_.tableau_rows;
  if (arrays.rows <= tableau_rows && TryTableauOfArrays(arrays, options, result)) return true;
  return BandPivoting::Suits(matrix_) && band_.Solve(matrix_, options, result);
}

// A step's rows: nothing is made of A but what RowSolver assembles. What it leaves open goes the long way.
bool AutoEngine::SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  if (options.max_iterations != 0 || !MayAskRows(arrays.rows)) return false;
  if (arrays.form != MatrixForm::kFactors) {
    if (SolveMatrix(arrays, options, result)) return true;
    result->f.setZero();
    return false;
  }
  return step_.Take(arrays) && TryRows(step_.rows(), options, result);
}

bool AutoEngine::TryRows(const StepRows& rows, const LcpOptions& options, LcpResult* result) {
  rows_.Reserve(rows.rows, rows.bodies);
  if (gaps_.size() < rows.rows) gaps_.resize(rows.rows);
  const double* const initial_f = options.initial_f == nullptr ? nullptr : options.initial_f->data();
  const RowAnswer answer = rows_.Solve(rows, options, initial_f, result->f.data(), gaps_.data());
  if (!answer.solved) {
    result->f.setZero();
    return false;
  }
  result->status = LcpStatus::kSolved;
  result->iterations = answer.iterations;
  result->detail = "rows";
  return true;
}

template class EngineSolver<AutoOptions, AutoEngine>;

}  // namespace lcpbench
