#include "model/scenes/packing_parts.h"

namespace lcpbench {

EllipseEdge Oval(double a, double b) { return {{}, a, b, 0, Side::kConvex}; }

Body MakeOval(Vec2 x, double theta, double a, double b, double density) {
  Body body;
  body.x = x;
  body.theta = theta;
  body.mass = kPi * a * b * density;
  body.inertia = body.mass * (a * a + b * b) / 4;
  body.outline = {OutlineEdge{Oval(a, b), 0, 2 * kPi}};
  return body;
}

Body MakeRing(Vec2 x, double outer_radius, double inner_radius, double density) {
  const double squares = outer_radius * outer_radius + inner_radius * inner_radius;
  Body body;
  body.x = x;
  body.mass = kPi * (outer_radius - inner_radius) * (outer_radius + inner_radius) * density;
  body.inertia = body.mass * squares / 2;
  body.outline = {FullCircle({}, outer_radius, Side::kConvex), FullCircle({}, inner_radius, Side::kConcave)};
  return body;
}

ArcEdge RoundedBoxShape::Corner(int corner_index) const {
  return {BoxCorner(width - 2 * corner, height - 2 * corner, corner_index), corner, Side::kConvex};
}

StraightEdge RoundedBoxShape::Edge(int edge) const {
  // The edge of the whole box, shortened by a corner at both ends.
  return edge % 2 == 0 ? BoxEdge(width - 2 * corner, height, edge) : BoxEdge(width, height - 2 * corner, edge);
}

Body MakeRoundedBox(Vec2 x, const RoundedBoxShape& shape, double density) {
  const double w = shape.width;
  const double h = shape.height;
  const double r = shape.corner;
  // The box, less a square at each corner, and a quarter disc about each corner's centre c instead. Moments per
  // density about the middle; a quarter disc's centroid is 4 r / (3 pi) from c along both axes.
  const Vec2 c{w / 2 - r, h / 2 - r};
  const Vec2 square{(w - r) / 2, (h - r) / 2};
  const double quarter = kPi * r * r / 4;
  const double centroid = 4 * r / (3 * kPi);
  const double square_inertia = r * r * (r * r / 6 + Dot(square, square));
  const double quarter_inertia = kPi * r * r * r * r / 8 + quarter * (Dot(c, c) + 2 * centroid * (c.x + c.y));
  Body body;
  body.x = x;
  body.mass = density * (w * h - 4 * (r * r - quarter));
  body.inertia = density * (w * h * (w * w + h * h) / 12 - 4 * (square_inertia - quarter_inertia));
  for (int k = 0; k < 4; ++k) {
    const StraightEdge edge = shape.Edge(k);
    body.outline.push_back(WholeEdge(edge.a, edge.b));
    // After the bottom comes the lower right corner, whose normals turn from down to right.
    body.outline.push_back({shape.Corner((k + 1) % 4), (k - 1) * kPi / 2, k * kPi / 2});
  }
  return body;
}

}  // namespace lcpbench
