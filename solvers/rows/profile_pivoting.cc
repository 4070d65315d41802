#include "solvers/rows/profile_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/lcp/law.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/linear_algebra/vector_register.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// Iterations before the first factor, at least, and rounds of pivoting that may pass without fewer violations.
constexpr Index kFirstIterations = 2;
constexpr int kPatience = 1;
// One row in so many counts as few violations, which pivoting ends mostly.
constexpr Index kRowsPerFew = 16;
constexpr int kMostRounds = 12;
// Processor cycles that an iteration takes per row, roughly.
constexpr double kCostOfRow = 110;
// Iterations of SweepOn.
constexpr int kMoreIterations = 4;
// The clock is read once in so many iterations, and before every factorization.
constexpr int kIterationsWithoutClock = 16;
// Alternations of sweeps and pivoting.
constexpr int kMostPhases = 5;
// Refinements of a basic point; and violations, in |D^-1/2 b|, that pivoting for exactness lets pass.
constexpr int kMostRefinements = 4;
constexpr int kPatienceOfPolish = 3;
constexpr double kRoundingOfGaps = 1e-13;
// Violations below this part of the tolerance, spread over all rows, are none.
constexpr double kPartOfTolerance = 0.1;

// The relaxation of BandPivoting's two sweeps, which guess the active set. With 1 obstacle problems of some hundred
// rows take 10 % more time.
constexpr double kRelaxation = 1.5;
// Violations below this part of the sum of absolute values that they are the difference of are rounding.
constexpr double kNoise = 3e-14;
constexpr int kPatienceOfBand = 3;
constexpr int kMostRoundsOfBand = 24;

}  // namespace

void ProfilePivoting::Reserve(Index max_rows, Index max_bodies) {
  order_.Reserve(max_rows, max_bodies);
  factor_.Reserve(max_rows);
  const Index n = max_rows + kRegister;
  if (x_.f.size() >= n) return;
  const Index most_image = ScaledRows::MostImage(2 * max_rows);
  scaled_.Reserve(max_rows);
  form_.Reserve(max_rows, 2 * max_rows);
  in_plane_ = MakeTwoBodyRows(scaled_, 3, false, &form_, instructions_);
  in_space_ = MakeTwoBodyRows(scaled_, 6, false, &form_, instructions_);
  sweeps_.Reserve(n, most_image);
  central_path_.Reserve(max_rows);
  is_active_.resize(At(max_rows));
  for (Point* point : {&x_, &basic_}) {
    point->f.resize(n);
    point->image.resize(most_image);
  }
  for (auto* v : {&gaps_, &correction_}) v->resize(n);
}

// False if a row acts on no body that can move, or A_ii is 0 in double.
bool ProfilePivoting::Load(const StepRows& all, std::span<const std::int32_t> part) {
  rows_ = nullptr;
  if (!order_.Find(all, part, &scaled_.order)) return false;
  scaled_.Take(all);
  if (!form_.Take(all, order_.bodies(), order_.number(), &scaled_)) return false;
  scaled_.SetB(all.b);
  RowKernel* const rows = all.columns_per_body == 3 ? in_plane_.get() : in_space_.get();
  rows->SetB();
  rows_ = rows;
  n_ = scaled_.size;
  return true;
}

// Returns the residual |min(x, w)| as the second sweep met it.
double ProfilePivoting::SweepBothWays() {
  ++iterations_;
  StepSums forward;
  StepSums backward;
  sweeps_.BeginIteration(x_);
  rows_->Sweep(0, n_, false, 1, &x_, &forward);
  rows_->Sweep(0, n_, true, 1, &x_, &backward);
  sweeps_.EndIteration(forward.energy + backward.energy, backward.residual, &x_);
  return std::sqrt(backward.residual);
}

// |min(x, w)| of x_, with its image made anew.
double ProfilePivoting::Residual() {
  rows_->MakeImage(n_, &x_);
  return std::sqrt(rows_->ResidualSquares(0, n_, x_, nullptr));
}

