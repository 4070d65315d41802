#include "solvers/friction/coulomb_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// Joints have no barrier: so much is added to their diagonal.
constexpr double kJointEps = 1e-9;
// The largest relative change of a part in a predictor, and in a correction of the second order.
constexpr double kLargestChange = 0.8, kLargestCorrection = 1;
// A predictor has its full length where parts are off the path by at most 1 - kCalm of themselves, and none from 1 on.
constexpr double kCalm = 0.7;
// Steps keep this part of what is positive.
constexpr double kKept = 0.1;
// A path that does not come nearer for so many steps, by rows, winds through folds; near an answer it may take twice as
// many. It leaves the rest of the time to other methods.
constexpr int kRowsPerStep = 8, kLeastPatience = 40, kMostPatience = 200;
constexpr double kNearAnswer = 1e-3, kShareOfTime = 2.0 / 3;
// A path that is as far from the answer as that has come back.
constexpr double kFarthest = 1e3;
constexpr double kNearest = 1e-15;  // rounding
// Modes are tried from this rho on, and again where it has fallen by this factor.
constexpr double kWorthModes = 3e-2, kFallOfRho = 0.25;

}  // namespace

// A mean over contacts: joints come first, and have no parts.
double CoulombPath::Compare(const Parts& a, const Parts& b) const {
  const Index contacts = std::ssize(places_) - joints_;
  return (a.bottomRows(contacts) * b.bottomRows(contacts) / parts_.bottomRows(contacts).square()).sum() /
         static_cast<double>(contacts);
}

double CoulombPath::Largest(const Parts& change) const {
  const Index contacts = std::ssize(places_) - joints_;
  return (change.bottomRows(contacts) / parts_.bottomRows(contacts)).abs().maxCoeff();
}

bool CoulombPath::Follow(const ContactRows& rows, int steps, ModeSteps* newton, PaddedVector* phi,
                         FrictionAnswer* answer) {
  if (!rows.can_relax() || rows.laws().normals.empty() || rows.OnBodies() == nullptr || rows.OnBodies()->cols() == 0) {
    return false;
  }
  Start(rows);
  const double enough = (1 - kShareOfTime) * answer->Remaining();
  const auto few = static_cast<int>(std::clamp<Index>(rows.size() / kRowsPerStep, kLeastPatience, kMostPatience));
  double halved = std::numeric_limits<double>::infinity();
  for (int step = 0, last = 0; step < steps && !answer->IsOver(); ++step) {
    ++answer->iterations();
    ComputeRest(rows);
    if (TryModes(rows, newton, phi, answer)) return true;
    if (rho_ < halved / 2) {
      halved = rho_;
      last = step;
    }
    const int patience = halved > kNearAnswer ? few : 2 * few;
    const bool is_under_way = kappa_ > kNearest && kappa_ < kFarthest && step - last < patience;
    if (!is_under_way || answer->Remaining() < enough || !Factorize() || !Advance()) return false;
  }
  return false;
}

void CoulombPath::Start(const ContactRows& rows) {
  const Laws laws = rows.laws();
  const SparseMatrix& G = *rows.OnBodies();
  places_.clear();
  joints_ = std::ssize(laws.joints);
  for (const Index row : laws.joints) places_.push_back({.normal = row, .is_joint = true});
  for (const Index row : laws.normals) {
    Place place{.normal = row};
    for (const FrictionRow& friction : rows.FrictionOf(row)) {
      if (!CanStick(friction)) continue;
      place.tangent = friction.row;
      place.mu = friction.mu;
    }
    places_.push_back(place);
  }
  columns_.clear(), normal_.clear(), tangent_.clear();
  std::size_t block = 0;
  for (Place& place : places_) {
    place.first = columns_.size();
    place.block = block;
    const auto add = [&](Index row, std::vector<double>* values) {
      if (row < 0) return;
      for (SparseMatrix::InnerIterator g(G, row); g; ++g) {
        const auto begin = columns_.begin() + static_cast<std::ptrdiff_t>(place.first);
        const auto at =
            static_cast<std::size_t>(std::find(begin, columns_.end(), static_cast<int>(g.col())) - columns_.begin());
        if (at == columns_.size()) {
          columns_.push_back(static_cast<int>(g.col()));
          normal_.push_back(0), tangent_.push_back(0);
        }
        (*values)[at] = g.value();
      }
    };
    add(place.normal, &normal_);
    add(place.tangent, &tangent_);
    place.entries = columns_.size() - place.first;
    block += place.entries * place.entries;
  }
  SetPattern(G.cols());

  const Index n = rows.size(), count = std::ssize(places_);
  scale_ = std::max(rows.b().lpNorm<Eigen::Infinity>(), std::numeric_limits<double>::min());
  kappa_ = 1;
  least_rho_ = kWorthModes / kFallOfRho;
  for (PaddedVector* const numbers : {&phi_, &gaps_}) numbers->Lengthen(n);
  phi_.head(n).setZero();
  parts_.setOnes(count, kParts);
  pairs_.setOnes(count, kParts / 2);
  first_rest_.setZero(count, 2);
  for (Index k = 0; k < count; ++k) {
    const Place& place = places_[At(k)];
    if (place.is_joint) pairs_(k, 0) = 0;
    if (place.tangent < 0) pairs_.row(k).tail<2>().setZero();
    if (place.tangent < 0) continue;
    parts_(k, kUpperCone) = parts_(k, kLowerCone) = place.mu;
    parts_(k, kForward) = parts_(k, kBackward) = 1 / place.mu;
  }
  ComputeRest(rows);
  first_rest_ = rest_;
}

