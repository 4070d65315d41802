#include "solvers/friction/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/lcp/engine_solver.h"
#include "solvers/linear_algebra/vector_register.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Up to so many rows the dense A is formed sooner than the sparse one.
constexpr Index kFewRows = 100;

// Bodies in space have so many columns.
constexpr Index kMostColumnsPerBody = 6;

double Square(double x) { return ContactLaw::Square(x); }

}  // namespace

std::string ContactRows::WhyUnsupported(const LcpProblem& problem) {
  std::vector<Index> normals;
  for (const FrictionRow& row : problem.friction_rows()) normals.push_back(row.normal);
  std::ranges::sort(normals);
  if (std::ranges::adjacent_find(normals) != normals.end()) return "several friction rows of one contact";
  return WhyNotSymmetric(problem);
}

void ContactRows::Reserve(Index max_rows, Index max_bodies) {
  start_.reserve(At(max_rows) + 1);
  for (std::vector<Index>* const numbers : {&end_, &first_of_register_, &end_of_register_}) {
    numbers->reserve(At(max_rows));
  }
  Lengthen(PaddedStride(max_rows) * max_rows, &dense_);
  jacobian_.reserve(At(2 * kMostColumnsPerBody * max_rows));
  sides_.Reserve(max_rows, max_bodies);
  for (std::vector<double>* const numbers : {&root_, &inverse_root_}) numbers->reserve(At(max_rows));
  for (std::vector<Index>* const numbers : {&first_, &next_, &joints_}) numbers->reserve(At(max_rows));
  kind_.reserve(At(max_rows));
  contacts_.reserve(At(max_rows));
  bounded_.reserve(At(max_rows));
  for (Eigen::VectorXd* const numbers : {&b_, &phi_, &omega_, &magnitude_, &hidden_}) Lengthen(max_rows, numbers);
}

void ContactRows::SetRoots(Index n, const double* diagonal, Index stride) {
  root_.assign(At(n), 1);
  inverse_root_.resize(At(n));
  for (Index i = 0; i < n; ++i) {
    if (diagonal[i * stride] > 0) root_[At(i)] = std::sqrt(diagonal[i * stride]);
    inverse_root_[At(i)] = 1 / root_[At(i)];
  }
}

void ContactRows::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  on_bodies_.resize(0, 0);
  SetRoots(problem.size(), problem.DiagonalA().data(), 1);
  TakeMatrix(problem);
  joints_ = problem.bilateral_rows();
  SetLaws(problem.friction_rows(), problem.bounded_rows());
  SetB(problem);
}

void ContactRows::Prepare(const StepRows& step, std::span<const std::int32_t> part,
                          std::span<const FrictionRow> friction, std::span<const BoundedRow> bounded) {
  problem_.reset();
  const Index n = std::ssize(part);
  WithNumbers(step, [&](const auto* J, auto p) { Assemble<p>(step, J, part); });
  SetRoots(n, dense_.data(), stride_ + 1);
  joints_.clear();
  Lengthen(n, &b_);
  b_.segment(n, stride_ - n).setZero();
  for (Index i = 0; i < n; ++i) {
    double* const row = dense_.data() + i * stride_;
    for (Index j = start_[At(i)]; j < end_[At(i)]; ++j) row[j] *= inverse_root_[At(i)] * inverse_root_[At(j)];
    const std::int32_t given = part[At(i)];
    b_[i] = step.b[given] * inverse_root_[At(i)];
    if (step.bilateral != nullptr && step.bilateral[given] != 0) joints_.push_back(i);
  }
  SetLaws(friction, bounded);
  SetScale();
}

