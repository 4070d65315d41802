#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/sides_of_bodies.h"

/// Internal to solvers/: A = J M^-1 J^T of rows on two bodies, the one coding of it in double. Kernels of instruction
/// sets include it, so that all of it is in an unnamed namespace and inlined (vector_register.h).
namespace lcpbench {
namespace {

/// The numbers of `together` rows on the same two bodies: J, and M^-1 J; 0 where there is no body.
template <int together, int p>
struct RowsOnBodies {
  std::int32_t body[2];
  double jacobian[together][2 * p], momentum[together][2 * p];

  /// False where the rows are on different bodies.
  template <typename Real>
  [[gnu::always_inline]] bool Load(const StepRows& step, const Real* J, const std::int32_t* rows) {
    bool are_together = true;
    for (int r = 0; r < together; ++r) {
      const Index row = rows[r];
      for (int s = 0; s < 2; ++s) {
        const std::int32_t of = step.body[2 * row + s];
        if (r == 0) body[s] = of;
        are_together = are_together && of == body[s];
        for (int c = 0; c < p; ++c) {
          const double j = of < 0 ? 0.0 : static_cast<double>(J[(2 * row + s) * p + c]);
          jacobian[r][s * p + c] = j;
          momentum[r][s * p + c] = of < 0 ? 0.0 : step.inverse_mass[static_cast<Index>(of) * p + c] * j;
        }
      }
    }
    return are_together;
  }
  /// sum[r][q] of row r here and row q there, over the sides that are on one body.
  [[gnu::always_inline]] void Multiply(const RowsOnBodies& other, double (*sum)[together]) const {
    for (int r = 0; r < together; ++r) {
      for (int q = 0; q < together; ++q) sum[r][q] = 0;
    }
    for (int s = 0; s < 2; ++s) {
      for (int t = 0; t < 2; ++t) {
        if (body[s] < 0 || body[s] != other.body[t]) continue;
        for (int r = 0; r < together; ++r) {
          for (int q = 0; q < together; ++q) {
            for (int c = 0; c < p; ++c) sum[r][q] += momentum[r][s * p + c] * other.jacobian[q][t * p + c];
          }
        }
      }
    }
  }
};

/// A of n rows, a few, by all pairs. False where rows that shall be together are not, or a row moves nothing.
/// @param together  so many rows in turn are on the same bodies: 1, or 2 for contacts with friction
template <int p, int together, int n, typename Real>
[[gnu::always_inline]] inline bool AssembleFew(const StepRows& step, const Real* J, const std::int32_t* rows,
                                               double (*A)[n]) {
  RowsOnBodies<together, p> of[n / together];
  for (int k = 0; k < n / together; ++k) {
    if (!of[k].Load(step, J, rows + Index{together} * k) && together > 1) return false;
    for (int l = 0; l <= k; ++l) {
      double sum[together][together];
      of[k].Multiply(of[l], sum);
      for (int r = 0; r < together; ++r) {
        for (int q = 0; q < together; ++q) {
          const int i = together * k + r, j = together * l + q;
          if (j <= i) A[i][j] = A[j][i] = sum[r][q];
        }
      }
    }
    for (int i = together * k; i < together * (k + 1); ++i) {
      if (!(A[i][i] > 0)) return false;
    }
  }
  return true;
}

/// A of the rows `part`, into rows of `stride` numbers that are 0 so far, by lists of the sides on each body.
/// @param jacobian  room for 2 p numbers a row
/// @param sides     reserved; none before and after
/// @param touch(i, j)  of each entry below the diagonal that is written, perhaps more than once
template <int p, typename Real, typename Touch>
[[gnu::always_inline]] inline void AssembleByBodies(const StepRows& step, const Real* J,
                                                    std::span<const std::int32_t> part, double* A, Index stride,
                                                    double* jacobian, SidesOfBodies* sides, const Touch& touch) {
  for (std::int32_t i = 0; i < std::ssize(part); ++i) {
    const Index given = part[static_cast<std::size_t>(i)];
    double* const own = jacobian + Index{2} * p * i;
    for (int c = 0; c < 2 * p; ++c) own[c] = static_cast<double>(J[Index{2} * p * given + c]);
    const std::int32_t bodies[2] = {step.body[2 * given], step.body[2 * given + 1]};
    const bool is_joined = bodies[0] == bodies[1];  // the row has one side: the sum of both
    for (int c = 0; c < p && is_joined; ++c) own[c] += own[p + c];
    double* const row = A + i * stride;
    double diagonal = 0;
    for (int s = 0; s < (is_joined ? 1 : 2); ++s) {
      if (bodies[s] < 0) continue;
      const double* const mass = step.inverse_mass + static_cast<Index>(bodies[s]) * p;
      double momentum[p];
      double of_side = 0;
      bool moves = false;
      for (int c = 0; c < p; ++c) {
        momentum[c] = mass[c] * own[s * p + c];
        of_side += mass[c] * (own[s * p + c] * own[s * p + c]);
        moves = moves || mass[c] > 0;
      }
      if (!moves) continue;
      diagonal += of_side;
      sides->ForEach(
          bodies[s], [&](std::int32_t other) __attribute__((always_inline)) {
            const Index j = other / 2;
            const double* const its = jacobian + Index{other} * p;
            double sum = row[j];
            for (int c = 0; c < p; ++c) sum += momentum[c] * its[c];
            row[j] = A[j * stride + i] = sum;
            touch(Index{i}, j);
          });
      sides->Add(bodies[s], 2 * i + s);
    }
    row[i] = diagonal;
  }
  for (const std::int32_t given : part) {
    for (Index side = Index{2} * given; side < Index{2} * given + 2; ++side) {
      if (step.body[side] >= 0) sides->Forget(step.body[side]);
    }
  }
}

}  // namespace
}  // namespace lcpbench
