#include "solvers/friction/normal_map_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "solvers/friction/relaxed_rows.h"
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
constexpr int kMostOfPath = 60;
constexpr double kMostPerRow = 0.03;
// rho of a point whose modes may be the answer's.
constexpr double kWorthPolishing = 1e-6;
// z below this part of where it started is 0: self-stresses at rest (b.f = 0) end there in rays.
constexpr double kVanished = 1e-12;

// In [0, 1), the same on every machine.
double Draw(std::minstd_rand* random) { return static_cast<double>((*random)()) * 0x1p-31; }

}  // namespace

void NormalMapPath::Reserve(Index max_rows) {
  factor_.Reserve(max_rows);
  for (PaddedVector* const numbers : {&center_, &x_, &phi_, &gaps_, &start_, &direction_, &column_}) {
    numbers->Lengthen(max_rows);
  }
  columns_.Lengthen(max_rows * static_cast<Index>(kMostCrossings));
  sides_.reserve(At(max_rows));
  friction_.reserve(At(max_rows));
  crossings_.reserve(kMostCrossings);
}

void NormalMapPath::Start(const ContactRows& rows, double eps) {
  Reserve(rows.size());
  eps_ = eps;
  friction_.assign(At(rows.size()), nullptr);
  for (const FrictionRow& row : rows.laws().friction) {
    friction_[At(row.row)] = &row;
    if (friction_[At(row.normal)] == nullptr) friction_[At(row.normal)] = &row;
  }
}

// phi_ = P(x_) of the present sides.
void NormalMapPath::ForcesOf(const ContactRows& rows) {
  const Laws laws = rows.laws();
  for (Index i = 0; i < rows.size(); ++i) phi_[i] = sides_[At(i)] == RangeSide::kInside ? x_[i] : 0;
  for (const FrictionRow& row : laws.friction) {
    const RangeSide side = sides_[At(row.row)];
    if (side != RangeSide::kInside) phi_[row.row] = SlopeOf(row, side) * phi_[row.normal];
  }
  for (const BoundedRow& row : laws.bounded) {
    const RangeSide side = sides_[At(row.row)];
    if (side != RangeSide::kInside) phi_[row.row] = side == RangeSide::kLower ? row.lower : row.upper;
  }
}

void NormalMapPath::ComputeNormalMap(const ContactRows& rows, PaddedVector* value) {
  ForcesOf(rows);
  rows.ComputeGaps(phi_, &gaps_);
  for (Index i = 0; i < rows.size(); ++i) {
    (*value)[i] = gaps_[i] + eps_ * (phi_[i] - center_[i]) - phi_[i] + x_[i];
  }
}

// y -> N'^-1 y.
void NormalMapPath::Solve(const ContactRows& rows, PaddedVector* y) {
  const Index n = rows.size();
  factor_.SolveEquations(rows, *y, &phi_);
  rows.Multiply(phi_, &gaps_);
  for (Index i = 0; i < n; ++i) {
    (*y)[i] = factor_.equations().IsUnknown(i) ? phi_[i] : (*y)[i] + (phi_[i] - eps_ * phi_[i] - gaps_[i]);
  }
  for (std::size_t k = 0; k < crossings_.size(); ++k) {
    const double along = crossings_[k].Of(*y);
    if (along != 0) y->head(n) -= (along / crossings_[k].pivot) * columns_.segment(static_cast<Index>(k) * n, n);
  }
}

// The factor of the present sides; by it, x_ is brought back to the path at z, and the direction is found.
bool NormalMapPath::Factorize(const ContactRows& rows, double z) {
  const Index n = rows.size();
  crossings_.clear();
  if (!factor_.Factorize(rows, sides_, eps_)) return false;
  ComputeNormalMap(rows, &column_);
  column_.head(n) -= z * start_.head(n);
  Solve(rows, &column_);
  x_.head(n) -= column_.head(n);
  direction_.head(n) = start_.head(n);
  Solve(rows, &direction_);
  return x_.head(n).allFinite() && direction_.head(n).allFinite();
}

