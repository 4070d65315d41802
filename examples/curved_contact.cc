// A disc slides through the bottom of a round bowl: the bowl's curvature raises the force by m v^2 / (R - r). Bodies
// and one contact are assembled (model/contact/assembly.h), solved by `auto`, and the answer is verified.

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "model/contact/assembly.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

using lcpbench::ArcEdge;

int main() {
  const double g = 9.81, r = 0.5, R = 2, speed = 3;  // [m/s^2], radii of disc and bowl [m], [m/s]

  lcpbench::Body disc;
  disc.name = "disc";
  disc.mass = 2;
  disc.inertia = disc.mass * r * r / 2;
  disc.x = {0, r - R};  // touches the lowest point of the bowl, whose centre is the origin
  disc.v = {speed, 0};
  disc.force = {0, -disc.mass * g};

  lcpbench::Body bowl;
  bowl.name = "bowl";
  bowl.fixed = true;

  lcpbench::Constraint contact;  // between an edge of body 0 and one of body 1, each in its body's frame
  contact.body1 = 0;
  contact.body2 = 1;
  contact.feature1 = ArcEdge{.center = {0, 0}, .radius = r, .side = lcpbench::Side::kConvex};
  contact.feature2 = ArcEdge{.center = {0, 0}, .radius = R, .side = lcpbench::Side::kConcave};
  contact.s1 = contact.s2 = -std::numbers::pi / 2;  // where the search for the closest points begins

  const lcpbench::AssembledLcp lcp = lcpbench::AssembleContactLcp({"disc-in-bowl", {disc, bowl}, {contact}});
  lcpbench::LcpResult result;
  lcpbench::MakeSolver("auto")->Solve(lcp.problem, {.tolerance = 1e-9}, &result);
  const bool passes = lcpbench::Verify(lcp.problem, result, 1e-9).passes;

  const double expected = disc.mass * (g + speed * speed / (R - r));
  std::printf("%s: gap %g m, gamma %g m/s^2, f = %g N, expected %g N\n",
              std::string(lcpbench::ToString(result.status)).c_str(), lcp.rows[0].d, lcp.rows[0].gamma, result.f[0],
              expected);
  return passes && std::abs(result.f[0] - expected) < 1e-9 * expected ? 0 : 1;
}
