#include "solvers/lcp/step_rows.h"

#include <bit>
#include <cmath>
#include <string>

#include "solvers/lcp/number_range.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

[[noreturn]] void Reject(const std::string& what) { throw InputError("step rows: " + what); }

void RequireArray(const void* array, const char* name) {
  if (array == nullptr) Reject(std::string(name) + " is missing");
}

// A number that is not what it must be, named by its row or body.
void RejectNumber(const StepRows& rows, const double* initial_f) {
  const Index p = rows.columns_per_body;
  const auto require = [](bool holds, const char* name, const char* place, Index index, double found,
                          const char* expected) {
    if (!holds) {
      Reject(std::string(name) + " of " + place + " " + std::to_string(index) + " is " + std::to_string(found) +
             ", expected " + expected);
    }
  };
  for (Index i = 0; i < rows.rows; ++i) {
    require(std::isfinite(rows.b[i]), "b", "row", i, rows.b[i], "a finite number");
    if (initial_f != nullptr)
      require(std::isfinite(initial_f[i]), "initial f", "row", i, initial_f[i], "a finite number");
    for (Index side = 0; side < 2; ++side) {
      const std::int32_t body = rows.body[2 * i + side];
      require(body >= -1 && body < rows.bodies, "body", "row", i, body,
              ("one in [-1, " + std::to_string(rows.bodies) + ")").c_str());
      for (Index c = 0; c < p; ++c) {
        const Index at = (2 * i + side) * p + c;
        const double j = rows.J != nullptr ? rows.J[at] : static_cast<double>(rows.J_single[at]);
        require(std::isfinite(j), "J", "row", i, j, "a finite number");
        if (body < 0) continue;
        const double m = rows.inverse_mass[body * p + c];
        require(std::isfinite(m) && m >= 0, "inverse mass", "body", body, m, "a finite number >= 0");
      }
    }
  }
}

}  // namespace

bool CheckRows(const StepRows& rows, const double* initial_f) {
  const Index p = rows.columns_per_body;
  if (p != 3 && p != 6) Reject("columns per body must be 3 or 6, found " + std::to_string(p));
  if (rows.rows < 0 || rows.bodies < 0) Reject("rows and bodies must be >= 0");
  if (rows.rows == 0) return true;
  RequireArray(rows.body, "body");
  RequireArray(rows.b, "b");
  if (rows.J == nullptr && rows.J_single == nullptr) Reject("J is missing");
  RequireArray(rows.bodies > 0 ? rows.inverse_mass : rows.b, "inverse mass");

  NumberRange of_factors(kFactorRange);
  NumberRange of_loads(kLoadRange);
  std::uint64_t negative = 0;
  bool is_known = true;
  if (rows.J != nullptr) {
    of_factors.Look(rows.J, 2 * p * rows.rows);
  } else {
    of_factors.Look(rows.J_single, 2 * p * rows.rows);
  }
  of_loads.Look(rows.b, rows.rows);
  for (Index k = 0; k < 2 * rows.rows; ++k) is_known &= rows.body[k] >= -1 && rows.body[k] < rows.bodies;
  if (is_known) {
    // Where few rows name bodies of a large world, only these are looked at.
    if (rows.bodies <= 2 * rows.rows) {
      of_factors.Look(rows.inverse_mass, rows.bodies * p);
      for (Index k = 0; k < rows.bodies * p; ++k) negative |= std::bit_cast<std::uint64_t>(rows.inverse_mass[k]);
    } else {
      for (Index k = 0; k < 2 * rows.rows; ++k) {
        if (rows.body[k] < 0) continue;
        const double* mass = rows.inverse_mass + rows.body[k] * p;
        of_factors.Look(mass, p);
        for (Index c = 0; c < p; ++c) negative |= std::bit_cast<std::uint64_t>(mass[c]);
      }
    }
  }
  bool is_finite = true;
  for (Index i = 0; i < rows.rows && initial_f != nullptr; ++i) is_finite &= std::isfinite(initial_f[i]);
  // -0.0 is allowed, but seldom: the slow way decides.
  if (!is_known || !is_finite || (negative >> 63U) != 0 || of_factors.has_large() || of_loads.has_large()) {
    RejectNumber(rows, initial_f);
  }
  return !of_factors.has_large() && of_loads.is_within() && (!of_factors.has_small() || HasDiagonalInRange(rows));
}

