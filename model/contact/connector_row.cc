#include "model/contact/connector_row.h"

#include <cmath>
#include <string>

#include "support/input_error.h"

namespace lcpbench {

ConnectorRow ComputeConnectorRow(Vec2 vertex1, const Rotation& rotation1, const Body& body1, Vec2 vertex2,
                                 const Rotation& rotation2, const Body& body2, double length) {
  RequireValid(Vertex{vertex1});
  RequireValid(Vertex{vertex2});
  if (!(length > 0 && std::isfinite(length))) {
    throw InputError("the length of a rod or rope must be finite and > 0, found " + std::to_string(length));
  }
  ConnectorRow connector;
  ClosestPoints& points = connector.points;
  points.R1 = Rotate(rotation1, vertex1);
  points.R2 = Rotate(rotation2, vertex2);
  const Vec2 between = (body1.x - body2.x) + (points.R1 - points.R2);
  points.d = Norm(between);
  if (!(points.d > kSingularD * length)) {
    throw InputError("zero distance: the two attachment points coincide, a rod or rope has no direction; point 1: " +
                     Describe(Vertex{vertex1}) + "; point 2: " + Describe(Vertex{vertex2}));
  }
  points.n = {between.x / points.d, between.y / points.d};
  points.moment1 = Cross(points.R1, points.n);
  points.moment2 = Cross(points.R2, points.n);
  points.curvature1 = {0, 1};
  points.curvature2 = {0, 1};
  connector.row = ComputeContactRow(points, body1, body2);
  return connector;
}

}  // namespace lcpbench
