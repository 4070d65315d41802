#include "solvers/auto/auto_solver.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/auto/auto_portfolio.h"
#include "solvers/auto/auto_rules.h"
#include "solvers/auto/exact_rule.h"
#include "solvers/auto/ladder.h"
#include "solvers/auto/law_ladder.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/rounding_floor.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/matrix_arrays.h"
#include "solvers/rows/profile_pivoting.h"
#include "solvers/rows/row_input.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Judgement = SmallPivoting::Answer::Judgement;

}  // namespace

AutoOptions AutoOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("auto", settings);
  AutoOptions options;
  for (const AutoLimit& limit : kAutoLimits) {
    const double value = limit.Of(options.limits);
    limit.Set(reader.Number(std::string(limit.name), value, limit.least, limit.most), &options.limits);
  }
  options.instructions = InstructionSetOf(reader.Choice("instructions", "best", {"best", "sse2", "avx2", "avx512"}));
  reader.Finish();
  return options;
}

AutoOptions AutoOptions::Only(AutoMethod method, const Settings& settings) {
  SettingsReader(KeyOf(method), settings).Finish();
  AutoOptions options;
  options.only = method;
  options.limits.tableau_rows = options.limits.hard_tableau_rows = SmallPivoting::kMaxRows;
  return options;
}

class AutoEngine {
 public:
  explicit AutoEngine(const AutoOptions& options);
  bool takes_other_laws() const { return !options_.only.has_value(); }
  static constexpr bool kReadsFriction = true;
  static constexpr bool kSolvesByFaces = true;

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Reserve(Index max_rows) { tableau_.Reserve(std::min(max_rows, options_.limits.tableau_rows)); }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  bool SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);

 private:
  // What is read in place: rows on two bodies, or a matrix.
  enum class Taken { kNothing, kRows, kMatrix };
  bool IsReadInPlace(MatrixForm form, Index rows) const;
  Taken Take(const ProblemView& arrays);
  bool SolveInPlace(const StepRows& rows, const LcpOptions& options, const Deadline* deadline, LcpResult* result);
  bool SolveRows(const StepRows& rows, const LcpOptions& options, const Deadline* deadline, LcpResult* result);
  bool SolveMatrix(const LcpOptions& options, const Deadline* deadline, LcpResult* result);
  template <typename Meets>
  bool TakeTableau(const SmallPivoting::Answer& answer, const LcpOptions& options, const Meets& meets,
                   LcpResult* result) const;
  bool TryTableauOfMatrix(const LcpOptions& options, const Deadline* deadline, LcpResult* result);

  void SolveFriction(const LcpProblem& problem, LcpOptions options, const Deadline* deadline, LcpResult* result);
  void PrepareProblem(const LcpProblem& problem);
  void PrepareDividing(const LcpProblem& problem, bool islands_are_known);
  void PrepareWhole(const LcpProblem& problem) {
    whole_.Prepare(problem);
    whole_is_ready_ = true;
  }
  void SolveProblem(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);
  bool TryTableau(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);
  bool TryIslands(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);
  void SolveRest(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);

  SmallPivoting::Request RequestFor(const LcpOptions& options, const Deadline* deadline) const {
    const double* initial_f = options.initial_f == nullptr ? nullptr : options.initial_f->data();
    return {tableau::kMargin * std::sqrt(options.tolerance), initial_f, deadline};
  }
  static void Refuse(const char* why, LcpResult* result) {
    result->status = LcpStatus::kUnsupported;
    result->detail = why;
  }
  // A limit of iterations is in the unit of a backend; the methods of the other stages are bounded by themselves.
  bool MayChoose(const LcpOptions& options) const { return options.max_iterations == 0 || options_.only.has_value(); }
  bool Allows(AutoMethod method) const { return options_.only.value_or(method) == method; }

  const AutoOptions options_;
  SmallPivoting tableau_;

  // Rows or a matrix, read in place: the caller's arrays, or of the prepared problem.
  Taken taken_ = Taken::kNothing;
  // Whether the methods in place have been asked in vain: for the arrays of the latest SolveArrays, and for the
  // prepared problem, which is of these arrays then.
  bool asked_in_place_ = false, was_asked_in_place_ = false;
  TwoBodyCopy step_;
  Ladder rows_;
  Eigen::VectorXd gaps_;
  MatrixArrays matrix_;
  AutoFacts matrix_facts_{.limits = &options_.limits};
  BandPivoting band_;

  // For problems that are not plain, made by the first that rows in place do not answer.
  std::unique_ptr<LawPortfolio> laws_;
  bool laws_are_ready_ = false;  // for the prepared problem
  // What rows in place have reached of the latest such problem, and the first rule that they have not asked.
  Eigen::VectorXd reached_;
  std::size_t next_rule_ = 0;

  // The prepared problem.
  bool problem_is_ready_ = false;
  bool whole_is_ready_ = false;
  AutoPortfolio whole_;  // for all rows
  Index tableau_rows_ = 0;
  GivenFormTest test_;  // of what one tableau solves

  // Where it is too large for one tableau.
  bool may_divide_ = false;
  IdleRows idle_rows_;
  Islands islands_;
  bool has_islands_ = false;  // even with all rows
  Index few_idle_rows_ = 1;   // fewer cannot cut one island into small ones
  std::vector<Index> rest_;
  Eigen::VectorXd rest_start_;
  AnswerJudge judge_;
};

