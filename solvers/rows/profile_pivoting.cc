#include "solvers/rows/profile_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/pivoting/vector_register.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }

// Numbers of a body: p, padded to a vector register.
template <Index p>
inline constexpr Index kWidth = p == 3 ? 4 : 8;
template <Index p>
using BodyVector [[gnu::vector_size(static_cast<std::size_t>(kWidth<p>) * sizeof(double)),
                   gnu::aligned(alignof(double)), gnu::may_alias]] = double;

template <Index p>
const BodyVector<p>& BodyAt(const double* y, Index body) {
  return *reinterpret_cast<const BodyVector<p>*>(y + body * kWidth<p>);
}
template <Index p>
BodyVector<p>& BodyAt(double* y, Index body) {
  return *reinterpret_cast<BodyVector<p>*>(y + body * kWidth<p>);
}

template <Index p>
double SumOf(const BodyVector<p>& v) {
  if constexpr (p == 3) return (v[0] + v[2]) + v[1];
  return ((v[0] + v[4]) + v[2]) + ((v[1] + v[5]) + v[3]);
}

constexpr Index kMostWidth = 8;
// Numbers of the profile per row that room is made for: an island whose profile is larger is left to sweeps.
constexpr Index kMostProfile = 256;
// Shift of the diagonal, in units of A_ii = 1.
constexpr double kShift = 1e-9;
// A pivot below is rounding; its row is left out of the factor.
constexpr double kLeastPivot = 1e-12;
// Of nncg.cc.
constexpr double kParallel = 1e-10;
constexpr std::int64_t kHovering = 32;
constexpr int kProjections = 2;
// Iterations before the first factor, at least, and rounds of pivoting that may pass without fewer violations.
constexpr Index kFirstIterations = 4;
constexpr int kPatience = 1;
constexpr int kMostRounds = 12;
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
  if (local_.size() < At(max_bodies)) local_.resize(At(max_bodies), -1);
  if (given_.size() >= At(max_rows)) return;
  const Index n = max_rows;
  const Index most_bodies = 2 * n;
  for (auto* v : {&given_, &first_body_, &second_body_, &profile_first_, &last_below_, &active_first_, &order_}) {
    v->resize(At(n));
  }
  profile_at_.resize(At(n) + 1);
  is_joint_.resize(At(n));
  is_active_.resize(At(n));
  G_.setZero(2 * kMostWidth * n);
  for (auto* v : {&b_, &scale_, &x_, &x_before_, &previous_x_, &extra_x_, &trial_x_, &gap_, &previous_gap_, &barrier_})
    v->setZero(n + kRegister);
  for (auto* v : {&y_, &y_before_, &previous_y_, &extra_y_, &trial_y_}) v->setZero(most_bodies * kMostWidth);
  for (auto* v : {&global_, &place_, &queue_, &bucket_}) v->resize(At(most_bodies) + 1);
  rows_of_body_.resize(At(2 * n));
  body_begin_.resize(At(most_bodies) + 2);
  for (auto* v : {&A_, &L_}) v->setZero(kMostProfile * n + 4 * kRegister);
  for (auto* v : {&column_, &mask_}) v->setZero(n + 2 * kRegister);
}

// Breadth-first from a body far from the first one, by the rows that bodies share; then from its end. What is not
// connected with it comes behind.
void ProfilePivoting::OrderBodies() {
  std::int32_t start = 0;
  for (int round = 0; round < 2; ++round) {
    std::fill_n(place_.begin(), bodies_, -1);
    std::int32_t count = 0;
    std::int32_t unplaced = 0;
    queue_[0] = start;
    place_[At(start)] = count++;
    for (std::int32_t head = 0; head < count; ++head) {
      const std::int32_t body = queue_[At(head)];
      for (std::int32_t e = body_begin_[At(body)]; e < body_begin_[At(body) + 1]; ++e) {
        const std::int32_t row = rows_of_body_[At(e)];
        const std::int32_t other = first_body_[At(row)] == body ? second_body_[At(row)] : first_body_[At(row)];
        if (other < 0 || place_[At(other)] >= 0) continue;
        place_[At(other)] = count;
        queue_[At(count++)] = other;
      }
      if (head + 1 < count || count == bodies_) continue;
      while (place_[At(unplaced)] >= 0) ++unplaced;
      place_[At(unplaced)] = count;
      queue_[At(count++)] = unplaced;
    }
    start = queue_[At(count - 1)];
  }
}

