#include "solvers/friction/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/lcp/engine_solver.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// As the verifier's: defects up to this part of a contact's loads count as none, rho is relative to no less than that
// part of all loads.
constexpr double kPartOfLoad = 0x1p-46;
constexpr double kLeastScale = 0x1p-20;
// Roundings of a sum over a row, beside one for each term.
constexpr double kTermsBesideRows = 64;

// Up to so many rows the dense A is formed sooner than the sparse one.
constexpr Index kFewRows = 100;

double Square(double x) { return x * x; }

}  // namespace

std::string ContactRows::WhyUnsupported(const LcpProblem& problem) {
  std::vector<Index> normals;
  for (const FrictionRow& row : problem.friction_rows()) normals.push_back(row.normal);
  std::ranges::sort(normals);
  if (std::ranges::adjacent_find(normals) != normals.end()) return "several friction rows of one contact";
  return WhyNotSymmetric(problem);
}

void ContactRows::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  on_bodies_.resize(0, 0);
  const Index n = problem.size();
  const Eigen::VectorXd& diagonal = problem.DiagonalA();
  root_.assign(At(n), 1);
  inverse_root_.resize(At(n));
  for (Index i = 0; i < n; ++i) {
    if (diagonal[i] > 0) root_[At(i)] = std::sqrt(diagonal[i]);
    inverse_root_[At(i)] = 1 / root_[At(i)];
  }
  TakeMatrix(problem);
  // The friction rows of a normal row are a list: first_[normal], next_[tangent], ...
  const std::vector<FrictionRow>& friction = problem.friction_rows();
  first_.assign(At(n), -1);
  next_.assign(friction.size(), -1);
  kind_.assign(At(n), RowKind::kUnilateral);
  is_sliding_ = false;
  is_paired_ = true;
  for (Index k = static_cast<Index>(friction.size()) - 1; k >= 0; --k) {
    const FrictionRow& row = friction[At(k)];
    next_[At(k)] = std::exchange(first_[At(row.normal)], k);
    is_paired_ = is_paired_ && next_[At(k)] < 0;
    kind_[At(row.row)] = RowKind::kFriction;
    is_sliding_ = is_sliding_ || row.slip != 0;
  }
  bounded_.clear();
  for (const BoundedRow& row : problem.bounded_rows()) {
    bounded_.push_back({row.row, row.lower * root_[At(row.row)], row.upper * root_[At(row.row)]});
    kind_[At(row.row)] = RowKind::kBounded;
  }
  joints_ = problem.bilateral_rows();
  for (const Index i : joints_) kind_[At(i)] = RowKind::kBilateral;
  contacts_.clear();
  for (Index i = 0; i < n; ++i) {
    if (kind_[At(i)] != RowKind::kUnilateral) continue;
    if (first_[At(i)] < 0) contacts_.push_back({i});
    for (Index k = first_[At(i)]; k >= 0; k = next_[At(k)]) {
      const FrictionRow& row = friction[At(k)];
      const double mu = row.mu * (root_[At(row.row)] / root_[At(i)]);
      contacts_.push_back({i, row.row, mu, row.mu, row.slip, k != first_[At(i)]});
    }
  }
  SetB(problem);
}

void ContactRows::TakeMatrix(const LcpProblem& problem) {
  const Index n = problem.size();
  start_.assign(1, 0);
  column_.clear();
  value_.clear();
  const auto add = [&](Index i, Index j, double value) {
    if (value == 0) return;
    column_.push_back(static_cast<int>(j));
    value_.push_back(value * inverse_root_[At(i)] * inverse_root_[At(j)]);
  };
  const bool is_dense = n <= kFewRows || problem.given_form() == MatrixForm::kDense;
  for (Index i = 0; i < n; ++i) {
    if (is_dense) {
      const Eigen::MatrixXd& A = problem.DenseA();
      for (Index j = 0; j < n; ++j) add(i, j, A(i, j));
    } else {
      for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) add(i, it.col(), it.value());
    }
    start_.push_back(static_cast<Index>(value_.size()));
  }
}

