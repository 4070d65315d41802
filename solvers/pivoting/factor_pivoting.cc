// dantzig and lemke: pivoting on an updated factor of the active rows. FactorPivoting drives: joints first, a rank rule
// with restarts, warm start, refinement with the given form, rays, limits and how a solve ends. DantzigEngine and
// LemkeEngine are two rules for what enters and what leaves.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/pivoting/complementary_basis.h"
#include "solvers/pivoting/dantzig.h"
#include "solvers/pivoting/lemke.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/row_input.h"

namespace lcpbench {
namespace {

using enum LcpStatus;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Index kNoRow = -1;
// A value is rounding only up to this multiple of the sum of magnitudes that it was computed from.
constexpr double kNoise = 64 * std::numeric_limits<double>::epsilon();
// A negative component of a would-be ray below this part of |D^1/2 y| may be the error of solving for y. The ray is
// refined and put to the proof before the component may block: it would at a force of 1 / kSmallComponent and more.
constexpr double kSmallComponent = 1e-8;
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
constexpr std::int64_t kPivotsPerRow = 50;
constexpr std::int64_t kExtraPivots = 1000;
// Multiply-adds between two looks at the clock (some 10 us), and what a pivot costs besides them.
constexpr Index kWorkPerClockRead = 16384;
constexpr Index kWorkPerPivot = 256;

// Positions of the permuted problem: F = [0, m), of which [0, joints) are bilateral; rows in play with f = 0
// [m, open), of which [q, open) are violated or not yet looked at; then rows out of play (dependent bilateral rows,
// rows set aside). Only Reserve and Prepare allocate, and ClaimRay for its ray.
class FactorPivoting : public RowEngine {
 public:
  // @param rule  by which SolveArrays pivots on a tableau, without a limit of iterations; empty: it does not. A tableau
  //              has a rank rule of its own, without a choice.
  FactorPivoting(const PivotOptions& options, std::optional<TableauRule> rule)
      : RowEngine(rule.has_value() && options.rank_tolerance == PivotOptions().rank_tolerance
                      ? std::min(options.max_rows, SmallPivoting::kMaxRows)
                      : 0),
        pivot_options_(options) {
    if (rule.has_value()) tableau_.emplace(InstructionSet::kBest, *rule);
  }

  // Refuses A that is not numerically symmetric, and more than max_rows rows.
  virtual std::string WhyUnsupported(const LcpProblem& problem) const {
    if (problem.size() <= pivot_options_.max_rows) return WhyNotSymmetric(problem);
    return std::to_string(problem.size()) +
           " rows are more than max_rows = " + std::to_string(pivot_options_.max_rows) + " of this dense solver";
  }

  virtual void Reserve(Index max_rows) {
    active_.Reserve(max_rows);
    surplus_.reserve(static_cast<size_t>(max_rows));
  }

  virtual void Prepare(const LcpProblem& problem) {
    problem_ = problem;
    Reserve(problem.size());
    judge_.Reset(problem, true);
  }

  virtual void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 protected:
  // The rows in play outside F that are violated, [q, open). False if there are none.
  // @param round  of repair; 0: the first, after EnterStart
  virtual bool FindViolations(int round) = 0;
  // The rule itself: ends with no row violated but by rounding (kSolved), or by a ray or a limit.
  virtual LcpStatus MakeRight(LcpResult* result) = 0;

