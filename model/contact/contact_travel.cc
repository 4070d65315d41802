#include "model/contact/contact_travel.h"

#include <cmath>

#include "model/contact/contact_row.h"
#include "support/input_error.h"

namespace lcpbench {

ContactTravel ComputeContactTravel(const ClosestPoints& closest, const Body& body1, const Body& body2) {
  const auto [r1, s1] = closest.curvature1;
  const auto [r2, s2] = closest.curvature2;
  const double u = ComputeContactRow(closest, body1, body2).slip;
  const double dw = body1.omega - body2.omega;
  const double D = closest.D();
  return {r1 * (r2 * dw - s2 * (u - closest.d * body1.omega)) / D,
          r2 * (r1 * dw + s1 * (u - closest.d * body2.omega)) / D};
}

ClosestPoints WithOneSidedCurvature(const ClosestPoints& closest, const std::optional<JoinCurvatures>& join1,
                                    const std::optional<JoinCurvatures>& join2, const Body& body1, const Body& body2) {
  if ((join1 && closest.curvature1.is_vertex()) || (join2 && closest.curvature2.is_vertex())) {
    throw InputError("a vertex has no one-sided curvature: expected two edges that join smoothly");
  }
  for (const bool along1 : {true, false}) {
    for (const bool along2 : {true, false}) {
      ClosestPoints c = closest;
      if (join1) c.curvature1.s = along1 ? join1->along_t : join1->against_t;
      if (join2) c.curvature2.s = along2 ? join2->along_t : join2->against_t;
      const bool vertex = c.curvature1.is_vertex() || c.curvature2.is_vertex();
      const double scale = vertex ? 1 : std::abs(c.curvature1.s) + std::abs(c.curvature2.s) + c.curvature_floor;
      if (!(c.D() > kSingularD * scale)) {
        throw InputError("not a contact on both sides of a join of edges: D = " + NumberText(c.D()) +
                         ", expected D > " + NumberText(kSingularD * scale) + " with curvatures " +
                         NumberText(c.curvature1.s) + " and " + NumberText(c.curvature2.s));
      }
      const ContactTravel travel = ComputeContactTravel(c, body1, body2);
      const bool agrees1 = !join1 || (along1 ? travel.sigma_dot1 >= 0 : travel.sigma_dot1 <= 0);
      const bool agrees2 = !join2 || (along2 ? travel.sigma_dot2 >= 0 : travel.sigma_dot2 <= 0);
      if (agrees1 && agrees2) return c;
    }
  }
  throw InputError("the travel of a contact over two joins of edges is not finite");
}

}  // namespace lcpbench
