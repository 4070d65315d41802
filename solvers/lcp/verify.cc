#include "solvers/lcp/verify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "solvers/lcp/exact_sum.h"
#include "solvers/lcp/law_metrics.h"

namespace lcpbench {
namespace {

// Coded apart from residual.h, which the solvers use, on purpose: an error there must not hide itself here.

// 64-bit significand on x86-64: 2^11 times finer than the double arithmetic of the solvers that are judged.
using Extended = long double;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// product = A x, magnitude = |A| |x|, by the given form. From factors the product goes through body space and the
// magnitude through the entries of A, which are summed one row at a time and never stored.
struct Products {
  ExtendedVector product;
  ExtendedVector magnitude;
  /// What was actually summed for the product, in absolute values: |J| M^-1 |J^T| |x| from factors, else |A| |x|.
  ExtendedVector summed;
};

using ColumnMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

// Rounding of a sum in extended precision, relative to what was summed: 2^-64 per term, with room for 64 terms.
constexpr Extended kRounding = 0x1p-58L;

void AddRow(const SparseMatrix& A, Index i, const Eigen::VectorXd& x, Extended* sum, Extended* absolute) {
  for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
    const Extended term = static_cast<Extended>(it.value()) * x[it.col()];
    *sum += term;
    *absolute += std::abs(term);
  }
}

Products Multiply(const LcpProblem& problem, const Eigen::VectorXd& x) {
  const Index n = problem.size();
  Products out;
  out.product.setZero(n);
  out.magnitude.setZero(n);
  switch (problem.given_form()) {
    case MatrixForm::kDense: {
      const Eigen::MatrixXd& A = problem.DenseA();
      for (Index j = 0; j < n; ++j) {
        if (x[j] == 0) continue;
        for (Index i = 0; i < n; ++i) {
          const Extended term = static_cast<Extended>(A(i, j)) * x[j];
          out.product[i] += term;
          out.magnitude[i] += std::abs(term);
        }
      }
      break;
    }
    case MatrixForm::kSparse: {
      const SparseMatrix& A = problem.SparseA();  // the given entries, and zeros on the diagonal
      for (Index i = 0; i < n; ++i) AddRow(A, i, x, &out.product[i], &out.magnitude[i]);
      break;
    }
    case MatrixForm::kFactors: {
      const SparseMatrix& J = problem.J();
      const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
      const ColumnMatrix columns = J;
      ExtendedVector body = ExtendedVector::Zero(J.cols());
      ExtendedVector body_magnitude = body;
      out.summed.setZero(n);
      for (Index k = 0; k < J.cols(); ++k) {
        if (inverse_mass[k] == 0) continue;
        Extended sum = 0;
        Extended absolute = 0;
        for (ColumnMatrix::InnerIterator it(columns, k); it; ++it) {
          const Extended term = static_cast<Extended>(it.value()) * x[it.row()];
          sum += term;
          absolute += std::abs(term);
        }
        body[k] = sum * inverse_mass[k];
        body_magnitude[k] = absolute * inverse_mass[k];
      }
      ExtendedVector entries = ExtendedVector::Zero(n);
      std::vector<Index> touched;
      for (Index i = 0; i < n; ++i) {
        Extended sum = 0;
        Extended summed = 0;
        touched.clear();
        for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
          const double m = inverse_mass[it.col()];
          if (m == 0) continue;
          sum += static_cast<Extended>(it.value()) * body[it.col()];
          summed += std::abs(static_cast<Extended>(it.value())) * body_magnitude[it.col()];
          const Extended scaled = static_cast<Extended>(it.value()) * m;
          for (ColumnMatrix::InnerIterator jt(columns, it.col()); jt; ++jt) {
            if (x[jt.row()] == 0) continue;
            const Index j = jt.row();
            if (entries[j] == 0) touched.push_back(j);
            entries[j] += scaled * jt.value();
          }
        }
        Extended absolute = 0;
        for (const Index j : touched) {
          absolute += std::abs(entries[j] * x[j]);
          entries[j] = 0;
        }
        out.product[i] = sum;
        out.magnitude[i] = absolute;
        out.summed[i] = summed;
      }
      break;
    }
  }
  if (out.summed.size() == 0) out.summed = out.magnitude;
  return out;
}