// basic_ := the basic point of the active rows, by proximal steps from x_ on them [Rockafellar 1976]: w of active rows
// is to vanish. gaps_ becomes its w.
void ProfilePivoting::FindBasicPoint() {
  ++iterations_;
  factor_.Factorize(is_active_.data(), ProfileFactor::kShift, nullptr);
  for (Index i = 0; i < n_; ++i) basic_.f[i] = is_active_[At(i)] != 0 ? x_.f[i] : 0;
  for (int step = 0;; ++step) {
    rows_->MakeImage(n_, &basic_);
    rows_->ResidualSquares(0, n_, basic_, &gaps_);
    for (Index i = 0; i < n_; ++i) correction_[i] = is_active_[At(i)] != 0 ? -gaps_[i] : 0.0;
    const double left = correction_.head(n_).cwiseAbs().maxCoeff();
    if ((step > 0 && left <= violation_) || step == kMostRefinements) return;
    factor_.Solve(correction_.data());
    basic_.f.head(n_) += correction_.head(n_);
  }
}

// Rows whose sign is wrong change sides. Returns how many.
Index ProfilePivoting::ExchangeViolated() {
  Index violations = 0;
  for (Index i = 0; i < n_; ++i) {
    if (scaled_.IsFree(i)) continue;
    unsigned char& is_active = is_active_[At(i)];
    const bool is_wrong = (is_active != 0 ? basic_.f[i] : gaps_[i]) < -violation_;
    violations += is_wrong ? 1 : 0;
    if (is_wrong) is_active = is_active != 0 ? 0 : 1;
  }
  return violations;
}

// In the place of x_, which basic_ becomes.
void ProfilePivoting::TakeBasicPoint() {
  for (Index i = 0; i < n_; ++i) {
    if (!scaled_.IsFree(i)) basic_.f[i] = std::max(basic_.f[i], 0.0);
  }
  std::swap(x_.f, basic_.f);
}

// Block principal pivoting from the active set that x_, with its image, suggests. True if no violation is left: basic_
// is the answer.
bool ProfilePivoting::Pivot(int most_patience) {
  rows_->ResidualSquares(0, n_, x_, &gaps_);
  for (Index i = 0; i < n_; ++i) {
    // What the next sweep would make of the row.
    is_active_[At(i)] = scaled_.IsFree(i) || x_.f[i] - gaps_[i] > 0 ? 1 : 0;
  }
  basic_.f.head(n_) = x_.f.head(n_);
  const auto find = [&] {
    if (TimeIsUp()) return false;
    FindBasicPoint();
    return true;
  };
  return ExchangeBlocks(
      kMostRounds, most_patience, find, [&] { return ExchangeViolated(); }, n_ / kRowsPerFew);
}

bool ProfilePivoting::SweepOn(double* f) {
  if (rows_ == nullptr || TimeIsUp()) return false;
  for (int k = 0; k < kMoreIterations; ++k) SweepBothWays();
  scaled_.ToGiven(x_.f, f);
  return true;
}

// Pivots until no sign is violated but by rounding, and takes forces that are rounding for none: where all forces
// around a row are 0, nothing else makes its backward error small.
double ProfilePivoting::Polish(double rounding, double* f) {
  if (rows_ == nullptr) return std::numeric_limits<double>::infinity();
  violation_ = std::min(violation_, kRoundingOfGaps * scaled_.b_norm / std::sqrt(static_cast<double>(n_)));
  if (has_profile_ && !std::exchange(is_polished_, true)) {
    const double before = Residual();
    const bool settled = Pivot(kPatienceOfPolish);
    TakeBasicPoint();
    if (!settled && !(Residual() <= before)) std::swap(x_.f, basic_.f);
  }
  const double least = rounding * x_.f.head(n_).cwiseAbs().maxCoeff();
  for (Index i = 0; i < n_; ++i) {
    if (std::abs(x_.f[i]) <= least) x_.f[i] = 0;
  }
  scaled_.ToGiven(x_.f, f);
  return Residual() / scaled_.b_norm;
}