// Calls test(row, next, value, rate) for every wall of the present sides: `value` is >= 0 inside, and 0 at the wall.
template <typename Test>
void NormalMapPath::VisitWalls(const ContactRows& rows, const Test& test) const {
  const Laws laws = rows.laws();
  const FrictionRow* const end = laws.friction.data() + laws.friction.size();
  for (const Index i : laws.normals) {
    // A contact that sticks slips before it opens.
    bool sticks = false;
    for (const FrictionRow* row = friction_[At(i)]; row != nullptr && row != end && row->normal == i; ++row) {
      sticks = sticks || sides_[At(row->row)] == RangeSide::kInside;
    }
    if (sticks) continue;
    const bool is_open = sides_[At(i)] == RangeSide::kLower;
    const double to = is_open ? -1 : 1;
    test(i, is_open ? RangeSide::kInside : RangeSide::kLower, to * x_[i], to * direction_[i]);
  }
  const auto visit = [&](Index i, double at_lower, double of_lower, double at_upper, double of_upper) {
    const double x = x_[i], rate = direction_[i];
    if (sides_[At(i)] == RangeSide::kInside) {
      if (at_lower > -kInfinity) test(i, RangeSide::kLower, x - at_lower, rate - of_lower);
      if (at_upper < kInfinity) test(i, RangeSide::kUpper, at_upper - x, of_upper - rate);
    } else if (sides_[At(i)] == RangeSide::kLower) {
      test(i, RangeSide::kInside, at_lower - x, of_lower - rate);
    } else {
      test(i, RangeSide::kInside, x - at_upper, rate - of_upper);
    }
  };
  for (const FrictionRow& row : laws.friction) {
    if (!CanStick(row) || sides_[At(row.normal)] == RangeSide::kLower) continue;
    const double most = row.mu * x_[row.normal], rate = row.mu * direction_[row.normal];
    visit(row.row, -most, -rate, most, rate);
  }
  for (const BoundedRow& row : laws.bounded) {
    if (row.lower < row.upper) visit(row.row, row.lower, 0, row.upper, 0);
  }
}

NormalMapPath::Wall NormalMapPath::FirstWall(const ContactRows& rows, double sign) const {
  Wall first{.step = kInfinity};
  VisitWalls(rows, [&](Index row, RangeSide next, double value, double rate) {
    rate *= sign;
    if (rate >= -kLeastRate || std::max(value, 0.0) >= -rate * first.step) return;
    first = {row, next, std::max(value, 0.0) / -rate};
  });
  return first;
}

// column_ += factor (A + eps - 1) e_row
void NormalMapPath::AddColumn(const ContactRows& rows, Index row, double factor) {
  rows.VisitRow(row, [&](Index j, double a) { column_[j] += factor * a; });
  column_[row] += factor * (eps_ - 1);
}

// Changes the sides; column_: p.
NormalMapPath::Crossing NormalMapPath::Jump(const ContactRows& rows, const Wall& wall) {
  column_.head(rows.size()).setZero();
  RangeSide& side = sides_[At(wall.row)];
  const RangeSide before = std::exchange(side, wall.next);
  const double factor = wall.next == RangeSide::kInside ? 1 : -1;
  AddColumn(rows, wall.row, factor);
  if (const FrictionRow* const row = friction_[At(wall.row)]; row != nullptr && row->row == wall.row) {
    return {row->row, row->normal, -SlopeOf(*row, factor > 0 ? before : wall.next), 1};
  }
  // All friction rows of a contact open and close together.
  for (const FrictionRow& row : rows.FrictionOf(wall.row)) {
    RangeSide& of_row = sides_[At(row.row)];
    if (CanStick(row) && factor > 0) of_row = x_[row.row] < 0 ? RangeSide::kLower : RangeSide::kUpper;
    AddColumn(rows, row.row, factor * SlopeOf(row, of_row));
    if (factor < 0) of_row = RangeSide::kLower;
  }
  return {wall.row, -1, 0, 1};
}