AutoEngine::AutoEngine(const AutoOptions& options)
    : options_(options),
      tableau_(options.instructions),
      rows_(options.instructions, options.only, options_.limits),
      band_(options.instructions),
      whole_(options.limits) {
  for (const AutoLimit& limit : kAutoLimits) {
    const double value = limit.Of(options.limits);
    if (value >= limit.least && value <= limit.most) continue;
    throw InputError("auto: " + std::string(limit.name) + " is out of its range");
  }
}

std::string AutoEngine::WhyUnsupported(const LcpProblem& problem) const {
  std::string why = WhyNotSymmetric(problem);
  if (!why.empty() || !options_.only.has_value()) return why;
  const bool has_rows = problem.has_factors() && problem.has_two_body_rows();
  const Index most = has_rows ? options_.limits.step_rows : SmallPivoting::kMaxRows;
  switch (*options_.only) {
    case AutoMethod::kBandPivoting:
      return problem.has_factors() ? "it takes A given as a matrix" : "";
    case AutoMethod::kPrincipalPivoting:
      return problem.size() > most ? "it takes up to " + std::to_string(most) + " rows of this form" : "";
    default:
      return has_rows ? "" : "it takes rows on at most two bodies each, given by J and M";
  }
}

bool AutoEngine::IsReadInPlace(MatrixForm form, Index rows) const {
  const Index most = form == MatrixForm::kDense ? options_.limits.dense_rows : options_.limits.step_rows;
  return rows <= most;
}

// Arrays that are not taken become an LcpProblem.
AutoEngine::Taken AutoEngine::Take(const ProblemView& arrays) {
  if (!IsReadInPlace(arrays.form, arrays.rows)) return Taken::kNothing;
  if (arrays.form != MatrixForm::kFactors) {
    if (!arrays.friction.empty() || !arrays.bounded.empty()) return Taken::kNothing;
    return matrix_.Take(arrays) ? Taken::kMatrix : Taken::kNothing;
  }
  return step_.Take(arrays) ? Taken::kRows : Taken::kNothing;
}

// True where the solve ends here: it is solved, or no other method is allowed.
bool AutoEngine::SolveInPlace(const StepRows& rows, const LcpOptions& options, const Deadline* deadline,
                              LcpResult* result) {
  const bool is_solved =
      taken_ == Taken::kRows ? SolveRows(rows, options, deadline, result) : SolveMatrix(options, deadline, result);
  if (is_solved) return true;
  if (!options_.only.has_value() || !result->f.allFinite()) result->f.setZero();
  if (!options_.only.has_value()) return false;
  const bool is_late = result->status != LcpStatus::kUnsupported && deadline != nullptr && deadline->Expired();
  if (is_late) result->status = LcpStatus::kTimeLimit;
  return true;
}