void ProfilePivoting::FindProfile() {
  // The first row of each body, in the rows' order, then of each row.
  std::fill_n(bucket_.begin(), bodies_, static_cast<std::int32_t>(n_));
  for (Index i = n_ - 1; i >= 0; --i) {
    bucket_[At(first_body_[At(i)])] = static_cast<std::int32_t>(i);
    if (second_body_[At(i)] >= 0) bucket_[At(second_body_[At(i)])] = static_cast<std::int32_t>(i);
  }
  Index at = 0;
  for (Index i = 0; i < n_; ++i) {
    std::int32_t first = bucket_[At(first_body_[At(i)])];
    if (second_body_[At(i)] >= 0) first = std::min(first, bucket_[At(second_body_[At(i)])]);
    profile_first_[At(i)] = first;
    const Index begin = first / kRegister * kRegister;
    profile_at_[At(i)] = at - begin;
    at += (i / kRegister + 1) * kRegister - begin;
    last_below_[At(i)] = static_cast<std::int32_t>(i);
  }
  has_profile_ = at + kRegister <= A_.size();
  // The lowest row that each column reaches.
  for (Index i = 0; i < n_; ++i) {
    const Index first = profile_first_[At(i)];
    last_below_[At(first)] = std::max(last_below_[At(first)], static_cast<std::int32_t>(i));
  }
  for (Index i = 1; i < n_; ++i) {
    last_below_[At(i)] = std::max(last_below_[At(i)], last_below_[At(i) - 1]);
  }
  factor_cost_ = 0;
  for (Index j = 0; j < n_; ++j) {
    const auto below = static_cast<double>(last_below_[At(j)] - j);
    factor_cost_ += below * (8 + below / 8) + 40;
  }
  sweep_cost_ = 110 * static_cast<double>(n_);
}