// diag A in extended precision, absolute values.
ExtendedVector AbsoluteDiagonal(const LcpProblem& problem) {
  const Index n = problem.size();
  ExtendedVector diagonal(n);
  for (Index i = 0; i < n; ++i) {
    Extended value = 0;
    if (problem.has_factors()) {
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
        value += static_cast<Extended>(it.value()) * it.value() * problem.inverse_mass()[it.col()];
      }
    } else {
      value = problem.DiagonalA()[i];
    }
    diagonal[i] = std::abs(value);
  }
  return diagonal;
}

// With 1 where A_ii = 0.
ExtendedVector ScalingDiagonal(const ExtendedVector& diagonal) {
  return (diagonal.array() == 0).select(ExtendedVector::Ones(diagonal.size()), diagonal);
}

// NaN must win over every number: std::max would drop it.
void RaiseTo(Extended candidate, Extended* maximum) {
  if (std::isnan(candidate) || candidate > *maximum) *maximum = candidate;
}

double Ratio(Extended numerator, Extended denominator) {
  if (numerator == 0) return 0;
  return static_cast<double>(numerator / denominator);
}

// Written so that NaN fails.
bool Meets(const Metrics& m, double tier) {
  return m.rho <= tier && m.backward_error <= std::sqrt(tier) && std::isfinite(m.natural_residual) && m.w.allFinite();
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

void MarkUseless(const LcpProblem& problem, Metrics* m) {
  m->w = Eigen::VectorXd::Constant(problem.size(), std::numeric_limits<double>::quiet_NaN());
  m->rho = m->backward_error = m->natural_residual = m->natural_residual_siconos = kInfinity;
  m->fischer_burmeister = m->primal_infeasibility = m->dual_infeasibility = m->complementarity = kInfinity;
  m->gap = m->gap_rel = m->energy_bound = m->energy_shift = kInfinity;
  if (!problem.is_plain()) {
    m->penetration = m->adhesion = m->separation = m->cone = m->dissipation = m->joints = m->beyond_bounds = kInfinity;
    m->friction_power = m->created = m->energy = kInfinity;
  }
}

// Where entries of A cancel (perpendicular normals, say) the terms of w do not: a defect within the rounding of its own
// evaluation cannot be told from 0, and must not be divided by a scale that is 0 as well. Nor can one below the
// smallest normal double: no force could be given finely enough to do better.
Extended RoundingOf(Extended b, Extended summed) {
  return std::max<Extended>(kRounding * (summed + std::abs(b)), std::numeric_limits<double>::min());
}

Extended BackwardError(Extended defect, Extended b, Extended magnitude, Extended summed) {
  return defect <= RoundingOf(b, summed) ? 0 : defect / (magnitude + std::abs(b));
}

Extended FischerBurmeister(Extended p, Extended q) {
  const Extended hypotenuse = std::hypot(p, q);
  return p + q > 0 ? -2 * p * q / (hypotenuse + p + q) : hypotenuse - p - q;
}

// By the largest difference, over one more than the largest of `scale`; of no rows 0.
double ErrorOf(const Eigen::VectorXd& found, const Eigen::VectorXd& known, const Eigen::VectorXd& scale) {
  if (found.size() == 0) return 0;
  return (found - known).cwiseAbs().maxCoeff() / (1 + scale.cwiseAbs().maxCoeff());
}

}  // namespace