const SparseMatrix* ContactRows::OnBodies() const {
  if (!problem_->has_factors()) return nullptr;
  if (on_bodies_.cols() > 0) return &on_bodies_;
  const SparseMatrix& J = problem_->J();
  std::vector<int> place(At(J.cols()), -1);
  int columns = 0;
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index i = 0; i < size(); ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      const double entry = it.value() * inverse_root_[At(i)] * std::sqrt(problem_->inverse_mass()[it.col()]);
      if (entry == 0) continue;
      int& column = place[At(it.col())];
      if (column < 0) column = columns++;
      entries.emplace_back(static_cast<int>(i), column, entry);
    }
  }
  on_bodies_.resize(size(), columns);
  on_bodies_.setFromTriplets(entries.begin(), entries.end());
  return &on_bodies_;
}

void ContactRows::SetB(const LcpProblem& problem) {
  b_.resize(size());
  for (Index i = 0; i < size(); ++i) b_[i] = problem.b()[i] / root_[At(i)];
  double plain = 0, answered = 0, all = 0;
  for (const Index i : joints_) plain += Square(b_[i]);
  for (const Contact& contact : contacts_) plain += contact.is_further ? 0 : Square(b_[contact.normal]);
  all = plain;
  for (const Bounded& row : bounded_) {
    plain += std::min(Square(b_[row.row]), Square(std::max(std::abs(row.lower), std::abs(row.upper))));
    all += Square(b_[row.row]);
  }
  for (const Contact& contact : contacts_) {
    if (contact.tangent < 0 || contact.slip != 0) continue;
    answered += std::min(Square(b_[contact.tangent]), Square(contact.mu) * plain);
    all += Square(b_[contact.tangent]);
  }
  scale_ = std::max(std::sqrt(plain + answered), kLeastScale * std::sqrt(all));
  if (scale_ == 0) scale_ = 1;
}

void ContactRows::ComputeGaps(const Eigen::VectorXd& phi, Eigen::VectorXd* omega) const {
  omega->resize(size());
  for (Index i = 0; i < size(); ++i) (*omega)[i] = Gap(i, phi);
}

double ContactRows::Rho(const Eigen::VectorXd& phi, const Eigen::VectorXd& omega) const {
  double sum = 0;
  for (const Index i : joints_) sum += Square(omega[i]);
  for (const Contact& contact : contacts_) {
    const double normal = phi[contact.normal];
    if (!contact.is_further) sum += Square(std::min(normal, omega[contact.normal]));
    if (contact.tangent < 0) continue;
    const double along = phi[contact.tangent];
    if (contact.slip != 0) {
      sum += Square(along + contact.slip * contact.mu * normal);
    } else {
      const double most = contact.mu * std::max(normal, 0.0);
      sum += Square(along - std::clamp(along - omega[contact.tangent], -most, most));
    }
  }
  for (const Bounded& row : bounded_) {
    sum += Square(phi[row.row] - std::clamp(phi[row.row] - omega[row.row], row.lower, row.upper));
  }
  return std::sqrt(sum) / scale_;
}

RowMode ContactRows::ModeOf(const Contact& contact, const Eigen::VectorXd& phi, const Eigen::VectorXd& omega) const {
  const double normal = phi[contact.normal] - omega[contact.normal];
  if (!(normal > 0)) return RowMode::kOpen;
  if (!contact.can_stick()) return RowMode::kClosed;
  const double along = phi[contact.tangent] - omega[contact.tangent];
  if (std::abs(along) <= contact.mu * normal) return RowMode::kStick;
  return along < 0 ? RowMode::kUp : RowMode::kDown;
}

void ContactRows::FindModes(const Eigen::VectorXd& phi, const Eigen::VectorXd& omega,
                            std::vector<RowMode>* modes) const {
  modes->clear();
  for (const Contact& contact : contacts_) modes->push_back(ModeOf(contact, phi, omega));
  for (const Bounded& row : bounded_) {
    const double trial = phi[row.row] - omega[row.row];
    modes->push_back(trial < row.lower ? RowMode::kUp : trial > row.upper ? RowMode::kDown : RowMode::kStick);
  }
}

void ContactRows::ToScaled(const Eigen::VectorXd& f, Eigen::VectorXd* phi) const {
  phi->resize(size());
  for (const Index i : joints_) (*phi)[i] = root_[At(i)] * f[i];
  for (const Contact& contact : contacts_) {
    const double normal = std::max(root_[At(contact.normal)] * f[contact.normal], 0.0);
    (*phi)[contact.normal] = normal;
    if (contact.tangent < 0) continue;
    const double most = contact.mu * normal;
    (*phi)[contact.tangent] = contact.slip != 0
                                  ? -contact.slip * most
                                  : std::clamp(root_[At(contact.tangent)] * f[contact.tangent], -most, most);
  }
  for (const Bounded& row : bounded_) {
    (*phi)[row.row] = std::clamp(root_[At(row.row)] * f[row.row], row.lower, row.upper);
  }
}

