#include "solvers/rows/tiny_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/pivoting/tableau_rules.h"

namespace lcpbench {
namespace {

template <int n>
struct Tiny {
  double A[n][n], b[n], f[n], w[n];
  bool is_joint[n];

  // f for the active set `set`, 0 elsewhere. False where a row depends on others, or a contact's force or gap is wrong.
  bool Try(unsigned set) {
    double L[n][n];
    for (int i = 0; i < n; ++i) {
      f[i] = 0;
      if ((set >> i & 1U) == 0) continue;
      double y = -b[i];
      for (int j = 0; j <= i; ++j) {
        if ((set >> j & 1U) == 0) continue;
        double sum = A[i][j];
        for (int k = 0; k < j; ++k) {
          if ((set >> k & 1U) != 0) sum -= L[i][k] * L[j][k] * L[k][k];
        }
        if (j < i) {
          L[i][j] = sum / L[j][j];
          y -= L[i][j] * f[j];
        } else if (!(sum > tableau::kLeastPivot * A[i][i])) {
          return false;
        } else {
          L[i][i] = sum;
        }
      }
      f[i] = y;
    }
    for (int i = n - 1; i >= 0; --i) {
      if ((set >> i & 1U) == 0) continue;
      f[i] /= L[i][i];
      for (int k = i + 1; k < n; ++k) {
        if ((set >> k & 1U) != 0) f[i] -= L[k][i] * f[k];
      }
      if (!is_joint[i] && f[i] < 0) return false;
    }
    for (int i = 0; i < n; ++i) {
      w[i] = b[i];
      for (int j = 0; j < n; ++j) w[i] += A[i][j] * f[j];
      if ((set >> i & 1U) == 0 && w[i] < 0) return false;
    }
    return true;
  }

  bool Find() {
    unsigned joints = 0;
    unsigned guess = 0;
    for (int i = 0; i < n; ++i) {
      joints |= (is_joint[i] ? 1U : 0U) << i;
      guess |= (b[i] < 0 ? 1U : 0U) << i;
    }
    guess |= joints;
    if (Try(guess)) return true;
    for (unsigned set = 0; set < 1U << n; ++set) {
      if (set != guess && (set & joints) == joints && Try(set)) return true;
    }
    return false;
  }

  bool Passes(double tolerance, double row_limit, double* rho) const {
    double r_square = 0;
    double b_square = 0;
    double rounding_square = 0;
    bool rows_meet = true;
    for (int i = 0; i < n; ++i) {
      double size = std::abs(b[i]);
      for (int j = 0; j < n; ++j) size += std::abs(A[i][j] * f[j]);
      const double inverse = 1 / A[i][i];
      const double defect = is_joint[i] ? w[i] : std::min(w[i], A[i][i] * f[i]);
      r_square += defect * defect * inverse;
      b_square += b[i] * b[i] * inverse;
      rounding_square += size * size * inverse;
      rows_meet = rows_meet && std::abs(defect) <= row_limit * size;
    }
    const double norm = b_square > 0 ? b_square : 1;
    *rho = std::sqrt(r_square / norm);
    const double rounding = kRoundings * std::numeric_limits<double>::epsilon() * std::sqrt(rounding_square / norm);
    return *rho + rounding <= tolerance && rows_meet;
  }

  // Of sums of 2 p products and n of these, in epsilon times the sum of absolute values.
  static constexpr double kRoundings = 2 * 12 + 8;
};

template <int n, int p, typename Real>
bool SolveRows(const StepRows& all, const Real* J, std::span<const std::int32_t> part, double tolerance,
               double row_limit, double* f, double* w, double* rho) {
  Tiny<n> tiny;
  double jacobian[n][2 * p];
  std::int32_t body[n][2];
  for (int i = 0; i < n; ++i) {
    const Index row = part[static_cast<std::size_t>(i)];
    tiny.b[i] = all.b[row];
    tiny.is_joint[i] = all.bilateral != nullptr && all.bilateral[row] != 0;
    double momentum[2 * p];
    for (int s = 0; s < 2; ++s) {
      const std::int32_t of = all.body[2 * row + s];
      body[i][s] = of;
      for (int c = 0; c < p; ++c) {
        const double j = of < 0 ? 0.0 : static_cast<double>(J[(2 * row + s) * p + c]);
        jacobian[i][s * p + c] = j;
        momentum[s * p + c] = of < 0 ? 0.0 : all.inverse_mass[static_cast<Index>(of) * p + c] * j;
      }
    }
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int s = 0; s < 2; ++s) {
        for (int t = 0; t < 2; ++t) {
          if (body[i][s] < 0 || body[i][s] != body[j][t]) continue;
          for (int c = 0; c < p; ++c) sum += momentum[s * p + c] * jacobian[j][t * p + c];
        }
      }
      tiny.A[i][j] = tiny.A[j][i] = sum;
    }
    if (!(tiny.A[i][i] > 0)) return false;
  }
  if (!tiny.Find() || !tiny.Passes(tolerance, row_limit, rho)) return false;
  for (int i = 0; i < n; ++i) {
    const Index row = part[static_cast<std::size_t>(i)];
    f[row] = tiny.f[i];
    w[row] = tiny.w[i];
  }
  return true;
}

template <int p, typename Real>
bool SolveSize(const StepRows& all, const Real* J, std::span<const std::int32_t> part, double tolerance,
               double row_limit, double* f, double* w, double* rho) {
  switch (part.size()) {
    case 1:
      return SolveRows<1, p>(all, J, part, tolerance, row_limit, f, w, rho);
    case 2:
      return SolveRows<2, p>(all, J, part, tolerance, row_limit, f, w, rho);
    default:
      return SolveRows<3, p>(all, J, part, tolerance, row_limit, f, w, rho);
  }
}

}  // namespace

bool TinyRows::Solve(const StepRows& all, std::span<const std::int32_t> part, double tolerance, double row_limit,
                     double* f, double* w, double* rho) {
  const auto by = [&](const auto* J) {
    return all.columns_per_body == 3 ? SolveSize<3>(all, J, part, tolerance, row_limit, f, w, rho)
                                     : SolveSize<6>(all, J, part, tolerance, row_limit, f, w, rho);
  };
  return all.J != nullptr ? by(all.J) : by(all.J_single);
}

}  // namespace lcpbench
