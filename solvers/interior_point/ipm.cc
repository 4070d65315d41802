#include "solvers/interior_point/ipm.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "solvers/answers/answer_judge.h"
#include "solvers/first_order/nncg.h"
#include "solvers/interior_point/interior_point.h"
#include "solvers/linear_algebra/cost_model.h"

namespace lcpbench {
namespace {

constexpr int kInteriorSteps = 80;        // far above the 10 to 30 that are normal
constexpr double kFirstFinish = 1e-4;     // mu from which every iterate may be the last one ...
constexpr double kFinishResidual = 1e-4;  // ... if the linear residual is this small too
constexpr double kFewWrongRows =
    0.02;  // with at most this fraction of rows wrong, pivots from the active set are tried
constexpr double kFewWrongRowsOfMany = 0.001;  // the same where sweeps mend what is local
constexpr double kNextGuess = 1e-3;            // fall of mu before they are tried again
constexpr std::int64_t kLastSweeps = 1000;  // where the interior point stagnates, while their rate promises an answer
constexpr int kMostRecentred = 3;
constexpr double kRecentredMu = 10;  // a row that blocks every step is off centre by more than that
constexpr double kLeastMu = 1e-22;   // nothing is to be learnt below
// Active sets tried from an interior iterate, as long as every one leaves at most half of the violated rows.
constexpr BlockPivoting::Rules kFromIterate = {
    .weight_factor = 0.01, .steps = 3, .try_every_set = true, .progress = 0.5, .factors = 5};
// Active sets of a warm start, in double the work of a step at most where they fail at once: none after the first set
// if that leaves more than 12 % of the rows violated, and no more once a set neither halves their number nor leaves 1
// %.
constexpr BlockPivoting::Rules kFromStart = {
    .try_every_set = true, .progress = 0.5, .most_wrong = 0.12, .few_wrong = 0.01, .factors = 8};
constexpr BlockPivoting::Rules kLastResort = {
    .weight_factor = 0.01, .steps = 12, .try_every_set = true, .factors = 300};
// Warm start: rho against the one of f = 0 from which its active set is worth a factorization, and from which the
// interior point starts from it rather than cold.
constexpr double kWorthTrying = 0.5;
// mu of a warm start, in its mean residual. What sweeps leave undone on redundant rows is smooth and small, and the
// active set behind it far from right: from a larger mu 10^5 rows of a wall need 40 steps instead of 100.
constexpr double kWarmMu = 0.1;
constexpr double kSweptMu = 40;
constexpr double kCloseEnough = 3e-2;
// A warm start whose first steps are as short as this is too close to the boundary for what has changed: its mu is
// lifted, and if that does not help either, the start is cold. (Measured with 0.5 % of
// the contacts lost and others gained: without this a start can cost several cold solves, and fail.)
constexpr int kTrialSteps = 6;
constexpr double kBlockedStep = 0.3;
constexpr double kLift = 100;
constexpr int kMostLifts = 2;
constexpr double kLeastWarmSweeps = 60;
constexpr double kWarmSweepWork = 4;  // limit of the sweeps, in factorizations

// Weight of the proximal term for pivots from an interior-point iterate: its distance from the solution is of the order
// of sqrt(mu) where rows are degenerate. The first guess of all takes the light weight: if F is right, it is exact.
constexpr double kTame = 10;
constexpr double kHeaviest = 1e-2;
double TameWeight(double mu) { return std::min(kHeaviest, kTame * std::sqrt(mu)); }

// Limits of InteriorFinish.
constexpr int kRefinements = 8;       // as long as each one leaves ...
constexpr double kRefineGain = 0.25;  // ... at most this fraction of rho
constexpr double kClose = 0.5;        // of the tolerance: what double calls enough before extended precision is asked
constexpr double kMoreDigits = 1e-3;  // of the tolerance: a right F gives them for a solve or two
constexpr double kWithinReach = 100;  // times the tolerance: rho from which sweeps are tried, ...
constexpr double kTryAgain = 0.4;     // ... again where rho has fallen to this fraction
constexpr std::int64_t kSweeps = 60;
constexpr double kNear = 5;  // times the tolerance: rho from which ...
constexpr std::int64_t kSweepsWhereNear = 300;
constexpr double kWorthSweeps = 1e6;  // flop; below, going on is as cheap, and exact

// Turns an interior iterate into an answer without another factorization. An interior point that has found mu leaves a
// residual of sqrt(mu) in every row where f and w both vanish, so that going on to mu = 1e-18 would take it twice as
// long as finding the active set. Two ways out, of which each costs less than one step:
//
// - Where the active set F = {f > w} is right, w_F = 0 is solved by iterative refinement on the factor of the latest
//   step: A + diag(w / f) is nearly A_FF on F and decouples the other rows. A wrong F shows after one solve.
// - Where it is nearly right, what is wrong is local, and sweeps of nonsmooth conjugate gradients mend it: one digit
//   in some 50 sweeps where redundant contacts leave many rows with f = w = 0. [nncg.h]
class InteriorFinish {
 public:
  // @param self_check  of the sweeps
  explicit InteriorFinish(bool self_check)
      : sweeps_(NncgOptions{.end_when_hopeless = true, .self_check = self_check}) {}

