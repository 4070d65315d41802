#include "solvers/pivoting/pivot_base.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Forces below this multiple of the largest D^1/2 f are looked at more closely: are they rounding only?
constexpr double kSmallForce = 1e-10;
// A guessed row enters without a closer look if its pivot is above this multiple of rank_tolerance A_ii.
constexpr double kGuessedPivot = 1e3;
// Blocks enter while more than this many rows are violated, and at most this part of those before.
constexpr Index kFewViolated = 2;
constexpr double kBlockProgress = 0.8;
// So many rows, and one for each kRowsPerUpdate of F, leave by updates of the factor; more by a new one.
constexpr Index kFewUpdates = 2;
constexpr Index kRowsPerUpdate = 8;
// Infeasibility is reported where the residual is above this, or above the tolerance if that is less: a proof holds at
// every tolerance, but a problem that is infeasible by rounding only shall be solved.
constexpr double kProofTolerance = 1e-9;
// Where an answer fails in single rows, forces up to these parts of the largest D^1/2 f are tried as zeros.
constexpr double kTinyForces[] = {1e-14, 1e-12, 1e-10};
// Rounds of an attempt; those after the first are repairs, each of which must improve the residual.
constexpr int kMaxRounds = 10;
constexpr int kRayRefinements = 3;
// Factors on rank_tolerance for the first attempt and the restarts.
constexpr double kAttempts[] = {1.0, 1e-2, 1e3};
// By End.
constexpr LcpStatus kStatusOf[] = {LcpStatus::kSolved,           LcpStatus::kNumericalFailure, LcpStatus::kInfeasible,
                                   LcpStatus::kNumericalFailure, LcpStatus::kIterationLimit,   LcpStatus::kTimeLimit};
constexpr std::int64_t kPivotsPerRow = 50;
constexpr std::int64_t kExtraPivots = 1000;
// Multiply-adds between two looks at the clock (some 10 us), and what a pivot costs besides them.
constexpr Index kWorkPerClockRead = 16384;
constexpr Index kWorkPerPivot = 256;

}  // namespace

void PivotOptions::Read(SettingsReader* reader) {
  rank_tolerance = reader->Number("rank_tolerance", rank_tolerance, std::numeric_limits<double>::epsilon(), 1e-3);
  block_start = reader->YesOrNo("block_start", block_start);
  max_rows = static_cast<Index>(reader->Number("max_rows", static_cast<double>(max_rows), 1, 1e5));
  self_check = reader->SelfCheck();
}

// A tableau has a rank rule of its own, without a choice.
PivotBase::PivotBase(const PivotOptions& options, std::optional<TableauRule> rule)
    : RowEngine(rule.has_value() && options.rank_tolerance == PivotOptions().rank_tolerance
                    ? std::min(options.max_rows, SmallPivoting::kMaxRows)
                    : 0),
      pivot_options_(options) {
  if (rule.has_value()) tableau_.emplace(InstructionSet::kBest, *rule);
}

bool PivotBase::SolveRows(const RowTask& task, LcpResult* result) {
  tableau_->ReserveRows(task.rows.rows, task.rows.bodies);
  SmallPivoting::Request request;
  request.deadline = task.deadline;
  request.self_check = pivot_options_.self_check;
  double rho = 0;
  const SmallPivoting::End end = tableau_->SolveRows(task.rows, task.all, task.options.tolerance, request, &task.judge,
                                                     result->f.data(), task.w, &rho);
  if (end != SmallPivoting::End::kSolved) return false;
  result->status = LcpStatus::kSolved;
  result->iterations = tableau_->pivots();
  return true;
}

std::string PivotBase::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.size() > pivot_options_.max_rows) {
    return std::to_string(problem.size()) +
           " rows are more than max_rows = " + std::to_string(pivot_options_.max_rows) + " of this dense solver";
  }
  return WhyNotSymmetric(problem);
}

void PivotBase::Reserve(Index max_rows) {
  active_.Reserve(max_rows);
  surplus_.reserve(static_cast<size_t>(max_rows));
}

void PivotBase::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  Reserve(problem.size());
  if (pivot_options_.self_check) judge_.Reset(problem, true);
}

void PivotBase::Start(const LcpOptions& options) {
  tolerance_ = options.tolerance;
  proof_tolerance_ = std::min(tolerance_, kProofTolerance);
  deadline_.reset();
  if (Deadline::IsNeeded(options)) deadline_.emplace(options);
  work_left_ = 0;
  out_of_time_ = false;
  pivots_ = 0;
  pivot_limit_ = options.max_iterations > 0 ? options.max_iterations : kPivotsPerRow * problem_->size() + kExtraPivots;
}

