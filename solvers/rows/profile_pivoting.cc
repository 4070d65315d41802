#include "solvers/rows/profile_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra/vector_register.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }

constexpr Index kMostWidth = kBodyWidth<6>;
// Shift of the diagonal, in units of A_ii = 1.
constexpr double kShift = 1e-9;
// Of nncg.cc.
constexpr double kParallel = 1e-10;
constexpr std::int64_t kHovering = 32;
constexpr int kProjections = 2;
// Iterations before the first factor, at least, and rounds of pivoting that may pass without fewer violations.
constexpr Index kFirstIterations = 4;
constexpr int kPatience = 1;
constexpr int kMostRounds = 12;
// Processor cycles that an iteration takes per row, roughly.
constexpr double kCostOfRow = 110;
// The clock is read once in so many iterations, and before every factorization.
constexpr int kIterationsWithoutClock = 16;
// Alternations of sweeps and pivoting.
constexpr int kMostPhases = 5;
// Interior points are asked after so many phases; their steps, the part of the way to the bounds that each goes, and
// the rho at which pivoting is to take over.
constexpr int kPhasesBeforeInteriorPoints = 1;
constexpr int kCentralSteps = 30;
constexpr double kPartOfStep = 0.995;
constexpr double kCentralStart = 0.03;  // least x and z at the start, in mean |x| + |b|
constexpr double kCentralResidual = 1e-8;
// Refinements of a basic point; and violations, in |D^-1/2 b|, that pivoting for exactness lets pass.
constexpr int kMostRefinements = 4;
constexpr int kPatienceOfPolish = 3;
constexpr double kRoundingOfGaps = 1e-13;
// Violations below this part of the tolerance, spread over all rows, are none.
constexpr double kPartOfTolerance = 0.1;

double Dot(const double* a, const double* b, Index n) {
  Register sum = {};
  Index i = 0;
  for (; i + kRegister <= n; i += kRegister) sum += *AsRegisters(a + i) * *AsRegisters(b + i);
  double rest = Sum(&sum);
  for (; i < n; ++i) rest += a[i] * b[i];
  return rest;
}

}  // namespace

void ProfilePivoting::Reserve(Index max_rows, Index max_bodies) {
  rows_.Reserve(max_rows, max_bodies);
  factor_.Reserve(max_rows);
  const Index n = max_rows;
  if (x_.size() >= n + kRegister) return;
  is_active_.resize(At(n));
  for (auto* v : {&x_, &x_before_, &previous_x_, &extra_x_, &trial_x_, &correction_, &shift_, &slack_, &right_side_,
                  &corrector_, &direction_})
    v->setZero(n + kRegister);
  for (auto* v : {&y_, &y_before_, &previous_y_, &extra_y_, &trial_y_}) v->setZero(2 * n * kMostWidth);
}

template <Index p, bool backward>
void ProfilePivoting::Sweep(double* energy, double* residual) {
  double* const y = y_.data();
  double gained = 0;
  double squares = 0;
  for (Index k = 0; k < n_; ++k) {
    const Index i = backward ? n_ - 1 - k : k;
    const double w = rows_.Gap<p>(i, y);
    const double x = x_[i];
    const double least = rows_.is_joint(i) ? -std::numeric_limits<double>::infinity() : 0.0;
    const double next = std::max(x - w, least);
    const double step = next - x;  // = -min(w, x) for contacts, -w for joints
    x_[i] = next;
    rows_.AddRow<p>(i, step, y);
    gained += step * (w + step / 2);
    squares += step * step;
  }
  *energy += gained;
  *residual = squares;
}

template <Index p>
void ProfilePivoting::Restart() {
  has_previous_ = false;
  previous_x_.head(n_).setZero();
  previous_y_.head(rows_.bodies() * kBodyWidth<p>).setZero();
  projections_ = 0;
}

