#include "solvers/step/step_solver.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <semaphore>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "solvers/auto/auto_solver.h"
#include "solvers/auto/ladder.h"
#include "solvers/batch/row_batch.h"
#include "solvers/lcp/verify.h"
#include "solvers/rows/row_input.h"
#include "support/cancellation.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr int kMostThreads = 1024;

bool IsPlain(const StepRows& rows) { return rows.friction.empty() && rows.bounded.empty(); }

// Rows with the bodies alone that they name: what solves one problem must not look at a whole world, and what other
// bodies have does not count.
class OwnBodies {
 public:
  void Reserve(Index max_rows) {
    const auto sides = static_cast<std::size_t>(2 * max_rows);
    bodies_.reserve(sides);
    local_.reserve(sides);
    inverse_mass_.reserve(sides * 6);
  }
  StepRows Take(StepRows rows) {
    bodies_.clear();
    for (Index k = 0; k < 2 * rows.rows; ++k) {
      const std::int32_t body = rows.body[k];
      if (body < -1 || body >= rows.bodies) return rows;  // refused as it is
      if (body >= 0) bodies_.push_back(body);
    }
    std::sort(bodies_.begin(), bodies_.end());
    bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
    local_.clear();
    for (Index k = 0; k < 2 * rows.rows; ++k) {
      const auto place = std::lower_bound(bodies_.begin(), bodies_.end(), rows.body[k]);
      local_.push_back(rows.body[k] < 0 ? -1 : static_cast<std::int32_t>(place - bodies_.begin()));
    }
    inverse_mass_.clear();
    for (const std::int32_t body : bodies_) {
      const double* mass = rows.inverse_mass + static_cast<Index>(body) * rows.columns_per_body;
      inverse_mass_.insert(inverse_mass_.end(), mass, mass + rows.columns_per_body);
    }
    rows.bodies = static_cast<Index>(bodies_.size());
    rows.body = local_.data();
    rows.inverse_mass = inverse_mass_.data();
    return rows;
  }

 private:
  std::vector<std::int32_t> bodies_, local_;
  std::vector<double> inverse_mass_;
};

// Friction rows and their normal rows in one problem each.
void RequireLawsWithinProblems(const StepRows& rows, std::span<const std::int32_t> start) {
  const auto problem_of = [&](Index row) { return std::ranges::upper_bound(start, row) - start.begin(); };
  for (const FrictionRow& row : rows.friction) {
    if (problem_of(row.row) == problem_of(row.normal)) continue;
    throw InputError("step rows: friction: row " + std::to_string(row.row) + ": normal is " +
                     std::to_string(row.normal) + ", expected a row of the same problem");
  }
}

// The friction and bounded rows of a step, and those of some of its rows, counted among these.
class LawsByRow {
 public:
  explicit LawsByRow(const StepRows& rows)
      : friction_(rows.friction.begin(), rows.friction.end()), bounded_(rows.bounded.begin(), rows.bounded.end()) {
    std::ranges::sort(friction_, {}, &FrictionRow::row);
    std::ranges::sort(bounded_, {}, &BoundedRow::row);
  }
  void Take(Index first, Index last, std::vector<FrictionRow>* friction, std::vector<BoundedRow>* bounded) const {
    TakeOf(friction_, first, last, friction);
    TakeOf(bounded_, first, last, bounded);
    for (FrictionRow& row : *friction) row.normal -= first;
  }

 private:
  template <typename Row>
  static void TakeOf(const std::vector<Row>& all, Index first, Index last, std::vector<Row>* part) {
    part->assign(std::ranges::lower_bound(all, first, {}, &Row::row),
                 std::ranges::lower_bound(all, last, {}, &Row::row));
    for (Row& row : *part) row.row -= first;
  }

  std::vector<FrictionRow> friction_;
  std::vector<BoundedRow> bounded_;
};

}  // namespace

struct StepSolver::Implementation {
  explicit Implementation(const StepOptions& given)
      : options(given), rows(given.instructions), batch(given.instructions) {}

  StepOptions options;
  Ladder rows;
  RowBatch batch;
  OwnBodies own_bodies;
  std::vector<FrictionRow> friction_of_part;
  std::vector<BoundedRow> bounded_of_part;
  std::int64_t left = 0;
  RowsReached reached;
  std::unique_ptr<AutoSolver> fallback;  // goes on from `reached`
  LcpResult result;
  Eigen::VectorXd initial_f, gaps, unwanted_w;
  std::int64_t fallbacks = 0;
  std::exception_ptr error;  // of the last batch

  LcpOptions SolveOptions() const {
    LcpOptions solve;
    solve.tolerance = options.tolerance;
    solve.time_limit_s = options.time_limit_s;
    return solve;
  }