Metrics ComputeMetrics(const LcpProblem& problem, const Eigen::VectorXd& f, const LcpReference* reference) {
  const Index n = problem.size();
  Metrics m;
  if (reference != nullptr && reference->floor.has_value() && std::isfinite(*reference->floor) &&
      *reference->floor >= 0) {
    m.floor = *reference->floor;
  }
  m.answer_floor = RoundingFloor(problem, f);
  if (f.size() != n || !f.allFinite()) {
    MarkUseless(problem, &m);
    return m;
  }
  const Eigen::VectorXd& b = problem.b();
  const ExtendedVector diagonal = AbsoluteDiagonal(problem);
  const ExtendedVector D = ScalingDiagonal(diagonal);
  const Products Af = Multiply(problem, f);

  const auto is_other = [&problem, plain = problem.is_plain()](Index i) {
    return !plain && problem.kind(i) >= RowKind::kFriction;
  };
  Extended r_squared = 0, b_squared = 0, b_scaled_squared = 0, siconos_squared = 0, merit = 0;
  Extended backward = 0, natural = 0, primal = 0, dual = 0, complementarity = 0;
  Extended f_w = 0, f_Af = 0, b_f = 0, energy = 0, shift_squared = 0;
  m.w.resize(n);
  for (Index i = 0; i < n; ++i) {
    const bool bilateral = problem.is_bilateral(i);
    const Extended root = std::sqrt(D[i]);
    const Extended fi = f[i];
    const Extended wi = Af.product[i] + b[i];
    m.w[i] = static_cast<double>(wi);
    b_squared += static_cast<Extended>(b[i]) * b[i];
    if (is_other(i)) continue;

    const Extended p = root * fi;
    const Extended q = wi / root;
    const Extended residual = bilateral ? q : std::min(p, q);
    r_squared += residual * residual;
    b_scaled_squared += (b[i] / root) * (b[i] / root);

    const Extended defect = std::abs(bilateral ? wi : std::min(diagonal[i] * fi, wi));
    RaiseTo(BackwardError(defect, b[i], Af.magnitude[i], Af.summed[i]), &backward);

    const Extended plain = bilateral ? wi : std::min(fi, wi);
    siconos_squared += plain * plain;
    RaiseTo(std::abs(plain), &natural);

    const Extended phi = bilateral ? q : FischerBurmeister(p, q);
    merit += phi * phi / 2;

    if (bilateral) {
      RaiseTo(std::abs(wi), &dual);
      shift_squared += q * q;
    } else {
      RaiseTo(-fi, &primal);
      RaiseTo(-wi, &dual);
      RaiseTo(std::abs(fi * wi), &complementarity);
      energy += std::max(fi, Extended(0)) * std::max(wi, Extended(0));
      if (wi < 0) shift_squared += q * q;
    }
    f_w += fi * wi;
    f_Af += fi * Af.product[i];
    b_f += fi * b[i];
  }
  const auto over_b = [](Extended squared, Extended b_norm_squared) {
    return static_cast<double>(b_norm_squared == 0 ? std::sqrt(squared) : std::sqrt(squared / b_norm_squared));
  };
  m.rho = over_b(r_squared, b_scaled_squared);
  m.backward_error = static_cast<double>(backward);
  m.natural_residual = static_cast<double>(natural);
  m.natural_residual_siconos = over_b(siconos_squared, b_squared);
  m.fischer_burmeister = static_cast<double>(merit);
  m.primal_infeasibility = static_cast<double>(primal);
  m.dual_infeasibility = static_cast<double>(dual);
  m.complementarity = static_cast<double>(complementarity);
  m.gap = static_cast<double>(std::abs(f_w));
  m.gap_rel = Ratio(std::abs(f_w), std::abs(f_Af) + std::abs(b_f));
  if (!problem.is_plain()) {
    ExtendedVector rounding(n);
    for (Index i = 0; i < n; ++i) rounding[i] = RoundingOf(b[i], Af.summed[i]);
    static_cast<LawMetrics&>(m) =
        MeasureLaws({problem, f, Af.product + b.cast<Extended>(), diagonal, Af.magnitude, rounding});
  } else if (problem.facts().symmetric && problem.facts().positive_semidefinite) {
    m.energy_bound = static_cast<double>(energy);
    m.energy_shift = static_cast<double>(std::sqrt(shift_squared));
  }
  if (reference != nullptr && reference->w.has_value()) m.w_error = ErrorOf(m.w, *reference->w, b);
  if (reference != nullptr && reference->f.has_value()) m.f_error = ErrorOf(f, *reference->f, *reference->f);
  return m;
}

