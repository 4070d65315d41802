#include "solvers/dantzig.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <utility>

#include "solvers/dantzig_engine.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Forces below this multiple of the largest D^1/2 f are looked at more closely: are they rounding only?
constexpr double kSmallForce = 1e-10;
// Entries of a warm start enter F above this multiple of the largest D^1/2 f (an interior point leaves no zeros).
constexpr double kWarmThreshold = 1e-10;
// Residual below which the answer is published without refinement or repair.
constexpr double kGoodEnough = 1e-13;
// Infeasibility is reported where the residual is above this, or above the tolerance if that is less: a proof holds at
// every tolerance, but a problem that is infeasible by rounding only shall be solved.
constexpr double kProofTolerance = 1e-9;
// Rounds of driving after the first are repairs; each must improve the residual.
constexpr int kMaxRounds = 10;
// Factors on rank_tolerance for the first attempt and the restarts.
constexpr double kAttempts[] = {1.0, 1e-2, 1e3};
constexpr std::int64_t kPivotsPerRow = 50;
constexpr std::int64_t kExtraPivots = 1000;
// Multiply-adds between two looks at the clock (some 10 us), and what a pivot costs besides them.
constexpr Index kWorkPerClockRead = 16384;
constexpr Index kWorkPerPivot = 256;

}  // namespace

void DantzigSolver::Engine::Reserve(Index max_rows) {
  if (max_rows <= dw_.size()) return;
  active_.Reserve(max_rows);
  dw_.setZero(max_rows);
}

void DantzigSolver::Engine::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  Reserve(problem.size());
  estimate_.Reset(*problem_, true);
  for (Eigen::VectorXd* v : {&f_trial_, &w_trial_, &w_best_}) v->resize(problem.size());
  if (problem.has_factors()) {
    body_.resize(problem.J().cols());
    body_extended_.resize(problem.J().cols());
  }
}

bool DantzigSolver::Engine::TimeIsUp(Index work) {
  if (!deadline_.has_value()) return false;
  work_left_ -= work + kWorkPerPivot;
  if (work_left_ >= 0) return false;
  work_left_ = kWorkPerClockRead;
  return deadline_->Expired();
}

DantzigSolver::Engine::End DantzigSolver::Engine::EnterJoints(LcpResult* result) {
  Index end = lcp_.bilateral;
  while (m() < end) {
    if (TimeIsUp(m() * m())) return End::kTimeLimit;
    const Index p = m();
    const double pivot = active_.SetDriven(p);
    if (pivot > rank_tolerance_ * active_.Direction(p)) {
      active_.EnterDriven(p, pivot);
    } else {
      lcp_.Swap(p, --end);
    }
  }
  joints_ = m();
  if (m() > 0) SolveForces(Leaving::kAll);
  // Dependent rows, now at [m, bilateral): w = y.b, which no force changes.
  for (Index p = m(); p < lcp_.bilateral; ++p) {
    const PermutedLcp::Sum w = lcp_.FreshW(p, m());
    if (std::abs(w.value) <= kNoise * w.magnitude || lcp_.ResidualShare(p, w.value) <= proof_tolerance_) continue;
    active_.SetDriven(p);
    active_.Direction(p);
    if (ClaimRay(p, w.value < 0 ? 1 : -1, result)) return End::kInfeasible;
  }
  for (Index p = lcp_.bilateral; p > m();) lcp_.Swap(--p, --open_);
  return End::kDone;
}

DantzigSolver::Engine::End DantzigSolver::Engine::EnterWarmRows() {
  if (initial_f_ == nullptr) return End::kDone;
  const auto size = [this](Index p) {
    const double given = (*initial_f_)[lcp_.row[static_cast<size_t>(p)]];
    return std::sqrt(lcp_.diagonal[p]) * lcp_.ScaledForce(p, given);
  };
  double largest = 0;
  for (Index p = m(); p < open_; ++p) largest = std::max(largest, size(p));
  for (Index p = m(); p < open_; ++p) {
    if (!(size(p) > kWarmThreshold * largest)) continue;
    if (TimeIsUp(m() * m())) return End::kTimeLimit;
    const double pivot = active_.SetDriven(p);
    if (pivot > rank_tolerance_ * active_.Direction(p)) active_.EnterDriven(p, pivot);
  }
  SolveForces(Leaving::kAll);
  return End::kDone;
}

// Whether a unilateral row of F with force f has no business there: f < 0, or f > 0 by rounding only.
DantzigSolver::Engine::Surplus DantzigSolver::Engine::FindSurplus(Index p, double largest, bool judge_by_size) const {
  const double f = lcp_.f[p];
  if (f < 0) return Surplus::kNegative;
  const double size = lcp_.diagonal[p] * f * f;
  if (size > kSmallForce * kSmallForce * largest) return Surplus::kNone;
  if (judge_by_size && size <= kNoise * kNoise * largest) return Surplus::kTiny;
  return lcp_.diagonal[p] * f > kNoise * lcp_.FreshW(p, m()).magnitude ? Surplus::kNone : Surplus::kRounding;
}

