#include "solvers/first_order/contact_sweeps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// Below, 1 - A_nt^2 of scaled rows counts as 0: the two rows are one.
constexpr double kLeastDeterminant = 0x1p-40;

double Square(double x) { return x * x; }

}  // namespace

void ContactSweeps::Prepare(const LcpProblem& problem) {
  const Index n = problem.size();
  has_factors_ = problem.has_factors();
  const Eigen::VectorXd& diagonal = problem.DiagonalA();
  root_.assign(At(n), 1);
  diagonal_.assign(At(n), 0);
  for (Index i = 0; i < n; ++i) {
    if (diagonal[i] == 0) continue;
    root_[At(i)] = std::sqrt(diagonal[i]);
    diagonal_[At(i)] = 1;
  }
  const SparseMatrix& given = has_factors_ ? problem.J() : problem.SparseA();
  start_.assign(1, 0);
  column_.clear();
  value_.clear();
  for (Index i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(given, i); it; ++it) {
      const double scale = has_factors_ ? std::sqrt(problem.inverse_mass()[it.col()]) : 1 / root_[At(it.col())];
      if (it.value() == 0 || scale == 0) continue;
      column_.push_back(static_cast<int>(it.col()));
      value_.push_back(it.value() / root_[At(i)] * scale);
    }
    start_.push_back(static_cast<Index>(value_.size()));
  }
  state_.assign(At(given.cols()), 0);

  friction_.clear();
  visits_.clear();
  std::vector<FrictionRow> rows = problem.friction_rows();
  std::ranges::stable_sort(rows, {}, &FrictionRow::normal);
  const SparseMatrix& A = has_factors_ ? given : problem.SparseA();
  for (const FrictionRow& row : rows) {
    double coupling = 0;
    if (!has_factors_) {
      coupling = A.coeff(row.normal, row.row) / (root_[At(row.normal)] * root_[At(row.row)]);
    } else {
      for (Index e = start_[At(row.normal)]; e < start_[At(row.normal) + 1]; ++e) {
        for (Index o = start_[At(row.row)]; o < start_[At(row.row) + 1]; ++o) {
          if (column_[At(e)] == column_[At(o)]) coupling += value_[At(e)] * value_[At(o)];
        }
      }
    }
    friction_.push_back({row.row, row.mu * root_[At(row.row)] / root_[At(row.normal)], coupling, row.slip});
  }
  std::vector<char> is_friction(At(n), 0);
  for (const FrictionRow& row : rows) is_friction[At(row.row)] = 1;
  size_t next = 0;
  std::vector<std::pair<Index, Index>> of_normal(At(n), {0, 0});
  while (next < rows.size()) {
    const size_t first = next;
    while (next < rows.size() && rows[next].normal == rows[first].normal) ++next;
    of_normal[At(rows[first].normal)] = {static_cast<Index>(first), static_cast<Index>(next)};
  }
  lower_.clear();
  upper_.clear();
  for (Index i = 0; i < n; ++i) {
    if (is_friction[At(i)] != 0) continue;
    Visit visit{i, problem.kind(i), of_normal[At(i)].first, of_normal[At(i)].second};
    if (visit.kind == RowKind::kBounded) {
      const BoundedRow& bounds = *std::ranges::lower_bound(problem.bounded_rows(), i, {}, &BoundedRow::row);
      visit.bounded = static_cast<Index>(lower_.size());
      lower_.push_back(bounds.lower * root_[At(i)]);
      upper_.push_back(bounds.upper * root_[At(i)]);
    }
    visits_.push_back(visit);
  }
}

void ContactSweeps::Start(const LcpProblem& problem, const Eigen::VectorXd* initial_f) {
  const Index n = problem.size();
  load_of_row_.resize(At(n));
  force_.assign(At(n), 0);
  load_ = 0;
  for (Index i = 0; i < n; ++i) {
    load_of_row_[At(i)] = problem.b()[i] / root_[At(i)];
    load_ += Square(load_of_row_[At(i)]);
    if (initial_f != nullptr) force_[At(i)] = root_[At(i)] * (*initial_f)[i];
  }
  load_ = std::sqrt(load_);
  for (const Visit& visit : visits_) {
    double& force = force_[At(visit.row)];
    if (visit.kind == RowKind::kUnilateral) force = std::max(force, 0.0);
    if (visit.kind == RowKind::kBounded)
      force = std::clamp(force, lower_[At(visit.bounded)], upper_[At(visit.bounded)]);
    for (Index k = visit.first_friction; k < visit.last_friction; ++k) {
      const Tangent& tangent = friction_[At(k)];
      double& along = force_[At(tangent.row)];
      const double most = tangent.mu * force;
      along = tangent.slip != 0 ? -tangent.slip * most : std::clamp(along, -most, most);
    }
  }
  std::ranges::fill(state_, 0.0);
  for (Index i = 0; i < n; ++i) {
    const double force = force_[At(i)];
    force_[At(i)] = 0;
    if (force != 0) Move(i, force);
  }
}

void ContactSweeps::GetForces(Eigen::VectorXd* f) const {
  for (Index i = 0; i < f->size(); ++i) (*f)[i] = force_[At(i)] / root_[At(i)];
}

// D^-1/2 w.
double ContactSweeps::Gap(Index row) const {
  double sum = load_of_row_[At(row)];
  for (Index e = start_[At(row)]; e < start_[At(row) + 1]; ++e) sum += value_[At(e)] * state_[At(column_[At(e)])];
  return sum;
}

