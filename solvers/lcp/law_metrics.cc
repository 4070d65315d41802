#include "solvers/lcp/law_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lcpbench {
namespace {

using Extended = long double;

constexpr Extended kInfinite = std::numeric_limits<Extended>::infinity();
// Defects up to this part of the largest load of their own contact count as none.
constexpr Extended kPartOfLoad = 0x1p-46L;
// rho is relative to no less than this part of |D^-1/2 b|_2.
constexpr Extended kLeastScale = 0x1p-20L;

Extended Positive(Extended x) { return std::max<Extended>(x, 0); }
// NaN stays.
Extended Larger(Extended x, Extended y) { return std::isnan(x) || x > y ? x : y; }
// x/0 is infinite, and 0 of anything is 0.
Extended Quotient(Extended part, Extended whole) { return part == 0 ? 0 : part / whole; }
Extended Clamped(Extended x, Extended lower, Extended upper) { return std::min(std::max(x, lower), upper); }

// The natural residual phi - clamp(phi - omega, lower, upper) without that sum, in which a large phi rounds omega away.
// An infinite end drops out; NaN stays NaN.
// @param from_lower, from_upper  phi less the lower and less the upper end
Extended NaturalResidual(Extended omega, Extended from_lower, Extended from_upper) {
  return std::max(std::min(omega, from_lower), from_upper);
}

// D^1/2, 1 where A_ii = 0.
Extended RootOf(Extended diagonal) { return diagonal == 0 ? 1 : std::sqrt(diagonal); }

// x + factor y, rounded once: a friction force at its bound differs from it in bits that the product alone would lose.
Extended Sum(double x, double factor, double y) { return std::fma(Extended{factor}, Extended{y}, Extended{x}); }

// A friction force less the ends of what it may be, -mu f_n and mu f_n.
struct FromEnds {
  Extended lower, upper;
};
FromEnds FromEndsOf(const FrictionRow& row, const Eigen::VectorXd& f) {
  const double normal = std::max(f[row.normal], 0.0);
  return {Sum(f[row.row], row.mu, normal), Sum(f[row.row], -row.mu, normal)};
}
// A sliding force less what the law asks for.
Extended SlidingDefect(const FrictionRow& row, const Eigen::VectorXd& f) {
  return Sum(f[row.row], row.slip * row.mu, f[row.normal]);
}
// The natural residual of a bounded row. Differences are formed before they are scaled, so that they are exact where
// f is near an end.
Extended BoundedResidual(const BoundedRow& row, double f, Extended root, Extended omega) {
  const Extended force = f;
  return NaturalResidual(omega, root * (force - row.lower), root * (force - row.upper));
}

// One pass over the rows of each law.
class LawMeasure {
 public:
  explicit LawMeasure(const JudgedRows& rows)
      : rows_(rows), n_(rows.f.size()), root_(rows.diagonal.unaryExpr(&RootOf)) {
    phi_ = root_.cwiseProduct(rows.f.cast<Extended>());
    omega_ = rows.w.cwiseQuotient(root_);
    beta_ = rows.problem.b().cast<Extended>().cwiseQuotient(root_);
    scale_ = LoadScale(rows.problem, root_);
    load_ = beta_.cwiseAbs();
    for (const FrictionRow& row : rows.problem.friction_rows()) {
      load_[row.normal] = std::max(load_[row.normal], load_[row.row]);
    }
    for (const FrictionRow& row : rows.problem.friction_rows()) load_[row.row] = load_[row.normal];
    MeasurePlainRows();
    for (const FrictionRow& row : rows.problem.friction_rows())
      row.slip == 0 ? MeasureFriction(row) : MeasureSliding(row);
    for (const BoundedRow& row : rows.problem.bounded_rows()) MeasureBounded(row);
  }

  LawMetrics Result() const {
    LawMetrics m;
    const auto relative = [this](Extended squared) {
      return static_cast<double>(scale_ == 0 ? std::sqrt(squared) : std::sqrt(squared) / scale_);
    };
    m.rho = relative(squared_);
    m.backward_error = static_cast<double>(worst_);
    m.penetration = relative(penetration_);
    m.adhesion = relative(adhesion_);
    m.separation = relative(separation_);
    m.cone = relative(cone_);
    m.dissipation = relative(dissipation_);
    m.joints = relative(joints_);
    m.beyond_bounds = relative(bounds_);
    if (!has_energy_) return m;
    const Extended unit = scale_ == 0 ? 1 : scale_ * scale_;
    m.friction_power = static_cast<double>(power_ / unit);
    m.created = static_cast<double>(created_ / unit);
    m.energy = static_cast<double>(phi_.dot(beta_ + omega_) / (2 * unit));
    return m;
  }