// The largest load of its rows.
double ContactRows::LoadOf(const Contact& contact) const {
  const double normal = std::abs(b_[contact.normal]);
  return contact.tangent < 0 ? normal : std::max(normal, std::abs(b_[contact.tangent]));
}

void ContactRows::ToForces(const Eigen::VectorXd& phi, const Eigen::VectorXd& omega, Eigen::VectorXd* f) const {
  f->setZero(size());
  for (const Index i : joints_) (*f)[i] = phi[i] / root_[At(i)];
  for (const Contact& contact : contacts_) {
    const RowMode mode = ModeOf(contact, phi, omega);
    const double along = contact.tangent < 0 ? 0 : phi[contact.tangent];
    const double least = kPartOfLoad * LoadOf(contact);
    if (mode == RowMode::kOpen || (phi[contact.normal] < least && std::abs(along) < least)) continue;
    const double normal = std::max(phi[contact.normal], 0.0) / root_[At(contact.normal)];
    (*f)[contact.normal] = normal;
    if (contact.tangent < 0) continue;
    const double most = contact.given_mu * normal;
    double& tangent = (*f)[contact.tangent];
    tangent = std::clamp(along / root_[At(contact.tangent)], -most, most);
    if (contact.slip != 0) tangent = -contact.slip * most;
    if (mode == RowMode::kUp) tangent = -most;
    if (mode == RowMode::kDown) tangent = most;
  }
  for (const Bounded& row : bounded_) {
    (*f)[row.row] = std::clamp(phi[row.row], row.lower, row.upper) / root_[At(row.row)];
  }
}

// Of a gap that is wrong by `defect`, or right by -defect, with its rounding on top.
double ContactRows::BackwardError(Index row, double defect) const {
  return std::max(defect + hidden_[row], 0.0) / magnitude_[row];
}

bool ContactRows::IsSurelyRight(const Eigen::VectorXd& f, double tolerance) const {
  const Index n = size();
  phi_.resize(n);
  magnitude_.resize(n);
  hidden_.resize(n);
  for (Index i = 0; i < n; ++i) phi_[i] = root_[At(i)] * f[i];
  omega_.resize(n);
  const double forces = phi_.lpNorm<1>();
  const double unit = (static_cast<double>(n) + kTermsBesideRows) * std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < n; ++i) {
    double sum = b_[i], size = std::abs(b_[i]);
    VisitRow(i, [&](Index j, double a) {
      sum += a * phi_[j];
      size += std::abs(a * phi_[j]);
    });
    omega_[i] = sum;
    magnitude_[i] = size;
    hidden_[i] = unit * (forces + size);
  }
  if (!(Rho(phi_, omega_) + hidden_.norm() / scale_ <= tolerance)) return false;
  double worst = 0;
  const auto raise = [&](double error) { worst = std::max(worst, error); };
  for (const Index i : joints_) raise(BackwardError(i, std::abs(omega_[i])));
  for (const Contact& contact : contacts_) {
    const double of_normal = omega_[contact.normal];
    raise(BackwardError(contact.normal, phi_[contact.normal] == 0 ? -of_normal : std::abs(of_normal)));
    if (!contact.can_stick()) continue;
    const double most = contact.given_mu * f[contact.normal], along = f[contact.tangent];
    if (most == 0 && along == 0) continue;
    const double gap = omega_[contact.tangent];
    const double stick = std::abs(along) <= most ? std::abs(gap) : kInfinity;
    const double up = along == -most ? -gap : kInfinity;
    const double down = along == most ? gap : kInfinity;
    raise(BackwardError(contact.tangent, std::min({stick, up, down})));
  }
  for (const Bounded& row : bounded_) {
    const double gap = omega_[row.row];
    const double at_lower = phi_[row.row] <= row.lower ? -gap : kInfinity;
    const double at_upper = phi_[row.row] >= row.upper ? gap : kInfinity;
    raise(BackwardError(row.row, std::min({std::abs(gap), at_lower, at_upper})));
  }
  return Square(worst) <= tolerance;
}

}  // namespace lcpbench