template <Index p, typename Real>
bool ProfilePivoting::Load(const StepRows& all, const Real* J, std::span<const std::int32_t> part) {
  constexpr Index width = kWidth<p>;
  n_ = static_cast<Index>(part.size());
  bodies_ = 0;
  const auto local = [&](std::int32_t body) -> std::int32_t {
    if (body < 0) return -1;
    std::int32_t& known = local_[At(body)];
    if (known >= 0) return known;
    double sum = 0;
    for (Index c = 0; c < p; ++c) sum += all.inverse_mass[body * p + c];
    if (sum == 0) return -1;
    global_[At(bodies_)] = body;
    body_begin_[At(bodies_) + 1] = 0;
    known = static_cast<std::int32_t>(bodies_++);
    return known;
  };
  body_begin_[0] = 0;
  bool all_move = true;
  for (Index i = 0; i < n_ && all_move; ++i) {
    const Index row = part[At(i)];
    std::int32_t first = local(all.body[2 * row]);
    std::int32_t second = local(all.body[2 * row + 1]);
    if (first < 0) std::swap(first, second);
    if (second == first) second = -1;
    first_body_[At(i)] = first;
    second_body_[At(i)] = second;
    all_move = first >= 0;
    if (!all_move) break;
    ++body_begin_[At(first) + 1];
    if (second >= 0) ++body_begin_[At(second) + 1];
  }
  if (all_move) {
    for (Index k = 0; k < bodies_; ++k) body_begin_[At(k) + 1] += body_begin_[At(k)];
    std::copy_n(body_begin_.begin(), bodies_, bucket_.begin());
    for (Index i = 0; i < n_; ++i) {
      rows_of_body_[At(bucket_[At(first_body_[At(i)])]++)] = static_cast<std::int32_t>(i);
      if (second_body_[At(i)] >= 0) {
        rows_of_body_[At(bucket_[At(second_body_[At(i)])]++)] = static_cast<std::int32_t>(i);
      }
    }
    OrderBodies();
    // Rows by the later one of their bodies, by counting.
    std::fill_n(bucket_.begin(), bodies_ + 1, 0);
    const auto key = [&](Index i) {
      const std::int32_t first = place_[At(first_body_[At(i)])];
      return second_body_[At(i)] < 0 ? first : std::max(first, place_[At(second_body_[At(i)])]);
    };
    for (Index i = 0; i < n_; ++i) ++bucket_[At(key(i)) + 1];
    for (Index k = 0; k < bodies_; ++k) bucket_[At(k) + 1] += bucket_[At(k)];
    for (Index i = 0; i < n_; ++i) order_[At(bucket_[At(key(i))]++)] = static_cast<std::int32_t>(i);
  }
  for (Index k = 0; k < bodies_; ++k) local_[At(global_[At(k)])] = -1;
  if (!all_move) return false;

  // Square roots of the inverse masses, by the bodies' places.
  double* const roots = trial_y_.data();
  for (Index k = 0; k < bodies_; ++k) {
    double* root = roots + place_[At(k)] * width;
    for (int c = 0; c < p; ++c) root[c] = std::sqrt(all.inverse_mass[static_cast<Index>(global_[At(k)]) * p + c]);
    for (int c = p; c < width; ++c) root[c] = 0;
  }
  // Places take the places of local numbers; order_ is read before given_ is written, by way of bucket-free copies.
  double b_square = 0;
  for (Index i = 0; i < n_; ++i) {
    const Index from = order_[At(i)];
    const Index row = part[At(from)];
    given_[At(i)] = static_cast<std::int32_t>(row);
    const std::int32_t* body = all.body + 2 * row;
    const std::int32_t first = first_body_[At(from)];
    const std::int32_t second = second_body_[At(from)];
    double* G = G_.data() + i * 2 * width;
    const Real* j = J + row * 2 * p;
    double d = 0;
    const bool is_joined = body[0] == body[1];
    const bool swapped = body[0] < 0 || global_[At(first)] != body[0];
    for (int s = 0; s < 2; ++s) {
      const std::int32_t of = s == 0 ? first : second;
      double* side = G + s * width;
      for (int c = 0; c < width; ++c) side[c] = 0;
      if (of < 0) continue;
      const double* root = roots + place_[At(of)] * width;
      const Real* numbers = j + ((s == 1) != swapped ? p : 0);
      for (int c = 0; c < p; ++c) {
        const double sum =
            is_joined ? static_cast<double>(j[c]) + static_cast<double>(j[p + c]) : static_cast<double>(numbers[c]);
        side[c] = sum * root[c];
        d += side[c] * side[c];
      }
    }
    if (!(d > 0)) return false;
    const double s = 1 / std::sqrt(d);
    for (int c = 0; c < 2 * width; ++c) G[c] *= s;
    scale_[i] = s;
    b_[i] = all.b[row] * s;
    b_square += b_[i] * b_[i];
    is_joint_[At(i)] = all.bilateral != nullptr && all.bilateral[row] != 0 ? 1 : 0;
  }
  // Bodies by their places, row by row in the new order.
  for (Index i = 0; i < n_; ++i) {
    const Index from = order_[At(i)];
    profile_first_[At(i)] = place_[At(first_body_[At(from)])];
    last_below_[At(i)] = second_body_[At(from)] < 0 ? -1 : place_[At(second_body_[At(from)])];
  }
  std::copy_n(profile_first_.begin(), n_, first_body_.begin());
  std::copy_n(last_below_.begin(), n_, second_body_.begin());
  b_norm_ = b_square > 0 ? std::sqrt(b_square) : 1;
  return true;
}