// As NncgEngine (nncg.cc), on A = G G^T. Returns the residual |min(x, w)| as the sweep met it.
template <Index p>
double ProfilePivoting::Iterate() {
  const Index count = rows_.bodies() * kBodyWidth<p>;
  ++iterations_;
  std::copy_n(x_.data(), n_, x_before_.data());
  std::copy_n(y_.data(), count, y_before_.data());
  double energy = 0;
  double residual = 0;
  Sweep<p, false>(&energy, &residual);
  Sweep<p, true>(&energy, &residual);
  ++hovering_;
  if (residual < least_residual_) {
    least_residual_ = residual;
    hovering_ = 0;
  }
  double zz = 0;
  double zp = 0;
  double pp = 0;
  {
    Register of_zz = {};
    Register of_zp = {};
    Register of_pp = {};
    // Padding holds zeros; a last half register is read alone.
    Index k = 0;
    for (; k + kRegister <= count; k += kRegister) {
      const Register z = *AsRegisters(y_.data() + k) - *AsRegisters(y_before_.data() + k);
      const Register q = *AsRegisters(previous_y_.data() + k);
      of_zz += z * z;
      of_zp += z * q;
      of_pp += q * q;
    }
    zz = Sum(&of_zz);
    zp = Sum(&of_zp);
    pp = Sum(&of_pp);
    for (; k < count; ++k) {
      const double z = y_[k] - y_before_[k];
      zz += z * z;
      zp += z * previous_y_[k];
      pp += previous_y_[k] * previous_y_[k];
    }
  }
  const double zw = energy - zz / 2;
  const double pw = has_previous_ ? previous_w_ + pp : 0;
  if (!has_previous_) zp = pp = 0;
  double along_sweep = zz > 0 ? -zw / zz : 1.0;
  double along_previous = 0;
  const double determinant = zz * pp - zp * zp;
  if (determinant > kParallel * zz * pp) {
    along_sweep = (zp * pw - pp * zw) / determinant;
    along_previous = (zp * zw - zz * pw) / determinant;
  }
  const double more = along_sweep - 1;
  for (Index k = 0; k < count; ++k) extra_y_[k] = along_previous * previous_y_[k] + more * (y_[k] - y_before_[k]);
  double slope = more * (zw + zz) + along_previous * (pw + zp);
  bool clipped = false;
  for (Index i = 0; i < n_; ++i) extra_x_[i] = along_previous * previous_x_[i] + more * (x_[i] - x_before_[i]);
  for (Index i = 0; i < n_; ++i) {
    if (x_[i] + extra_x_[i] >= 0 || rows_.is_joint(i)) continue;
    clipped = true;
    const double back = -x_[i] - extra_x_[i];
    extra_x_[i] = -x_[i];
    rows_.AddRow<p>(i, back, extra_y_.data());
    slope += back * rows_.Gap<p>(i, y_.data());
  }
  double part = 1;
  double sweep_extra = more * zz + along_previous * zp;
  if (clipped) {
    const double curvature = Dot(extra_y_.data(), extra_y_.data(), count);
    part = curvature > 0 ? std::clamp(-slope / curvature, 0.0, 1.0) : 0.0;
    sweep_extra = Dot(extra_y_.data(), y_.data(), count) - Dot(extra_y_.data(), y_before_.data(), count);
  }
  previous_w_ = zw + part * (slope - sweep_extra);
  for (Index i = 0; i < n_; ++i) {
    const double next = x_[i] + part * extra_x_[i];
    previous_x_[i] = next - x_before_[i];
    x_[i] = next;
  }
  for (Index k = 0; k < count; ++k) {
    const double next = y_[k] + part * extra_y_[k];
    previous_y_[k] = next - y_before_[k];
    y_[k] = next;
  }
  has_previous_ = true;
  projections_ = clipped ? projections_ + 1 : 0;
  if (hovering_ > std::max<std::int64_t>(kHovering, n_ / 2) && projections_ >= kProjections) Restart<p>();
  return std::sqrt(residual);
}