// f_F = -A_FF^-1 b_F. Unilateral rows with f < 0, or f > 0 by rounding only, leave until there is none. Rounding is
// judged by the row's own magnitudes and, at first, also by the largest force: where all forces around a row should be
// 0, its own magnitudes are rounding too. Returns true if rows left by that second rule: their w needs a look.
bool DantzigSolver::Engine::SolveForces(Leaving leaving) {
  const bool judge_by_size = leaving == Leaving::kAllAndTiny;
  bool dropped_by_size = false;
  for (bool again = true; again;) {
    again = false;
    const double largest = active_.SolveForces();
    Index worst = kNoRow;
    double least = kInfinity;
    for (Index p = m() - 1; p >= joints_; --p) {
      const Surplus surplus = FindSurplus(p, largest, judge_by_size);
      if (surplus == Surplus::kNone) continue;
      if (leaving == Leaving::kOneByOne) {
        const double scaled = lcp_.f[p] * std::sqrt(lcp_.diagonal[p]);
        if (scaled < least) {
          least = scaled;
          worst = p;
        }
        continue;
      }
      dropped_by_size = dropped_by_size || surplus == Surplus::kTiny;
      Release(p);
      again = true;
    }
    if (worst != kNoRow) {
      Release(worst);
      again = true;
    }
  }
  return dropped_by_size;
}

void DantzigSolver::Engine::Release(Index p) {
  lcp_.f[p] = 0;
  lcp_.w[p] = 0;
  active_.Leave(p);
}

// Recomputes w of all rows outside F; those with w < 0 beyond rounding wait for another round, the others are watched.
bool DantzigSolver::Engine::FindViolations() {
  q_ = open_;
  for (Index p = m(); p < q_;) {
    const PermutedLcp::Sum w = lcp_.FreshW(p, m());
    lcp_.f[p] = 0;
    lcp_.w[p] = w.value;
    if (w.value >= -kNoise * w.magnitude) {
      lcp_.w[p] = std::max(w.value, 0.0);
      ++p;
    } else {
      lcp_.Swap(p, --q_);
    }
  }
  return q_ < open_;
}

// w = A f + b for A given by factors, through body space, as LcpProblem::ComputeW, which allocates.
template <typename Real>
void DantzigSolver::Engine::ComputeWByFactors(const Eigen::VectorXd& f, Eigen::Matrix<Real, Eigen::Dynamic, 1>* body,
                                              Eigen::VectorXd* w) const {
  const SparseMatrix& J = problem_->J();
  body->setZero();
  for (Index i = 0; i < J.rows(); ++i) {
    if (f[i] == 0) continue;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) (*body)[it.col()] += static_cast<Real>(it.value()) * f[i];
  }
  for (Index k = 0; k < J.cols(); ++k) (*body)[k] *= problem_->inverse_mass()[k];
  for (Index i = 0; i < J.rows(); ++i) {
    Real sum = 0;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) sum += it.value() * (*body)[it.col()];
    (*w)[i] = static_cast<double>(sum + problem_->b()[i]);
  }
}

// Judges f with w by the given form and keeps it if it is the best so far. True if it is good enough to stop.
bool DantzigSolver::Engine::Publish(LcpResult* result) {
  f_trial_.setZero();
  for (Index p = 0; p < lcp_.nonzero; ++p) f_trial_[lcp_.row[static_cast<size_t>(p)]] = lcp_.GivenForce(p);
  if (problem_->has_factors()) {
    ComputeWByFactors(f_trial_, &body_, &w_trial_);
  } else {
    problem_->ComputeW(f_trial_, &w_trial_);
  }
  const double rho = estimate_.Rho(f_trial_, w_trial_);
  if (!(rho < tier_)) return false;
  double backward = estimate_.BackwardError(f_trial_, w_trial_);
  if (problem_->has_factors() && backward * backward > tolerance_) {
    // Where the sums through body space cancel in a row whose own terms are all (nearly) 0, the row's backward error is
    // rounding over nothing. The verdict is made in extended precision, so the estimate is, too.
    ComputeWByFactors(f_trial_, &body_extended_, &w_trial_);
    backward = estimate_.BackwardError(f_trial_, w_trial_);
  }
  const double tier = std::max(rho, backward * backward);
  if (!(tier < tier_)) return false;
  tier_ = tier;
  result->f.swap(f_trial_);
  w_best_.swap(w_trial_);
  return tier <= kGoodEnough;
}

// One step of iterative refinement with the residual of the given form.
void DantzigSolver::Engine::Refine() {
  for (Index p = 0; p < m(); ++p) lcp_.w[p] = lcp_.ScaledW(p, w_best_[lcp_.row[static_cast<size_t>(p)]]);
  active_.CorrectForces();
  for (Index p = joints_; p < m(); ++p) lcp_.f[p] = std::max(lcp_.f[p], 0.0);
}