namespace {

// Sums over a column of J or A, times y: without rounding, and of absolute values.
struct ColumnSums {
  ExtendedVector value;
  ExtendedVector absolute;
};

ColumnSums SumColumns(const LcpProblem& problem, const Eigen::VectorXd& y) {
  ColumnSums sums;
  ExactSum exact;
  const auto make = [&](Index columns, const auto& add_column) {
    sums.value.setZero(columns);
    sums.absolute.setZero(columns);
    for (Index k = 0; k < columns; ++k) {
      exact.Clear();
      add_column(k);
      if (sums.absolute[k] != 0) sums.value[k] = exact.Value();
    }
  };
  const auto add = [&](Index k, double entry, double times) {
    if (entry == 0 || times == 0) return;
    exact.Add(entry, times);
    sums.absolute[k] += std::abs(static_cast<Extended>(entry) * times);
  };
  if (problem.given_form() == MatrixForm::kDense) {
    const Eigen::MatrixXd& A = problem.DenseA();
    make(A.cols(), [&](Index k) {
      for (Index i = 0; i < A.rows(); ++i) add(k, A(i, k), y[i]);
    });
    return sums;
  }
  const ColumnMatrix columns = problem.has_factors() ? problem.J() : problem.SparseA();
  make(columns.cols(), [&](Index k) {
    if (problem.has_factors() && problem.inverse_mass()[k] == 0) return;
    for (ColumnMatrix::InnerIterator it(columns, k); it; ++it) add(k, it.value(), y[it.row()]);
  });
  return sums;
}

// A^T y, where `sums` are those of J: exact but for the rounding of the second product.
ExtendedVector ThroughBodies(const LcpProblem& problem, const ColumnSums& sums) {
  ExtendedVector product = ExtendedVector::Zero(problem.size());
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
      product[i] += it.value() * (problem.inverse_mass()[it.col()] * sums.value[it.col()]);
    }
  }
  return product;
}

// max |J^T y|_k / (|J^T||y|)_k: the least relative change of entries of J that makes J^T y = 0.  [Oettli, Prager 1964]
double NullResidualOfFactors(const ColumnSums& sums) {
  double largest = 0;
  for (Index k = 0; k < sums.value.size(); ++k) {
    largest = std::max(largest, Ratio(std::abs(sums.value[k]), sums.absolute[k]));
  }
  return largest;
}

double NullResidualOfMatrix(const ColumnSums& sums, const ExtendedVector& D, const Eigen::VectorXd& y) {
  Extended largest = 0, largest_summed = 0;
  for (Index i = 0; i < y.size(); ++i) {
    RaiseTo(std::abs(sums.value[i]) / std::sqrt(D[i]), &largest);
    // A row of zeros stands as one whose diagonal entry, taken as 1, has vanished.
    const Extended summed = sums.absolute[i] == 0 ? std::abs(static_cast<Extended>(y[i])) : sums.absolute[i];
    RaiseTo(summed / std::sqrt(D[i]), &largest_summed);
  }
  return Ratio(largest, largest_summed);
}

// Whether every f that the rows allow, with its w, has y.w >= 0: why not, "" where so.
std::string WhyNotInCone(const LcpProblem& problem, const Eigen::VectorXd& y) {
  for (const FrictionRow& row : problem.friction_rows()) {
    if (y[row.row] != 0) return "y is not 0 on friction row " + std::to_string(row.row);
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    if ((y[row.row] > 0 && std::isfinite(row.upper)) || (y[row.row] < 0 && std::isfinite(row.lower))) {
      return "y is not 0 on bounded row " + std::to_string(row.row) + ", where f is bounded on that side";
    }
  }
  for (Index i = 0; i < y.size(); ++i) {
    if (y[i] < 0 && problem.kind(i) == RowKind::kUnilateral) {
      return "y is negative on unilateral row " + std::to_string(i);
    }
  }
  return {};
}