bool PivotBase::TimeIsUp(Index work) {
  if (!deadline_.has_value()) return false;
  if (out_of_time_) return true;
  work_left_ -= work + kWorkPerPivot;
  if (work_left_ >= 0) return false;
  work_left_ = kWorkPerClockRead;
  return deadline_->Expired();
}

PermutedLcp::Loaded PivotBase::Load(const PermutedLcp::Guess& guess) {
  const PermutedLcp::Loaded loaded = lcp_.Load(*problem_, guess, deadline());
  if (loaded != PermutedLcp::Loaded::kDone) return loaded;
  active_.Reset();
  solved_at_ = -1;
  joints_ = 0;
  open_ = lcp_.nonzero;
  unit_ = lcp_.nonzero > 0 ? lcp_.diagonal[0] : 1.0;
  return loaded;
}

void PivotBase::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  problem_ = problem;
  if (pivot_options_.self_check) judge_.Start(problem, options.tolerance, result);
  Start(options);
  End end = End::kNotMet;
  char text[160];
  for (const double factor : kAttempts) {
    if (end != End::kNotMet) break;
    rank_tolerance_ = pivot_options_.rank_tolerance * factor;
    const bool first = factor == kAttempts[0];
    blocks_ = first && (pivot_options_.block_start || options.initial_f != nullptr);
    guess_ = {first ? options.initial_f : nullptr, blocks_};
    const PermutedLcp::Loaded loaded = Load(guess_);
    if (loaded == PermutedLcp::Loaded::kOutOfTime) {
      end = End::kTimeLimit;
      break;
    }
    if (loaded == PermutedLcp::Loaded::kNegativeDiagonal) {
      result->status = LcpStatus::kUnsupported;
      result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
      return;
    }
    result->farkas_ray = FindZeroRowRay(*problem_, proof_tolerance_ * lcp_.b_norm);
    if (result->farkas_ray.has_value()) {
      result->status = LcpStatus::kInfeasible;
      return;
    }
    end = Attempt(result);
    if (factor != kAttempts[0] && end == End::kDone) {
      std::snprintf(text, sizeof text, "solved after a restart with rank tolerance %.0e", rank_tolerance_);
      result->detail = text;
    }
  }
  result->iterations = pivots_;
  result->status = kStatusOf[static_cast<size_t>(end)];
  if (end == End::kDone) result->farkas_ray.reset();
  if (result->status != LcpStatus::kNumericalFailure) return;
  std::snprintf(text, sizeof text,
                "residual %.1e above the tolerance for rank tolerances %.0e, %.0e and %.0e, and no proven ray",
                judge_.tier(), pivot_options_.rank_tolerance, pivot_options_.rank_tolerance * kAttempts[1],
                pivot_options_.rank_tolerance * kAttempts[2]);
  result->detail = text;
}

// An answer that meets the tolerance counts whatever ended the search for it; f of a search that came to no end is
// judged unless time is up, and stands then if nothing was published before.
PivotBase::End PivotBase::Attempt(LcpResult* result) {
  End end = EnterStart(result);
  for (int round = 0; end == End::kDone && round < kMaxRounds; ++round) {
    if (!FindViolations(round) && round > 0 && !out_of_time_) break;
    end = out_of_time_ ? End::kTimeLimit : MakeRight(result);
    if (end != End::kDone) break;
    SolveForces(round == 0 ? Leaving::kAll : Leaving::kOneByOne);
    const double tier_before = judge_.tier();
    if (Publish(result) || (round > 0 && !(judge_.tier() < tier_before))) break;
    Refine();
    if (Publish(result)) break;
    SolveForces(Leaving::kOneByOne);
  }
  if (end == End::kTimeLimit) {
    if (!std::isfinite(judge_.tier())) GiveForces(&result->f);
  } else if (end != End::kDone) {
    Publish(result);
  }
  if (!pivot_options_.self_check) return end == End::kDone && MayBeWrong() ? End::kNotMet : end;
  if (end == End::kDone && judge_.tier() > tolerance_) DropTinyForces(result);
  if (judge_.tier() <= (end == End::kInfeasible ? proof_tolerance_ : tolerance_)) return End::kDone;
  return end == End::kDone ? End::kNotMet : end;
}

// Without a judge: whether a row that was left out or set aside is wrong by more than the tolerance, or any row may be
// because the rounding of its terms is as large.
bool PivotBase::MayBeWrong() const {
  double forces = 0;
  for (Index p = 0; p < m(); ++p) forces += std::abs(lcp_.f[p]) * std::sqrt(lcp_.diagonal[p]);
  if (std::numeric_limits<double>::epsilon() * forces > tolerance_ * lcp_.b_scale * lcp_.b_norm) return true;
  for (Index p = open_; p < lcp_.nonzero; ++p) {
    const double w = lcp_.FreshW(p, m()).value;
    const double wrong = problem_->is_bilateral(RowAt(p)) ? w : std::min(w, 0.0);
    if (lcp_.ResidualShare(p, wrong) > tolerance_) return true;
  }
  return false;
}