double ProfilePivoting::Solve(const StepRows& all, std::span<const std::int32_t> part, const Request& request,
                              double* f) {
  iterations_ = 0;
  deadline_ = request.deadline;
  if (!Load(all, part)) {
    for (const std::int32_t row : part) f[row] = 0;
    return std::numeric_limits<double>::infinity();
  }
  has_profile_ = factor_.FindProfile(form_);
  is_polished_ = false;
  bool has_matrix = false;
  violation_ = kPartOfTolerance * request.tolerance * scaled_.b_norm / std::sqrt(static_cast<double>(n_));
  const double limit = request.tolerance * scaled_.b_norm;
  scaled_.Start(request.initial_f, &x_.f);
  rows_->MakeImage(n_, &x_);
  sweeps_.Start(*rows_, scaled_);
  double residual = std::numeric_limits<double>::infinity();
  const double sweep_cost = kCostOfRow * static_cast<double>(n_);
  auto budget = std::max<Index>(kFirstIterations, static_cast<Index>(2 * factor_.cost() / sweep_cost));
  if (request.initial_f != nullptr) budget = 1;
  for (int phase = 0; phase < kMostPhases; ++phase) {
    bool arrived = false;
    // Interior points do as well from where the first sweeps ended.
    const Index most = phase == 1 && has_profile_ ? 0 : budget;
    for (Index k = 0; k < most && !arrived; ++k) {
      arrived = SweepBothWays() <= limit / 2;
      if (iterations_ % kIterationsWithoutClock == 0 && TimeIsUp()) break;
    }
    if (!arrived && has_profile_) {
      if (!has_matrix) factor_.Assemble(form_);
      has_matrix = true;
      if (phase > 0) {
        iterations_ += central_path_.Follow(scaled_, *rows_, limit / 4, deadline_, &factor_, &x_);
      }
      if (Pivot(kPatience)) TakeBasicPoint();
      sweeps_.Restart();
    }
    residual = Residual();
    if (residual <= limit || TimeIsUp()) break;
    budget *= 2;
  }
  scaled_.ToGiven(x_.f, f);
  return residual / scaled_.b_norm;
}

// One step of the relaxation, which keeps w_. False if nothing moved.
bool BandPivoting::SweepRow(Index i) {
  const double wanted = f_[i] - kRelaxation * w_[i] / A_->diagonal()[At(i)];
  const double f = A_->is_joint(i) ? wanted : std::max(wanted, 0.0);
  const double change = f - f_[i];
  if (change == 0) return false;
  f_[i] = f;
  double* const w = w_.data();
  A_->ForEntries(i, [=](Index j, double a) { w[j] += change * a; });
  return true;
}

void BandPivoting::Start(const Eigen::VectorXd* initial_f) {
  f_.setZero();
  if (initial_f != nullptr) f_.head(A_->size()) = *initial_f;
  ClipForces();
  FindGaps();
  bool moves = false;
  for (Index i = 0; i < A_->size(); ++i) moves |= SweepRow(i);
  for (Index i = A_->size(); moves && i-- > 0;) SweepRow(i);
  for (Index i = 0; i < A_->size(); ++i) is_active_[At(i)] = f_[i] > 0 || A_->is_joint(i) ? 1 : 0;
}

// Row j of A is its column j.
void BandPivoting::FindGaps() {
  double* const w = w_.data();
  double* const size = size_.data();
  for (Index i = 0; i < A_->size(); ++i) {
    w[i] = A_->arrays().b[At(i)];
    size[i] = std::abs(w[i]);
  }
  for (Index j = 0; j < A_->size(); ++j) {
    if (f_[j] == 0) continue;
    A_->ForEntries(j, [=, f = f_[j]](Index i, double a) {
      w[i] += a * f;
      size[i] += std::abs(a * f);
    });
  }
}

