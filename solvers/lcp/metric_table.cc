#include "solvers/lcp/metric_table.h"

#include <array>

namespace lcpbench {
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
    MetricEntry{"w_error", &Metrics::w_error, "max_i |w_i - w*_i| / (1 + |b|_inf), where w* is known"},
    MetricEntry{"f_error", &Metrics::f_error, "max_i |f_i - f*_i| / (1 + |f*|_inf), where f* is known and unique"},
    MetricEntry{"floor", &Metrics::floor,
                "rounding floor of the problem: answer_floor of a reference answer; tiers below it cannot be demanded"},
    MetricEntry{"answer_floor", &Metrics::answer_floor,
                "2^-53 |D^-1/2 |A||f||_2 / |D^-1/2 b|_2: what rounding f to double can add to rho"},
};

}  // namespace

std::span<const MetricEntry> AllMetrics() { return kMetrics; }

}  // namespace lcpbench