  // w of all rows in play outside F, with f = 0 there; those with w < 0 beyond rounding move behind the others, whose
  // w < 0 becomes 0. q is the position of the first of them, open if there is none; also where time runs out.
  void SetViolatedApart() {
    q_ = open_;
    for (Index p = m(); p < q_;) {
      if (TimeIsUp(m() + lcp_.n)) {
        q_ = open_;
        return;
      }
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
  }

  // How rows that do not belong in F leave it. All at once is cheap, but a row may have been judged beside one that was
  // itself only rounding: repairs let them go one by one, the worst first, and solve anew in between.
  enum class Leaving { kAll, kOneByOne };
  void SolveForces(Leaving leaving);
  void Release(Index p) {
    lcp_.f[p] = lcp_.w[p] = 0;
    active_.Leave(p);
  }
  // f of F and w of [m, end) move by `step` along `rate`; those of contacts stop at 0.
  void Advance(double step, const double* rate, Index end) {
    double* f = lcp_.f.data();
    double* w = lcp_.w.data();
    for (Index p = 0; p < joints_; ++p) f[p] += step * rate[p];
    for (Index p = joints_; p < m(); ++p) f[p] = std::max(f[p] + step * rate[p], 0.0);
    for (Index p = m(); p < end; ++p) w[p] = std::max(w[p] + step * rate[p], 0.0);
  }
  // Along `rate`, a row and how far it is to where its f or w is 0.
  struct Blocking {
    Index row = kNoRow;
    double step = 0;
  };
  double StepToZero(Index p, const double* rate) const { return (p < m() ? lcp_.f[p] : lcp_.w[p]) / -rate[p]; }
  // Whether df_p is up to this part of |D^1/2 y|, y = (df_F, 1) with y.D y = norm2.
  bool IsBelow(double part, Index p, double norm2) const {
    return active_.df()[p] * active_.df()[p] * lcp_.diagonal[p] <= part * part * norm2;
  }

  // Whether the residual of row d alone, of that gap, calls for a proof of infeasibility.
  bool Matters(Index d, double w) const { return lcp_.ResidualShare(d, w) > proof_tolerance_; }
  bool ClaimRay(Index d, double sign, LcpResult* result);

  bool TimeIsUp(Index work) {
    if (!deadline_.has_value() || out_of_time_) return out_of_time_;
    work_left_ -= work + kWorkPerPivot;
    if (work_left_ >= 0) return false;
    work_left_ = kWorkPerClockRead;
    return out_of_time_ = deadline_->Expired();
  }
  // Counts a pivot of that work, or says which limit forbids it.
  LcpStatus BeginPivot(Index work) {
    if (pivots_ >= pivot_limit_) return kIterationLimit;
    if (TimeIsUp(work)) return kTimeLimit;
    ++pivots_;
    return kSolved;
  }

  Index m() const { return active_.size(); }
  // Forces f_p and gaps w_p of different rows compare as f_p ForceRoot(p) and w_p / GapRoot(p): sqrt(A_pp) in units of
  // one row's, because sqrt(A_pp) itself is rounded differently when A is multiplied by 2.
  double ForceRoot(Index p) const { return std::sqrt(lcp_.diagonal[p] / unit_); }
  double GapRoot(Index p) const { return ForceRoot(p) * unit_; }
  Index RowAt(Index p) const { return lcp_.row[static_cast<size_t>(p)]; }

  double rank_tolerance_ = 0;
  ComplementaryBasis active_;
  PermutedLcp& lcp_ = active_.lcp;
  Index joints_ = 0;
  Index q_ = 0;
  Index open_ = 0;

 private:
  bool SolveRows(const RowTask& task, LcpResult* result) override;
  PermutedLcp::Loaded Load();
  LcpStatus Attempt(LcpResult* result);
  LcpStatus EnterStart(LcpResult* result);
  LcpStatus EnterJoints(LcpResult* result);
  LcpStatus EnterBlocks(double least_pivot);
  void LeaveOutStrongest(Index p);
  bool IsSurplus(Index p) const;
  void ReleaseAll();
  bool Publish();
  void Refine();
  void DropTinyForces();

  void GiveForces(Eigen::VectorXd* f) const {
    f->setZero();
    for (Index p = 0; p < lcp_.nonzero; ++p) (*f)[RowAt(p)] = lcp_.GivenForce(p);
  }
  const Deadline* deadline() const { return deadline_.has_value() ? &*deadline_ : nullptr; }

  const PivotOptions pivot_options_;
  std::optional<SmallPivoting> tableau_;
  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  AnswerJudge judge_;

  // One call.
  double tolerance_ = 0;
  double proof_tolerance_ = 0;  // residuals up to this are not worth a proof of infeasibility
  std::optional<Deadline> deadline_;
  bool out_of_time_ = false;
  Index work_left_ = 0;
  std::int64_t pivots_ = 0;
  std::int64_t pivot_limit_ = 0;

  // One attempt.
  PermutedLcp::Guess guess_;
  bool blocks_ = false;
  double unit_ = 1;              // A_pp of the row that came first
  std::int64_t solved_at_ = -1;  // pivots_ when SolveForces left F and f as they are; -1: not so
  double largest_ = 0;           // A_ii f_i^2 then
  std::vector<Index> surplus_;   // positions, descending
};

bool FactorPivoting::SolveRows(const RowTask& task, LcpResult* result) {
  tableau_->ReserveRows(task.rows.rows, task.rows.bodies);
  SmallPivoting::Request request;
  request.deadline = task.deadline;
  double rho = 0;
  const SmallPivoting::End end = tableau_->SolveRows(task.rows, task.all, task.options.tolerance, request, &task.judge,
                                                     result->f.data(), task.w, &rho);
  if (end != SmallPivoting::End::kSolved) return false;
  result->status = kSolved;
  result->iterations = tableau_->pivots();
  return true;
}

PermutedLcp::Loaded FactorPivoting::Load() {
  const PermutedLcp::Loaded loaded = lcp_.Load(*problem_, guess_, deadline());
  if (loaded != PermutedLcp::Loaded::kDone) return loaded;
  active_.Reset();
  solved_at_ = -1;
  joints_ = 0;
  open_ = lcp_.nonzero;
  unit_ = lcp_.nonzero > 0 ? lcp_.diagonal[0] : 1.0;
  return loaded;
}

// Runs the rule with the rank tolerance, then, where that met neither the tolerance nor a proof, with a finer and a
// coarser one, from nothing active and without blocks. `problem` shares its matrix with the prepared one.
void FactorPivoting::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  problem_ = problem;
  judge_.Start(problem, options.tolerance, result);
  tolerance_ = options.tolerance;
  proof_tolerance_ = std::min(tolerance_, kProofTolerance);
  deadline_.reset();
  if (Deadline::IsNeeded(options)) deadline_.emplace(options);
  out_of_time_ = false;
  work_left_ = 0;
  pivots_ = 0;
  pivot_limit_ = options.max_iterations > 0 ? options.max_iterations : kPivotsPerRow * problem.size() + kExtraPivots;
  LcpStatus end = kNumericalFailure;
  char text[160];
  for (const double factor : kAttempts) {
    rank_tolerance_ = pivot_options_.rank_tolerance * factor;
    const bool first = factor == kAttempts[0];
    blocks_ = first && (pivot_options_.block_start || options.initial_f != nullptr);
    guess_ = {first ? options.initial_f : nullptr, blocks_};
    const PermutedLcp::Loaded loaded = Load();
    if (loaded == PermutedLcp::Loaded::kNegativeDiagonal) {
      result->status = kUnsupported;
      result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
      return;
    }
    end = loaded == PermutedLcp::Loaded::kDone ? Attempt(result) : kTimeLimit;
    if (!first && end == kSolved) {
      std::snprintf(text, sizeof text, "solved after a restart with rank tolerance %.0e", rank_tolerance_);
      result->detail = text;
    }
    if (end != kNumericalFailure) break;
  }
  result->iterations = pivots_;
  result->status = end;
  if (end == kSolved) result->farkas_ray.reset();
  if (end != kNumericalFailure) return;
  std::snprintf(text, sizeof text,
                "residual %.1e above the tolerance for rank tolerances %.0e, %.0e and %.0e, and no proven ray",
                judge_.tier(), pivot_options_.rank_tolerance, pivot_options_.rank_tolerance * kAttempts[1],
                pivot_options_.rank_tolerance * kAttempts[2]);
  result->detail = text;
}

// An answer that meets the tolerance counts whatever ended the search for it; f of a search that came to no end is
// judged unless time is up, and stands then if nothing was published before.
LcpStatus FactorPivoting::Attempt(LcpResult* result) {
  result->farkas_ray = FindZeroRowRay(*problem_, proof_tolerance_ * lcp_.b_norm);
  if (result->farkas_ray.has_value()) return kInfeasible;
  LcpStatus end = EnterStart(result);
  for (int round = 0; end == kSolved && round < kMaxRounds; ++round) {
    if (!FindViolations(round) && round > 0 && !out_of_time_) break;
    end = out_of_time_ ? kTimeLimit : MakeRight(result);
    if (end != kSolved) break;
    SolveForces(round == 0 ? Leaving::kAll : Leaving::kOneByOne);
    const double tier_before = judge_.tier();
    if (Publish() || (round > 0 && !(judge_.tier() < tier_before))) break;
    Refine();
    if (Publish()) break;
    SolveForces(Leaving::kOneByOne);
  }
  if (end == kTimeLimit) {
    if (!std::isfinite(judge_.tier())) GiveForces(&result->f);
  } else if (end != kSolved) {
    Publish();
  }
  if (end == kSolved && judge_.tier() > tolerance_) DropTinyForces();
  if (judge_.tier() <= (end == kInfeasible ? proof_tolerance_ : tolerance_)) return kSolved;
  return end == kSolved ? kNumericalFailure : end;
}

// A start for the rule: f_F >= 0 on unilateral rows.
//
// Bilateral rows enter and stay, and unilateral rows with initial_f_i > 0 (PermutedLcp::kGuessThreshold), without
// initial_f those with b_i < 0 if there is a block start, enter where clearly independent; all in one factorization
// unless bilateral rows may be dependent. Then unilateral rows with f < 0 leave until there is none. With a block start
// all rows with w < 0 enter next, where clearly independent, and so on while their number falls.
//
// Each such block is one pivot; the first one is free.
LcpStatus FactorPivoting::EnterStart(LcpResult* result) {
  const double least_pivot = kGuessedPivot * rank_tolerance_;
  const Index rows = lcp_.bilateral + lcp_.guessed;
  if (rows > 0) {
    if (TimeIsUp(rows * rows) || !active_.Factor(rows, least_pivot, deadline())) return kTimeLimit;
    joints_ = lcp_.bilateral;
    // Joints stay, so the rank rule itself decides where there is any doubt.
    const double doubtful = std::sqrt(rank_tolerance_);
    bool clear = active_.first_left_out(rows) >= joints_;
    for (Index p = 0; p < joints_ && clear; ++p) clear = active_.pivot(p) > doubtful * lcp_.diagonal[p];
    if (!clear) {
      if (Load() != PermutedLcp::Loaded::kDone) return kTimeLimit;  // the order as it was
      if (const LcpStatus end = EnterJoints(result); end != kSolved) return end;
    }
    SolveForces(Leaving::kAll);
    if (out_of_time_) return kTimeLimit;
  }
  q_ = m();
  return blocks_ ? EnterBlocks(least_pivot) : kSolved;
}

// A dependent joint has w = y.b for every f: it is right and out of play, or proved impossible (kInfeasible).
LcpStatus FactorPivoting::EnterJoints(LcpResult* result) {
  Index end = lcp_.bilateral;
  while (m() < end) {
    if (TimeIsUp(m() * m())) return kTimeLimit;
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
    if (std::abs(w.value) <= kNoise * w.magnitude || lcp_.ResidualShare(p, w.value) <= negligible) continue;
    if (TimeIsUp(m() * m())) return kTimeLimit;
    active_.SetDriven(p);
    active_.Direction(p);
    if (Matters(p, w.value) && ClaimRay(p, w.value < 0 ? 1 : -1, result)) return kInfeasible;
    LeaveOutStrongest(p);
  }
  for (Index p = lcp_.bilateral; p > m();) lcp_.Swap(--p, --open_);
  return kSolved;
}

// A y = 0 for y = (df_F, 1) but for rounding, so y.w = y.b whatever f is: where that is not quite 0, the gap of the one
// row left out is y.b over its own part of y. The row of the largest D^1/2 |y| takes the place of the driven row p.
void FactorPivoting::LeaveOutStrongest(Index p) {
  Index strongest = kNoRow;
  double largest = ForceRoot(p);
  for (Index k = 0; k < m(); ++k) {
    const double size = std::abs(active_.df()[k]) * ForceRoot(k);
    if (size <= largest) continue;
    largest = size;
    strongest = k;
  }
  if (strongest == kNoRow) return;
  Release(strongest);  // to m, the first position outside F
  if (const double pivot = active_.SetDriven(p); pivot > 0) active_.EnterDriven(p, pivot);
  joints_ = m();
  active_.SolveForces();
}

LcpStatus FactorPivoting::EnterBlocks(double least_pivot) {
  for (Index most = open_;;) {
    SetViolatedApart();
    if (out_of_time_) return kTimeLimit;
    const Index count = open_ - q_;
    if (count <= kFewViolated || count > most) return kSolved;
    most = static_cast<Index>(kBlockProgress * static_cast<double>(count));
    if (const LcpStatus end = BeginPivot(m() * (m() + open_)); end != kSolved) return end;
    for (Index k = 0; k < count && m() + k < q_; ++k) {
      if (TimeIsUp(lcp_.n)) return kTimeLimit;
      lcp_.Swap(m() + k, open_ - 1 - k);
    }
    if (!active_.Factor(m() + count, least_pivot, deadline())) return kTimeLimit;
    SolveForces(Leaving::kAll);
    if (out_of_time_) return kTimeLimit;
  }
}

// Whether a unilateral row of F has no business there: f < 0, or f > 0 by rounding only.
bool FactorPivoting::IsSurplus(Index p) const {
  const double f = lcp_.f[p];
  if (f < 0) return true;
  if (lcp_.diagonal[p] * f * f > kSmallForce * kSmallForce * largest_) return false;
  return lcp_.diagonal[p] * f <= kNoise * lcp_.FreshW(p, m()).magnitude;
}

// f_F = -A_FF^-1 b_F, unless F has not changed since; surplus rows leave until there is none. Where time runs out F is
// empty.
void FactorPivoting::SolveForces(Leaving leaving) {
  for (;;) {
    if (solved_at_ != pivots_) largest_ = active_.SolveForces();
    solved_at_ = pivots_;
    surplus_.clear();
    double least = kInfinity;
    for (Index p = m() - 1; p >= joints_; --p) {
      if (!IsSurplus(p)) continue;
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
void FactorPivoting::ReleaseAll() {
  solved_at_ = -1;
  if (std::ssize(surplus_) <= kFewUpdates + m() / kRowsPerUpdate) {
    for (const Index p : surplus_) Release(p);
    return;
  }
  Index rest = m();
  for (const Index p : surplus_) {
    lcp_.f[p] = lcp_.w[p] = 0;
    lcp_.Swap(p, --rest);
  }
  if (active_.Factor(rest, 0.0, deadline())) return;
  out_of_time_ = true;
  lcp_.f.head(lcp_.nonzero).setZero();
}

// Judges f; true if it is good enough to stop.
bool FactorPivoting::Publish() {
  GiveForces(&judge_.candidate());
  return judge_.Publish();
}

// Forces that are rounding beside the largest may be all that a row has whose forces and b should be 0; its backward
// error is rounding over rounding then.
void FactorPivoting::DropTinyForces() {
  const auto size = [this](Index p) { return std::abs(lcp_.f[p]) * ForceRoot(p); };
  double largest = 0;
  for (Index p = 0; p < lcp_.nonzero; ++p) largest = std::max(largest, size(p));
  for (const double tiny : kTinyForces) {
    for (Index p = 0; p < lcp_.nonzero; ++p) lcp_.f[p] = size(p) <= tiny * largest ? 0.0 : lcp_.f[p];
    Publish();
  }
}

// One step of iterative refinement with the residual of the given form at the published f.
void FactorPivoting::Refine() {
  for (Index p = 0; p < m(); ++p) lcp_.w[p] = lcp_.ScaledW(p, judge_.w()[RowAt(p)]);
  active_.CorrectForces();
  solved_at_ = -1;
  for (Index p = joints_; p < m(); ++p) lcp_.f[p] = std::max(lcp_.f[p], 0.0);
}

// y = sign (df_F, 1 at d) as a Farkas ray, refined with extended-precision residuals until VerifyFarkasRay accepts it,
// at most a few times.
bool FactorPivoting::ClaimRay(Index d, double sign, LcpResult* result) {
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
    if (result->farkas_ray.has_value() || pass == kRayRefinements) return result->farkas_ray.has_value();
    given.ComputeW(ray, &product);
    for (Index p = 0; p < m(); ++p) {
      correction[p] = sign * static_cast<double>(product[RowAt(p)]) * lcp_.scale[RowAt(p)];
    }
    active_.SolveSystem(correction.data());
    y -= correction;
  }
}

// For dantzig.

// A step that raises w_d by less than this part of |w_d| is degenerate.
constexpr double kDegenerateStep = 1e-12;
// Degenerate steps in a row before ties go to the least index. Until then they go to the largest pivot, for stability.
constexpr int kDegenerateLimit = 20;

// For lemke.

// First-order terms of tied rows are equal within this part of the largest: then the next column decides.
constexpr double kEqualOrder = 1e-10;

// In [1, 2), generic but fixed: a Weyl sequence on the golden ratio.
double Generic(Index i) {
  constexpr double kGolden = 0.6180339887498949;
  const double x = static_cast<double>(i + 1) * kGolden;
  return 1 + (x - std::floor(x));
}

}  // namespace

void PivotOptions::ReadShared(SettingsReader* reader) {
  rank_tolerance = reader->Number("rank_tolerance", rank_tolerance, std::numeric_limits<double>::epsilon(), 1e-3);
  block_start = reader->YesOrNo("block_start", block_start);
  max_rows = static_cast<Index>(reader->Number("max_rows", static_cast<double>(max_rows), 1, 1e5));
}

// Positions: watched rows [m, q) with w >= 0; the driven row q and the waiting rows behind it. Rates of w along the
// direction of F stand behind df.
class DantzigEngine final : public FactorPivoting {
 public:
  explicit DantzigEngine(const DantzigOptions& options)
      : FactorPivoting(options,
                       options.order == DantzigOrder::kIndex ? std::optional(TableauRule::kDriven) : std::nullopt),
        order_(options.order) {}

 private:
  // At first all rows wait that no block has looked at.
  bool FindViolations(int round) override {
    if (round > 0 || (q_ == m() && order_ == DantzigOrder::kMostNegative)) SetViolatedApart();
    return q_ < open_;
  }

  LcpStatus MakeRight(LcpResult* result) override {
    while (q_ < open_) {
      if (order_ == DantzigOrder::kMostNegative) {
        const auto size = [this](Index p) { return lcp_.w[p] * std::abs(lcp_.w[p]) / lcp_.diagonal[p]; };
        Index worst = q_;
        for (Index p = q_ + 1; p < open_; ++p) {
          if (size(p) < size(worst)) worst = p;
        }
        lcp_.Swap(worst, q_);
      }
      const PermutedLcp::Sum w = lcp_.FreshW(q_, m());
      lcp_.w[q_] = w.value;
      if (w.value >= -kNoise * w.magnitude) {
        lcp_.w[q_] = std::max(w.value, 0.0);
        ++q_;
      } else if (const LcpStatus end = Drive(result); end != kSolved) {
        return end;
      }
    }
    return kSolved;
  }

  LcpStatus Drive(LcpResult* result);
  void Retreat(double norm2);
  void SetAside();
  double NoiseAlongDirection() const;
  Blocking FindBlocking(double s, double norm2, bool singular, bool least_index) const;
  Index rates_end() const { return order_ == DantzigOrder::kIndex ? q_ : open_; }

  const DantzigOrder order_;
};

// Raises f_q until w_q = 0, or sets row q aside: it can be neither made right nor proved impossible.
LcpStatus DantzigEngine::Drive(LcpResult* result) {
  double* const rate = active_.df();
  int degenerate = 0;
  double s = active_.SetDriven(q_);
  for (;;) {
    if (const LcpStatus end = BeginPivot(m() * rates_end()); end != kSolved) return end;
    const double norm2 = active_.Direction(q_);
    const bool singular = !(s > rank_tolerance_ * norm2);
    if (singular) {
      if (lcp_.w[q_] >= -NoiseAlongDirection()) {
        Retreat(norm2);
        return kSolved;
      }
    } else {
      std::copy(lcp_.column(q_) + m(), lcp_.column(q_) + rates_end(), rate + m());
      lcp_.AddColumns(m(), rates_end(), m(), rate, rate);
    }
    Blocking blocking;
    double s_blocking = 0;
    for (;;) {
      blocking = FindBlocking(s, norm2, singular, degenerate >= kDegenerateLimit);
      if (blocking.row < m()) break;
      s_blocking = active_.PivotOf(blocking.row);
      if (s_blocking > rank_tolerance_ * lcp_.diagonal[blocking.row]) break;
      rate[blocking.row] = 0;  // depends on F, so only rounding moves its w
    }
    if (singular && (blocking.row == kNoRow || IsBelow(kSmallComponent, blocking.row, norm2))) {
      if (Matters(q_, lcp_.w[q_]) && ClaimRay(q_, 1, result)) return kInfeasible;
      if (blocking.row == kNoRow) {
        SetAside();
        return kSolved;
      }
    }
    const bool still = singular || blocking.step * s <= -kDegenerateStep * lcp_.w[q_];
    degenerate = still ? degenerate + 1 : 0;
    Advance(blocking.step, rate, singular ? m() : q_);
    lcp_.f[q_] += blocking.step;
    if (!singular) {
      for (Index p = q_ + 1; p < rates_end(); ++p) lcp_.w[p] += blocking.step * rate[p];
      lcp_.w[q_] += blocking.step * s;
    }
    if (blocking.row == kNoRow) {
      lcp_.w[q_] = 0;
      active_.EnterDriven(q_++, s);
      return kSolved;
    }
    lcp_.f[blocking.row] = lcp_.w[blocking.row] = 0;
    if (blocking.row < m()) {
      active_.Leave(blocking.row);
      s = active_.SetDriven(q_);
    } else {
      s = active_.Enter(blocking.row, s_blocking, q_);
    }
  }
}

// The first row to reach zero along the direction, before w_q does.
FactorPivoting::Blocking DantzigEngine::FindBlocking(double s, double norm2, bool singular, bool least_index) const {
  const double* rate = active_.df();
  const double full = singular ? kInfinity : -lcp_.w[q_] / s;
  const double still = singular ? 0 : kDegenerateStep * full;
  const double rounding = kNoise * kNoise * norm2;  // squared size of components of y that are rounding
  Blocking blocking{kNoRow, full * (1 - kNoise)};   // a tie with the full step needs no pivot
  double strength = 0;
  for (Index p = joints_; p < (singular ? m() : q_); ++p) {
    if (rate[p] >= 0) continue;
    const double size = p < m() ? rate[p] * rate[p] * lcp_.diagonal[p] : rate[p] * rate[p] / lcp_.diagonal[p];
    if (!(size > rounding)) continue;
    double step = StepToZero(p, rate);
    if (least_index && step <= still) step = 0;
    if (step > blocking.step) continue;
    const double candidate = size / (p < m() ? norm2 : s);
    const bool tied = step == blocking.step && blocking.row != kNoRow;
    if (tied && !(least_index ? RowAt(p) < RowAt(blocking.row) : candidate > strength)) continue;
    blocking = {p, step};
    strength = candidate;
  }
  if (blocking.row == kNoRow) blocking.step = full;
  return blocking;
}

// w_q = 0 but for rounding while row q depends on F through A (df_F, 1) = 0: goes back along that direction, which
// changes no w, until row q or a row of F that it can replace has f = 0.
void DantzigEngine::Retreat(double norm2) {
  const double* df = active_.df();
  Index leaving = q_;
  double step = lcp_.f[q_];
  for (Index p = joints_; p < m(); ++p) {
    if (df[p] <= 0 || lcp_.f[p] >= step * df[p] || IsBelow(kNoise, p, norm2)) continue;
    step = lcp_.f[p] / df[p];
    leaving = p;
  }
  Advance(-step, df, m());
  lcp_.f[q_] -= step;
  lcp_.w[q_] = 0;
  lcp_.f[leaving] = 0;
  if (leaving != q_) {
    Release(leaving);
    const double pivot = active_.SetDriven(q_);
    if (pivot > 0) {
      active_.EnterDriven(q_, pivot);
    } else {
      lcp_.f[q_] = 0;
    }
  }
  ++q_;
}

void DantzigEngine::SetAside() {
  const bool moved = lcp_.f[q_] != 0;
  lcp_.f[q_] = 0;
  lcp_.Swap(q_, --open_);
  if (!moved) return;
  SolveForces(Leaving::kAll);
  SetViolatedApart();
}

// A y = 0 for y = (df_F, 1), so w_q = y.w = y.b but for the rounding of every row of F, each weighted by its |y_i|.
double DantzigEngine::NoiseAlongDirection() const {
  const double* df = active_.df();
  const double own = std::abs(lcp_.f[q_]);
  const double* c = lcp_.column(q_);
  double sum = lcp_.FreshW(q_, m()).magnitude + lcp_.diagonal[q_] * own;
  for (Index p = 0; p < m(); ++p) {
    if (df[p] != 0) sum += std::abs(df[p]) * (lcp_.FreshW(p, m()).magnitude + std::abs(c[p]) * own);
  }
  return kNoise * sum;
}

void DantzigOptions::Read(SettingsReader* reader) {
  ReadShared(reader);
  const bool is_index = reader->Choice("order", "index", {"index", "most-negative"}) == "index";
  order = is_index ? DantzigOrder::kIndex : DantzigOrder::kMostNegative;
}

template class EngineSolver<DantzigOptions, DantzigEngine>;

// Problems that are not plain are left to options.make_other's solver.
class LemkeEngine final : public FactorPivoting {
 public:
  explicit LemkeEngine(const LemkeOptions& options)
      : FactorPivoting(options, TableauRule::kAlongPath), other_(options.make_other ? options.make_other() : nullptr) {}

  bool takes_other_laws() const { return other_ != nullptr; }
  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return IsOther(problem) ? other_->WhyUnsupported(problem) : FactorPivoting::WhyUnsupported(problem);
  }
  void Reserve(Index max_rows) override {
    if (max_rows <= rate_.size()) return;
    FactorPivoting::Reserve(max_rows);
    for (Eigen::VectorXd* v : {&cover_, &perturbation_, &rate_, &first_order_}) v->setZero(max_rows);
    ties_.reserve(static_cast<size_t>(max_rows));
  }
  void Prepare(const LcpProblem& problem) override {
    IsOther(problem) ? other_->Prepare(problem) : FactorPivoting::Prepare(problem);
  }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    IsOther(problem) ? other_->Solve(problem, options, result) : FactorPivoting::Solve(problem, options, result);
  }

