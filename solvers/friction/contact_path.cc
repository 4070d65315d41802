#include "solvers/friction/contact_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <random>

#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Slower approaches to a wall are rounding.
constexpr double kLeastRate = 1e-11;
// Of a joint that depends on those before it, the share of its diagonal that is left.
constexpr double kDependent = 1e-10;
// The inverse is made anew after so many updates, and after one by a smaller pivot.
constexpr int kMostUpdates = 50;
constexpr double kSmallPivot = 1e-7;
// z below this part of where it started is 0: self-stresses at rest (b.f = 0) end there in rays.
constexpr double kVanished = 1e-12;

// In [0, 1), the same on every machine.
double Draw(std::mt19937* random) { return static_cast<double>((*random)()) * 0x1p-32; }

}  // namespace

double ContactPath::BoundOf(Index row) const {
  const State& state = Of(row);
  const auto at = std::ranges::lower_bound(rows_->bounded(), row, {}, &ContactRows::Bounded::row);
  return state.side > 0 ? at->lower : at->upper;
}

void ContactPath::Reserve(Index max_rows) {
  state_.reserve(At(max_rows));
  owner_.reserve(At(max_rows));
  position_.reserve(At(max_rows + 1));
  variable_.reserve(At(max_rows));
  room_.reserve(At((max_rows + 4) * max_rows));
  basis_.Reserve(max_rows);
}

void ContactPath::SetViews() {
  room_.resize(At((n_ + 4) * n_));
  double* at = room_.data();
  for (View<Eigen::VectorXd>* const view : {&cover_, &column_, &direction_, &value_}) {
    new (view) View<Eigen::VectorXd>(at, n_);
    at += n_;
  }
  new (&inverse_) View<Eigen::MatrixXd>(at, n_, n_);
}

void ContactPath::Start(const ContactRows& rows, unsigned seed) {
  rows_ = &rows;
  n_ = rows.size();
  SetViews();
  std::mt19937 random(seed + 1);
  state_.clear();
  owner_.assign(At(n_), -1);
  cover_.setZero();
  const auto own = [&](Index row) { owner_[At(row)] = static_cast<Index>(state_.size()); };
  for (const ContactRows::Contact& contact : rows.contacts()) {
    State state{.normal = contact.normal, .tangent = contact.tangent, .cell = Cell::kOpen};
    if (contact.can_stick()) state.mu = contact.mu;
    if (contact.slip != 0) state.along = -contact.slip * contact.mu;
    own(contact.normal);
    cover_[contact.normal] = 1 + Draw(&random);
    if (contact.tangent >= 0) {
      own(contact.tangent);
      cover_[contact.tangent] = (Draw(&random) - 0.5) * cover_[contact.normal] / std::max(contact.mu, 1.0);
    }
    state_.push_back(state);
  }
  for (const ContactRows::Bounded& row : rows.bounded()) {
    const double drawn = 1 + Draw(&random);
    const bool has_lower = std::isfinite(row.lower), has_upper = std::isfinite(row.upper);
    const bool is_at_lower = has_lower && (!has_upper || Draw(&random) < 0.5);
    own(row.row);
    if (has_lower || has_upper) cover_[row.row] = is_at_lower ? drawn : -drawn;
    state_.push_back({.span = row.upper - row.lower,
                      .cell = has_lower || has_upper ? Cell::kSlip : Cell::kDropped,
                      .side = is_at_lower ? 1 : -1});
  }
  for (const Index row : rows.joints()) {
    own(row);
    state_.push_back({.cell = Cell::kDropped});
  }
  inverse_.setZero();
  position_.resize(At(n_ + 1));
  variable_.resize(At(n_));
  for (Index i = 0; i < n_; ++i) {
    position_[At(i)] = variable_[At(i)] = i;
    const bool is_bound = Of(i).cell == Cell::kSlip;
    inverse_(i, i) = is_bound ? -Of(i).side : -1;
  }
  position_[At(n_)] = -1;
  StartJoints();
}

// The joints that do not depend on others enter the basis.
void ContactPath::StartJoints() {
  for (Index i = 0; i < n_; ++i) {
    if (Of(i).cell != Cell::kDropped) continue;
    Of(i).cell = Cell::kJoint;
    SetColumn(i);
    SetDirection();
    if (std::abs(direction_[i]) > kDependent) {
      Pivot(i);
    } else {
      Of(i).cell = Cell::kDropped;
    }
  }
}

void ContactPath::AddForce(Index row, double factor) {
  if (factor == 0) return;
  rows_->VisitRow(row, [&](Index j, double a) { column_[j] += factor * a; });
  column_[row] += factor * eps_;
}

// Of A phi - omega + z d, by the variable of a row, or z. A is symmetric: its row is its column.
void ContactPath::SetColumn(Index variable) {
  if (variable == n_) {
    column_ = cover_;
    return;
  }
  column_.setZero();
  const State& state = Of(variable);
  if (state.cell == Cell::kJoint) return AddForce(variable, 1);
  if (state.normal == variable && state.cell != Cell::kOpen) {
    AddForce(variable, 1);
    if (state.tangent >= 0) AddForce(state.tangent, state.mu > 0 ? -state.side * state.mu : state.along);
  } else if (state.normal != variable && state.cell == Cell::kStick) {
    AddForce(variable, state.side);
  } else {
    column_[variable] = state.normal == variable ? -1 : -state.side;
  }
}