Extended ExactProduct(const Eigen::VectorXd& b, const Eigen::VectorXd& y) {
  ExactSum sum;
  for (Index i = 0; i < b.size(); ++i) sum.Add(b[i], y[i]);
  return sum.Value();
}

}  // namespace

FarkasVerdict VerifyFarkasRay(const LcpProblem& problem, const Eigen::VectorXd& y) {
  FarkasVerdict verdict;
  const Index n = problem.size();
  if (y.size() != n || !y.allFinite()) {
    verdict.reason = "the ray must have n finite entries";
    return verdict;
  }
  if (!problem.IsNumericallySymmetric()) {
    verdict.reason = "rays are proofs for symmetric A only";
    return verdict;
  }
  const Extended b_dot_y = ExactProduct(problem.b(), y);
  verdict.b_dot_y = static_cast<double>(b_dot_y);
  verdict.reason = WhyNotInCone(problem, y);
  if (!verdict.reason.empty()) return verdict;
  if (!(b_dot_y < 0)) {
    verdict.reason = "b.y = " + Number(verdict.b_dot_y) + " is not negative";
    return verdict;
  }
  const bool has_factors = problem.has_factors();
  const ExtendedVector D = ScalingDiagonal(AbsoluteDiagonal(problem));
  const ColumnSums sums = SumColumns(problem, y);
  verdict.proved = (sums.value.array() == 0).all();
  verdict.null_residual = has_factors ? NullResidualOfFactors(sums) : NullResidualOfMatrix(sums, D, y);
  const ExtendedVector Ay = has_factors ? ThroughBodies(problem, sums) : sums.value;
  Extended largest = 0, b_norm1 = 0;
  for (Index i = 0; i < n; ++i) {
    RaiseTo(std::abs(Ay[i]) / std::sqrt(D[i]), &largest);
    b_norm1 += std::abs(static_cast<Extended>(problem.b()[i])) / std::sqrt(D[i]);
  }
  verdict.force_min = verdict.proved ? kInfinity : static_cast<double>(-b_dot_y / largest);
  const double needed = FarkasVerdict::kRayThreshold * static_cast<double>(b_norm1);
  if (verdict.null_residual > FarkasVerdict::kNullTolerance) {
    verdict.reason = std::string(has_factors ? "J^T y" : "A y") + " = 0 holds to " + Number(verdict.null_residual) +
                     (has_factors ? " of |J^T||y|" : " of |A||y|") + " only, expected " +
                     Number(FarkasVerdict::kNullTolerance);
  } else if (verdict.proved || verdict.force_min >= needed) {
    verdict.accepted = true;
  } else {
    verdict.reason = "F_min = " + Number(verdict.force_min) + " is below 1e12 |D^-1/2 b|_1 = " + Number(needed);
  }
  return verdict;
}

double EffectiveTier(const Metrics& m, double tolerance) {
  return std::max(tolerance, std::min(m.floor, kLargestFloor));
}

bool PassesTier(const Metrics& m, double tolerance) { return Meets(m, EffectiveTier(m, tolerance)); }

namespace {

double FrozenResidual(const LcpProblem& problem, const LcpResult& result) {
  const Eigen::VectorXd& bounds = result.friction_bounds;
  if (bounds.size() != problem.size() || !bounds.allFinite() || (bounds.array() < 0).any()) return kInfinity;
  RowBounds rows = problem.bounds();
  std::erase_if(rows.friction, [&](const FrictionRow& row) {
    if (row.slip != 0) return false;
    rows.bounded.push_back({row.row, -bounds[row.row], bounds[row.row]});
    return true;
  });
  return ComputeMetrics(problem.WithBounds(rows), result.f).rho;
}

}  // namespace