void ContactSweeps::Move(Index row, double change) {
  if (change == 0) return;
  force_[At(row)] += change;
  if (!has_factors_) {
    state_[At(row)] = force_[At(row)];
    return;
  }
  for (Index e = start_[At(row)]; e < start_[At(row) + 1]; ++e) state_[At(column_[At(e)])] += value_[At(e)] * change;
}

double ContactSweeps::Sweep(double omega) {
  double changes = 0;
  for (const Visit& visit : visits_) {
    changes += visit.first_friction == visit.last_friction ? VisitPlain(visit, omega) : VisitContact(visit, omega);
  }
  return changes;
}

double ContactSweeps::VisitPlain(const Visit& visit, double omega) {
  const Index row = visit.row;
  const double gap = Gap(row);
  const double before = force_[At(row)];
  double force = before - omega * gap;
  if (diagonal_[At(row)] == 0) {
    // The force changes nothing here: only a bound can meet the law.
    force = 0;
    if (visit.kind == RowKind::kBounded) {
      const double lower = lower_[At(visit.bounded)], upper = upper_[At(visit.bounded)];
      force = gap > 0 && std::isfinite(lower) ? lower : gap < 0 && std::isfinite(upper) ? upper : 0;
      force = std::clamp(force, lower, upper);
    }
  } else if (visit.kind == RowKind::kUnilateral) {
    force = std::max(force, 0.0);
  } else if (visit.kind == RowKind::kBounded) {
    force = std::clamp(force, lower_[At(visit.bounded)], upper_[At(visit.bounded)]);
  }
  Move(row, force - before);
  return Square(force - before);
}

double ContactSweeps::VisitContact(const Visit& visit, double omega) {
  const Tangent& first = friction_[At(visit.first_friction)];
  if (visit.last_friction - visit.first_friction == 1) {
    return first.slip == 0 ? VisitPair(visit.row, first, omega) : VisitSliding(visit.row, first, omega);
  }
  double changes = VisitPlain(visit, omega);
  for (Index k = visit.first_friction; k < visit.last_friction; ++k) {
    const Tangent& tangent = friction_[At(k)];
    const double most = tangent.mu * force_[At(visit.row)];
    const double before = force_[At(tangent.row)];
    const double force =
        tangent.slip != 0 ? -tangent.slip * most : std::clamp(before - omega * Gap(tangent.row), -most, most);
    Move(tangent.row, force - before);
    changes += Square(force - before);
  }
  return changes;
}

double ContactSweeps::VisitPair(Index normal, const Tangent& tangent, double omega) {
  const Pair before{force_[At(normal)], force_[At(tangent.row)]};
  const Pair gap{Gap(normal), Gap(tangent.row)};
  const Pair rest{gap.normal - diagonal_[At(normal)] * before.normal - tangent.coupling * before.tangent,
                  gap.tangent - diagonal_[At(tangent.row)] * before.tangent - tangent.coupling * before.normal};
  const Pair solution = SolvePair(normal, tangent, rest);
  const double force = std::max(before.normal + omega * (solution.normal - before.normal), 0.0);
  const double most = tangent.mu * force;
  const double along = std::clamp(before.tangent + omega * (solution.tangent - before.tangent), -most, most);
  Move(normal, force - before.normal);
  Move(tangent.row, along - before.tangent);
  return Square(force - before.normal) + Square(along - before.tangent);
}

// @param rest  D^-1/2 w without the contact's own forces
ContactSweeps::Pair ContactSweeps::SolvePair(Index normal, const Tangent& tangent, Pair rest) const {
  if (rest.normal >= 0 || diagonal_[At(normal)] == 0) return {};
  const double c = tangent.coupling, mu = tangent.mu;
  if (diagonal_[At(tangent.row)] == 0) {
    const double force = -rest.normal;
    if (rest.tangent == 0) return {force, std::clamp(force_[At(tangent.row)], -mu * force, mu * force)};
    return {force, rest.tangent > 0 ? -mu * force : mu * force};
  }
  const double determinant = 1 - c * c;
  if (determinant > kLeastDeterminant) {
    const Pair stick{(-rest.normal + c * rest.tangent) / determinant, (-rest.tangent + c * rest.normal) / determinant};
    if (std::abs(stick.tangent) <= mu * stick.normal) return stick;
  } else if (std::abs(rest.normal - c * rest.tangent) <= kLeastDeterminant * std::abs(rest.normal)) {
    return {-rest.normal, 0};
  }
  Pair best{force_[At(normal)], force_[At(tangent.row)]};
  double least = std::numeric_limits<double>::infinity();
  for (const int s : {1, -1}) {
    const double slope = 1 - s * mu * c;
    if (slope <= 0) continue;
    const double force = -rest.normal / slope;
    const double along = -s * mu * force;
    const double wrong = std::max(-s * (rest.tangent + c * force + along), 0.0);
    if (wrong >= least) continue;
    least = wrong;
    best = {force, along};
  }
  return best;
}

// The friction row follows the normal one: both move along (1, -s mu).
double ContactSweeps::VisitSliding(Index normal, const Tangent& tangent, double omega) {
  const double before = force_[At(normal)];
  const double slope = diagonal_[At(normal)] - tangent.slip * tangent.mu * tangent.coupling;
  if (slope <= 0) return 0;
  const double force = std::max(before - omega * Gap(normal) / slope, 0.0);
  Move(normal, force - before);
  Move(tangent.row, -tangent.slip * tangent.mu * force - force_[At(tangent.row)]);
  return Square(force - before);
}

}  // namespace lcpbench