PivotBase::End PivotBase::EnterJoints(LcpResult* result) {
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
  solved_at_ = -1;
  if (m() > 0) active_.SolveForces();
  const double negligible = proof_tolerance_ / static_cast<double>(1 + lcp_.bilateral - m());  // in all rows together
  for (Index p = m(); p < lcp_.bilateral; ++p) {
    const PermutedLcp::Sum w = lcp_.FreshW(p, m());
    const double share = lcp_.ResidualShare(p, w.value);
    if (std::abs(w.value) <= kNoise * w.magnitude || share <= negligible) continue;
    if (TimeIsUp(m() * m())) return End::kTimeLimit;
    active_.SetDriven(p);
    active_.Direction(p);
    if (share > proof_tolerance_ && ClaimRay(p, w.value < 0 ? 1 : -1, result)) return End::kInfeasible;
    LeaveOutStrongest(p);
  }
  for (Index p = lcp_.bilateral; p > m();) lcp_.Swap(--p, --open_);
  return End::kDone;
}

// A y = 0 for y = (df_F, 1) but for rounding, so y.w = y.b whatever f is: where that is not quite 0, the gap of the one
// row left out is y.b over its own part of y. The row of the largest D^1/2 |y| takes the place of the driven row p.
void PivotBase::LeaveOutStrongest(Index p) {
  const auto size = [this](Index k) { return std::abs(active_.df()[k]) * ForceRoot(k); };
  Index strongest = kNoRow;
  double largest = ForceRoot(p);
  for (Index k = 0; k < m(); ++k) {
    if (size(k) <= largest) continue;
    largest = size(k);
    strongest = k;
  }
  if (strongest == kNoRow) return;
  Release(strongest);  // to m, the first position outside F
  if (const double pivot = active_.SetDriven(p); pivot > 0) active_.EnterDriven(p, pivot);
  joints_ = m();
  active_.SolveForces();
}

PivotBase::End PivotBase::EnterStart(LcpResult* result) {
  const double least_pivot = kGuessedPivot * rank_tolerance_;
  const Index rows = lcp_.bilateral + lcp_.guessed;
  if (rows > 0) {
    if (TimeIsUp(rows * rows) || !active_.Factor(rows, least_pivot, deadline())) return End::kTimeLimit;
    joints_ = lcp_.bilateral;
    // Joints stay, so the rank rule itself decides where there is any doubt.
    const double doubtful = std::sqrt(rank_tolerance_);
    bool clear = active_.first_left_out(rows) >= joints_;
    for (Index p = 0; p < joints_ && clear; ++p) clear = active_.pivot(p) > doubtful * lcp_.diagonal[p];
    if (!clear) {
      if (Load(guess_) != PermutedLcp::Loaded::kDone) return End::kTimeLimit;  // the order as it was
      const End end = EnterJoints(result);
      if (end != End::kDone) return end;
    }
    SolveForces(Leaving::kAll);
    if (out_of_time_) return End::kTimeLimit;
  }
  violated_ = m();
  return blocks_ ? EnterBlocks(least_pivot) : End::kDone;
}

PivotBase::End PivotBase::EnterBlocks(double least_pivot) {
  for (Index most = open_;;) {
    violated_ = SetViolatedApart();
    if (out_of_time_) return End::kTimeLimit;
    const Index count = open_ - violated_;
    if (count <= kFewViolated || count > most) return End::kDone;
    most = static_cast<Index>(kBlockProgress * static_cast<double>(count));
    if (pivots_ >= pivot_limit_) return End::kIterationLimit;
    if (TimeIsUp(m() * (m() + open_))) return End::kTimeLimit;
    ++pivots_;
    for (Index k = 0; k < count && m() + k < violated_; ++k) {
      if (TimeIsUp(lcp_.n)) return End::kTimeLimit;
      lcp_.Swap(m() + k, open_ - 1 - k);
    }
    if (!active_.Factor(m() + count, least_pivot, deadline())) return End::kTimeLimit;
    SolveForces(Leaving::kAll);
    if (out_of_time_) return End::kTimeLimit;
  }
}

Index PivotBase::SetViolatedApart() {
  Index q = open_;
  for (Index p = m(); p < q;) {
    if (TimeIsUp(m() + lcp_.n)) {
      out_of_time_ = true;
      return open_;
    }
    const PermutedLcp::Sum w = lcp_.FreshW(p, m());
    lcp_.f[p] = 0;
    lcp_.w[p] = w.value;
    if (w.value >= -kNoise * w.magnitude) {
      lcp_.w[p] = std::max(w.value, 0.0);
      ++p;
    } else {
      lcp_.Swap(p, --q);
    }
  }
  return q;
}