  // Set-up for a problem; the sweeps' own set-up waits until they are first needed.
  // @param factor_work  of one factorization [flop]: sweeps are for where that is much
  void Reserve(Index n, double factor_work);
  // To be called at the beginning of a solve.
  void Restart() { least_tried_ = std::numeric_limits<double>::infinity(); }

  // @param f, w  an interior iterate, scaled, after a step whose factor is the system's latest
  // @returns whether run->best_f() meets the tier now
  bool Try(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
    return Refine(run, f, w) || (may_sweep_ && Sweep(run, f));
  }
  // Rows whose side the latest Try found to be wrong after one solve, as a fraction of all: how far F is from right.
  double wrong_rows() const { return wrong_rows_; }
  bool may_sweep() const { return may_sweep_; }
  // From run->best_f(), for as long as the rate of convergence promises the tier within `iterations`.
  // @returns as Try
  bool SweepFromBest(IpmRun* run, std::int64_t iterations) {
    const Eigen::VectorXd start = run->best_f();
    return Sweeps(run, start, kClose * run->options().tolerance, iterations);
  }

 private:
  bool Refine(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w);
  bool Sweep(IpmRun* run, const Eigen::VectorXd& f);
  double Rho(const ScaledSystem& system, const Eigen::VectorXd& f);
  bool Sweeps(IpmRun* run, const Eigen::VectorXd& start, double tolerance, std::int64_t iterations);

  Eigen::VectorXd x_, gap_, right_, correction_;
  NncgSolver sweeps_;
  bool prepared_ = false;
  double wrong_rows_ = 1;
  bool may_sweep_ = false;
  double least_tried_ = 0;  // rho of the last iterate that the sweeps were given
};

void InteriorFinish::Reserve(Index n, double factor_work) {
  may_sweep_ = factor_work > kWorthSweeps;
  for (Eigen::VectorXd* v : {&x_, &gap_, &right_, &correction_}) v->setZero(n);
  prepared_ = false;
  Restart();
}

double InteriorFinish::Rho(const ScaledSystem& system, const Eigen::VectorXd& f) {
  system.Multiply(f, &gap_);
  gap_ += system.b();
  return system.rows().Rho(f, gap_);
}

bool InteriorFinish::Refine(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  ScaledSystem& system = run->system();
  const Index n = f.size();
  const double tolerance = run->options().tolerance;
  for (Index i = 0; i < n; ++i) {
    const bool active = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]);
    x_[i] = active ? f[i] : 0.0;
  }
  wrong_rows_ = 1;
  double rho = Rho(system, x_);
  bool accepted = false;
  for (int k = 0; k < kRefinements; ++k) {
    if (rho <= kClose * tolerance && run->AcceptScaled(x_, nullptr)) accepted = true;
    if (accepted && rho <= kMoreDigits * tolerance) return true;
    for (Index i = 0; i < n; ++i) {
      const bool active = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]);
      right_[i] = active ? -gap_[i] : 0.0;
    }
    system.Solve(right_, &correction_);
    Index wrong = 0;
    for (Index i = 0; i < n; ++i) {
      if (right_[i] == 0) continue;
      x_[i] += correction_[i];
      if (!system.unilateral(i) || x_[i] >= 0) continue;
      x_[i] = 0;
      ++wrong;
    }
    const double now = Rho(system, x_);
    if (k == 0) {
      for (Index i = 0; i < n; ++i) wrong += system.unilateral(i) && f[i] <= w[i] && gap_[i] < 0 ? 1 : 0;
      wrong_rows_ = static_cast<double>(wrong) / static_cast<double>(n);
    }
    if (!(now <= kRefineGain * rho) && (accepted || !(now <= kClose * tolerance))) break;
    rho = now;
  }
  // Where steps are cheap a better answer than this one is worth a few more.
  return accepted && may_sweep_;
}