double DiagonalOf(const StepRows& rows, std::int64_t row) {
  const Index p = rows.columns_per_body;
  const auto j = [&](Index side, Index c) {
    const Index at = (2 * row + side) * p + c;
    return rows.J != nullptr ? rows.J[at] : static_cast<double>(rows.J_single[at]);
  };
  const std::int32_t first = rows.body[2 * row];
  const std::int32_t second = rows.body[2 * row + 1];
  double d = 0;
  for (Index c = 0; c < p && first >= 0; ++c) {
    const double sum = j(0, c) + (first == second ? j(1, c) : 0.0);
    d += rows.inverse_mass[first * p + c] * (sum * sum);
  }
  for (Index c = 0; c < p && second >= 0 && second != first; ++c) {
    d += rows.inverse_mass[second * p + c] * (j(1, c) * j(1, c));
  }
  return d;
}

bool HasDiagonalInRange(const StepRows& rows) {
  for (Index i = 0; i < rows.rows; ++i) {
    const double d = DiagonalOf(rows, i);
    if (!(d <= kEntryRange.most) || (d < kEntryRange.least && d > 0)) return false;
  }
  return true;
}

namespace {

// @param J  2 p numbers a row
template <int p, typename Number>
void Assemble(const StepRows& rows, const Number* J, double* A, Index stride) {
  for (Index i = 0; i < rows.rows; ++i) {
    double scaled[2][p] = {};  // of row i, by the inverse masses
    for (int side = 0; side < 2; ++side) {
      const std::int32_t body = rows.body[2 * i + side];
      for (int c = 0; c < p && body >= 0; ++c) {
        scaled[side][c] = rows.inverse_mass[body * p + c] * static_cast<double>(J[(2 * i + side) * p + c]);
      }
    }
    for (Index j = 0; j <= i; ++j) {
      double sum = 0;
      for (int side = 0; side < 2; ++side) {
        const std::int32_t body = rows.body[2 * i + side];
        for (int other = 0; other < 2; ++other) {
          if (body < 0 || rows.body[2 * j + other] != body) continue;
          const Number* const of = J + (2 * j + other) * p;
          for (int c = 0; c < p; ++c) sum += scaled[side][c] * static_cast<double>(of[c]);
        }
      }
      A[i * stride + j] = A[j * stride + i] = sum;
    }
    std::fill(A + i * stride + rows.rows, A + (i + 1) * stride, 0.0);
  }
}

}  // namespace

void AssembleDenseA(const StepRows& rows, double* A, Index stride) {
  if (rows.columns_per_body == 3) {
    rows.J != nullptr ? Assemble<3>(rows, rows.J, A, stride) : Assemble<3>(rows, rows.J_single, A, stride);
  } else {
    rows.J != nullptr ? Assemble<6>(rows, rows.J, A, stride) : Assemble<6>(rows, rows.J_single, A, stride);
  }
}

StepRows PartOf(const StepRows& rows, std::int64_t first, std::int64_t last) {
  StepRows part = rows;
  const std::int64_t width = std::int64_t{2} * rows.columns_per_body;
  part.rows = last - first;
  part.body += 2 * first;
  if (part.J != nullptr) part.J += width * first;
  if (part.J_single != nullptr) part.J_single += width * first;
  part.b += first;
  if (part.bilateral != nullptr) part.bilateral += first;
  return part;
}

}  // namespace lcpbench