// AutoStage::kRows: nothing is made of A but what Ladder assembles.
bool AutoEngine::SolveRows(const StepRows& rows, const LcpOptions& options, const Deadline* deadline,
                           LcpResult* result) {
  rows_.Reserve(rows.rows, rows.bodies);
  if (gaps_.size() < rows.rows) gaps_.resize(rows.rows);
  const double* const initial_f = options.initial_f == nullptr ? nullptr : options.initial_f->data();
  const bool has_laws = !rows.friction.empty();
  if (has_laws) rows_.ReserveLaws(rows.rows, rows.bodies);
  const RowAnswer answer =
      rows_.Solve(rows, options.tolerance, deadline, initial_f, result->f.data(), has_laws ? nullptr : gaps_.data());
  next_rule_ = answer.next;
  if (has_laws && !answer.solved) reached_ = result->f;
  if (!answer.fits && options_.only.has_value()) Refuse("an island has more rows than it takes", result);
  if (!answer.solved) return false;
  result->status = LcpStatus::kSolved;
  result->iterations = answer.iterations;
  result->detail = has_laws ? rows_.method() : "rows";
  return true;
}

// AutoStage::kMatrix. The band comes second where forces of very different size lie side by side, of which a tableau
// takes the small ones for rounding.
bool AutoEngine::SolveMatrix(const LcpOptions& options, const Deadline* deadline, LcpResult* result) {
  const bool is_full = 2 * matrix_.bandwidth() >= matrix_.size();
  AutoFacts& facts = matrix_facts_;
  facts.rows = matrix_.size();
  facts.tableau_rows = is_full ? std::max(options_.limits.tableau_rows, options_.limits.hard_tableau_rows)
                               : options_.limits.tableau_rows;
  facts.is_dense = matrix_.is_dense();
  facts.bandwidth = matrix_.bandwidth();
  bool is_for_one = false;
  for (const AutoRule& rule : AutoRulesOf(AutoStage::kMatrix)) {
    if (rule.Grants(facts) == 0 || !Allows(rule.method)) continue;
    is_for_one = true;
    const bool is_over = rule.method == AutoMethod::kPrincipalPivoting
                             ? TryTableauOfMatrix(options, deadline, result)
                             : band_.Solve(matrix_, options, deadline, result);
    if (is_over) return true;
  }
  if (!is_for_one && options_.only.has_value()) {
    Refuse("the matrix has more rows or a wider band than it takes", result);
  }
  return false;
}

// Whether the tableau's answer passes; where its sums in double do not tell, `meets` does, by the given form.
template <typename Meets>
bool AutoEngine::TakeTableau(const SmallPivoting::Answer& answer, const LcpOptions& options, const Meets& meets,
                             LcpResult* result) const {
  const Judgement judgement = answer.Judge(options.tolerance);
  if (judgement == Judgement::kWrong || (judgement == Judgement::kUnclear && !meets())) return false;
  result->status = LcpStatus::kSolved;
  result->iterations = tableau_.pivots();
  result->detail = "tableau";
  return true;
}

bool AutoEngine::TryTableauOfMatrix(const LcpOptions& options, const Deadline* deadline, LcpResult* result) {
  const ProblemView& arrays = matrix_.arrays();
  tableau_.Reserve(arrays.rows);
  const SmallPivoting::Answer answer = tableau_.SolveMatrix(matrix_, RequestFor(options, deadline), result->f.data());
  const auto meets = [&] {
    test_.Reset(LcpProblem::FromArrays(arrays), GivenFormTest::Rows::kGivenWhenNeeded);
    return test_.Meets(options.tolerance, result->f);
  };
  return TakeTableau(answer, options, meets, result);
}

bool AutoEngine::TryTableau(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                            LcpResult* result) {
  const SmallPivoting::Answer answer = tableau_.Solve(problem, RequestFor(options, &deadline), &result->f);
  const auto meets = [&] {
    test_.SetB(problem);
    return test_.Meets(options.tolerance, result->f);
  };
  return TakeTableau(answer, options, meets, result);
}