// Whether a unilateral row of F with force f has no business there: f < 0, or f > 0 by rounding only.
bool PivotBase::IsSurplus(Index p, double largest) const {
  const double f = lcp_.f[p];
  if (f < 0) return true;
  if (lcp_.diagonal[p] * f * f > kSmallForce * kSmallForce * largest) return false;
  return lcp_.diagonal[p] * f <= kNoise * lcp_.FreshW(p, m()).magnitude;
}

void PivotBase::SolveForces(Leaving leaving) {
  for (;;) {
    if (solved_at_ != pivots_) largest_ = active_.SolveForces();
    solved_at_ = pivots_;
    surplus_.clear();
    double least = kInfinity;
    for (Index p = m() - 1; p >= joints_; --p) {
      if (!IsSurplus(p, largest_)) continue;
      if (leaving == Leaving::kOneByOne) {
        const double size = lcp_.f[p] * ForceRoot(p);
        if (size >= least) continue;
        least = size;
        surplus_.clear();
      }
      surplus_.push_back(p);
    }
    if (surplus_.empty()) return;
    ReleaseAll();
    if (out_of_time_) return;
  }
}

// The rows in surplus_.
void PivotBase::ReleaseAll() {
  solved_at_ = -1;
  const auto count = static_cast<Index>(surplus_.size());
  if (count <= kFewUpdates + m() / kRowsPerUpdate) {
    for (const Index p : surplus_) Release(p);
    return;
  }
  Index rest = m();
  for (const Index p : surplus_) {
    lcp_.f[p] = 0;
    lcp_.w[p] = 0;
    lcp_.Swap(p, --rest);
  }
  if (active_.Factor(rest, 0.0, deadline())) return;
  out_of_time_ = true;
  lcp_.f.head(lcp_.nonzero).setZero();
}

void PivotBase::Release(Index p) {
  lcp_.f[p] = 0;
  lcp_.w[p] = 0;
  active_.Leave(p);
}

bool PivotBase::Publish(LcpResult* result) {
  if (!pivot_options_.self_check) {
    GiveForces(&result->f);
    return true;
  }
  GiveForces(&judge_.candidate());
  return judge_.Publish();
}

void PivotBase::GiveForces(Eigen::VectorXd* f) const {
  f->setZero();
  for (Index p = 0; p < lcp_.nonzero; ++p) (*f)[RowAt(p)] = lcp_.GivenForce(p);
}

// Forces that are rounding beside the largest may be all that a row has whose forces and b should be 0; its backward
// error is rounding over rounding then.
void PivotBase::DropTinyForces(LcpResult* result) {
  const auto size = [this](Index p) { return std::abs(lcp_.f[p]) * ForceRoot(p); };
  double largest = 0;
  for (Index p = 0; p < lcp_.nonzero; ++p) largest = std::max(largest, size(p));
  for (const double tiny : kTinyForces) {
    for (Index p = 0; p < lcp_.nonzero; ++p) lcp_.f[p] = size(p) <= tiny * largest ? 0.0 : lcp_.f[p];
    Publish(result);
  }
}

void PivotBase::Refine() {
  for (Index p = 0; p < m(); ++p) lcp_.w[p] = lcp_.ScaledW(p, judge_.w()[RowAt(p)]);
  active_.CorrectForces();
  solved_at_ = -1;
  for (Index p = joints_; p < m(); ++p) lcp_.f[p] = std::max(lcp_.f[p], 0.0);
}

bool PivotBase::ClaimRay(Index d, double sign, LcpResult* result) {
  Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(active_.df(), m());
  Eigen::VectorXd correction(m());
  Eigen::VectorXd ray = Eigen::VectorXd::Zero(lcp_.n);
  GivenFormTest given(problem_->WithB(ray));  // A y alone
  GivenFormTest::Vector product(lcp_.n);
  for (int pass = 0;; ++pass) {
    const auto set = [&](Index p, double value) { ray[RowAt(p)] = sign * value * lcp_.scale[RowAt(p)]; };
    for (Index p = 0; p < m(); ++p) {
      if (p >= joints_) y[p] = std::max(y[p], 0.0);
      set(p, y[p]);
    }
    set(d, 1);
    result->farkas_ray = AcceptedRay(*problem_, ray);
    if (result->farkas_ray.has_value()) return true;
    if (pass == kRayRefinements) return false;
    given.ComputeW(ray, &product);
    for (Index p = 0; p < m(); ++p)
      correction[p] = sign * static_cast<double>(product[RowAt(p)]) * lcp_.scale[RowAt(p)];
    active_.SolveSystem(correction.data());
    y -= correction;
  }
}

}  // namespace lcpbench