  // @param has_own_bodies  rows come from own_bodies
  StepAnswer Solve(StepRows of, bool has_own_bodies, const double* start, double* f, double* w) {
    bool is_in_range = CheckRows(of, start);
    if (of.rows == 0 && IsPlain(of)) return {LcpStatus::kSolved, 0, 0};
    if (!is_in_range && !has_own_bodies) {  // the check may have met other bodies
      of = own_bodies.Take(of);
      has_own_bodies = true;
      is_in_range = CheckRows(of, start);
    }
    std::optional<Deadline> limit;
    if (of.rows > SmallPivoting::kRowsWithoutClock && Deadline::IsNeeded(SolveOptions())) {
      limit.emplace(SolveOptions());
    }
    const Deadline* const deadline = limit.has_value() ? &*limit : nullptr;
    reached.was_asked = is_in_range && (of.bounded.empty() || !of.friction.empty());
    if (reached.was_asked) {
      const RowAnswer answer = SolveRows(of, deadline, start, f, w);
      if (answer.solved) return {LcpStatus::kSolved, answer.iterations, answer.rho};
      reached.next = answer.next;
    }
    return SolveRest(has_own_bodies ? of : own_bodies.Take(of), deadline, start, f, w);
  }

  RowAnswer SolveRows(const StepRows& of, const Deadline* deadline, const double* start, double* f, double* w) {
    if (!IsPlain(of)) {
      rows.ReserveLaws(of.rows, of.bodies);
      return rows.Solve(of, options.tolerance, deadline, start, f, w);
    }
    rows.Reserve(of.rows, of.bodies);
    if (w == nullptr && unwanted_w.size() < of.rows) unwanted_w.resize(of.rows);
    double* const gaps_of_rows = w == nullptr ? unwanted_w.data() : w;
    return rows.Solve(of, options.tolerance, deadline, start, f, gaps_of_rows);
  }

  // A problem of a batch: the rows first to last - 1.
  StepAnswer SolvePart(const StepRows& of, const LawsByRow& laws, Index first, Index last, double* f) {
    StepRows part = PartOf(of, first, last);
    if (!IsPlain(of)) {
      laws.Take(first, last, &friction_of_part, &bounded_of_part);
      part.friction = friction_of_part;
      part.bounded = bounded_of_part;
    }
    ++left;
    try {
      return Solve(own_bodies.Take(part), true, nullptr, f + first, nullptr);
    } catch (const InputError&) {
      CheckRows(of, nullptr);  // names the row by its place among all
      if (!IsPlain(of)) ProblemOf(of);
      throw;
    }
  }

  // What rows in place leave open. `f` holds what it reached.
  StepAnswer SolveRest(const StepRows& of, const Deadline* deadline, const double* start, double* f, double* w) {
    ++fallbacks;
    if (fallback == nullptr) {
      fallback = std::make_unique<AutoSolver>(AutoOptions{.reached = &reached, .instructions = options.instructions});
    }
    if (reached.was_asked) reached.f = Eigen::Map<const Eigen::VectorXd>(f, of.rows);
    const LcpProblem problem = ProblemOf(of);
    LcpOptions solve = SolveOptions();
    if (deadline != nullptr) solve.time_limit_s = deadline->RestOfLimit();
    if (start != nullptr) {
      initial_f = Eigen::Map<const Eigen::VectorXd>(start, of.rows);
      solve.initial_f = &initial_f;
    }
    fallback->Solve(problem, solve, &result);
    std::copy_n(result.f.data(), of.rows, f);
    if (w != nullptr) {
      problem.ComputeW(result.f, &gaps);
      std::copy_n(gaps.data(), of.rows, w);
    }
    if (result.status == LcpStatus::kUnsupported) return {result.status, 0};
    StepAnswer answer{result.status, result.iterations, ComputeMetrics(problem, result.f).rho};
    if (result.status == LcpStatus::kInfeasible) {
      const FarkasVerdict verdict = VerifyFarkasRay(problem, *result.farkas_ray);
      answer.infeasible_proved = verdict.proved;
      answer.force_min = verdict.force_min;
    }
    return answer;
  }
};

StepSolver::StepSolver(const StepOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    throw InputError("tolerance must be in (0, 1), found " + std::to_string(options.tolerance));
  }
  if (!(options.time_limit_s > 0)) {
    throw InputError("time limit must be > 0 s, found " + std::to_string(options.time_limit_s));
  }
  if (!(options.threads >= 1 && options.threads <= kMostThreads)) {
    throw InputError("threads must be from 1 to " + std::to_string(kMostThreads) + ", found " +
                     std::to_string(options.threads));
  }
  for (int k = 0; k < options.threads; ++k) threads_.push_back(std::make_unique<Implementation>(options));
}

StepSolver::~StepSolver() = default;

void StepSolver::Reserve(Index max_rows, Index max_bodies) {
  for (const auto& own : threads_) {
    own->rows.ReserveLaws(max_rows, max_bodies);
    own->own_bodies.Reserve(max_rows);
    if (own->unwanted_w.size() < max_rows) own->unwanted_w.resize(max_rows);
  }
}

