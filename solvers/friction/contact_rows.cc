#include "solvers/friction/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "solvers/linear_algebra/vector_register.h"
#include "solvers/rows/two_body_product.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// Up to so many rows the dense A is formed sooner than the sparse one.
constexpr Index kFewRows = 100;

// Bodies in space have so many columns.
constexpr Index kMostColumnsPerBody = 6;

using law::Square;

double Clamped(PointRange range, double /*force*/) { return range.force; }
double Clamped(IntervalRange range, double force) { return std::clamp(force, range.lower, range.upper); }

// phi - omega, by row.
struct Trial {
  const PaddedVector& phi;
  const PaddedVector& omega;
  double operator[](Index row) const { return phi[row] - omega[row]; }
};

}  // namespace

void ContactRows::Reserve(Index max_rows, Index max_bodies) {
  start_.reserve(At(max_rows) + 1);
  for (std::vector<Index>* const numbers : {&end_, &first_of_register_, &end_of_register_}) {
    numbers->reserve(At(max_rows));
  }
  dense_.Lengthen(PaddedStride(max_rows) * max_rows);
  jacobian_.reserve(At(2 * kMostColumnsPerBody * max_rows));
  sides_.Reserve(max_rows, max_bodies);
  for (std::vector<double>* const numbers : {&root_, &inverse_root_, &given_mu_, &load_}) {
    numbers->reserve(At(max_rows));
  }
  for (std::vector<Index>* const numbers : {&joints_, &normals_}) numbers->reserve(At(max_rows));
  kind_.reserve(At(max_rows));
  friction_.reserve(At(max_rows));
  bounded_.reserve(At(max_rows));
  for (PaddedVector* const numbers : {&b_, &phi_, &omega_, &magnitude_}) numbers->Lengthen(max_rows);
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
  b_.Lengthen(n);
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

template <int p, typename Real>
void ContactRows::Assemble(const StepRows& step, const Real* J, std::span<const std::int32_t> part) {
  const Index n = std::ssize(part);
  is_dense_ = true;
  stride_ = PaddedStride(n);
  dense_.Lengthen(stride_ * n);
  dense_.head(stride_ * n).setZero();
  start_.resize(At(n));
  end_.resize(At(n));
  jacobian_.resize(At(Index{2} * p * n));
  sides_.Reserve(n, step.bodies);
  for (Index i = 0; i < n; ++i) {
    start_[At(i)] = i;
    end_[At(i)] = i + 1;
  }
  AssembleByBodies<p>(step, J, part, dense_.data(), stride_, jacobian_.data(), &sides_, [this](Index i, Index j) {
    start_[At(i)] = std::min(start_[At(i)], j);
    end_[At(j)] = i + 1;
  });
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
}

void ContactRows::SetLaws(std::span<const FrictionRow> friction, std::span<const BoundedRow> bounded) {
  const auto is_before = [](const FrictionRow& a, const FrictionRow& b) {
    return std::tie(a.normal, a.row) < std::tie(b.normal, b.row);
  };
  friction_.assign(friction.begin(), friction.end());
  if (!std::ranges::is_sorted(friction_, is_before)) std::ranges::sort(friction_, is_before);
  kind_.assign(At(size()), RowKind::kUnilateral);
  given_mu_.clear();
  is_sliding_ = false;
  is_paired_ = true;
  Index last = -1;
  for (FrictionRow& row : friction_) {
    is_paired_ = is_paired_ && row.normal != last;
    last = row.normal;
    is_sliding_ = is_sliding_ || row.slip != 0;
    kind_[At(row.row)] = RowKind::kFriction;
    given_mu_.push_back(row.mu);
    row.mu *= root_[At(row.row)] / root_[At(row.normal)];
  }
  bounded_.clear();
  for (const BoundedRow& row : bounded) {
    bounded_.push_back({row.row, row.lower * root_[At(row.row)], row.upper * root_[At(row.row)]});
    kind_[At(row.row)] = RowKind::kBounded;
  }
  for (const Index i : joints_) kind_[At(i)] = RowKind::kBilateral;
  normals_.clear();
  for (Index i = 0; i < size(); ++i) {
    if (kind_[At(i)] == RowKind::kUnilateral) normals_.push_back(i);
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
  b_.Lengthen(size());
  for (Index i = 0; i < size(); ++i) b_[i] = problem.b()[i] / root_[At(i)];
  SetScale();
}

void ContactRows::SetScale() {
  double plain = 0, answered = 0;
  load_.resize(At(size()));
  for (Index i = 0; i < size(); ++i) load_[At(i)] = std::abs(b_[i]);
  for (const Index i : joints_) plain += Square(b_[i]);
  for (const Index i : normals_) plain += Square(b_[i]);
  double all = plain;
  for (const BoundedRow& row : bounded_) {
    plain += std::min(Square(b_[row.row]), Square(std::max(std::abs(row.lower), std::abs(row.upper))));
    all += Square(b_[row.row]);
  }
  for (const FrictionRow& row : friction_) {
    load_[At(row.normal)] = std::max(load_[At(row.normal)], load_[At(row.row)]);
    if (row.slip != 0) continue;
    answered += std::min(Square(b_[row.row]), Square(row.mu) * plain);
    all += Square(b_[row.row]);
  }
  scale_ = law::Scale(plain, answered, all);
}

// A phi, with b, and |b| + |A| |phi| for a dense A, a register of rows at a time. A is symmetric: its rows are read as
// columns.
template <bool kWithLoads, bool kWithMagnitudes>
void ContactRows::SumRows(const PaddedVector& phi, double* sums, double* magnitudes) const {
  constexpr Index kWidth = Lanes::kWidth;
  for (Index i = 0; i < size(); i += kWidth) {
    Lanes::V sum = kWithLoads ? Lanes::Load(b_.data() + i) : Lanes::Set(0), magnitude = Lanes::Abs(sum);
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

void ContactRows::Multiply(const PaddedVector& phi, PaddedVector* product) const {
  product->Lengthen(size());
  if (is_dense_) return SumRows<false, false>(phi, product->data(), nullptr);
  for (Index i = 0; i < size(); ++i) {
    double sum = 0;
    VisitRow(i, [&](Index j, double a) { sum += a * phi[j]; });
    (*product)[i] = sum;
  }
}

void ContactRows::ComputeGaps(const PaddedVector& phi, PaddedVector* omega) const {
  omega->Lengthen(size());
  if (is_dense_) return SumRows<true, false>(phi, omega->data(), nullptr);
  for (Index i = 0; i < size(); ++i) (*omega)[i] = Gap(i, phi);
}

void ContactRows::ComputeGapsOf(const Eigen::VectorXd& f, PaddedVector* w) const {
  const Index n = size();
  phi_.Lengthen(n);
  for (Index i = 0; i < n; ++i) phi_[i] = root_[At(i)] * f[i];
  ComputeGaps(phi_, w);
  for (Index i = 0; i < n; ++i) (*w)[i] *= root_[At(i)];
}

double ContactRows::Rho(const PaddedVector& phi, const PaddedVector& omega) const {
  LawSums<double> sums;
  laws().VisitRanges(phi, [&](Index i, const auto& range) { sums.AddResidual(ResidualOf(range, phi[i], omega[i])); });
  return sums.norm() / scale_;
}

void ContactRows::FindSides(const PaddedVector& phi, const PaddedVector& omega, std::vector<RangeSide>* sides) const {
  const Trial trial{phi, omega};
  sides->resize(At(size()));
  laws().VisitRanges(trial, [&](Index i, const auto& range) { (*sides)[At(i)] = SideOf(range, trial[i]); });
}

void ContactRows::ToScaled(const Eigen::VectorXd& f, PaddedVector* phi) const {
  phi->Lengthen(size());
  for (Index i = 0; i < size(); ++i) (*phi)[i] = root_[At(i)] * f[i];
  for (const Index i : normals_) (*phi)[i] = std::max((*phi)[i], 0.0);
  laws().VisitOthers(*phi, [&](Index i, const auto& range) { (*phi)[i] = Clamped(range, (*phi)[i]); });
}

void ContactRows::ToForces(const PaddedVector& phi, const PaddedVector& omega, PaddedVector* f) const {
  const Trial trial{phi, omega};
  const auto closing = [&](Index normal) { return std::max(phi[normal], 0.0) / root_[At(normal)]; };
  const auto is_closed = [&](Index normal, double most) {
    return trial[normal] > 0 && !(most < law::kPartOfLoad * load_[At(normal)]);
  };
  f->Lengthen(size());
  for (const Index i : joints_) (*f)[i] = phi[i] / root_[At(i)];
  for (const Index i : normals_) (*f)[i] = is_closed(i, phi[i]) ? closing(i) : 0;
  for (size_t k = 0; k < friction_.size(); ++k) {
    const FrictionRow& row = friction_[k];
    const Index n = row.normal, t = row.row;
    (*f)[t] = 0;
    if (!is_closed(n, std::max(phi[n], std::abs(phi[t])))) continue;
    (*f)[n] = closing(n);
    const double most = given_mu_[k] * (*f)[n], scaled = row.mu * std::max(trial[n], 0.0);
    const RangeSide side = CanStick(row) ? SideOf(IntervalRange{-scaled, scaled}, trial[t]) : RangeSide::kLower;
    (*f)[t] = row.slip != 0                ? -row.slip * most
              : side == RangeSide::kInside ? std::clamp(phi[t] / root_[At(t)], -most, most)
                                           : static_cast<int>(side) * most;
  }
  for (const BoundedRow& row : bounded_) {
    (*f)[row.row] = std::clamp(phi[row.row], row.lower, row.upper) / root_[At(row.row)];
  }
}

LawSums<double>::Known ContactRows::Judge(const Eigen::VectorXd& f, double tolerance, double* rho) const {
  using Known = LawSums<double>::Known;
  constexpr double kNear = 10;
  const Index n = size();
  for (PaddedVector* const numbers : {&phi_, &omega_, &magnitude_}) numbers->Lengthen(n);
  for (Index i = 0; i < n; ++i) phi_[i] = root_[At(i)] * f[i];
  const double forces = phi_.head(n).lpNorm<1>();
  const double unit = (static_cast<double>(n) + law::kTermsBesideRows) * std::numeric_limits<double>::epsilon();
  if (is_dense_) SumRows<true, true>(phi_, omega_.data(), magnitude_.data());
  for (Index i = 0; i < n && !is_dense_; ++i) {
    double sum = b_[i], size = std::abs(b_[i]);
    VisitRow(i, [&](Index j, double a) {
      sum += a * phi_[j];
      size += std::abs(a * phi_[j]);
    });
    omega_[i] = sum;
    magnitude_[i] = size;
  }
  LawSums<double> sums(std::sqrt(tolerance));
  laws().VisitRanges(phi_,
                     [&](Index i, const auto& range) { sums.AddResidual(ResidualOf(range, phi_[i], omega_[i])); });
  *rho = sums.norm() / scale_;
  if (!(*rho <= kNear * tolerance)) return Known::kWrong;
  const auto add = [&](Index i, bool is_at_lower, bool is_at_upper) {
    sums.AddHidden(unit * (forces + magnitude_[i]), GapDefect(omega_[i], is_at_lower, is_at_upper), magnitude_[i]);
  };
  for (const Index i : joints_) add(i, false, false);
  for (const Index i : normals_) add(i, phi_[i] == 0, false);
  for (size_t k = 0; k < friction_.size(); ++k) {
    // An open contact may have any gap, and so may one that slides in a known direction.
    const double most = given_mu_[k] * f[friction_[k].normal], along = f[friction_[k].row];
    const Index i = friction_[k].row;
    const bool is_free = !CanStick(friction_[k]) || (most == 0 && along == 0);
    is_free ? sums.AddHidden(unit * (forces + magnitude_[i])) : add(i, along == -most, along == most);
  }
  for (const BoundedRow& row : bounded_) {
    add(row.row, phi_[row.row] <= row.lower, phi_[row.row] >= row.upper);
  }
  if (sums.AreSurelyRight(tolerance, scale_)) return Known::kRight;
  return sums.AreSurelyWrong(tolerance, scale_) ? Known::kWrong : Known::kUnclear;
}

}  // namespace lcpbench