DantzigSolver::Engine::End DantzigSolver::Engine::Run(LcpResult* result) {
  active_.Reset();
  joints_ = 0;
  open_ = lcp_.nonzero;
  End end = EnterJoints(result);
  if (end == End::kDone) end = EnterWarmRows();
  q_ = m();
  if (options_.order == DantzigOrder::kMostNegative) FindViolations();
  for (int round = 0; round < kMaxRounds && end == End::kDone; ++round) {
    end = DriveAll(result);
    if (end != End::kDone) break;
    if (SolveForces(round == 0 ? Leaving::kAllAndTiny : Leaving::kOneByOne) && FindViolations()) continue;
    const double tier_before = tier_;
    if (Publish(result)) break;
    if (round > 0 && !(tier_ < tier_before)) break;
    Refine();
    if (Publish(result)) break;
    SolveForces(Leaving::kOneByOne);
    if (!FindViolations()) break;
  }
  if (end != End::kDone) Publish(result);
  if (tier_ <= (end == End::kInfeasible ? proof_tolerance_ : tolerance_)) return End::kDone;
  return end == End::kDone ? End::kNotMet : end;
}

// A_ii = 0 makes row i of a PSD A zero: w_i = b_i whatever f is, and +-e_i is a ray if that is wrong.
bool DantzigSolver::Engine::FindZeroRowRay(LcpResult* result) {
  for (Index p = lcp_.nonzero; p < lcp_.n; ++p) {
    const Index i = lcp_.row[static_cast<size_t>(p)];
    const double b = problem_->b()[i];
    if ((b >= 0 && !problem_->is_bilateral(i)) || std::abs(b) <= proof_tolerance_ * lcp_.b_norm) continue;
    Eigen::VectorXd ray = Eigen::VectorXd::Zero(lcp_.n);
    ray[i] = b < 0 ? 1 : -1;
    if (!VerifyFarkasRay(*problem_, ray).accepted) continue;
    result->farkas_ray = std::move(ray);
    return true;
  }
  return false;
}

void DantzigSolver::Engine::Solve(const LcpOptions& options, LcpResult* result) {
  tolerance_ = options.tolerance;
  proof_tolerance_ = std::min(tolerance_, kProofTolerance);
  initial_f_ = options.initial_f;
  deadline_.reset();
  if (std::isfinite(options.time_limit_s)) deadline_.emplace(options);
  work_left_ = 0;
  pivots_ = 0;
  pivot_limit_ = options.max_iterations > 0 ? options.max_iterations : kPivotsPerRow * problem_->size() + kExtraPivots;
  tier_ = kInfinity;
  End end = End::kNotMet;
  char text[160];
  for (const double factor : kAttempts) {
    if (end != End::kNotMet) break;
    rank_tolerance_ = options_.rank_tolerance * factor;
    if (!lcp_.Load(*problem_)) {
      result->status = LcpStatus::kUnsupported;
      result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
      return;
    }
    if (FindZeroRowRay(result)) {
      result->status = LcpStatus::kInfeasible;
      return;
    }
    end = Run(result);
    if (factor != kAttempts[0] && end == End::kDone) {
      std::snprintf(text, sizeof text, "solved after a restart with rank tolerance %.0e", rank_tolerance_);
      result->detail = text;
    }
  }
  result->iterations = pivots_;
  switch (end) {
    case End::kDone:
      result->status = LcpStatus::kSolved;
      result->farkas_ray.reset();
      break;
    case End::kInfeasible:
      result->status = LcpStatus::kInfeasible;
      break;
    case End::kIterationLimit:
      result->status = LcpStatus::kIterationLimit;
      break;
    case End::kTimeLimit:
      result->status = LcpStatus::kTimeLimit;
      break;
    case End::kStuck:
    case End::kNotMet:
      result->status = LcpStatus::kNumericalFailure;
      std::snprintf(text, sizeof text,
                    "residual %.1e above the tolerance for rank tolerances %.0e, %.0e and %.0e, and no proven ray",
                    tier_, options_.rank_tolerance, options_.rank_tolerance * kAttempts[1],
                    options_.rank_tolerance * kAttempts[2]);
      result->detail = text;
      break;
  }
}

DantzigOptions DantzigOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("dantzig", settings);
  DantzigOptions options;
  options.rank_tolerance =
      reader.Number("rank_tolerance", options.rank_tolerance, std::numeric_limits<double>::epsilon(), 1e-3);
  options.max_rows = static_cast<Index>(reader.Number("max_rows", static_cast<double>(options.max_rows), 1, 1e5));
  if (reader.Choice("order", "index", {"index", "most-negative"}) == "most-negative") {
    options.order = DantzigOrder::kMostNegative;
  }
  reader.Finish();
  return options;
}

DantzigSolver::DantzigSolver(DantzigOptions options)
    : max_rows_(options.max_rows), engine_(std::make_unique<Engine>(options)) {}
DantzigSolver::~DantzigSolver() = default;

std::string DantzigSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.size() > max_rows_) {
    return std::to_string(problem.size()) + " rows are more than max_rows = " + std::to_string(max_rows_) +
           " of this dense solver";
  }
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric";
}

void DantzigSolver::Reserve(Index max_rows) { engine_->Reserve(max_rows); }

void DantzigSolver::DoPrepare(const LcpProblem& problem) { engine_->Prepare(problem); }

void DantzigSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) {
  engine_->Solve(options, result);
}

}  // namespace lcpbench