// *sign: of dz along the path, which turns where the determinant changes its sign.
bool NormalMapPath::Cross(const ContactRows& rows, const Wall& wall, double* sign) {
  const Index n = rows.size();
  Crossing crossing = Jump(rows, wall);
  Solve(rows, &column_);
  crossing.pivot = 1 + crossing.Of(column_);
  if (crossing.pivot == 0 || !column_.head(n).allFinite()) return false;
  columns_.segment(std::ssize(crossings_) * n, n) = column_.head(n);
  crossings_.push_back(crossing);
  direction_.head(n) -= (crossing.Of(direction_) / crossing.pivot) * column_.head(n);
  if (crossing.pivot < 0) *sign = -*sign;
  return true;
}

// From x_ on the path at z, of whose sides the factor is. *phi: forces at the end, where it is reached.
NormalMapPath::End NormalMapPath::FollowFrom(const ContactRows& rows, double z, int most_crossings, PaddedVector* phi,
                                             FrictionAnswer* answer) {
  const Index n = rows.size();
  const double vanished = kVanished * z;
  double sign = -1;
  for (int count = 0; count < most_crossings && !answer->IsOver(); ++count) {
    ++answer->iterations();
    const Wall wall = FirstWall(rows, sign);
    const bool is_end = sign < 0 && z <= wall.step;
    if (is_end || (wall.row < 0 && z <= vanished)) {
      if (is_end) x_.head(n) -= z * direction_.head(n);
      ForcesOf(rows);
      phi->Lengthen(n);
      phi->head(n) = phi_.head(n);
      return phi_.head(n).allFinite() ? End::kReached : End::kSingular;
    }
    if (wall.row < 0) return End::kRay;
    z += sign * wall.step;
    x_.head(n) += sign * wall.step * direction_.head(n);
    if (!Cross(rows, wall, &sign)) return End::kSingular;
    const bool is_stale = crossings_.size() == kMostCrossings || std::abs(crossings_.back().pivot) < kSmallPivot;
    if (is_stale && !Factorize(rows, z)) return End::kSingular;
  }
  return End::kLimit;
}

// From *phi, the center, to the answer about it.
NormalMapPath::End NormalMapPath::FollowToCenter(const ContactRows& rows, double eps, int most_crossings,
                                                 PaddedVector* phi, FrictionAnswer* answer) {
  const Index n = rows.size();
  Start(rows, eps);
  center_.head(n) = phi->head(n);
  rows.ComputeGaps(center_, &gaps_);
  x_.head(n) = center_.head(n) - gaps_.head(n);
  rows.FindSides(center_, gaps_, &sides_);
  ComputeNormalMap(rows, &start_);
  return Factorize(rows, 1) ? FollowFrom(rows, 1, most_crossings, phi, answer) : End::kSingular;
}

bool NormalMapPath::ApproachByNewton(const ContactRows& rows, ModeSteps* newton, PaddedVector* phi,
                                     FrictionAnswer* answer) {
  constexpr int kFirstSweeps = 20, kSweeps = 50, kPoints = 100;
  return newton->Sweep(rows, kFirstSweeps, phi, answer) ||
         newton->TakeDampedSteps(rows, {.sweeps = kSweeps}, phi, answer) ||
         Approach(rows, kPoints, newton, phi, answer);
}