template <Index p>
double ProfilePivoting::Gap(Index i, const double* y) const {
  constexpr Index width = kWidth<p>;
  const double* G = G_.data() + i * 2 * width;
  BodyVector<p> sum = BodyAt<p>(G, 0) * BodyAt<p>(y, first_body_[At(i)]);
  if (second_body_[At(i)] >= 0) sum += BodyAt<p>(G, 1) * BodyAt<p>(y, second_body_[At(i)]);
  return b_[i] + SumOf<p>(sum);
}

template <Index p>
void ProfilePivoting::AddRow(Index i, double x, double* y) const {
  constexpr Index width = kWidth<p>;
  const double* G = G_.data() + i * 2 * width;
  BodyAt<p>(y, first_body_[At(i)]) += x * BodyAt<p>(G, 0);
  if (second_body_[At(i)] >= 0) BodyAt<p>(y, second_body_[At(i)]) += x * BodyAt<p>(G, 1);
}

template <Index p, bool backward>
void ProfilePivoting::Sweep(double* energy, double* residual) {
  double* const y = y_.data();
  double gained = 0;
  double squares = 0;
  for (Index k = 0; k < n_; ++k) {
    const Index i = backward ? n_ - 1 - k : k;
    const double w = Gap<p>(i, y);
    const double x = x_[i];
    const double least = is_joint_[At(i)] != 0 ? -std::numeric_limits<double>::infinity() : 0.0;
    const double next = std::max(x - w, least);
    const double step = next - x;  // = -min(w, x) for contacts, -w for joints
    x_[i] = next;
    AddRow<p>(i, step, y);
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
  previous_y_.head(bodies_ * kWidth<p>).setZero();
  projections_ = 0;
}

// As NncgEngine (nncg.cc), on A = G G^T. Returns the residual |min(x, w)| as the sweep met it.
template <Index p>
double ProfilePivoting::Iterate() {
  const Index count = bodies_ * kWidth<p>;
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
    if (x_[i] + extra_x_[i] >= 0 || is_joint_[At(i)] != 0) continue;
    clipped = true;
    const double back = -x_[i] - extra_x_[i];
    extra_x_[i] = -x_[i];
    AddRow<p>(i, back, extra_y_.data());
    slope += back * Gap<p>(i, y_.data());
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

// |min(x, w)| of x_, with y_ and gap_ made anew.
template <Index p>
double ProfilePivoting::Residual() {
  y_.head(bodies_ * kWidth<p>).setZero();
  for (Index i = 0; i < n_; ++i) {
    if (x_[i] != 0) AddRow<p>(i, x_[i], y_.data());
  }
  double squares = 0;
  for (Index i = 0; i < n_; ++i) {
    const double w = Gap<p>(i, y_.data());
    gap_[i] = w;
    const double r = is_joint_[At(i)] != 0 ? w : std::min(w, x_[i]);
    squares += r * r;
  }
  return std::sqrt(squares);
}

template <Index p>
void ProfilePivoting::AssembleProfile() {
  constexpr Index width = kWidth<p>;
  std::fill_n(A_.data(), profile_at_[At(n_) - 1] + (n_ - 1) / kRegister * kRegister + kRegister, 0.0);
  // rows_of_body_ anew, by places and in the order of rows.
  std::fill_n(body_begin_.begin(), bodies_ + 1, 0);
  for (Index i = 0; i < n_; ++i) {
    ++body_begin_[At(first_body_[At(i)]) + 1];
    if (second_body_[At(i)] >= 0) ++body_begin_[At(second_body_[At(i)]) + 1];
  }
  for (Index k = 0; k < bodies_; ++k) {
    body_begin_[At(k) + 1] += body_begin_[At(k)];
    bucket_[At(k)] = body_begin_[At(k)];
  }
  for (Index i = 0; i < n_; ++i) {
    double* const row = A_.data() + profile_at_[At(i)];
    const double* G = G_.data() + i * 2 * width;
    for (int s = 0; s < 2; ++s) {
      const std::int32_t body = s == 0 ? first_body_[At(i)] : second_body_[At(i)];
      if (body < 0) continue;
      const BodyVector<p> own = BodyAt<p>(G, s);
      for (std::int32_t e = body_begin_[At(body)]; e < bucket_[At(body)]; ++e) {
        const std::int32_t side = rows_of_body_[At(e)];  // 2 row + side
        row[side / 2] += SumOf<p>(own * BodyAt<p>(G_.data() + static_cast<Index>(side / 2) * 2 * width, side % 2));
      }
      rows_of_body_[At(bucket_[At(body)]++)] = static_cast<std::int32_t>(2 * i + s);
    }
    row[i] = 1;
  }
}

// L D L^T of A_FF + shift, F the active rows: column by column, each one subtracted from the rows below at once.
void ProfilePivoting::Factorize() {
  for (Index i = 0; i < n_; ++i) {
    mask_[i] = is_active_[At(i)] != 0 ? 1 : 0;
    active_first_[At(i)] = is_active_[At(i)] != 0 ? profile_first_[At(i)] : static_cast<std::int32_t>(n_);
  }
  for (Index i = 0; i < n_; ++i) {
    if (is_active_[At(i)] == 0) continue;
    const double* from = A_.data() + profile_at_[At(i)];
    double* to = L_.data() + profile_at_[At(i)];
    for (Index k = profile_first_[At(i)] / kRegister * kRegister; k <= i; k += kRegister) {
      *AsRegisters(to + k) = *AsRegisters(from + k) * *AsRegisters(mask_.data() + k);
    }
    to[i] = 1 + barrier_[i];
  }
  double* const column = column_.data();
  for (Index j = 0; j < n_; ++j) {
    column[j] = 0;
    if (is_active_[At(j)] == 0) continue;
    const Index last = last_below_[At(j)];
    double& pivot = L_[profile_at_[At(j)] + j];
    if (!(pivot > kLeastPivot)) pivot = std::numeric_limits<double>::infinity();  // left out: its x is 0
    const double inverse = 1 / pivot;
    const std::int32_t reached = static_cast<std::int32_t>(j);
    for (Index i = j + 1; i <= last; ++i) {
      column[i] = active_first_[At(i)] <= reached ? L_[profile_at_[At(i)] + j] : 0.0;
    }
    const Index begin = (j + 1) / kRegister * kRegister;
    for (Index i = j + 1; i <= last; ++i) {
      const double of_row = column[i];
      if (of_row == 0) continue;
      double* const row = L_.data() + profile_at_[At(i)];
      const double factor = of_row * inverse;
      for (Index k = begin; k <= i; k += kRegister) *AsRegisters(row + k) -= factor * *AsRegisters(column + k);
      row[j] = factor;
    }
    // What lies beyond the diagonal in a register is never read as a number of the row.
  }
  for (Index i = 0; i < n_; ++i) column[i] = 0;
}

// x := (A_FF + shift)^-1 x on active rows; other entries of x must be 0, and are 0 afterwards.
void ProfilePivoting::SolveFactor(double* x) {
  for (Index i = 0; i < n_; ++i) {
    if (is_active_[At(i)] == 0) continue;
    const double* row = L_.data() + profile_at_[At(i)];
    const double own = x[i];
    x[i] = 0;
    Register sum = {};
    const Index begin = profile_first_[At(i)] / kRegister * kRegister;
    const Index end = i / kRegister * kRegister;
    for (Index k = begin; k < end; k += kRegister) sum += *AsRegisters(row + k) * *AsRegisters(x + k);
    double rest = Sum(&sum);
    for (Index k = std::max(begin, end); k < i; ++k) rest += row[k] * x[k];
    x[i] = own - rest;
  }
  for (Index i = 0; i < n_; ++i) {
    if (is_active_[At(i)] != 0) x[i] /= L_[profile_at_[At(i)] + i];
  }
  for (Index i = n_ - 1; i >= 0; --i) {
    if (is_active_[At(i)] == 0) continue;
    const double* row = L_.data() + profile_at_[At(i)];
    const double own = x[i];
    const Index begin = profile_first_[At(i)] / kRegister * kRegister;
    const Index end = i / kRegister * kRegister;
    for (Index k = begin; k < end; k += kRegister) *AsRegisters(x + k) -= own * *AsRegisters(row + k);
    for (Index k = std::max(begin, end); k < i; ++k) x[k] -= own * row[k];
  }
}

// 1/2 x.A x + b.x, with y = G^T x made anew.
template <Index p>
double ProfilePivoting::Energy(const double* x, double* y) const {
  std::fill_n(y, bodies_ * kWidth<p>, 0.0);
  for (Index i = 0; i < n_; ++i) {
    if (x[i] != 0) AddRow<p>(i, x[i], y);
  }
  return Dot(y, y, bodies_ * kWidth<p>) / 2 + Dot(b_.data(), x, n_);
}

// Block principal pivoting from the active set that x_ suggests; x_ and y_ become the answer, or whichever of the
// sweeps' point and the last projected basic point has less energy. True if no violation is left.
template <Index p>
bool ProfilePivoting::Pivot(int most_patience) {
  double* const x = trial_x_.data();
  double* const y = trial_y_.data();
  for (Index i = 0; i < n_; ++i) {
    // What the next sweep would make of the row.
    is_active_[At(i)] = is_joint_[At(i)] != 0 || x_[i] - Gap<p>(i, y_.data()) > 0 ? 1 : 0;
  }
  Index least = n_ + 1;
  int patience = most_patience;
  bool found = false;
  for (int round = 0; round < kMostRounds; ++round) {
    ++iterations_;
    barrier_.head(n_).setConstant(kShift);
    Factorize();
    for (Index i = 0; i < n_; ++i) x[i] = is_active_[At(i)] != 0 ? x_[i] : 0;
    Index violations = 0;
    for (int step = 0; step < kMostRefinements; ++step) {
      // A proximal step from x: w of active rows is to vanish.
      std::fill_n(y, bodies_ * kWidth<p>, 0.0);
      for (Index i = 0; i < n_; ++i) {
        if (x[i] != 0) AddRow<p>(i, x[i], y);
      }
      double left = 0;
      for (Index i = 0; i < n_; ++i) {
        gap_[i] = is_active_[At(i)] != 0 ? -Gap<p>(i, y) : 0.0;
        left = std::max(left, std::abs(gap_[i]));
      }
      if (step > 0 && left <= violation_) break;
      SolveFactor(gap_.data());
      for (Index i = 0; i < n_; ++i) x[i] += gap_[i];
    }
    std::fill_n(y, bodies_ * kWidth<p>, 0.0);
    for (Index i = 0; i < n_; ++i) {
      if (x[i] != 0) AddRow<p>(i, x[i], y);
    }
    for (Index i = 0; i < n_; ++i) {
      if (is_joint_[At(i)] != 0) continue;
      unsigned char& is_active = is_active_[At(i)];
      const bool is_wrong = is_active != 0 ? x[i] < -violation_ : Gap<p>(i, y) < -violation_;
      violations += is_wrong ? 1 : 0;
      if (is_wrong) is_active = is_active != 0 ? 0 : 1;
    }
    if (violations == 0) {
      found = true;
      break;
    }
    if (violations < least) {
      least = violations;
      patience = most_patience;
    } else if (--patience == 0) {
      break;
    }
  }
  if (found) {
    for (Index i = 0; i < n_; ++i) x_[i] = is_joint_[At(i)] != 0 ? x[i] : std::max(x[i], 0.0);
    Energy<p>(x_.data(), y_.data());
  }
  return found;
}

// Mehrotra's predictor and corrector on x z = mu, z = w on contacts, from x_; x_ and y_ become where it ends.
template <Index p>
void ProfilePivoting::FollowCentralPath(double enough) {
  double* const x = trial_x_.data();
  double* const y = trial_y_.data();
  double* const z = extra_x_.data();
  double* const dx = gap_.data();
  double* const corrected = previous_x_.data();
  Energy<p>(x_.data(), y_.data());
  std::fill_n(is_active_.begin(), n_, static_cast<unsigned char>(1));
  double size = 0;
  double contacts = 0;
  for (Index i = 0; i < n_; ++i) {
    size += std::abs(x_[i]) + std::abs(b_[i]);
    contacts += is_joint_[At(i)] != 0 ? 0 : 1;
  }
  const double least = kCentralStart * size / static_cast<double>(n_);
  for (Index i = 0; i < n_; ++i) {
    const bool is_joint = is_joint_[At(i)] != 0;
    x[i] = is_joint ? x_[i] : std::max(x_[i], least);
    z[i] = is_joint ? 0 : std::max(Gap<p>(i, y_.data()), least);
  }
  const auto step_length = [&](const double* change) {
    double most = 1;
    for (Index i = 0; i < n_; ++i) {
      if (is_joint_[At(i)] != 0) continue;
      if (change[i] < 0) most = std::min(most, -x[i] / change[i]);
      const double dz = corrected[i] - z[i] - z[i] / x[i] * change[i];
      if (dz < 0) most = std::min(most, -z[i] / dz);
    }
    return most;
  };
  for (int round = 0; round < kCentralSteps; ++round) {
    ++iterations_;
    Energy<p>(x, y);
    double mu = 0;
    double squares = 0;
    for (Index i = 0; i < n_; ++i) {
      const double w = Gap<p>(i, y);
      column_[i] = -w;
      const double r = is_joint_[At(i)] != 0 ? w : std::min(w, x[i]);
      squares += r * r;
      if (is_joint_[At(i)] == 0) mu += x[i] * z[i];
      barrier_[i] = is_joint_[At(i)] != 0 ? kShift : kShift + z[i] / x[i];
    }
    mu /= contacts;
    std::copy_n(x, n_, x_.data());
    if (std::sqrt(squares) <= enough || !(mu > 0)) break;
    // column_ is what Factorize works in.
    std::copy_n(column_.data(), n_, dx);
    std::fill_n(corrected, n_, 0.0);
    Factorize();
    for (Index i = 0; i < n_; ++i) previous_gap_[i] = dx[i];
    SolveFactor(dx);
    const double affine = step_length(dx);
    double mu_affine = 0;
    for (Index i = 0; i < n_; ++i) {
      if (is_joint_[At(i)] != 0) continue;
      const double dz = -z[i] - z[i] / x[i] * dx[i];
      mu_affine += (x[i] + affine * dx[i]) * (z[i] + affine * dz);
    }
    mu_affine /= contacts;
    const double ratio = mu_affine / mu;
    const double target = ratio * ratio * ratio * mu;
    for (Index i = 0; i < n_; ++i) {
      if (is_joint_[At(i)] != 0) {
        dx[i] = previous_gap_[i];
        continue;
      }
      const double dz = -z[i] - z[i] / x[i] * dx[i];
      corrected[i] = (target - dx[i] * dz) / x[i];
      dx[i] = previous_gap_[i] + corrected[i];
    }
    SolveFactor(dx);
    const double length = std::min(1.0, kPartOfStep * step_length(dx));
    for (Index i = 0; i < n_; ++i) {
      if (is_joint_[At(i)] == 0) z[i] += length * (corrected[i] - z[i] - z[i] / x[i] * dx[i]);
      x[i] += length * dx[i];
    }
  }
  Energy<p>(x_.data(), y_.data());
}

// Pivots until no sign is violated but by rounding, and takes forces that are rounding for none: where all forces
// around a row are 0, nothing else makes its backward error small.
template <Index p>
double ProfilePivoting::PolishOf(double rounding, double* f) {
  if (n_ == 0) return std::numeric_limits<double>::infinity();
  violation_ = std::min(violation_, kRoundingOfGaps * b_norm_ / std::sqrt(static_cast<double>(n_)));
  if (has_profile_) {
    std::copy_n(x_.data(), n_, previous_x_.data());
    const double before = Residual<p>();
    if (!Pivot<p>(kPatienceOfPolish)) {
      for (Index i = 0; i < n_; ++i) x_[i] = is_joint_[At(i)] != 0 ? trial_x_[i] : std::max(trial_x_[i], 0.0);
      if (!(Residual<p>() <= before)) std::copy_n(previous_x_.data(), n_, x_.data());
    }
  }
  const double least = rounding * x_.head(n_).cwiseAbs().maxCoeff();
  for (Index i = 0; i < n_; ++i) {
    if (std::abs(x_[i]) <= least) x_[i] = 0;
    f[given_[At(i)]] = x_[i] * scale_[i];
  }
  return Residual<p>() / b_norm_;
}

template <Index p>
double ProfilePivoting::SolveOf(const StepRows& all, std::span<const std::int32_t> part, const Request& request,
                                double* f) {
  iterations_ = 0;
  const bool loaded = all.J != nullptr ? Load<p>(all, all.J, part) : Load<p>(all, all.J_single, part);
  if (!loaded) {
    n_ = 0;
    for (const std::int32_t row : part) f[row] = 0;
    return std::numeric_limits<double>::infinity();
  }
  FindProfile();
  bool has_matrix = false;
  violation_ = kPartOfTolerance * request.tolerance * b_norm_ / std::sqrt(static_cast<double>(n_));
  const double limit = request.tolerance * b_norm_;
  y_.head(bodies_ * kWidth<p>).setZero();
  x_.head(n_).setZero();
  if (request.initial_f != nullptr) {
    for (Index i = 0; i < n_; ++i) {
      const double start = request.initial_f[given_[At(i)]] / scale_[i];
      x_[i] = is_joint_[At(i)] != 0 ? start : std::max(start, 0.0);
      if (x_[i] != 0) AddRow<p>(i, x_[i], y_.data());
    }
  }
  Restart<p>();
  least_residual_ = std::numeric_limits<double>::infinity();
  hovering_ = 0;
  double residual = std::numeric_limits<double>::infinity();
  auto budget = std::max<Index>(kFirstIterations, static_cast<Index>(2 * factor_cost_ / sweep_cost_));
  if (request.initial_f != nullptr) budget = 1;
  for (int phase = 0; phase < kMostPhases; ++phase) {
    bool arrived = false;
    for (Index k = 0; k < budget && !arrived; ++k) {
      arrived = Iterate<p>() <= limit / 2;
      if (request.deadline != nullptr && iterations_ % 16 == 0 && request.deadline->Expired()) break;
    }
    if (!arrived && has_profile_) {
      if (!has_matrix) AssembleProfile<p>();
      has_matrix = true;
      if (phase >= kPhasesBeforeInteriorPoints) {
        FollowCentralPath<p>(std::min(kCentralResidual * b_norm_, limit / 4));
      }
      Pivot<p>(kPatience);
      Restart<p>();
    }
    residual = Residual<p>();
    if (residual <= limit || (request.deadline != nullptr && request.deadline->Expired())) break;
    budget *= 2;
  }
  Store(f);
  return residual / b_norm_;
}

void ProfilePivoting::Store(double* f) const {
  for (Index i = 0; i < n_; ++i) f[given_[At(i)]] = x_[i] * scale_[i];
}

double ProfilePivoting::Polish(const StepRows& all, double rounding, double* f) {
  return all.columns_per_body == 3 ? PolishOf<3>(rounding, f) : PolishOf<6>(rounding, f);
}

double ProfilePivoting::Solve(const StepRows& all, std::span<const std::int32_t> part, const Request& request,
                              double* f) {
  return all.columns_per_body == 3 ? SolveOf<3>(all, part, request, f) : SolveOf<6>(all, part, request, f);
}

}  // namespace lcpbench