 private:
  Extended Square(Extended x) { return x * x; }

  // What w differs by from what the law asks for, over what the row sums.
  Extended GapError(Index i, Extended defect) const {
    defect = std::abs(defect);
    if (defect <= rows_.rounding[i] || defect <= kPartOfLoad * load_[i] * root_[i]) return 0;
    return Quotient(defect, rows_.magnitude[i] + std::abs(static_cast<Extended>(rows_.problem.b()[i])));
  }
  // F of a row, the force that what it sums amounts to.
  Extended ForceUnit(Index i) const {
    if (rows_.diagonal[i] == 0) return kInfinite;
    return (rows_.magnitude[i] + std::abs(static_cast<Extended>(rows_.problem.b()[i]))) / rows_.diagonal[i];
  }
  // What f differs by, over `unit`.
  Extended ForceError(Index i, Extended defect, Extended unit) const {
    defect = std::abs(defect);
    if (std::isinf(defect)) return kInfinite;  // there is no such bound
    return defect * root_[i] <= kPartOfLoad * load_[i] ? 0 : Quotient(defect, unit);
  }

  void MeasurePlainRows() {
    std::vector<RowKind> kinds(static_cast<size_t>(n_), RowKind::kUnilateral);
    const LcpProblem& problem = rows_.problem;
    for (const Index i : problem.bilateral_rows()) kinds[static_cast<size_t>(i)] = RowKind::kBilateral;
    for (const FrictionRow& row : problem.friction_rows()) kinds[static_cast<size_t>(row.row)] = RowKind::kFriction;
    for (const BoundedRow& row : problem.bounded_rows()) kinds[static_cast<size_t>(row.row)] = RowKind::kBounded;
    for (Index i = 0; i < n_; ++i) {
      if (kinds[static_cast<size_t>(i)] == RowKind::kBilateral) {
        joints_ += Square(omega_[i]);
        squared_ += Square(omega_[i]);
        worst_ = Larger(GapError(i, rows_.w[i]), worst_);
      } else if (kinds[static_cast<size_t>(i)] == RowKind::kUnilateral) {
        penetration_ += Square(Positive(-omega_[i]));
        adhesion_ += Square(Positive(-phi_[i]));
        separation_ += Square(Positive(std::min(phi_[i], omega_[i])));
        squared_ += Square(std::min(phi_[i], omega_[i]));
        worst_ = Larger(GapError(i, std::min(rows_.diagonal[i] * rows_.f[i], rows_.w[i])), worst_);
      }
    }
  }

  void MeasureFriction(const FrictionRow& row) {
    const Index t = row.row;
    const Extended mu = row.mu, root = root_[t], omega = omega_[t];
    const FromEnds from = FromEndsOf(row, rows_.f);
    const Extended outside = Positive(std::max(-from.lower, from.upper));
    squared_ += Square(NaturalResidual(omega, root * from.lower, root * from.upper));
    cone_ += Square(root * outside);
    // The same with f clipped to the cone.
    const Extended width = 2 * mu * Positive(rows_.f[row.normal]);
    dissipation_ +=
        Square(NaturalResidual(omega, root * Clamped(from.lower, 0, width), root * Clamped(from.upper, -width, 0)));
    power_ += phi_[t] * omega_[t];
    created_ += Positive(phi_[t] * omega_[t]);

    const Extended w = rows_.w[t], unit = mu == 0 ? 0 : mu * ForceUnit(row.normal);
    const Extended sticks = Larger(GapError(t, w), ForceError(t, outside, unit));
    const Extended slips_up = Larger(GapError(t, Positive(-w)), ForceError(t, from.lower, unit));
    const Extended slips_down = Larger(GapError(t, Positive(w)), ForceError(t, from.upper, unit));
    worst_ = Larger(std::min({sticks, slips_up, slips_down}), worst_);
  }

  void MeasureSliding(const FrictionRow& row) {
    has_energy_ = false;
    const Extended mu = row.mu;
    const Extended defect = SlidingDefect(row, rows_.f);
    joints_ += Square(root_[row.row] * defect);
    squared_ += Square(root_[row.row] * defect);
    worst_ = Larger(ForceError(row.row, defect, mu == 0 ? 0 : mu * ForceUnit(row.normal)), worst_);
  }