Verdict Verify(const LcpProblem& problem, const LcpResult& result, double tolerance, const LcpReference* reference) {
  Verdict verdict;
  verdict.requested = tolerance;
  verdict.metrics = ComputeMetrics(problem, result.f, reference);
  const Metrics& m = verdict.metrics;
  verdict.passes = PassesTier(m, tolerance);
  verdict.at_floor = verdict.passes && !Meets(m, tolerance);
  for (const double tier : kTiers) {
    if (PassesTier(m, tier)) {
      verdict.best_tier = tier;
      break;
    }
  }
  const bool is_of_law = result.model == FrictionModel::kCoulomb;
  if (result.model == FrictionModel::kRelaxation) verdict.model_rho = RelaxationResidual(problem, result.f, m.w);
  if (result.model == FrictionModel::kFrozenBounds) verdict.model_rho = FrozenResidual(problem, result);
  const bool holds = is_of_law ? verdict.passes : verdict.model_rho <= EffectiveTier(m, tolerance);
  verdict.false_success = result.status == LcpStatus::kSolved && !holds;
  if (result.farkas_ray.has_value()) verdict.farkas = VerifyFarkasRay(problem, *result.farkas_ray);
  const bool known_solvable =
      reference != nullptr && (reference->status == LcpReference::Status::kSolved || reference->solvable);
  // At a loose tier a point of a problem that is infeasible by less than the tier passes; the ray decides then.
  const bool has_ray = verdict.farkas.has_value() && verdict.farkas->accepted;
  verdict.false_infeasible = result.status == LcpStatus::kInfeasible &&
                             (known_solvable || (!has_ray && (verdict.passes || !problem.is_plain())));
  if (!verdict.passes) {
    const double tier = EffectiveTier(m, tolerance);
    const std::string whose = tier > tolerance ? " (rounding floor)" : "";
    if (result.f.size() != problem.size()) {
      verdict.reason =
          "f has " + std::to_string(result.f.size()) + " entries, expected " + std::to_string(problem.size());
    } else if (!result.f.allFinite()) {
      verdict.reason = "f is not finite";
    } else if (!(m.rho <= tier)) {
      verdict.reason = "rho = " + Number(m.rho) + " > " + Number(tier) + whose;
    } else if (!(m.backward_error <= std::sqrt(tier))) {
      verdict.reason = "backward error = " + Number(m.backward_error) + " > " + Number(std::sqrt(tier)) + whose;
    } else {
      verdict.reason = "a metric is not finite";
    }
  }
  return verdict;
}