// A by the bodies that rows share, as SmallPivoting has it.
template <Index p, typename Real>
void ContactRows::Assemble(const StepRows& step, const Real* J, std::span<const std::int32_t> part) {
  const Index n = std::ssize(part);
  is_dense_ = true;
  stride_ = PaddedStride(n);
  Lengthen(stride_ * n, &dense_);
  dense_.head(stride_ * n).setZero();
  start_.resize(At(n));
  end_.resize(At(n));
  jacobian_.resize(At(2 * p * n));
  sides_.Reserve(n, step.bodies);
  for (Index i = 0; i < n; ++i) {
    const Index given = part[At(i)];
    double* const own = jacobian_.data() + 2 * p * i;
    for (Index c = 0; c < 2 * p; ++c) own[c] = static_cast<double>(J[2 * p * given + c]);
    const std::int32_t bodies[2] = {step.body[2 * given], step.body[2 * given + 1]};
    const bool is_joined = bodies[0] == bodies[1];
    for (Index c = 0; c < p && is_joined; ++c) own[c] += own[p + c];
    double* const row = dense_.data() + i * stride_;
    start_[At(i)] = i;
    end_[At(i)] = i + 1;
    for (Index side = 0; side < (is_joined ? 1 : 2); ++side) {
      const Index body = bodies[side];
      if (body < 0) continue;
      double momentum[p];
      bool moves = false;
      for (Index c = 0; c < p; ++c) {
        momentum[c] = step.inverse_mass[body * p + c] * own[side * p + c];
        row[i] += momentum[c] * own[side * p + c];
        moves = moves || step.inverse_mass[body * p + c] > 0;
      }
      if (!moves) continue;
      sides_.ForEach(body, [&](std::int32_t other) {
        const Index j = other / 2;
        if (j == i) return;
        const double* const its = jacobian_.data() + p * other;
        double sum = row[j];
        for (Index c = 0; c < p; ++c) sum += momentum[c] * its[c];
        row[j] = dense_[j * stride_ + i] = sum;
        start_[At(i)] = std::min(start_[At(i)], j);
        end_[At(j)] = i + 1;
      });
      sides_.Add(body, static_cast<std::int32_t>(2 * i + side));
    }
  }
  first_of_register_.clear();
  end_of_register_.clear();
  for (Index i = 0; i < n; ++i) {
    if (i % Lanes::kWidth == 0) {
      first_of_register_.push_back(i);
      end_of_register_.push_back(i);
    }
    first_of_register_.back() = std::min(first_of_register_.back(), start_[At(i)]);
    end_of_register_.back() = std::max(end_of_register_.back(), end_[At(i)]);
  }
  for (const std::int32_t given : part) {
    for (Index side = Index{2} * given; side < Index{2} * given + 2; ++side) {
      if (step.body[side] >= 0) sides_.Forget(step.body[side]);
    }
  }
}

void ContactRows::SetLaws(std::span<const FrictionRow> friction, std::span<const BoundedRow> bounded) {
  const Index n = size();
  // The friction rows of a normal row are a list: first_[normal], next_[tangent], ...
  first_.assign(At(n), -1);
  next_.assign(friction.size(), -1);
  kind_.assign(At(n), RowKind::kUnilateral);
  is_sliding_ = false;
  is_paired_ = true;
  for (Index k = std::ssize(friction) - 1; k >= 0; --k) {
    const FrictionRow& row = friction[At(k)];
    next_[At(k)] = std::exchange(first_[At(row.normal)], k);
    is_paired_ = is_paired_ && next_[At(k)] < 0;
    kind_[At(row.row)] = RowKind::kFriction;
    is_sliding_ = is_sliding_ || row.slip != 0;
  }
  bounded_.clear();
  for (const BoundedRow& row : bounded) {
    bounded_.push_back({row.row, row.lower * root_[At(row.row)], row.upper * root_[At(row.row)]});
    kind_[At(row.row)] = RowKind::kBounded;
  }
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
}

void ContactRows::TakeMatrix(const LcpProblem& problem) {
  const Index n = problem.size();
  is_dense_ = false;
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
  if (!problem_ || !problem_->has_factors()) return nullptr;
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
  Lengthen(size(), &b_);
  for (Index i = 0; i < size(); ++i) b_[i] = problem.b()[i] / root_[At(i)];
  SetScale();
}

void ContactRows::SetScale() {
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
  scale_ = ContactLaw::Scale(plain, answered, all);
}

// b + A phi and |b| + |A| |phi| for a dense A, a register of rows at a time. A is symmetric: its rows are read as
// columns.
template <bool kWithMagnitudes>
void ContactRows::SumRows(const Eigen::VectorXd& phi, double* sums, double* magnitudes) const {
  constexpr Index kWidth = Lanes::kWidth;
  for (Index i = 0; i < size(); i += kWidth) {
    Lanes::V sum = Lanes::Load(b_.data() + i), magnitude = Lanes::Abs(sum);
    const double* const entry = dense_.data() + i;
    const Index end = end_of_register_[At(i / kWidth)];
    for (Index j = first_of_register_[At(i / kWidth)]; j < end; ++j) {
      const Lanes::V product = Lanes::Load(entry + j * stride_) * Lanes::Set(phi[j]);
      sum += product;
      if constexpr (kWithMagnitudes) magnitude += Lanes::Abs(product);
    }
    Lanes::Store(sums + i, sum);
    if constexpr (kWithMagnitudes) Lanes::Store(magnitudes + i, magnitude);
  }
}

