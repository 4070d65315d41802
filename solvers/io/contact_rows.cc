#include "solvers/io/contact_rows.h"

#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {

ContactRows RowsOfContacts(int dimension, std::span<const double> mu, TangentRows tangents,
                           const std::function<void(const std::string& expected, const std::string& found)>& reject) {
  ContactRows rows;
  for (const double coefficient : mu) {
    const bool has_friction = coefficient != 0 && tangents != TangentRows::kNone;
    if (has_friction && coefficient < 0) reject("friction coefficients >= 0", NumberText(coefficient));
    if (has_friction && dimension > 2 && tangents == TangentRows::kOne) {
      reject(
          "friction coefficients 0 of contacts with two tangents, or `lcpbench convert --box-friction`, which bounds "
          "the force of each tangent, or --without-friction, which passes over them",
          NumberText(coefficient));
    }
    const int normal = rows.count;
    for (int k = 0; k < dimension; ++k) {
      const bool is_read = k == 0 || has_friction;
      rows.row.push_back(is_read ? rows.count++ : -1);
      if (is_read && k > 0) rows.friction.push_back({rows.row.back(), normal, coefficient});
    }
  }
  return rows;
}

void RequireNoFriction(const LcpProblem& problem, bool takes_bounded) {
  const auto refuse = [&](const char* kind, const char* expected) {
    throw InputError("problem '" + problem.id() + "' has " + kind + " rows, which the format has no place for; " +
                     expected);
  };
  if (!problem.friction_rows().empty())
    refuse("friction", "expected JSON lines, FCLib, or --without-friction, which drops them");
  if (!problem.bounded_rows().empty() && !takes_bounded) refuse("bounded", "expected JSON lines");
}

}  // namespace lcpbench