bool InteriorFinish::Sweep(IpmRun* run, const Eigen::VectorXd& f) {
  ScaledSystem& system = run->system();
  const double tolerance = run->options().tolerance;
  const double rho = Rho(system, f);
  if (!(rho <= kWithinReach * tolerance) || rho > kTryAgain * least_tried_) return false;
  least_tried_ = rho;
  Eigen::VectorXd start(f.size());
  for (Index i = 0; i < f.size(); ++i) start[i] = system.rows().GivenForce(i, f[i]);
  return Sweeps(run, start, kClose * tolerance, rho <= kNear * tolerance ? kSweepsWhereNear : kSweeps);
}

bool InteriorFinish::Sweeps(IpmRun* run, const Eigen::VectorXd& start, double tolerance, std::int64_t iterations) {
  const LcpProblem& problem = run->system().problem();
  if (!prepared_) {
    sweeps_.Prepare(problem);
    prepared_ = true;
  }
  LcpOptions options = run->options();
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  options.initial_f = &start;
  if (!run->TimeLeft(&options.time_limit_s)) return false;
  LcpResult result;
  sweeps_.Solve(problem, options, &result);
  return run->Accept(result.f);
}

}  // namespace

IpmOptions IpmOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("ipm", settings);
  IpmOptions options;
  const std::string space = reader.Choice("space", "auto", {"auto", "contact", "body"});
  options.space = space == "contact" ? Space::kContact : space == "body" ? Space::kBody : Space::kAutomatic;
  options.proximal = reader.Number("proximal", options.proximal, 1e-13, 1e-6);
  options.correctors = static_cast<int>(reader.Number("correctors", options.correctors, 0, 10));
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

class IpmEngine {
 public:
  using WarmStart = IpmSolver::WarmStart;

