#include "solvers/rows/extended_rho.h"

#include <algorithm>
#include <cmath>

namespace lcpbench {
namespace {

using Extended = long double;

struct Body {
  const double* inverse_mass;
  Extended velocity[6];
};

}  // namespace

long double ExtendedRho(const StepRows& rows, const double* f) {
  const Index p = rows.columns_per_body;
  const auto number = [&](Index at) { return rows.J != nullptr ? Extended{rows.J[at]} : Extended{rows.J_single[at]}; };
  // Bodies in the order in which rows name them.
  std::int32_t names[2 * kMostExtendedRows];
  Body bodies[2 * kMostExtendedRows];
  int place[2 * kMostExtendedRows];  // by side of a row; -1: none
  int count = 0;
  for (Index side = 0; side < 2 * rows.rows; ++side) {
    const std::int32_t body = rows.body[side];
    place[side] = -1;
    if (body < 0) continue;
    int at = count - 1;
    while (at >= 0 && names[at] != body) --at;
    if (at < 0) {
      at = count++;
      names[at] = body;
      bodies[at] = {rows.inverse_mass + static_cast<Index>(body) * p, {}};
    }
    place[side] = at;
    for (Index c = 0; c < p; ++c) {
      bodies[at].velocity[c] += bodies[at].inverse_mass[c] * (number(side * p + c) * f[side / 2]);
    }
  }
  Extended sum = 0;
  Extended square = 0;
  for (Index i = 0; i < rows.rows; ++i) {
    Extended w = rows.b[i];
    Extended d = 0;
    const bool is_joined = place[2 * i] >= 0 && place[2 * i] == place[2 * i + 1];
    for (Index side = 2 * i; side < 2 * i + 2; ++side) {
      if (place[side] < 0) continue;
      const Body& body = bodies[place[side]];
      for (Index c = 0; c < p; ++c) {
        const Extended j = number(side * p + c);
        w += j * body.velocity[c];
        const Extended other = is_joined ? number((4 * i + 1 - side) * p + c) : 0;
        d += body.inverse_mass[c] * (j * (j + other));
      }
    }
    const bool is_joint = rows.bilateral != nullptr && rows.bilateral[i] != 0;
    const Extended unit = d > 0 ? d : 1;
    const Extended defect = is_joint ? w : std::min(unit * f[i], w);
    sum += defect * defect / unit;
    square += Extended{rows.b[i]} * rows.b[i] / unit;
  }
  return std::sqrt(square > 0 ? sum / square : sum);
}

}  // namespace lcpbench