// Of column_, of which few entries are not 0.
void ContactPath::SetDirection() {
  direction_.setZero();
  for (Index j = 0; j < n_; ++j) {
    if (column_[j] != 0) direction_ += column_[j] * inverse_.col(j);
  }
}

double ContactPath::ValueOf(Index variable) const {
  if (variable == entering_) return entered_;
  return position_[At(variable)] < 0 ? 0 : value_[position_[At(variable)]];
}

double ContactPath::DirectionOf(Index variable) const {
  if (variable == entering_) return 1;
  return position_[At(variable)] < 0 ? 0 : -direction_[position_[At(variable)]];
}

// The column whose solution is direction_ takes the place of that at `position`.
void ContactPath::Pivot(Index position) {
  const double pivot = direction_[position];
  direction_[position] -= 1;
  for (Index j = 0; j < n_; ++j) {
    const double factor = inverse_(position, j) / pivot;
    if (factor != 0) inverse_.col(j) -= factor * direction_;
  }
  direction_[position] += 1;
  updates_ = std::abs(pivot) < kSmallPivot ? kMostUpdates : updates_ + 1;
}

// Inverse and values from the variables of the basis.
bool ContactPath::Renew() {
  if (updates_ >= kMostUpdates) {
    basis_.Start(n_);
    for (Index p = 0; p < n_; ++p) {
      SetColumn(variable_[At(p)]);
      for (Index i = 0; i < n_; ++i) {
        if (column_[i] != 0) basis_.Add(i, p, column_[i]);
      }
    }
    if (!basis_.Factorize()) return false;
    inverse_.setIdentity();
    for (Index p = 0; p < n_; ++p) basis_.Solve(inverse_.col(p).data());
    updates_ = 0;
  }
  column_ = -rows_->b();
  for (const ContactRows::Bounded& row : rows_->bounded()) {
    if (Of(row.row).cell == Cell::kSlip || Of(row.row).cell == Cell::kStick) AddForce(row.row, -BoundOf(row.row));
  }
  value_.noalias() = inverse_ * column_;
  return value_.allFinite();
}

// Calls test(value, rate, is_far) for the walls that the variable of `row` may meet.
template <typename Test>
void ContactPath::VisitWalls(Index row, const Test& test) const {
  const State& state = Of(row);
  const double value = ValueOf(row), rate = DirectionOf(row);
  const bool is_bounded = state.normal < 0;
  switch (state.cell) {
    case Cell::kOpen:
    case Cell::kClosed:
      if (state.normal == row) test(value, rate, false);
      return;
    case Cell::kSlip:
      test(value, rate, false);
      return;
    case Cell::kStick:
      if (state.normal == row) return;
      test(value, rate, false);
      if (is_bounded && std::isfinite(state.span)) test(state.span - value, -rate, true);
      if (!is_bounded)
        test(2 * state.mu * ValueOf(state.normal) - value, 2 * state.mu * DirectionOf(state.normal) - rate, true);
      return;
    default:
      return;
  }
}

// row < 0: none.
ContactPath::Wall ContactPath::FirstWall() const {
  Wall first{.step = kInfinity};
  for (Index row = 0; row < n_; ++row) {
    VisitWalls(row, [&](double value, double rate, bool is_far) {
      if (rate >= -kLeastRate || std::max(value, 0.0) >= -rate * first.step) return;
      first = {row, is_far, std::max(value, 0.0) / -rate};
    });
  }
  return first;
}

// A force that sticks is told by its distance from the far wall from here on. The position that the entering variable
// then takes: -1 where the basis stays as it is.
Index ContactPath::FarWall(Index row) {
  State& state = Of(row);
  const bool is_bounded = state.normal < 0;
  const Index own = position_[At(row)], normal = is_bounded ? -1 : position_[At(state.normal)];
  state.side = -state.side;
  if (own >= 0) {
    inverse_.row(own) *= -1;
    direction_[own] *= -1;
    if (!is_bounded) {
      inverse_.row(own) += 2 * state.mu * inverse_.row(normal);
      direction_[own] += 2 * state.mu * direction_[normal];
    }
    return own;
  }
  // It is the entering variable itself.
  if (is_bounded) return -1;
  direction_ *= 2 * state.mu;
  direction_[normal] += 1;
  Pivot(normal);
  return -1;
}

// The entering variable comes into the basis, the one at the wall goes.
void ContactPath::Replace(const Wall& wall) {
  const Index position = wall.is_far ? FarWall(wall.row) : position_[At(wall.row)];
  if (position < 0) return;
  Pivot(position);
  variable_[At(position)] = entering_;
  position_[At(entering_)] = position;
  position_[At(wall.row)] = -1;
}