bool NormalMapPath::Approach(const ContactRows& rows, int points, ModeSteps* newton, PaddedVector* phi,
                             FrictionAnswer* answer) {
  const int most = std::max(kMostOfPath, static_cast<int>(kMostPerRow * static_cast<double>(rows.size())));
  double eps = kFirstEps;
  for (int point = 0; point < points && !answer->IsOver(); ++point) {
    const std::int64_t before = answer->iterations();
    end_ = FollowToCenter(rows, eps, most, phi, answer);
    if (end_ != End::kReached) {
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

// start_ = -d, and the sides at large z: contacts open, bounded rows at a bound, joints inside, d = 0 there.
void NormalMapPath::DrawCover(const ContactRows& rows, unsigned seed) {
  std::minstd_rand random(seed + 1);
  const Laws laws = rows.laws();
  start_.head(rows.size()).setZero();
  sides_.assign(At(rows.size()), RangeSide::kInside);
  for (const Index i : laws.normals) {
    sides_[At(i)] = RangeSide::kLower;
    start_[i] = -1 - Draw(&random);
  }
  for (const FrictionRow& row : laws.friction) {
    sides_[At(row.row)] = RangeSide::kLower;
    start_[row.row] = (Draw(&random) - 0.5) * start_[row.normal] / std::max(row.mu, 1.0);
  }
  for (const BoundedRow& row : laws.bounded) {
    const double drawn = 1 + Draw(&random);
    const bool has_lower = std::isfinite(row.lower), has_upper = std::isfinite(row.upper);
    if (!has_lower && !has_upper) continue;
    const bool is_at_lower = has_lower && (!has_upper || Draw(&random) < 0.5);
    sides_[At(row.row)] = is_at_lower ? RangeSide::kLower : RangeSide::kUpper;
    start_[row.row] = is_at_lower ? -drawn : drawn;
  }
}

NormalMapPath::End NormalMapPath::FollowCover(const ContactRows& rows, unsigned seed, double eps, PaddedVector* phi,
                                              FrictionAnswer* answer) {
  const Index n = rows.size();
  Start(rows, eps);
  DrawCover(rows, seed);
  center_.head(n).setZero();
  x_.head(n).setZero();
  if (!Factorize(rows, 0)) return End::kSingular;
  // The least z at which these are the sides.
  double z = 0;
  VisitWalls(rows, [&](Index /*row*/, RangeSide /*next*/, double value, double rate) {
    if (value < 0 && rate > 0) z = std::max(z, -value / rate);
  });
  x_.head(n) += z * direction_.head(n);
  const End end = FollowFrom(rows, z, static_cast<int>(50 * n + 1000), phi, answer);
  // What rounding of crossings has left.
  if (end == End::kReached && !crossings_.empty() && Factorize(rows, 0)) {
    ForcesOf(rows);
    phi->head(n) = phi_.head(n);
  }
  return end;
}

bool NormalMapPath::Cover(const ContactRows& rows, unsigned seeds, ModeSteps* newton, PaddedVector* phi,
                          FrictionAnswer* answer) {
  constexpr ModeSteps::Limits kAfterwards{.steps = 15, .eps = 1e-8};
  for (const double eps : {0.0, 1e-7, 1e-10}) {
    for (unsigned seed = 0; seed < seeds && !answer->IsOver(); ++seed) {
      end_ = FollowCover(rows, seed, eps, phi, answer);
      if (end_ != End::kReached) continue;
      if (answer->Take(*phi) || newton->Polish(rows, *phi, answer)) return true;
      if (eps > 0 && newton->TakeDampedSteps(rows, kAfterwards, phi, answer)) return true;
    }
  }
  return false;
}

class ModeLemkeEngine {
 public:
  explicit ModeLemkeEngine(const ModeLemkeOptions& /*options*/) {}
  static constexpr bool kTakesFriction = true;
  static constexpr bool kTakesBounded = true;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    const std::string why = WhyNotPlanar(problem, true);
    return why.empty() ? WhyNotSymmetric(problem) : why;
  }
  void Prepare(const LcpProblem& problem) {
    rows_.Prepare(problem);
    newton_.Reset();
  }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    constexpr unsigned kSeeds = 3;
    constexpr const char* kWhy[] = {"rounding: the end of the path does not pass", "secondary ray",
                                    "rounding spoils the equations", "limit of crossings"};
    rows_.SetB(problem);
    FrictionAnswer answer(rows_, &problem, options, result);
    if (path_.Cover(rows_, kSeeds, &newton_, &phi_, &answer)) return;
    answer.Fail(kWhy[static_cast<int>(path_.end())]);
  }

 private:
  ContactRows rows_;
  NormalMapPath path_;
  ModeSteps newton_;
  PaddedVector phi_;
};

template class EngineSolver<ModeLemkeOptions, ModeLemkeEngine>;

}  // namespace lcpbench