// |min(x, w)| of x_, with y_ made anew.
template <Index p>
double ProfilePivoting::Residual() {
  rows_.ComputeMomenta<p>(x_.data(), y_.data());
  double squares = 0;
  for (Index i = 0; i < n_; ++i) {
    const double w = rows_.Gap<p>(i, y_.data());
    const double r = rows_.is_joint(i) ? w : std::min(w, x_[i]);
    squares += r * r;
  }
  return std::sqrt(squares);
}

// x := the basic point of the active rows, by proximal steps from x_ on them [Rockafellar 1976]: w of active rows is to
// vanish. y becomes its momenta.
template <Index p>
void ProfilePivoting::FindBasicPoint(double* x, double* y) {
  ++iterations_;
  shift_.head(n_).setConstant(kShift);
  factor_.Factorize(is_active_.data(), shift_.data());
  for (Index i = 0; i < n_; ++i) x[i] = is_active_[At(i)] != 0 ? x_[i] : 0;
  for (int step = 0; step < kMostRefinements; ++step) {
    rows_.ComputeMomenta<p>(x, y);
    double left = 0;
    for (Index i = 0; i < n_; ++i) {
      correction_[i] = is_active_[At(i)] != 0 ? -rows_.Gap<p>(i, y) : 0.0;
      left = std::max(left, std::abs(correction_[i]));
    }
    if (step > 0 && left <= violation_) return;
    factor_.Solve(correction_.data());
    for (Index i = 0; i < n_; ++i) x[i] += correction_[i];
  }
  rows_.ComputeMomenta<p>(x, y);
}

// Rows whose sign is wrong change sides. Returns how many.
template <Index p>
Index ProfilePivoting::ExchangeViolated(const double* x, const double* y) {
  Index violations = 0;
  for (Index i = 0; i < n_; ++i) {
    if (rows_.is_joint(i)) continue;
    unsigned char& is_active = is_active_[At(i)];
    const bool is_wrong = is_active != 0 ? x[i] < -violation_ : rows_.Gap<p>(i, y) < -violation_;
    violations += is_wrong ? 1 : 0;
    if (is_wrong) is_active = is_active != 0 ? 0 : 1;
  }
  return violations;
}

// Block principal pivoting from the active set that x_ suggests. True if no violation is left: x_ and y_ are the
// answer. False leaves them, and the last basic point in trial_x_.
template <Index p>
bool ProfilePivoting::Pivot(int most_patience) {
  double* const x = trial_x_.data();
  double* const y = trial_y_.data();
  for (Index i = 0; i < n_; ++i) {
    // What the next sweep would make of the row.
    is_active_[At(i)] = rows_.is_joint(i) || x_[i] - rows_.Gap<p>(i, y_.data()) > 0 ? 1 : 0;
  }
  trial_x_.head(n_) = x_.head(n_);
  Index least = n_ + 1;
  int patience = most_patience;
  for (int round = 0; round < kMostRounds && !TimeIsUp(); ++round) {
    FindBasicPoint<p>(x, y);
    const Index violations = ExchangeViolated<p>(x, y);
    if (violations == 0) {
      for (Index i = 0; i < n_; ++i) x_[i] = rows_.is_joint(i) ? x[i] : std::max(x[i], 0.0);
      rows_.ComputeMomenta<p>(x_.data(), y_.data());
      return true;
    }
    if (violations < least) {
      least = violations;
      patience = most_patience;
    } else if (--patience == 0) {
      return false;
    }
  }
  return false;
}

// The part of the way along `change` of x, and of z with it, on which x and z stay positive on contacts; at most 1.
double ProfilePivoting::StepLength(const double* x, const double* change) const {
  double most = 1;
  for (Index i = 0; i < n_; ++i) {
    if (rows_.is_joint(i)) continue;
    const double z = slack_[i];
    if (change[i] < 0) most = std::min(most, -x[i] / change[i]);
    const double dz = corrector_[i] - z - z / x[i] * change[i];
    if (dz < 0) most = std::min(most, -z / dz);
  }
  return most;
}