// I and the squares of the places: where each of their entries is among the values.
void CoulombPath::SetPattern(Index columns) {
  std::vector<Eigen::Triplet<double, int>> entries;
  for (int k = 0; k < columns; ++k) entries.emplace_back(k, k, 0);
  const auto visit = [&](const auto& each) {
    for (const Place& place : places_) {
      for (std::size_t i = 0; i < place.entries; ++i) {
        for (std::size_t j = 0; j < place.entries; ++j) {
          each(place.block + i * place.entries + j, columns_[place.first + i], columns_[place.first + j]);
        }
      }
    }
  };
  visit([&](std::size_t /*at*/, int row, int column) { entries.emplace_back(row, column, 0); });
  K_.resize(columns, columns);
  K_.setFromTriplets(entries.begin(), entries.end());
  positions_.resize(entries.size() - At(columns));
  visit([&](std::size_t at, int row, int column) {
    const int* const begin = K_.innerIndexPtr() + K_.outerIndexPtr()[column];
    const int* const end = K_.innerIndexPtr() + K_.outerIndexPtr()[column + 1];
    positions_[at] = static_cast<int>(std::lower_bound(begin, end, row) - K_.innerIndexPtr());
  });
  lu_.SetPattern(K_);
}

// What the equations are off by, beyond what the path at kappa has; phi_, gaps_ and rho_ of the point.
void CoulombPath::ComputeRest(const ContactRows& rows) {
  const Index count = std::ssize(places_);
  for (Index k = 0; k < count; ++k) {
    const Place& place = places_[At(k)];
    if (!place.is_joint) phi_[place.normal] = scale_ * parts_(k, kForce);
    if (place.tangent >= 0) phi_[place.tangent] = scale_ / 2 * (parts_(k, kUpperCone) - parts_(k, kLowerCone));
  }
  rows.ComputeGaps(phi_, &gaps_);
  rho_ = rows.Rho(phi_, gaps_);
  rest_.setZero(count, 2);
  products_ = (kappa_ - parts_.leftCols<kParts / 2>() * parts_.rightCols<kParts / 2>()) * pairs_;
  for (Index k = 0; k < count; ++k) {
    const Place& place = places_[At(k)];
    rest_(k, 0) = (place.is_joint ? 0 : parts_(k, kOpening)) - gaps_[place.normal] / scale_;
    if (place.tangent >= 0) {
      rest_(k, 1) = parts_(k, kForward) - parts_(k, kBackward) - gaps_[place.tangent] / scale_;
    }
  }
  rest_ -= kappa_ * first_rest_;
}

bool CoulombPath::TryModes(const ContactRows& rows, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer) {
  constexpr ModeSteps::Limits kFew{.steps = 2, .eps = 1e-8};
  if (!(rho_ < kFallOfRho * least_rho_)) return false;
  least_rho_ = rho_;
  phi->Lengthen(rows.size());
  phi->head(rows.size()) = phi_.head(rows.size());
  return newton->TakeDampedSteps(rows, kFew, phi, answer);
}

// K = I + G^T D^-1 G, with D = -dv/dphi: (D + G G^T) d = r is d = D^-1 (r - G u), K u = G^T
// D^-1 r.
bool CoulombPath::Factorize() {
  const Index count = std::ssize(places_);
  inverse_.setZero(count, 3);
  double* const value = K_.valuePtr();
  std::fill_n(value, K_.nonZeros(), 0.0);
  for (Index k = 0; k < K_.cols(); ++k) K_.coeffRef(k, k) = 1;
  for (Index k = 0; k < count; ++k) {
    const Place& place = places_[At(k)];
    const double nn = place.is_joint ? kJointEps : parts_(k, kOpening) / parts_(k, kForce);
    inverse_(k, 0) = 1 / nn;
    if (place.tangent >= 0) {
      const double upper = parts_(k, kForward) / parts_(k, kUpperCone);
      const double lower = parts_(k, kBackward) / parts_(k, kLowerCone);
      inverse_(k, 2) = 1 / (upper + lower);
      inverse_(k, 1) = -place.mu * (upper - lower) / nn * inverse_(k, 2);
    }
    const double* const g = normal_.data() + place.first;
    const double* const t = tangent_.data() + place.first;
    const int* position = positions_.data() + place.block;
    for (std::size_t i = 0; i < place.entries; ++i) {
      const double of_normal = g[i] * inverse_(k, 0) + t[i] * inverse_(k, 1), of_tangent = t[i] * inverse_(k, 2);
      for (std::size_t j = 0; j < place.entries; ++j) value[*position++] += of_normal * g[j] + of_tangent * t[j];
    }
  }
  return lu_.FactorizeValues(K_);
}