// Small islands by tableau, the rest by a portfolio of its own. False if dividing does not pay or led to nothing.
bool AutoEngine::TryIslands(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                            LcpResult* result) {
  const Index idle = idle_rows_.Find(problem);
  if (idle < few_idle_rows_ && !has_islands_) return false;
  islands_.Find(problem.SparseA(), idle_rows_.keep());
  const double worth = options_.limits.dominant_share * static_cast<double>(problem.size());
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
    const bool solved =
        static_cast<Index>(rows.size()) <= tableau_rows_ &&
        tableau_.SolvePart(problem, rows, RequestFor(options, &deadline), &result->f).Judge(options.tolerance) !=
            Judgement::kWrong;  // what is unclear is judged with the whole
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
  // All parts passed; what joins them, and rows left out, have not been looked at.
  judge_.Start(problem, options.tolerance, result);
  judge_.candidate() = result->f;
  judge_.Publish();
  if (judge_.tier() <= options.tolerance) return true;
  result->status = LcpStatus::kNumericalFailure;
  return false;
}

void AutoEngine::SolveRest(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                           LcpResult* result) {
  std::sort(rest_.begin(), rest_.end());
  const LcpProblem part = Subproblem(problem, rest_);
  LcpOptions part_options = options;
  if (options.initial_f != nullptr) {
    rest_start_ = (*options.initial_f)(rest_);
    part_options.initial_f = &rest_start_;
  }
  AutoPortfolio portfolio(options_.limits);
  portfolio.Prepare(part);
  LcpResult answer;
  answer.f.setZero(part.size());
  portfolio.Solve(part, part_options, deadline, &answer);
  result->detail += "; " + answer.detail;
  TakeAnswer(problem, rest_, answer, result);
}

// What rows in place leave open.
void AutoEngine::SolveFriction(const LcpProblem& problem, LcpOptions options, const Deadline* deadline,
                               LcpResult* result) {
  if (laws_ == nullptr) {
    AutoOptions plain = options_;
    plain.reached = nullptr;
    plain.asks_exact = false;
    laws_ = std::make_unique<LawPortfolio>(
        &tableau_, WithinOptions{[plain] { return std::make_unique<AutoSolver>(plain); }}, options_.limits);
  }
  if (!std::exchange(laws_are_ready_, true)) laws_->Prepare(problem);
  if (deadline != nullptr) options.time_limit_s = deadline->RestOfLimit();
  const bool was_asked = next_rule_ > 0;
  laws_->Solve(problem, options, next_rule_, was_asked ? &reached_ : nullptr, result);
  next_rule_ = 0;
}

void AutoEngine::Prepare(const LcpProblem& problem) {
  laws_are_ready_ = problem_is_ready_ = false;
  taken_ = Taken::kNothing;
  was_asked_in_place_ = std::exchange(asked_in_place_, false);
  if (!was_asked_in_place_) next_rule_ = 0;
  if (options_.reached != nullptr && options_.reached->was_asked) {
    was_asked_in_place_ = true;
    next_rule_ = options_.reached->next;
    reached_ = options_.reached->f;
  }
  if (!was_asked_in_place_) taken_ = Take(problem.view());
  if (taken_ == Taken::kRows) rows_.Reserve(step_.rows().rows, step_.rows().bodies);
  if (taken_ == Taken::kNothing && problem.is_plain()) PrepareProblem(problem);
}

// Large problems by factors are looked at by columns of J first: A is not formed where one island has most rows.
void AutoEngine::PrepareProblem(const LcpProblem& problem) {
  problem_is_ready_ = true;
  if (options_.only.has_value() && *options_.only != AutoMethod::kPrincipalPivoting) return;
  const Index n = problem.size();
  tableau_rows_ = options_.limits.tableau_rows;
  whole_is_ready_ = false;
  may_divide_ = n > tableau_rows_;
  whole_.Classify(problem);
  const bool looks_first = may_divide_ && whole_.facts().is_large && problem.has_factors();
  if (looks_first) {
    islands_.FindByColumns(problem.J(), problem.inverse_mass());
    may_divide_ = static_cast<double>(islands_.largest()) <= options_.limits.dominant_share * static_cast<double>(n);
  }
  if (n > tableau_rows_) {
    // Where large problems may be divided, the whole is set up only if the islands turn out to be too large.
    if (!looks_first || !may_divide_) PrepareWhole(problem);
    const AutoFacts& facts = whole_.facts();
    const bool is_hard = facts.is_redundant || facts.has_dense_factor;
    if (is_hard) tableau_rows_ = std::max(tableau_rows_, options_.limits.hard_tableau_rows);
  }
  if (n <= tableau_rows_) {
    problem.DenseA();
    tableau_.Reserve(n);
    test_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
  } else if (may_divide_) {
    PrepareDividing(problem, looks_first);
  }
}