// One step from x and slack_, where -w is in right_side_ and x.z / contacts is mu.
void ProfilePivoting::StepToCentre(double mu, double contacts, double* x) {
  double* const dx = direction_.data();
  double* const z = slack_.data();
  corrector_.head(n_).setZero();
  factor_.Factorize(is_active_.data(), shift_.data());
  std::copy_n(right_side_.data(), n_, dx);
  factor_.Solve(dx);
  const double affine = StepLength(x, dx);
  double mu_affine = 0;
  for (Index i = 0; i < n_; ++i) {
    if (rows_.is_joint(i)) continue;
    const double dz = -z[i] - z[i] / x[i] * dx[i];
    mu_affine += (x[i] + affine * dx[i]) * (z[i] + affine * dz);
  }
  mu_affine /= contacts;
  const double ratio = mu_affine / mu;
  const double target = ratio * ratio * ratio * mu;
  for (Index i = 0; i < n_; ++i) {
    if (rows_.is_joint(i)) {
      dx[i] = right_side_[i];
      continue;
    }
    const double dz = -z[i] - z[i] / x[i] * dx[i];
    corrector_[i] = (target - dx[i] * dz) / x[i];
    dx[i] = right_side_[i] + corrector_[i];
  }
  factor_.Solve(dx);
  const double length = std::min(1.0, kPartOfStep * StepLength(x, dx));
  for (Index i = 0; i < n_; ++i) {
    if (!rows_.is_joint(i)) z[i] += length * (corrector_[i] - z[i] - z[i] / x[i] * dx[i]);
    x[i] += length * dx[i];
  }
}

// Mehrotra's predictor and corrector on x z = mu, z = w on contacts, from x_; x_ and y_ become where it ends.
template <Index p>
void ProfilePivoting::FollowCentralPath(double enough) {
  double* const x = trial_x_.data();
  double* const y = trial_y_.data();
  rows_.ComputeMomenta<p>(x_.data(), y_.data());
  std::fill_n(is_active_.begin(), n_, static_cast<unsigned char>(1));
  double size = 0;
  double contacts = 0;
  for (Index i = 0; i < n_; ++i) {
    size += std::abs(x_[i]) + std::abs(rows_.b()[i]);
    contacts += rows_.is_joint(i) ? 0 : 1;
  }
  const double least = kCentralStart * size / static_cast<double>(n_);
  for (Index i = 0; i < n_; ++i) {
    const bool is_joint = rows_.is_joint(i);
    x[i] = is_joint ? x_[i] : std::max(x_[i], least);
    slack_[i] = is_joint ? 0 : std::max(rows_.Gap<p>(i, y_.data()), least);
  }
  for (int round = 0; round < kCentralSteps && !TimeIsUp(); ++round) {
    ++iterations_;
    rows_.ComputeMomenta<p>(x, y);
    double mu = 0;
    double squares = 0;
    for (Index i = 0; i < n_; ++i) {
      const double w = rows_.Gap<p>(i, y);
      right_side_[i] = -w;
      const double r = rows_.is_joint(i) ? w : std::min(w, x[i]);
      squares += r * r;
      if (!rows_.is_joint(i)) mu += x[i] * slack_[i];
      shift_[i] = rows_.is_joint(i) ? kShift : kShift + slack_[i] / x[i];
    }
    mu /= contacts;
    std::copy_n(x, n_, x_.data());
    if (std::sqrt(squares) <= enough || !(mu > 0)) break;
    StepToCentre(mu, contacts, x);
  }
  rows_.ComputeMomenta<p>(x_.data(), y_.data());
}