 private:
  bool IsOther(const LcpProblem& problem) const { return other_ != nullptr && !problem.is_plain(); }

  bool FindViolations(int round) override {
    if (round == 0) in_play_ = open_;
    open_ = in_play_;
    SetViolatedApart();
    violation_ = 0;
    for (Index p = q_; p < open_; ++p) violation_ = std::max(violation_, -lcp_.w[p] / GapRoot(p));
    return violation_ > 0;
  }

  LcpStatus MakeRight(LcpResult* result) override;
  void StartPath();
  double ComputeRates();
  LcpStatus EnterOrExchange(Index p, LcpResult* result);
  // The row in [joints, end) whose f or w reaches 0 first by `rate`, kNoRow if none does before `limit`. `event` as for
  // BreakTie.
  Blocking FirstToReachZero(const double* rate, Index end, double limit, Index event, const auto& skip);
  Index BreakTie(const double* rate, Index event);
  void ComputePerturbation(Index k);
  bool IsRounding(Index p, double size) const;
  // f_p or w_p below this is 0 but for rounding.
  double Noise(Index p) const {
    return kNoise * (p < m() ? largest_force_ / ForceRoot(p) : largest_force_ * GapRoot(p));
  }

  const std::unique_ptr<LcpSolver> other_;
  double violation_ = 0;  // the largest -w_i / sqrt(A_ii) at the start of a path
  Index in_play_ = 0;     // open_ at the start of every path
  double z_ = 0;
  double largest_force_ = 0;      // D^1/2 f, over the path so far
  Eigen::VectorXd cover_;         // d, by row of the problem
  Eigen::VectorXd perturbation_;  // g, by row of the problem
  Eigen::VectorXd rate_;          // by position, per unit of falling z: of f in F, of w outside
  Eigen::VectorXd first_order_;   // by position: what one column of the perturbation does to f in F and w outside
  std::vector<Index> ties_;       // positions
};

// From z = 1 to z = 0.
LcpStatus LemkeEngine::MakeRight(LcpResult* result) {
  if (violation_ == 0) return kSolved;
  StartPath();
  while (z_ > 0) {
    if (const LcpStatus end = BeginPivot(m() * (m() + open_)); end != kSolved) return end;
    const double size = ComputeRates();
    const auto is_rounding = [&](Index j) { return IsRounding(j, size); };
    auto [p, step] = FirstToReachZero(rate_.data(), open_, z_, kNoRow, is_rounding);
    step = std::max(step, 0.0);
    Advance(step, rate_.data(), open_);
    for (Index j = 0; j < m(); ++j) largest_force_ = std::max(largest_force_, std::abs(lcp_.f[j]) * ForceRoot(j));
    if (p == kNoRow) break;
    z_ -= step;
    if (p < m()) {
      Release(p);
      continue;
    }
    lcp_.w[p] = 0;
    if (const LcpStatus end = EnterOrExchange(p, result); end != kSolved) return end;
  }
  return kSolved;
}

// The point at z = 1: d outside F, and g = h_w - A h_f for h_w, h_f > 0, so that it has f_F + e h_f, w + e h_w > 0.
void LemkeEngine::StartPath() {
  z_ = 1;
  largest_force_ = violation_;
  cover_.head(lcp_.n).setZero();
  for (Index p = 0; p < m(); ++p) rate_[p] = p < joints_ ? 0 : -Generic(RowAt(p)) / ForceRoot(p);
  first_order_.head(open_).setZero();
  lcp_.AddColumns(0, open_, m(), rate_.data(), first_order_.data());
  for (Index p = 0; p < open_; ++p) {
    perturbation_[RowAt(p)] = first_order_[p] + (p < m() ? 0.0 : Generic(RowAt(p)) * GapRoot(p));
    if (p < m()) continue;
    cover_[RowAt(p)] = violation_ * GapRoot(p);
    lcp_.w[p] = std::max(lcp_.w[p] + cover_[RowAt(p)], 0.0);
  }
}

// Returns s + |D^1/2 f_F'|_1, which times D^1/2 bounds the terms that w_p' is the sum of.
double LemkeEngine::ComputeRates() {
  double size = 0;
  for (Index p = 0; p < m(); ++p) rate_[p] = cover_[RowAt(p)];
  active_.SolveSystem(rate_.data());
  for (Index p = 0; p < m(); ++p) size += std::abs(rate_[p]) * ForceRoot(p);
  double largest_cover = 0;
  for (Index p = m(); p < open_; ++p) {
    rate_[p] = -cover_[RowAt(p)];
    largest_cover = std::max(largest_cover, -rate_[p] / GapRoot(p));
  }
  lcp_.AddColumns(m(), open_, m(), rate_.data(), rate_.data());
  return size + largest_cover;
}

// Whether the rate of row p is, with `size` as ComputeRates has found it.
bool LemkeEngine::IsRounding(Index p, double size) const {
  const double rate = std::abs(rate_[p]);
  if (p < m()) return rate * ForceRoot(p) <= kNoise * size;
  if (rate > kNoise * size * GapRoot(p)) return false;
  const double* a = lcp_.column(p);
  double magnitude = cover_[RowAt(p)];
  for (Index j = 0; j < m(); ++j) magnitude += std::abs(a[j] * rate_[j]);
  return rate <= kNoise * magnitude;
}

FactorPivoting::Blocking LemkeEngine::FirstToReachZero(const double* rate, Index end, double limit, Index event,
                                                       const auto& skip) {
  double bound = limit;
  ties_.clear();
  for (Index p = joints_; p < end; ++p) {
    if (rate[p] >= 0 || skip(p) || StepToZero(p, rate) > bound) continue;
    bound = std::min(bound, StepToZero(p, rate) + Noise(p) / -rate[p]);
    ties_.push_back(p);
  }
  if (bound >= limit) return {kNoRow, limit};
  std::erase_if(ties_, [&](Index p) { return StepToZero(p, rate) > bound; });
  const Index p = BreakTie(rate, event);
  return {p, StepToZero(p, rate)};
}

// The row of those in ties_, which reach 0 together, that reaches it first in the perturbed problem. `event` < 0:
// they move by rate_. Otherwise by `rate` along the direction of an exchange, at the z of the event.
Index LemkeEngine::BreakTie(const double* rate, Index event) {
  for (Index k = 0; k <= lcp_.n && ties_.size() > 1; ++k) {
    ComputePerturbation(k);
    const double lag = event < 0 ? 0.0 : first_order_[event] / -rate_[event];
    const auto order = [&](Index p) { return (first_order_[p] + (event < 0 ? 0.0 : lag * rate_[p])) / -rate[p]; };
    double least = kInfinity;
    double largest = 0;
    for (const Index p : ties_) {
      least = std::min(least, order(p));
      largest = std::max(largest, std::abs(order(p)));
    }
    std::erase_if(ties_, [&](Index p) { return order(p) > least + kEqualOrder * largest; });
  }
  return ties_.front();
}

// What column k of the perturbation (0: g, k: the unit vector of row k - 1) does to f_F and w, by position.
void LemkeEngine::ComputePerturbation(Index k) {
  for (Index p = 0; p < open_; ++p) {
    const double term = k == 0 ? perturbation_[RowAt(p)] : static_cast<double>(RowAt(p) == k - 1);
    first_order_[p] = p < m() ? -term : term;
  }
  active_.SolveSystem(first_order_.data());
  lcp_.AddColumns(m(), open_, m(), first_order_.data(), first_order_.data());
}

// Row p, outside F with w_p = 0, enters F, or takes the place of a row that it depends on.
LcpStatus LemkeEngine::EnterOrExchange(Index p, LcpResult* result) {
  for (Index event = p;; event = kNoRow) {  // more than once only where rounding spoils the pivot of an exchange
    const double pivot = active_.SetDriven(p);
    const double norm2 = active_.Direction(p);
    if (pivot > rank_tolerance_ * norm2) {
      active_.EnterDriven(p, pivot);
      return kSolved;
    }
    const auto is_rounding = [&](Index j) { return IsBelow(kNoise, j, norm2); };
    const auto [leaving, step] = FirstToReachZero(active_.df(), m(), kInfinity, event, is_rounding);
    bool set_aside = leaving == kNoRow;
    if (set_aside || IsBelow(kSmallComponent, leaving, norm2)) {
      // y.w = y.b + z y.d is 0 here, so y.b = -z y.d. Where that is next to nothing, so would be the use of a long step
      // that ends at a component which may be rounding.
      const bool matters = event != kNoRow && Matters(p, z_ * rate_[p]);
      if (matters && ClaimRay(p, 1, result)) return kInfeasible;
      set_aside = set_aside || !matters;
    }
    if (set_aside) {
      lcp_.f[p] = 0;
      lcp_.Swap(p, --open_);  // the final check decides
      return kSolved;
    }
    if (const LcpStatus end = BeginPivot(m()); end != kSolved) return end;
    Advance(step, active_.df(), m());
    lcp_.f[p] += step;
    Release(leaving);  // which moves rows of F and the first one outside only, not p
  }
}

template class EngineSolver<LemkeOptions, LemkeEngine>;

}  // namespace lcpbench