// Beyond the wall another variable of the same row enters.
void ContactPath::Cross(const Wall& wall) {
  State& state = Of(wall.row);
  entering_ = wall.row;
  if (state.normal != wall.row) {
    state.cell = state.cell == Cell::kStick ? Cell::kSlip : Cell::kStick;
  } else if (state.cell != Cell::kOpen) {
    state.cell = Cell::kOpen;
  } else if (!(state.mu > 0)) {
    state.cell = Cell::kClosed;
  } else {
    state.cell = Cell::kSlip;
    const Index tangent = position_[At(state.tangent)];
    if (value_[tangent] >= 0) return;
    state.side = -state.side;
    inverse_.row(tangent) *= -1;
    value_[tangent] *= -1;
  }
}

void ContactPath::GetForces(Eigen::VectorXd* phi) const {
  ContactRows::Lengthen(n_, phi);
  phi->head(n_).setZero();
  for (Index row = 0; row < n_; ++row) {
    const State& state = Of(row);
    if (state.cell == Cell::kJoint) {
      (*phi)[row] = ValueOf(row);
    } else if (state.normal < 0 && state.cell != Cell::kDropped) {
      (*phi)[row] = BoundOf(row) + (state.cell == Cell::kStick ? state.side * ValueOf(row) : 0);
    } else if (state.normal == row && state.cell != Cell::kOpen) {
      (*phi)[row] = ValueOf(row);
      if (state.tangent < 0) continue;
      const double stuck = state.cell == Cell::kStick ? ValueOf(state.tangent) : 0;
      (*phi)[state.tangent] =
          state.mu > 0 ? state.side * (stuck - state.mu * ValueOf(row)) : state.along * ValueOf(row);
    }
  }
}

ContactPath::End ContactPath::Follow(const ContactRows& rows, unsigned seed, double eps, FrictionAnswer* answer,
                                     Eigen::VectorXd* phi) {
  eps_ = eps;
  updates_ = 0;
  entering_ = -1;
  entered_ = 0;
  Start(rows, seed);
  if (!Renew()) return End::kSingular;
  // The least z at which all contacts may be open.
  entering_ = n_;
  direction_.noalias() = inverse_ * cover_;
  Wall first;
  for (Index row = 0; row < n_; ++row) {
    VisitWalls(row, [&](double value, double rate, bool is_far) {
      if (value < 0 && rate > 0 && -value > rate * first.step) first = {row, is_far, -value / rate};
    });
  }
  if (first.row < 0) {
    GetForces(phi);
    return End::kReached;
  }
  entered_ = first.step;
  value_ -= first.step * direction_;
  const double vanished = kVanished * first.step;
  const std::int64_t limit = 50 * n_ + 1000;
  for (std::int64_t pivot = 0; pivot < limit && !answer->IsOver(); ++pivot) {
    ++answer->iterations();
    Replace(first);
    const Index row = first.row;
    // Values by the new basis; the crossing variable is 0.
    entering_ = -1;
    entered_ = 0;
    if (!Renew()) return End::kSingular;
    Cross(first);
    SetColumn(row);
    SetDirection();
    const double z = ValueOf(n_), rate = DirectionOf(n_);
    first = FirstWall();
    if (rate < 0 && z <= -rate * first.step) {
      entered_ = z / -rate;
      value_ -= entered_ * direction_;
      GetForces(phi);
      return End::kReached;
    }
    if (first.row < 0) {
      if (z > vanished) return End::kRay;
      GetForces(phi);
      return End::kReached;
    }
    entered_ = first.step;
    value_ -= first.step * direction_;
  }
  return End::kLimit;
}

bool FollowPaths(const ContactRows& rows, unsigned seeds, ContactPath* path, ModeSteps* newton, Eigen::VectorXd* phi,
                 FrictionAnswer* answer, ContactPath::End* end) {
  constexpr double kEps = 1e-7;
  constexpr ModeSteps::Limits kAfterwards{.steps = 15, .eps = 1e-8};
  for (const double eps : {0.0, kEps}) {
    for (unsigned seed = 0; seed < seeds && !answer->IsOver(); ++seed) {
      *end = path->Follow(rows, seed, eps, answer, phi);
      if (*end != ContactPath::End::kReached) continue;
      if (answer->Take(*phi) || newton->Polish(rows, *phi, answer)) return true;
      if (eps > 0 && newton->Run(rows, kAfterwards, phi, answer)) return true;
    }
  }
  return false;
}

void ContactPathSolver::Prepare(const LcpProblem& problem) {
  rows_.Prepare(problem);
  newton_.Reset();
}

void ContactPathSolver::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  constexpr unsigned kSeeds = 3;
  rows_.SetB(problem);
  FrictionAnswer answer(rows_, &problem, options, result);
  ContactPath::End end = ContactPath::End::kLimit;
  if (FollowPaths(rows_, kSeeds, &path_, &newton_, &phi_, &answer, &end)) return;
  const char* const why[] = {"rounding: the end of the path does not pass", "secondary ray",
                             "rounding spoils the basis", "limit of pivots"};
  answer.Fail(why[static_cast<int>(end)]);
}

}  // namespace lcpbench
