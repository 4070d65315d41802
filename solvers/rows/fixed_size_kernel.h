#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "solvers/lcp/law.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/rows/fixed_size_bpp.h"
#include "solvers/rows/kernel.h"
#include "solvers/rows/profile_kernel.h"
#include "solvers/rows/two_body_product.h"

/// Internal to solvers/rows/: the kernel of FixedSizeBpp, in an unnamed namespace as vector_register.h says; and the
/// kernels of the folder together.
namespace lcpbench {
namespace {

// Active sets that are tried at most; and first by moving all wrong rows at once.
constexpr int kMostRounds = 12;
constexpr int kBlockRounds = 3;
// What the gap of a dependent row may be, in noise; and the change of a force with another below which it has none.
constexpr double kDependentNoise = 1e4;
constexpr double kLeastSlope = 1e-9;

// Not those of the standard library, which are not inlined in every build.
inline double Size(double x) { return __builtin_fabs(x); }
inline double Larger(double a, double b) { return a < b ? b : a; }

template <int n>
struct Tiny {
  double A[n][n] = {}, b[n], f[n], w[n];
  unsigned joints = 0;
  double noise = 0;
  // L D L^T of the last active set; `inverse` is 1/D, or 0 for a row that depends on those before it.
  double L[n][n], inverse[n];
  unsigned active = 0, depends = 0;

  // f for the active set `set`, 0 elsewhere and where a row depends on others. Returns the contacts whose force or gap
  // has the wrong sign, dependent ones apart: their gaps follow. Without branches, which fresh problems would
  // mispredict; rows that are not in the set are cut off by zeros.
  unsigned Try(unsigned set) {
    double y[n];
#pragma GCC unroll 8
    for (int i = 0; i < n; ++i) {
      const bool is_active = (set >> i & 1U) != 0;
      y[i] = is_active ? -b[i] : 0.0;
#pragma GCC unroll 8
      for (int j = 0; j < i; ++j) L[i][j] = is_active && (set >> j & 1U) != 0 ? A[i][j] : 0.0;
      L[i][i] = A[i][i];
    }
    active = set;
    depends = 0;
#pragma GCC unroll 8
    for (int k = 0; k < n; ++k) {
      const bool is_independent = L[k][k] > tableau::kLeastPivot * A[k][k];
      inverse[k] = is_independent ? 1 / L[k][k] : 0.0;
      depends |= (is_independent ? 0U : 1U) << k;
#pragma GCC unroll 8
      for (int i = n - 1; i > k; --i) {
        const double factor = L[i][k] * inverse[k];
#pragma GCC unroll 8
        for (int j = k + 1; j <= i; ++j) L[i][j] -= factor * L[j][k];
        y[i] -= factor * y[k];
        L[i][k] = factor;
      }
    }
#pragma GCC unroll 8
    for (int k = n - 1; k >= 0; --k) {
      f[k] = y[k] * inverse[k];
#pragma GCC unroll 8
      for (int i = k + 1; i < n; ++i) f[k] -= L[i][k] * f[i];
    }
    unsigned wrong = 0;
    for (int i = 0; i < n; ++i) {
      w[i] = b[i];
      for (int j = 0; j < n; ++j) w[i] += A[i][j] * f[j];
      const bool has_force = ((set & ~depends) >> i & 1U) != 0;
      const bool has_gap = (set >> i & 1U) == 0;
      wrong |= ((has_force && f[i] * A[i][i] < -noise) || (has_gap && w[i] < -noise) ? 1U : 0U) << i;
    }
    return wrong & ~joints;
  }

  // The active set when row r begins to push: with r, and without the row whose force vanishes first where r depends
  // on the active ones [Keller 1973].
  unsigned Enter(int r) const {
    double y[n];
    for (int i = 0; i < n; ++i) {
      y[i] = ((active & ~depends) >> i & 1U) != 0 ? A[i][r] : 0.0;
      for (int k = 0; k < i; ++k) y[i] -= L[i][k] * y[k];
    }
    double left = A[r][r];
    for (int k = n - 1; k >= 0; --k) {
      y[k] *= inverse[k];
      for (int i = k + 1; i < n; ++i) y[k] -= L[i][k] * y[i];
      left -= A[r][k] * y[k];
    }
    const unsigned with_r = active | 1U << r;
    if (left > tableau::kLeastPivot * A[r][r]) return with_r;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double least = kInfinity;
    unsigned leaves = 0;
    for (int k = 0; k < n; ++k) {
      const bool may_leave = ((active & ~(joints | depends)) >> k & 1U) != 0 && y[k] * A[k][k] > kLeastSlope * A[r][r];
      if (!may_leave || f[k] >= least * y[k]) continue;
      least = f[k] / y[k];
      leaves = 1U << k;
    }
    return with_r & ~leaves;
  }