// f_F -= A_FF^-1 w_F
void BandPivoting::Correct() {
  for (Index i = 0; i < A_->size(); ++i) correction_[i] = is_active_[At(i)] != 0 ? w_[i] : 0.0;
  factor_.Solve(correction_.data());
  f_.head(A_->size()) -= correction_.head(A_->size());
}

// How many rows have changed sides.
Index BandPivoting::ExchangeViolated() {
  Index count = 0;
  for (Index i = 0; i < A_->size(); ++i) {
    if (A_->is_joint(i)) continue;
    const bool is_active = is_active_[At(i)] != 0;
    const double value = is_active ? f_[i] * A_->diagonal()[At(i)] : w_[i];
    if (!(value < -kNoise * size_[i])) continue;
    is_active_[At(i)] = is_active ? 0 : 1;
    ++count;
  }
  return count;
}

void BandPivoting::ClipForces() {
  for (Index i = 0; i < A_->size(); ++i) {
    if (f_[i] < 0 && !A_->is_joint(i)) f_[i] = 0;
  }
}

// In double, and in extended precision where rounding may hide more than the tolerance. Sums have as many terms as the
// band is wide, and a few more.
bool BandPivoting::Meets(double tolerance) {
  using Known = LawSums<double>::Known;
  ClipForces();
  FindGaps();
  const auto judge = [&](double epsilon, const auto& gap) {
    LawSums<double> sums(tableau::kMargin * std::sqrt(tolerance));
    for (Index i = 0; i < A_->size(); ++i) {
      sums.Add(A_->diagonal()[At(i)], A_->arrays().b[At(i)], gap(i), f_[i], A_->is_joint(i), size_[i]);
    }
    double rho = 0;
    return sums.Judge(tolerance, static_cast<double>(2 * A_->bandwidth() + 5) * epsilon, &rho);
  };
  const Known known = judge(std::numeric_limits<double>::epsilon(), [&](Index i) { return w_[i]; });
  if (known != Known::kUnclear) return known == Known::kRight;
  return judge(static_cast<double>(std::numeric_limits<long double>::epsilon()), [&](Index i) {
           long double w = A_->arrays().b[At(i)];
           A_->ForEntries(i, [&](Index j, double a) { w += static_cast<long double>(a) * f_[j]; });
           return static_cast<double>(w);
         }) == Known::kRight;
}

bool BandPivoting::Solve(const MatrixArrays& A, const LcpOptions& options, const Deadline* deadline,
                         LcpResult* result) {
  A_ = &A;
  const Index n = A.size();
  for (Eigen::VectorXd* v : {&f_, &w_, &size_, &correction_}) {
    if (v->size() < n) v->resize(n);
  }
  if (is_active_.size() < At(n)) is_active_.resize(At(n));
  Start(options.initial_f);
  factor_.Take(A);
  std::int64_t factors = 0;
  bool is_late = false;
  const auto find = [&] {
    is_late = factors > 0 && deadline != nullptr && deadline->Expired();
    if (is_late || !factor_.Factorize(is_active_.data(), 0, nullptr)) return false;
    ++factors;
    f_.setZero();
    std::copy_n(A.arrays().b.data(), n, w_.data());
    Correct();
    FindGaps();
    return true;
  };
  const bool is_done = ExchangeBlocks(kMostRoundsOfBand, kPatienceOfBand, find, [&] { return ExchangeViolated(); });
  if (!is_done && !is_late) return false;
  if (is_done && !Meets(options.tolerance)) {
    Correct();
    if (!Meets(options.tolerance)) return false;
  }
  ClipForces();
  result->f = f_.head(n);
  result->status = is_done ? LcpStatus::kSolved : LcpStatus::kTimeLimit;
  result->iterations = factors;
  result->detail = "band";
  return true;
}

}  // namespace lcpbench