namespace {

constexpr std::array kMetrics{
    MetricEntry{"rho", &Metrics::rho,
                "scaled natural residual |min(D^1/2 f, D^-1/2 w)|_2 / |D^-1/2 b|_2, D = diag A (primary)"},
    MetricEntry{"backward_error", &Metrics::backward_error,
                "max_i |min(A_ii f_i, w_i)| / (|A||f| + |b|)_i, componentwise"},
    MetricEntry{"natural_residual", &Metrics::natural_residual, "max_i |min(f_i, w_i)|, |w_i| on bilateral rows"},
    MetricEntry{"natural_residual_siconos", &Metrics::natural_residual_siconos, "|f - max(0, f - w)|_2 / |b|_2"},
    MetricEntry{"fischer_burmeister", &Metrics::fischer_burmeister,
                "1/2 sum (sqrt(p^2 + q^2) - p - q)^2 with p = D^1/2 f, q = D^-1/2 w"},
    MetricEntry{"primal_infeasibility", &Metrics::primal_infeasibility, "max_i max(0, -f_i)"},
    MetricEntry{"dual_infeasibility", &Metrics::dual_infeasibility, "max_i max(0, -w_i), |w_i| on bilateral rows"},
    MetricEntry{"complementarity", &Metrics::complementarity, "max_i |f_i w_i|"},
    MetricEntry{"gap", &Metrics::gap, "|f.w|"},
    MetricEntry{"gap_rel", &Metrics::gap_rel, "|f.w| / (|f.A f| + |b.f|)"},
    MetricEntry{"energy_bound", &Metrics::energy_bound,
                "f_C.max(w_C, 0) >= |f - f~|_A^2 for the problem with b~ = b + (w~ - w)"},
    MetricEntry{"energy_shift", &Metrics::energy_shift, "|D^-1/2 (b~ - b)|_2, by which energy_bound is off"},
    MetricEntry{"penetration", &Metrics::penetration, "|(-D^-1/2 w)_+|_2 / S on unilateral rows"},
    MetricEntry{"adhesion", &Metrics::adhesion, "|(-D^1/2 f)_+|_2 / S on unilateral rows"},
    MetricEntry{"separation", &Metrics::separation, "|min(D^1/2 f, D^-1/2 w)_+|_2 / S on unilateral rows"},
    MetricEntry{"cone", &Metrics::cone, "what D^1/2 f exceeds the friction cone by, over S"},
    MetricEntry{"dissipation", &Metrics::dissipation, "residual of friction rows with f clipped to the cone, over S"},
    MetricEntry{"joints", &Metrics::joints, "|D^-1/2 w|_2 / S on bilateral rows, and the residual of sliding rows"},
    MetricEntry{"beyond_bounds", &Metrics::beyond_bounds, "residual of bounded rows over S"},
    MetricEntry{"friction_power", &Metrics::friction_power, "sum f_t w_t / S^2 over friction rows"},
    MetricEntry{"created", &Metrics::created, "sum (f_t w_t)_+ / S^2 over friction rows"},
    MetricEntry{"energy", &Metrics::energy, "(b.f + f.A f / 2) / S^2, <= 0 for every solution with friction"},
    MetricEntry{"w_error", &Metrics::w_error, "max_i |w_i - w*_i| / (1 + |b|_inf), where w* is known"},
    MetricEntry{"f_error", &Metrics::f_error, "max_i |f_i - f*_i| / (1 + |f*|_inf), where f* is known and unique"},
    MetricEntry{"floor", &Metrics::floor,
                "rounding floor of the problem: answer_floor of a reference answer; tiers below it cannot be demanded"},
    MetricEntry{"answer_floor", &Metrics::answer_floor,
                "2^-53 |D^-1/2 |A||f||_2 / |D^-1/2 b|_2: what rounding f to double can add to rho"},
};

}  // namespace

std::span<const MetricEntry> AllMetrics() { return kMetrics; }

namespace {

constexpr double kUnitRoundoff = 0x1p-53;

// |A| |f|, or from factors its bound.
Eigen::VectorXd Magnitude(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::VectorXd absolute = f.cwiseAbs();
  switch (problem.given_form()) {
    case MatrixForm::kDense:
      return problem.DenseA().cwiseAbs() * absolute;
    case MatrixForm::kSparse:
      return problem.SparseA().cwiseAbs() * absolute;
    case MatrixForm::kFactors:
      break;
  }
  const SparseMatrix J = problem.J().cwiseAbs();
  return J * problem.inverse_mass().cwiseProduct(J.transpose() * absolute);
}

// |x|_2, of which units may make the squares too large or small for doubles. Eigen's own stableNorm ends on an
// assertion about the alignment of its copies where that is 64 bytes and vectors are narrower.
double NormInRange(const Eigen::VectorXd& x) {
  const double largest = x.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest)) return largest;
  return largest * (x / largest).norm();
}

}  // namespace

double RoundingFloor(const LcpProblem& problem, const Eigen::VectorXd& f) {
  if (f.size() != problem.size() || !f.allFinite()) return std::numeric_limits<double>::infinity();
  if (f.size() == 0) return 0;
  const Eigen::VectorXd root =
      problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1 : std::sqrt(std::abs(d)); });
  Eigen::VectorXd moved = Magnitude(problem, f).cwiseQuotient(root);
  for (const FrictionRow& row : problem.friction_rows()) {
    moved[row.row] += row.mu * root[row.row] * std::abs(f[row.normal]);
  }
  const double change = kUnitRoundoff * NormInRange(moved);
  const double load = problem.is_plain() ? NormInRange(problem.b().cwiseQuotient(root))
                                         : static_cast<double>(LoadScale(problem, root.cast<Extended>()));
  return load == 0 ? change : change / load;
}

}  // namespace lcpbench
