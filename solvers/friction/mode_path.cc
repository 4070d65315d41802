#include "solvers/friction/mode_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The factor is made anew after so many crossings, and after one with a smaller pivot.
constexpr std::size_t kMostCrossings = 100;
constexpr double kSmallPivot = 1e-6;
// Slower approaches to a wall are rounding.
constexpr double kLeastRate = 1e-13;
// The first eps of proximal points, its limits, and its factors: after a path that does not reach its end, after one of
// few crossings, and after one of many.
constexpr double kFirstEps = 1e-2, kLeastEps = 1e-13, kMostEps = 10;
constexpr double kAfterFailure = 2, kAfterFew = 0.3, kAfterMany = 0.9;
constexpr std::int64_t kFewCrossings = 40;
// Paths that wander are given up after so many crossings, or this part of the rows.
constexpr int kMostOfPath = 120;
constexpr double kMostPerRow = 0.1;
// rho of a point whose modes may be the answer's.
constexpr double kWorthPolishing = 1e-6;

}  // namespace

// phi_ = P(x_) in the present modes.
void ModePath::ForcesOf(const ContactRows& rows) {
  phi_.setZero();
  for (const Index i : rows.joints()) phi_[i] = x_[i];
  std::size_t place = 0;
  for (const ContactRows::Contact& contact : rows.contacts()) {
    const RowMode mode = modes_[place++];
    if (mode == RowMode::kOpen) continue;
    phi_[contact.normal] = x_[contact.normal];
    if (contact.tangent < 0) continue;
    phi_[contact.tangent] =
        mode == RowMode::kStick ? x_[contact.tangent] : -SlipOf(mode, contact.slip) * contact.mu * x_[contact.normal];
  }
  for (const ContactRows::Bounded& row : rows.bounded()) {
    const RowMode mode = modes_[place++];
    phi_[row.row] = mode == RowMode::kUp ? row.lower : mode == RowMode::kDown ? row.upper : x_[row.row];
  }
}

void ModePath::ComputeNormalMap(const ContactRows& rows, Eigen::VectorXd* value) {
  ForcesOf(rows);
  rows.ComputeGaps(phi_, &gaps_);
  *value = gaps_.head(rows.size()) + eps_ * (phi_ - center_) - phi_ + x_;
}

// y -> N'^-1 y.
void ModePath::Solve(const ContactRows& rows, Eigen::VectorXd* y) {
  factor_.SolveEquations(rows, *y, &phi_);
  for (Index i = 0; i < rows.size(); ++i) {
    if (factor_.IsUnknown(i)) {
      (*y)[i] = phi_[i];
    } else {
      (*y)[i] += phi_[i] - eps_ * phi_[i];
      rows.VisitRow(i, [&](Index j, double a) { (*y)[i] -= a * phi_[j]; });
    }
  }
  for (std::size_t k = 0; k < crossings_.size(); ++k) {
    const double along = crossings_[k].Of(*y);
    if (along != 0) *y -= (along / crossings_[k].pivot) * columns_.col(static_cast<Index>(k));
  }
}

// The factor of the present modes; by it, x_ is brought back to the path at z, and the direction is found.
bool ModePath::Factorize(const ContactRows& rows, double z) {
  crossings_.clear();
  if (!factor_.Factorize(rows, modes_, eps_)) return false;
  ComputeNormalMap(rows, &column_);
  column_ -= z * start_;
  Solve(rows, &column_);
  x_ -= column_;
  direction_ = start_;
  Solve(rows, &direction_);
  return x_.allFinite() && direction_.allFinite();
}

ModePath::Wall ModePath::FirstWall(const ContactRows& rows, double sign) const {
  Wall first{0, RowMode::kOpen, kInfinity};
  std::size_t place = 0;
  // A wall is where `value`, which is >= 0 in the present mode, becomes 0.
  const auto look = [&](RowMode next, double value, double rate) {
    rate *= sign;
    if (rate >= -kLeastRate || std::max(value, 0.0) >= -rate * first.step) return;
    first = {place, next, std::max(value, 0.0) / -rate};
  };
  for (const ContactRows::Contact& contact : rows.contacts()) {
    const RowMode mode = modes_[place];
    const double normal = x_[contact.normal], of_normal = direction_[contact.normal];
    if (mode == RowMode::kOpen) {
      if (!contact.is_further) look(RowMode::kClosed, -normal, -of_normal);
    } else if (!contact.can_stick()) {
      if (!contact.is_further) look(RowMode::kOpen, normal, of_normal);
    } else {
      const double most = contact.mu * normal, of_most = contact.mu * of_normal;
      const double along = x_[contact.tangent], of_along = direction_[contact.tangent];
      if (mode == RowMode::kStick) {
        look(RowMode::kUp, most + along, of_most + of_along);
        look(RowMode::kDown, most - along, of_most - of_along);
      } else {
        const double side = mode == RowMode::kUp ? -1 : 1;
        look(RowMode::kStick, side * along - most, side * of_along - of_most);
        look(RowMode::kOpen, normal, of_normal);
      }
    }
    ++place;
  }
  for (const ContactRows::Bounded& row : rows.bounded()) {
    const double x = x_[row.row], rate = direction_[row.row];
    if (modes_[place] == RowMode::kStick) {
      if (std::isfinite(row.lower)) look(RowMode::kUp, x - row.lower, rate);
      if (std::isfinite(row.upper)) look(RowMode::kDown, row.upper - x, -rate);
    } else if (modes_[place] == RowMode::kUp) {
      look(RowMode::kStick, row.lower - x, -rate);
    } else {
      look(RowMode::kStick, x - row.upper, rate);
    }
    ++place;
  }
  return first;
}