  explicit IpmEngine(const IpmOptions& options) : options_(options), finish_(options.self_check) {}
  static constexpr bool kSolvesByFaces = true;

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem) {
    statistics_ = {};
    system_.Prepare(problem, options_.space);
    interior_.Reserve(problem.size());
    finish_.Reserve(problem.size(), system_.flops());
    warm_sweeps_ = static_cast<std::int64_t>(
        std::max(kLeastWarmSweeps,
                 kWarmSweepWork * CostModel::SweepsPerFactorization(problem, system_.flops(), system_.fill())));
    pivoting_.Reserve(problem);
    test_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
    statistics_.analyses = system_.analyses();
    statistics_.body_space = system_.in_body_space();
    statistics_.fill = system_.fill();
    statistics_.factor_flops = system_.flops();
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    system_.SetB(problem);
    statistics_.factorizations = statistics_.interior_steps = statistics_.pivots = 0;
    test_.SetB(problem);
    IpmRun run(system_, test_, {options_.proximal, options_.correctors, options_.self_check}, options, statistics_);
    BlockPivoting::Task task;
    task.problem = &problem;
    task.scaled = &system_.rows();
    task.block = &run;
    task.sink = &run;
    task.factors = std::numeric_limits<std::int64_t>::max();  // limits are the run's
    task.tolerance = options.tolerance;
    task.through_bodies = system_.in_body_space();
    pivoting_.Begin(task);
    result->status = SolveWithin(&run, result);
    if (run.accepted()) result->status = LcpStatus::kSolved;
    result->iterations = statistics_.factorizations;
    if (result->status == LcpStatus::kInfeasible && !result->farkas_ray.has_value()) {
      result->farkas_ray = std::move(pivoting_.ray());
    }
    result->f = run.best_f();
  }

  const IpmStatistics& statistics() const { return statistics_; }
  void UseWarmStart(WarmStart use) { use_ = use; }

 private:
  using End = BlockPivoting::End;
  using Progress = InteriorPoint::Progress;

  LcpStatus SolveWithin(IpmRun* run, LcpResult* result) {
    const LcpProblem& problem = system_.problem();
    const Index n = problem.size();
    result->farkas_ray = FindZeroRowRay(problem, 0);
    if (result->farkas_ray.has_value()) return LcpStatus::kInfeasible;

    bool live = false;
    bool contacts = false;
    for (Index i = 0; i < n; ++i) {
      live = live || !system_.idle(i);
      contacts = contacts || system_.unilateral(i);
    }
    if (run->Accept(Eigen::VectorXd::Zero(n))) return LcpStatus::kSolved;
    if (!live) {
      result->detail = "a row with A_ii = 0 has a gap acceleration that no force can change";
      return LcpStatus::kNumericalFailure;
    }
    Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd w = f;
    if (!contacts) return Finish(run, f, w, 0.0, result);

    finish_.Restart();
    bool warm = false;
    if (run->options().initial_f != nullptr) {
      const double rho_of_zero = run->best_rho();
      if (TryStart(run, rho_of_zero)) return LcpStatus::kSolved;
      if (run->limit_hit()) return Ended(run, End::kStopped, result);
      if (use_ == WarmStart::kGuessOnly) return LcpStatus::kIterationLimit;
      warm = run->best_rho() <= kCloseEnough * rho_of_zero;
    }
    if (warm) {
      system_.rows().Clip(run->best_f(), &f);
      interior_.StartWarm(run, f, use_ == WarmStart::kAfterSweeps ? kSweptMu : kWarmMu);
    } else if (interior_.StartCold(run) == Progress::kStopped) {
      return Ended(run, run->limit_hit() ? End::kStopped : End::kGaveUp, result);
    }

    double guess_below = kFirstFinish;
    int guesses = 0;
    int recentred = 0;
    int lifted = 0;
    const double few_wrong = finish_.may_sweep() ? kFewWrongRowsOfMany : kFewWrongRows;
    Progress progress = Progress::kGood;
    for (int k = 0; k < kInteriorSteps && progress == Progress::kGood && interior_.mu() > kLeastMu; ++k) {
      progress = interior_.Step(run);
      const bool stagnant = progress == Progress::kStagnant;
      // What sweeps have left is worth its short steps: they are as short from elsewhere.
      const bool doubtful = warm && use_ != WarmStart::kAfterSweeps;
      const bool blocked =
          progress == Progress::kGood && doubtful && k < kTrialSteps && interior_.step() < kBlockedStep;
      if (stagnant && recentred++ < kMostRecentred) {
        interior_.Recentre(run, kRecentredMu);
        progress = Progress::kGood;
        continue;
      }
      if (blocked && lifted++ < kMostLifts) {
        interior_.Recentre(run, kLift);
        k = -1;
        continue;
      }
      if (blocked || (stagnant && doubtful)) {
        warm = false;
        progress = interior_.StartCold(run);
        k = -1;
        recentred = guesses = 0;
        guess_below = kFirstFinish;
        continue;
      }
      if (progress != Progress::kGood) break;
      if (interior_.mu() > kFirstFinish || interior_.residual() > kFinishResidual) continue;
      if (finish_.Try(run, interior_.f(), interior_.w())) return LcpStatus::kSolved;
      if (interior_.mu() > guess_below || finish_.wrong_rows() > few_wrong) continue;
      guess_below = kNextGuess * interior_.mu();
      const double weight = guesses++ == 0 ? 0.0 : TameWeight(interior_.mu());
      const End end = TryActiveSets(interior_.f(), interior_.w(), kFromIterate, weight);
      if (run->limit_hit() || end == End::kDone || end == End::kInfeasible) return Ended(run, end, result);
    }
    return FinishFrom(progress, run, result);
  }

  // After the last interior step.
  LcpStatus FinishFrom(Progress progress, IpmRun* run, LcpResult* result) {
    if (run->limit_hit()) {
      Remember(run);
      return Ended(run, End::kStopped, result);
    }
    if (progress == Progress::kDiverged) {
      if (pivoting_.FindRay(interior_.f())) return Ended(run, End::kInfeasible, result);
      const Eigen::VectorXd w = interior_.w() - interior_.f();  // keeps F = {f > w} while c = 0
      return Finish(run, Eigen::VectorXd::Zero(w.size()), w, 0.0, result);
    }
    if (finish_.may_sweep()) {
      Remember(run);
      if (finish_.SweepFromBest(run, kLastSweeps)) return LcpStatus::kSolved;
    }
    return Finish(run, interior_.f(), interior_.w(), TameWeight(interior_.mu()), result);
  }

  // All of a warm start that comes before the interior point; what it finds is run->best_f(). True if that is it.
  bool TryStart(IpmRun* run, double rho_of_zero) {
    Eigen::VectorXd f(system_.size()), w(system_.size());
    system_.rows().Clip(*run->options().initial_f, &f);
    if (run->AcceptScaled(f, &w)) return true;
    if (!(run->best_rho() <= kWorthTrying * rho_of_zero)) return false;
    if (TryActiveSets(f, w, kFromStart, 0) == End::kDone) return true;
    if (run->limit_hit() || use_ != WarmStart::kFull) return false;
    return finish_.SweepFromBest(run, warm_sweeps_);
  }

  End TryActiveSets(const Eigen::VectorXd& f, const Eigen::VectorXd& w, BlockPivoting::Rules rules, double weight) {
    rules.weight = std::max(rules.weight, weight);
    pivoting_.StartFrom(f, w);
    return pivoting_.Run(rules);
  }

  LcpStatus Finish(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w, double weight, LcpResult* result) {
    return Ended(run, TryActiveSets(f, w, kLastResort, weight), result);
  }

  LcpStatus Ended(IpmRun* run, End end, LcpResult* result) {
    if (run->accepted()) return LcpStatus::kSolved;
    if (end == End::kInfeasible) return LcpStatus::kInfeasible;
    if (run->limit_hit()) return run->limit_status();
    result->detail = "the active-set method ended above the tolerance";
    if (!system_.why().empty()) result->detail += "; " + system_.why();
    return LcpStatus::kNumericalFailure;
  }

  void Remember(IpmRun* run) { run->AcceptScaled(interior_.f(), nullptr); }

  IpmOptions options_;
  WarmStart use_ = WarmStart::kFull;
  std::int64_t warm_sweeps_ = 0;
  IpmStatistics statistics_;
  ScaledSystem system_;
  InteriorPoint interior_;
  InteriorFinish finish_;
  BlockPivoting pivoting_;
  GivenFormTest test_;
};

std::string IpmEngine::WhyUnsupported(const LcpProblem& problem) const {
  if (!problem.IsNumericallySymmetric()) return WhyNotSymmetric(problem);
  const Eigen::VectorXd& diagonal = problem.DiagonalA();
  for (Index i = 0; i < problem.size(); ++i) {
    if (diagonal[i] > 0) continue;
    const std::string row = std::to_string(i);
    if (diagonal[i] < 0) return "A is not positive semidefinite: its diagonal entry " + row + " is negative";
    if (problem.has_factors()) continue;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
      if (it.value() != 0) return "A is not positive semidefinite: row " + row + " is nonzero beside a zero diagonal";
    }
  }
  return {};
}

const IpmStatistics& IpmSolver::statistics() const { return engine_->statistics(); }

void IpmSolver::UseWarmStart(WarmStart use) { engine_->UseWarmStart(use); }

template class EngineSolver<IpmOptions, IpmEngine>;

}  // namespace lcpbench