// The change that takes up these products and rests, by the factor.
void CoulombPath::Solve(const Products& products, const Rest& rest, Parts* change) const {
  const Index count = std::ssize(places_);
  Rest right = rest;
  right.col(0) += products.col(0) / parts_.col(kForce);
  right.col(1) += products.col(1) / parts_.col(kUpperCone) - products.col(2) / parts_.col(kLowerCone);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(K_.cols());
  const auto visit = [&](const auto& each) {
    for (Index k = 0; k < count; ++k) {
      const Place& place = places_[At(k)];
      each(k, place, columns_.data() + place.first, normal_.data() + place.first, tangent_.data() + place.first);
    }
  };
  visit([&](Index k, const Place& place, const int* column, const double* g, const double* t) {
    const double of_normal = inverse_(k, 0) * right(k, 0);
    const double of_tangent = inverse_(k, 1) * right(k, 0) + inverse_(k, 2) * right(k, 1);
    for (std::size_t i = 0; i < place.entries; ++i) u[column[i]] += g[i] * of_normal + t[i] * of_tangent;
  });
  u = lu_.Solve(u);
  change->setZero(count, kParts);
  visit([&](Index k, const Place& place, const int* column, const double* g, const double* t) {
    double normal = right(k, 0), tangent = right(k, 1);
    for (std::size_t i = 0; i < place.entries; ++i) {
      normal -= g[i] * u[column[i]];
      tangent -= t[i] * u[column[i]];
    }
    auto of = change->row(k);
    of[kForce] = inverse_(k, 0) * normal;
    if (place.is_joint) return;
    of[kOpening] = (products(k, 0) - parts_(k, kOpening) * of[kForce]) / parts_(k, kForce);
    if (place.tangent < 0) return;
    const double of_tangent = inverse_(k, 1) * normal + inverse_(k, 2) * tangent;
    of[kUpperCone] = place.mu * of[kForce] + of_tangent;
    of[kLowerCone] = place.mu * of[kForce] - of_tangent;
    of[kForward] = (products(k, 1) - parts_(k, kForward) * of[kUpperCone]) / parts_(k, kUpperCone);
    of[kBackward] = (products(k, 2) - parts_(k, kBackward) * of[kLowerCone]) / parts_(k, kLowerCone);
  });
}

// A step along the path, and back towards it across the path, in relative changes of parts and kappa.
bool CoulombPath::Advance() {
  const double down = lu_.has_negative_determinant() ? 1 : -1;  // of log kappa
  Parts change, along, second;
  Solve(products_, rest_, &change);
  Solve(kappa_ * pairs_, -kappa_ * first_rest_, &along);  // by log kappa
  const double length = Compare(along, along) + 1;
  const double back = -Compare(along, change) / length;
  const double off = Largest(change + back * along);
  if (!std::isfinite(off) || !std::isfinite(length)) return false;
  // Where the path is far, all of the step is towards it.
  const double towards = std::min(1.0, (1 - kKept) / off);
  const double onward = kLargestChange / std::max(Largest(along), 1.0) * std::clamp((1 - off) / kCalm, 0.0, 1.0);
  double log_kappa = towards * back + down * onward;
  change = towards * change + log_kappa * along;
  Solve(-change.leftCols<kParts / 2>() * change.rightCols<kParts / 2>(), Rest::Zero(rest_.rows(), 2), &second);
  second += log_kappa * log_kappa / 2 * along;  // kappa's own second order
  const double of_second = -Compare(along, second) / length;
  second += of_second * along;
  if (Largest(second) < kLargestCorrection) {
    change += second;
    log_kappa += of_second;
  }
  const Index contacts = std::ssize(places_) - joints_;
  const double least = (change.bottomRows(contacts) / parts_.bottomRows(contacts)).minCoeff();
  const double part = std::min(1.0, (1 - kKept) / std::max(-least, std::numeric_limits<double>::min()));
  parts_.bottomRows(contacts) += part * change.bottomRows(contacts);
  for (Index k = 0; k < joints_; ++k) phi_[places_[At(k)].normal] += scale_ * part * change(k, kForce);
  kappa_ *= std::exp(part * log_kappa);
  return std::isfinite(kappa_);
}

}  // namespace lcpbench