// column_ += factor (A + eps - 1) e_row
void ModePath::AddColumn(const ContactRows& rows, Index row, double factor) {
  rows.VisitRow(row, [&](Index j, double a) { column_[j] += factor * a; });
  column_[row] += factor * (eps_ - 1);
}

// Changes the modes; column_: p.
ModePath::Crossing ModePath::Jump(const ContactRows& rows, const Wall& wall) {
  column_.setZero();
  const std::size_t count = rows.contacts().size();
  if (wall.place >= count) {
    const Index row = rows.bounded()[wall.place - count].row;
    AddColumn(rows, row, wall.next == RowMode::kStick ? 1 : -1);
    modes_[wall.place] = wall.next;
    return {row, -1, 0, 1};
  }
  const ContactRows::Contact& contact = rows.contacts()[wall.place];
  const RowMode before = modes_[wall.place];
  if (before != RowMode::kOpen && wall.next != RowMode::kOpen) {
    const bool sticks = wall.next == RowMode::kStick;
    AddColumn(rows, contact.tangent, sticks ? 1 : -1);
    modes_[wall.place] = wall.next;
    return {contact.tangent, contact.normal, SlipOf(sticks ? before : wall.next, contact.slip) * contact.mu, 1};
  }
  // All friction rows of a contact open and close together.
  const double factor = before == RowMode::kOpen ? 1 : -1;
  AddColumn(rows, contact.normal, factor);
  std::size_t place = wall.place;
  while (rows.contacts()[place].is_further) --place;
  for (; place < count && rows.contacts()[place].normal == contact.normal; ++place) {
    const ContactRows::Contact& part = rows.contacts()[place];
    RowMode& mode = modes_[place];
    const RowMode closed = !part.can_stick()          ? RowMode::kClosed
                           : before != RowMode::kOpen ? mode
                           : x_[part.tangent] < 0     ? RowMode::kUp
                                                      : RowMode::kDown;
    mode = before == RowMode::kOpen ? closed : RowMode::kOpen;
    if (part.tangent >= 0) AddColumn(rows, part.tangent, -factor * SlipOf(closed, part.slip) * part.mu);
  }
  return {contact.normal, -1, 0, 1};
}

// *sign: of dz along the path, which turns where the determinant changes its sign.
bool ModePath::Cross(const ContactRows& rows, const Wall& wall, double* sign) {
  Crossing crossing = Jump(rows, wall);
  Solve(rows, &column_);
  crossing.pivot = 1 + crossing.Of(column_);
  if (crossing.pivot == 0 || !column_.allFinite()) return false;
  columns_.col(std::ssize(crossings_)) = column_;
  crossings_.push_back(crossing);
  direction_ -= (crossing.Of(direction_) / crossing.pivot) * column_;
  if (crossing.pivot < 0) *sign = -*sign;
  return true;
}

// From *phi, the center. Whether the end is reached, which is *phi then.
bool ModePath::Follow(const ContactRows& rows, double eps, int most_crossings, Eigen::VectorXd* phi,
                      FrictionAnswer* answer) {
  const Index n = rows.size();
  eps_ = eps;
  for (Eigen::VectorXd* const numbers : {&phi_, &start_, &direction_, &column_}) numbers->resize(n);
  columns_.resize(n, static_cast<Index>(kMostCrossings));
  center_ = phi->head(n);
  rows.ComputeGaps(center_, &gaps_);
  x_ = center_ - gaps_.head(n);
  rows.FindModes(center_, gaps_, &modes_);
  ComputeNormalMap(rows, &start_);
  double z = 1, sign = -1;
  if (!Factorize(rows, z)) return false;
  for (int count = 0; count < most_crossings && !answer->IsOver(); ++count) {
    ++answer->iterations();
    const Wall wall = FirstWall(rows, sign);
    if (sign < 0 && z <= wall.step) {
      x_ -= z * direction_;
      ForcesOf(rows);
      *phi = phi_;
      return phi_.allFinite();
    }
    if (wall.step == kInfinity) return false;
    z += sign * wall.step;
    x_ += sign * wall.step * direction_;
    if (!Cross(rows, wall, &sign)) return false;
    const bool is_stale = crossings_.size() == kMostCrossings || std::abs(crossings_.back().pivot) < kSmallPivot;
    if (is_stale && !Factorize(rows, z)) return false;
  }
  return false;
}

bool ModePath::Approach(const ContactRows& rows, int points, ModeSteps* newton, Eigen::VectorXd* phi,
                        FrictionAnswer* answer) {
  const int most = std::max(kMostOfPath, static_cast<int>(kMostPerRow * static_cast<double>(rows.size())));
  double eps = kFirstEps;
  for (int point = 0; point < points && !answer->IsOver(); ++point) {
    const std::int64_t before = answer->iterations();
    if (!Follow(rows, eps, most, phi, answer)) {
      eps = std::min(kAfterFailure * eps, kMostEps);
      continue;
    }
    rows.ComputeGaps(*phi, &gaps_);
    const double rho = rows.Rho(*phi, gaps_);
    if (rho < kWorthPolishing && newton->Polish(rows, *phi, answer)) return true;
    if ((rho <= answer->tolerance() || rho < answer->rho()) && answer->Take(*phi, gaps_)) return true;
    const bool is_short = answer->iterations() - before < kFewCrossings;
    eps = std::max((is_short ? kAfterFew : kAfterMany) * eps, kLeastEps);
  }
  return false;
}

}  // namespace lcpbench