// Pivots until no sign is violated but by rounding, and takes forces that are rounding for none: where all forces
// around a row are 0, nothing else makes its backward error small.
template <Index p>
double ProfilePivoting::PolishOf(double rounding, double* f) {
  if (n_ == 0) return std::numeric_limits<double>::infinity();
  violation_ = std::min(violation_, kRoundingOfGaps * rows_.b_norm() / std::sqrt(static_cast<double>(n_)));
  if (has_profile_) {
    std::copy_n(x_.data(), n_, x_before_.data());
    const double before = Residual<p>();
    if (!Pivot<p>(kPatienceOfPolish)) {
      for (Index i = 0; i < n_; ++i) x_[i] = rows_.is_joint(i) ? trial_x_[i] : std::max(trial_x_[i], 0.0);
      if (!(Residual<p>() <= before)) std::copy_n(x_before_.data(), n_, x_.data());
    }
  }
  const double least = rounding * x_.head(n_).cwiseAbs().maxCoeff();
  for (Index i = 0; i < n_; ++i) {
    if (std::abs(x_[i]) <= least) x_[i] = 0;
  }
  Store(f);
  return Residual<p>() / rows_.b_norm();
}

// x_ from the start values, y_ with it.
template <Index p>
void ProfilePivoting::Start(const double* initial_f) {
  x_.head(n_).setZero();
  for (Index i = 0; i < n_ && initial_f != nullptr; ++i) {
    const double start = initial_f[rows_.given(i)] / rows_.scale(i);
    x_[i] = rows_.is_joint(i) ? start : std::max(start, 0.0);
  }
  rows_.ComputeMomenta<p>(x_.data(), y_.data());
  Restart<p>();
  least_residual_ = std::numeric_limits<double>::infinity();
  hovering_ = 0;
}

template <Index p>
double ProfilePivoting::SolveOf(const Request& request, double* f) {
  has_profile_ = factor_.FindProfile(rows_);
  bool has_matrix = false;
  violation_ = kPartOfTolerance * request.tolerance * rows_.b_norm() / std::sqrt(static_cast<double>(n_));
  const double limit = request.tolerance * rows_.b_norm();
  Start<p>(request.initial_f);
  double residual = std::numeric_limits<double>::infinity();
  const double sweep_cost = kCostOfRow * static_cast<double>(n_);
  auto budget = std::max<Index>(kFirstIterations, static_cast<Index>(2 * factor_.cost() / sweep_cost));
  if (request.initial_f != nullptr) budget = 1;
  for (int phase = 0; phase < kMostPhases; ++phase) {
    bool arrived = false;
    for (Index k = 0; k < budget && !arrived; ++k) {
      arrived = Iterate<p>() <= limit / 2;
      if (iterations_ % kIterationsWithoutClock == 0 && TimeIsUp()) break;
    }
    if (!arrived && has_profile_) {
      if (!has_matrix) factor_.Assemble<p>(rows_);
      has_matrix = true;
      if (phase >= kPhasesBeforeInteriorPoints) {
        FollowCentralPath<p>(std::min(kCentralResidual * rows_.b_norm(), limit / 4));
      }
      Pivot<p>(kPatience);
      Restart<p>();
    }
    residual = Residual<p>();
    if (residual <= limit || TimeIsUp()) break;
    budget *= 2;
  }
  Store(f);
  return residual / rows_.b_norm();
}

void ProfilePivoting::Store(double* f) const {
  for (Index i = 0; i < n_; ++i) f[rows_.given(i)] = x_[i] * rows_.scale(i);
}

double ProfilePivoting::Polish(const StepRows& all, double rounding, double* f) {
  return all.columns_per_body == 3 ? PolishOf<3>(rounding, f) : PolishOf<6>(rounding, f);
}

double ProfilePivoting::Solve(const StepRows& all, std::span<const std::int32_t> part, const Request& request,
                              double* f) {
  iterations_ = 0;
  deadline_ = request.deadline;
  if (!rows_.Load(all, part)) {
    n_ = 0;
    for (const std::int32_t row : part) f[row] = 0;
    return std::numeric_limits<double>::infinity();
  }
  n_ = rows_.size();
  return all.columns_per_body == 3 ? SolveOf<3>(request, f) : SolveOf<6>(request, f);
}

}  // namespace lcpbench