void ContactRows::ComputeGaps(const Eigen::VectorXd& phi, Eigen::VectorXd* omega) const {
  Lengthen(size(), omega);
  if (is_dense_) return SumRows<false>(phi, omega->data(), nullptr);
  for (Index i = 0; i < size(); ++i) (*omega)[i] = Gap(i, phi);
}

void ContactRows::ComputeGapsOf(const Eigen::VectorXd& f, Eigen::VectorXd* w) const {
  const Index n = size();
  Lengthen(n, &phi_);
  for (Index i = 0; i < n; ++i) phi_[i] = root_[At(i)] * f[i];
  ComputeGaps(phi_, w);
  for (Index i = 0; i < n; ++i) (*w)[i] *= root_[At(i)];
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
      sum += Square(ContactLaw::Residual(contact.mu, normal, along, omega[contact.tangent]));
    }
  }
  for (const Bounded& row : bounded_) {
    sum += Square(phi[row.row] - std::clamp(phi[row.row] - omega[row.row], row.lower, row.upper));
  }
  return std::sqrt(sum) / scale_;
}

RowMode ContactRows::ModeOf(const Contact& contact, const Eigen::VectorXd& phi, const Eigen::VectorXd& omega) const {
  const double normal = phi[contact.normal] - omega[contact.normal];
  if (!contact.can_stick()) return normal > 0 ? RowMode::kClosed : RowMode::kOpen;
  return ContactLaw::ModeOf(contact.mu, normal, phi[contact.tangent] - omega[contact.tangent]);
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
  Lengthen(size(), phi);
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
  Lengthen(size(), f);
  f->head(size()).setZero();
  for (const Index i : joints_) (*f)[i] = phi[i] / root_[At(i)];
  for (const Contact& contact : contacts_) {
    const RowMode mode = ModeOf(contact, phi, omega);
    const double along = contact.tangent < 0 ? 0 : phi[contact.tangent];
    const double least = ContactLaw::kPartOfLoad * LoadOf(contact);
    if (mode == RowMode::kOpen || (phi[contact.normal] < least && std::abs(along) < least)) continue;
    const double normal = std::max(phi[contact.normal], 0.0) / root_[At(contact.normal)];
    (*f)[contact.normal] = normal;
    if (contact.tangent < 0) continue;
    const double most = contact.given_mu * normal;
    (*f)[contact.tangent] =
        contact.slip != 0 ? -contact.slip * most : ContactLaw::Friction(mode, most, along / root_[At(contact.tangent)]);
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
  for (Eigen::VectorXd* const numbers : {&phi_, &omega_, &magnitude_, &hidden_}) Lengthen(n, numbers);
  for (Index i = 0; i < n; ++i) phi_[i] = root_[At(i)] * f[i];
  const double forces = phi_.head(n).lpNorm<1>();
  const double unit = (static_cast<double>(n) + ContactLaw::kTermsBesideRows) * std::numeric_limits<double>::epsilon();
  if (is_dense_) SumRows<true>(phi_, omega_.data(), magnitude_.data());
  for (Index i = 0; i < n && !is_dense_; ++i) {
    double sum = b_[i], size = std::abs(b_[i]);
    VisitRow(i, [&](Index j, double a) {
      sum += a * phi_[j];
      size += std::abs(a * phi_[j]);
    });
    omega_[i] = sum;
    magnitude_[i] = size;
  }
  for (Index i = 0; i < n; ++i) hidden_[i] = unit * (forces + magnitude_[i]);
  if (!(Rho(phi_, omega_) + hidden_.head(n).norm() / scale_ <= tolerance)) return false;
  double worst = 0;
  const auto raise = [&](double error) { worst = std::max(worst, error); };
  for (const Index i : joints_) raise(BackwardError(i, std::abs(omega_[i])));
  for (const Contact& contact : contacts_) {
    const double of_normal = omega_[contact.normal];
    raise(BackwardError(contact.normal, phi_[contact.normal] == 0 ? -of_normal : std::abs(of_normal)));
    if (!contact.can_stick()) continue;
    const double most = contact.given_mu * f[contact.normal], along = f[contact.tangent];
    if (most == 0 && along == 0) continue;
    raise(BackwardError(contact.tangent, ContactLaw::Defect(most, along, omega_[contact.tangent])));
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