  // From the rows with negative b, by block principal pivoting, then row by row.
  bool Find() {
    unsigned set = joints;
    for (int i = 0; i < n; ++i) {
      set |= (b[i] < 0 ? 1U : 0U) << i;
      noise = Larger(noise, tableau::kNoise * Size(b[i]));
    }
    for (int round = 0; round < kMostRounds; ++round) {
      const unsigned wrong = Try(set);
      if (wrong != 0 && round < kBlockRounds) {
        set ^= wrong;
      } else if ((wrong & active) != 0) {
        set ^= wrong & active;
      } else {
        int worst = -1;
        for (int i = 0; i < n; ++i) {
          const bool is_open = ((wrong | (depends & active & ~joints)) >> i & 1U) != 0;
          if (is_open && w[i] < -kDependentNoise * noise && (worst < 0 || w[i] < w[worst])) worst = i;
        }
        if (worst < 0) return true;
        set = Enter(worst);
        if (set == active) return false;
      }
    }
    return false;
  }

  // Forces that are negative by rounding become 0.
  void Clip() {
    unsigned negative = 0;
    for (int i = 0; i < n; ++i) negative |= (f[i] < 0 ? 1U : 0U) << i;
    negative &= ~joints;
    if (negative == 0) return;
    for (int i = 0; i < n; ++i) f[i] = (negative >> i & 1U) != 0 ? 0.0 : f[i];
    for (int i = 0; i < n; ++i) {
      w[i] = b[i];
      for (int j = 0; j < n; ++j) w[i] += A[i][j] * f[j];
    }
  }

  bool Passes(double tolerance, double row_limit, double* rho) const {
    LawSums<double> sums(row_limit);
    double squares = 0;
    for (int j = 0; j < n; ++j) squares += A[j][j] * f[j] * f[j];
    const double hidden = (n + tableau::kTermsBesideRows) * tableau::kRounding / (tableau::kHiddenInRow * row_limit);
    for (int i = 0; i < n; ++i) {
      double size = Size(b[i]);
      for (int j = 0; j < n; ++j) size += Size(A[i][j] * f[j]);
      sums.Add(A[i][i], b[i], w[i], f[i], (joints >> i & 1U) != 0, size);
      if (n > 1 && !(hidden * hidden * n * squares * A[i][i] <= size * size)) sums.DoubtRow();
    }
    return sums.Judge(tolerance, kRoundingOfTwoBodies<>, rho) == LawSums<double>::Known::kRight;
  }

  void Store(const std::int32_t* part, double* all_f, double* all_w) const {
    for (int i = 0; i < n; ++i) {
      const Index row = part[i];
      all_f[row] = f[i];
      all_w[row] = w[i];
    }
  }
};

template <int n, int p, typename Real>
bool SolveRows(const FewRows& rows, const Real* J, double* f, double* w, double* rho) {
  const StepRows& all = *rows.all;
  Tiny<n> tiny;
  for (int i = 0; i < n; ++i) {
    const Index row = rows.part[i];
    tiny.b[i] = all.b[row];
    tiny.joints |= (all.bilateral != nullptr && all.bilateral[row] != 0 ? 1U : 0U) << i;
  }
  if (!AssembleFew<p, 1>(all, J, rows.part, tiny.A)) return false;
  if (!tiny.Find()) return false;
  tiny.Clip();
  if (!tiny.Passes(rows.tolerance, rows.row_limit, rho)) return false;
  tiny.Store(rows.part, f, w);
  return true;
}

template <int p, typename Real, int... n>
bool SolveSize(const FewRows& rows, const Real* J, double* f, double* w, double* rho,
               std::integer_sequence<int, n...> /*rows less one*/) {
  static constexpr bool (*kBySize[])(const FewRows&, const Real*, double*, double*,
                                     double*) = {&SolveRows<n + 1, p, Real>...};
  return kBySize[rows.size - 1](rows, J, f, w, rho);
}

bool SolveFewRows(const FewRows& rows, double* f, double* w, double* rho) {
  return WithNumbers(*rows.all, [&](const auto* J, auto p) {
    return SolveSize<p>(rows, J, f, w, rho, std::make_integer_sequence<int, FixedSizeBpp::kMostRows>{});
  });
}

}  // namespace

extern const RowsKernel LCPBENCH_KERNEL(kRowsKernel){&SolveFewRows, &FactorizeProfile, &SolveProfile};

}  // namespace lcpbench