void AutoEngine::PrepareDividing(const LcpProblem& problem, bool islands_are_known) {
  const Index n = problem.size();
  tableau_.Reserve(tableau_rows_, n);
  idle_rows_.Prepare(problem);
  rest_.reserve(static_cast<size_t>(n));
  judge_.Reset(problem, false);
  islands_.Reserve(n);
  if (!islands_are_known) islands_.Find(problem.SparseA(), idle_rows_.keep());
  has_islands_ = static_cast<double>(islands_.largest()) <= options_.limits.dominant_share * static_cast<double>(n);
  few_idle_rows_ = n / options_.limits.rows_per_cut;
}

void AutoEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  // Reading the clock costs a tenth of the smallest problems, which a tableau ends in no time.
  std::optional<Deadline> limit;
  if (Deadline::IsNeeded(options) && problem.size() > SmallPivoting::kRowsWithoutClock) limit.emplace(options);
  const bool is_taken = taken_ != Taken::kNothing && MayChoose(options);
  if (is_taken) {
    StepRows rows = step_.rows();
    matrix_.SetB(problem.loads());
    rows.b = matrix_.arrays().b.data();
    if (SolveInPlace(rows, options, limit.has_value() ? &*limit : nullptr, result)) return;
  }
  const Deadline deadline = limit.value_or(Deadline(options));
  if (problem.is_plain()) {
    if (!problem_is_ready_) PrepareProblem(problem);
    whole_.facts().tableau_failed = (is_taken || was_asked_in_place_) && problem.size() <= tableau_rows_;
    SolveProblem(problem, options, deadline, result);
  } else {
    SolveFriction(problem, options, limit.has_value() ? &*limit : nullptr, result);
  }
  const bool is_open = result->status == LcpStatus::kNumericalFailure || result->status == LcpStatus::kIterationLimit;
  if (is_open && options_.asks_exact && !options_.only) TryExact(problem, options, options_.limits, deadline, result);
}

// AutoStage::kProblem, and then kBackends.
void AutoEngine::SolveProblem(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline,
                              LcpResult* result) {
  AutoFacts& facts = whole_.facts();
  facts.tableau_rows = tableau_rows_;
  facts.may_divide = may_divide_;
  for (const AutoRule& rule : AutoRulesOf(AutoStage::kProblem)) {
    if (rule.Grants(facts) == 0 || !Allows(rule.method) || !MayChoose(options)) continue;
    const bool is_over = rule.method == AutoMethod::kIslands ? TryIslands(problem, options, deadline, result)
                                                             : TryTableau(problem, options, deadline, result);
    if (is_over) return;
  }
  if (options_.only.has_value()) return;
  facts.tableau_failed = problem.size() <= tableau_rows_;
  if (!whole_is_ready_ && !facts.tableau_failed) PrepareWhole(problem);
  whole_.Solve(problem, options, deadline, result);
}

// Where this leaves the arrays open, LcpSolver calls Prepare and Solve next, with an LcpProblem of them.
bool AutoEngine::SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  asked_in_place_ = false;
  if (!MayChoose(options)) return false;
  taken_ = Take(arrays);
  if (taken_ == Taken::kNothing) return false;
  std::optional<Deadline> limit;
  if (Deadline::IsNeeded(options) && arrays.rows > SmallPivoting::kRowsWithoutClock) limit.emplace(options);
  const bool is_over = SolveInPlace(step_.rows(), options, limit.has_value() ? &*limit : nullptr, result);
  asked_in_place_ = !is_over;
  return is_over;
}

template class EngineSolver<AutoOptions, AutoEngine>;

}  // namespace lcpbench