StepAnswer StepSolver::Solve(const StepRows& rows, const double* initial_f, double* f, double* w) {
  return threads_.front()->Solve(rows, false, initial_f, f, w);
}

std::int64_t StepSolver::fallbacks() const { return Sum(&Implementation::fallbacks); }
std::int64_t StepSolver::left() const { return Sum(&Implementation::left); }
std::int64_t StepSolver::Sum(std::int64_t Implementation::*count) const {
  std::int64_t sum = 0;
  for (const auto& own : threads_) sum += (*own).*count;
  return sum;
}

// What becomes of the problems of a batch.
class StepSolver::BatchReceiver final : public RowBatch::Receiver {
 public:
  BatchReceiver(Implementation* own, const StepRows& rows, const LawsByRow& laws, std::span<const std::int32_t> start,
                double* f, std::span<StepAnswer> answers)
      : own_(*own), rows_(rows), laws_(laws), start_(start), f_(f), answers_(answers) {}

  void Take(std::int32_t problem, int pivots, double rho) override {
    answers_[static_cast<std::size_t>(problem)] = {LcpStatus::kSolved, pivots, rho};
  }
  void Leave(std::int32_t problem) override {
    const auto k = static_cast<std::size_t>(problem);
    answers_[k] = own_.SolvePart(rows_, laws_, start_[k], start_[k + 1], f_);
  }

 private:
  Implementation& own_;
  const StepRows& rows_;
  const LawsByRow& laws_;
  std::span<const std::int32_t> start_;
  double* f_;
  std::span<StepAnswer> answers_;
};

void StepSolver::SolveBatch(const StepRows& rows, std::span<const std::int32_t> start, double* f,
                            std::span<StepAnswer> answers) {
  if (start.size() != answers.size() + 1 || start.front() != 0 || start.back() != rows.rows) {
    throw InputError("start must have one number more than there are answers, from 0 to the number of rows");
  }
  for (std::size_t k = 0; k < answers.size(); ++k) {
    if (start[k + 1] < start[k]) throw InputError("start must ascend, entry " + std::to_string(k + 1) + " does not");
  }
  const LawsByRow laws(rows);
  // Lanes take plain rows only.
  const bool has_lanes = IsPlain(rows);
  if (!has_lanes) RequireLawsWithinProblems(rows, start);
  // Arrays, and what the first row has; lanes look at the rest as they read it.
  CheckRows(rows.rows > 0 && has_lanes ? PartOf(rows, 0, 1) : rows, nullptr);
  constexpr std::size_t kProblemsAtOnce = 16;
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> is_interrupted = false;
  std::counting_semaphore<> ended(0);
  const auto run = [&](Implementation* own) {
    try {
      BatchReceiver receiver(own, rows, laws, start, f, answers);
      if (has_lanes) return own->batch.Solve(rows, start, own->options.tolerance, &next, f, &receiver);
      for (std::size_t first = next.fetch_add(kProblemsAtOnce); first < answers.size();
           first = next.fetch_add(kProblemsAtOnce)) {
        Cancellation::Check();
        const std::size_t last = std::min(first + kProblemsAtOnce, answers.size());
        for (std::size_t k = first; k < last; ++k) receiver.Leave(static_cast<std::int32_t>(k));
      }
    } catch (...) {
      own->error = std::current_exception();
      next = answers.size();  // the others need not go on
    }
  };
  const auto look = [](void* flag) { return static_cast<std::atomic<bool>*>(flag)->load(); };
  const auto run_beside = [&, is_possible = Cancellation::IsPossible()](Implementation* own) {
    const Cancellation::Scope scope(is_possible ? +look : nullptr, &is_interrupted);
    run(own);
    ended.release();
  };
  for (const auto& own : threads_) {
    own->left = 0;
    own->error = nullptr;
  }
  std::vector<std::thread> others;
  const std::size_t useful =
      std::min(threads_.size(), answers.size() / (has_lanes ? RowBatch::kBlock : kProblemsAtOnce));
  try {
    for (std::size_t k = 1; k < useful; ++k) others.emplace_back(run_beside, threads_[k].get());
  } catch (const std::system_error&) {  // as many as there are
  }
  Implementation* const first = threads_.front().get();
  run(first);
  try {
    for (std::size_t k = 0; k < others.size(); ++k) {
      while (!ended.try_acquire_for(std::chrono::duration<double>(Cancellation::kPeriod))) Cancellation::Check();
    }
  } catch (const Cancelled&) {
    first->error = std::current_exception();
  }
  is_interrupted = first->error != nullptr;
  for (std::thread& other : others) other.join();
  for (const auto& own : threads_) {
    if (own->error != nullptr) std::rethrow_exception(own->error);
  }
}

}  // namespace lcpbench
