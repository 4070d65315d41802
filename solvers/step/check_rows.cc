#include "solvers/step/check_rows.h"

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

}  // namespace lcpbench