  void MeasureBounded(const BoundedRow& row) {
    has_energy_ = false;
    const Index i = row.row;
    const Extended f = rows_.f[i], w = rows_.w[i], unit = ForceUnit(i);
    const Extended residual = BoundedResidual(row, rows_.f[i], root_[i], omega_[i]);
    bounds_ += Square(residual);
    squared_ += Square(residual);
    const Extended outside = std::max(Positive(row.lower - f), Positive(f - row.upper));
    const Extended between = Larger(GapError(i, w), ForceError(i, outside, unit));
    const Extended at_lower = Larger(GapError(i, Positive(-w)), ForceError(i, f - row.lower, unit));
    const Extended at_upper = Larger(GapError(i, Positive(w)), ForceError(i, f - row.upper, unit));
    worst_ = Larger(std::min({between, at_lower, at_upper}), worst_);
  }

  const JudgedRows& rows_;
  const Index n_;
  ExtendedVector root_;                // D^1/2
  ExtendedVector phi_, omega_, beta_;  // D^1/2 f, D^-1/2 w, D^-1/2 b
  ExtendedVector load_;                // the largest |beta| of the contact's rows
  Extended scale_ = 0;                 // S
  Extended squared_ = 0, worst_ = 0;
  Extended penetration_ = 0, adhesion_ = 0, separation_ = 0, cone_ = 0, dissipation_ = 0, joints_ = 0, bounds_ = 0;
  Extended power_ = 0, created_ = 0;
  bool has_energy_ = true;
};

}  // namespace

long double LoadScale(const LcpProblem& problem, const ExtendedVector& root) {
  const ExtendedVector beta = problem.b().cast<Extended>().cwiseQuotient(root);
  std::vector<char> is_plain(static_cast<size_t>(beta.size()), 1);
  Extended plain = 0, all = 0, answered = 0;
  for (const FrictionRow& row : problem.friction_rows()) is_plain[static_cast<size_t>(row.row)] = 0;
  for (const BoundedRow& row : problem.bounded_rows()) {
    is_plain[static_cast<size_t>(row.row)] = 0;
    const Extended load = beta[row.row] * beta[row.row];
    const Extended most = root[row.row] * std::max(std::abs(row.lower), std::abs(row.upper));
    plain += std::min(load, most * most);
    all += load;
  }
  for (Index i = 0; i < beta.size(); ++i) {
    if (is_plain[static_cast<size_t>(i)] == 0) continue;
    plain += beta[i] * beta[i];
    all += beta[i] * beta[i];
  }
  for (const FrictionRow& row : problem.friction_rows()) {
    if (row.slip != 0) continue;
    const Extended load = beta[row.row] * beta[row.row];
    const Extended mu = row.mu * (root[row.row] / root[row.normal]);
    answered += std::min(load, mu * mu * plain);
    all += load;
  }
  return std::max(std::sqrt(plain + answered), kLeastScale * std::sqrt(all));
}

double RelaxationResidual(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  if (f.size() != problem.size() || !f.allFinite() || !w.allFinite()) return std::numeric_limits<double>::infinity();
  const ExtendedVector root = problem.DiagonalA().cast<Extended>().cwiseAbs().unaryExpr(&RootOf);
  const ExtendedVector phi = root.cwiseProduct(f.cast<Extended>());
  const ExtendedVector omega = w.cast<Extended>().cwiseQuotient(root);
  // phi less the projection of phi - omega. Plain rows first; contacts with friction then overwrite what they project
  // together.
  ExtendedVector residual = omega;
  for (Index i = 0; i < f.size(); ++i) {
    if (problem.kind(i) == RowKind::kUnilateral) residual[i] = std::min(phi[i], omega[i]);
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    residual[row.row] = BoundedResidual(row, f[row.row], root[row.row], omega[row.row]);
  }
  for (const FrictionRow& row : problem.friction_rows()) {
    const Index n = row.normal, t = row.row;
    const Extended mu = row.mu * (root[t] / root[n]);
    if (row.slip != 0) {
      residual[t] = root[t] * SlidingDefect(row, f) - row.slip * mu * residual[n];
      continue;
    }
    // Along the edge (1, side mu) that phi - omega is nearer to, which ends at the tip, and from it out of the cone.
    const int side = phi[t] < omega[t] ? -1 : 1;
    const Extended along = std::min(Sum(w[n], side * row.mu, w[t]) / root[n], phi[n] + side * mu * phi[t]);
    const Extended across = std::max(side * omega[t] - mu * omega[n], root[t] * Sum(side * f[t], -row.mu, f[n]));
    residual[n] = (along - mu * across) / (1 + mu * mu);
    residual[t] = side * (mu * along + across) / (1 + mu * mu);
  }
  const Extended scale = LoadScale(problem, root);
  const Extended norm = residual.norm();
  return static_cast<double>(scale == 0 ? norm : norm / scale);
}

LawMetrics MeasureLaws(const JudgedRows& rows) { return LawMeasure(rows).Result(); }

}  // namespace lcpbench
