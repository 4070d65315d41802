#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/loads.h"
#include "model/contact/system.h"

namespace lcpbench {

// What pictures and animations show alike: how they tell things apart, and of bodies, connectors and forces the shapes.
// Colours of Okabe and Ito (2008), told apart by the colour-blind. Edges, forces and joints share none; what matters
// most, contact forces, has the strongest.

/// Kinds of edges that look different.
enum class EdgeKind { kStraight, kConvexArc, kConcaveArc, kEllipse, kSuperellipse, kBezier };

/// How a kind of edge is named in the legend, and drawn.
struct EdgeStyle {
  std::string_view name;
  std::string_view color;
};

/// By EdgeKind.
inline constexpr std::array<EdgeStyle, 6> kEdgeStyles{{{"straight edge", "#0072B2"},
                                                       {"convex arc", "#009E73"},
                                                       {"concave arc", "#CC79A7"},
                                                       {"ellipse", "#56B4E9"},
                                                       {"superellipse", "#E69F00"},
                                                       {"Bézier curve", "#000000"}}};

inline constexpr std::string_view kForceColor = "#D55E00";
inline constexpr std::string_view kSlideColor = "#7A1FA2";  ///< of forces of contacts that slide
inline constexpr std::string_view kInkColor = "#222222";
inline constexpr std::string_view kSoftInkColor = "#6B7280";
inline constexpr std::string_view kWhite = "#FFFFFF";
inline constexpr std::string_view kBodyFill = "#F1F3F5";
inline constexpr std::string_view kConeColor = "#8C8C8C";
/// Ground and stripes of fixed bodies, and of driven ones: fixed bodies that move as prescribed.
inline constexpr std::array<std::string_view, 2> kFixedFill{"#ECECEC", "#9A9A9A"};
inline constexpr std::array<std::string_view, 2> kDrivenFill{"#F3E8C8", "#A98A3A"};

/// A fixed body that moves, or begins to, as prescribed, or whose surface does.
bool IsDriven(const Body& body);

/// A body's outline as paths in its frame (svg.h).
struct BodyPaths {
  std::string fill;                                   ///< by the even-odd rule
  std::array<std::string, kEdgeStyles.size()> edges;  ///< by EdgeKind; "" where it has none
};
/// @param unit  path units per metre
/// @param band  depth of the hatching of unbounded bodies, which is their fill [path units]
BodyPaths PathsOf(const Body& body, double unit, double band);

/// What holds bodies together, or a point of one on a path of another.
struct Connector {
  std::string_view type;  ///< pin, path joint, rod, rope, spring or damper
  Attachment end1;        ///< of a path joint: the point on the path
  Attachment end2;        ///< of a path joint: the body that has the path
  double length = 0;      ///< of a rope [m]
  double side = 0;        ///< of springs and dampers with the same ends: 1 and -1, which are drawn beside each other
  std::vector<OutlineEdge> path = {};
};
/// @param loads  or null
std::vector<Connector> ConnectorsOf(const std::vector<Constraint>& joints, const Loads* loads);

/// A corner of the line that a rod, spring, damper or rope is drawn as: `along` is 0 at one end and 1 at the other,
/// `across` in units of the half width, of ropes of the sag.
struct SymbolPoint {
  double along;
  double across;
  bool down = true;  ///< a line leads here
};
std::vector<SymbolPoint> SymbolOf(std::string_view type);

/// The connector between two points of the page.
/// @param half    half width of springs and dampers [px], which the others are in proportion to
/// @param length  of a rope [px]
std::string ConnectorShape(const Connector& connector, Vec2 from, Vec2 to, double half, double length);
/// The mark of a pin, the end of a rod.
std::string PinShape(Vec2 at, double radius);
/// The mark of a point on a path with this normal.
std::string SliderShape(Vec2 at, Vec2 normal, double radius);

/// Where the row's force acts on the body that it is shown on, body 1, or body 2 where body 1 is fixed; world frame.
Vec2 PlaceOf(const ContactSystem& system, const RowInfo& row);

/// n entries: true for the normal row of a contact that bears force and slides. It slides where |w| of its friction row
/// exceeds the distance of the tangential force from its bound, and is large enough to be seen: a contact whose force
/// is on the edge of its cone may stick.
std::vector<bool> SlidingRows(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// The force of one constraint on that body; world frame.
struct DrawnForce {
  Vec2 at;              ///< [m]
  Vec2 force;           ///< [N]
  bool slides = false;  ///< of a contact that slides
};
/// In the order of the rows; the two rows of a pin are one force, and those of a contact with friction. Without those
/// that are 0 or not finite.
/// @param slides  SlidingRows, or empty: none does
std::vector<DrawnForce> ForcesOf(const ContactSystem& system, const std::vector<RowInfo>& rows,
                                 const Eigen::VectorXd& f, const std::vector<bool>& slides = {});

/// The friction cone of a contact that bears force, from `at` to where it is as high as the normal force.
struct DrawnCone {
  Vec2 at;                    ///< [m]
  std::array<Vec2, 2> sides;  ///< forces on its two edges [N]
};
std::vector<DrawnCone> ConesOf(const ContactSystem& system, const std::vector<RowInfo>& rows, const Eigen::VectorXd& f);

/// A line of the legend.
struct LegendItem {
  double width;        ///< of the symbol [px]
  std::string symbol;  ///< elements of SVG, from x = 0 to `width`, about y = 0
  std::string text;    ///< not escaped yet
};
/// The legend: kinds of edges, fixed bodies and connectors that are there, with their number.
std::vector<LegendItem> LegendOf(const std::vector<Body>& bodies, const std::vector<Connector>& connectors);
/// That of a friction cone.
LegendItem ConeItem();
/// "name (count)"
std::string Counted(std::string_view name, std::size_t count);

/// An axis-parallel box; empty until a point is added.
using Bounds = Eigen::AlignedBox2d;
inline Eigen::Vector2d PointOf(Vec2 p) { return {p.x, p.y}; }
/// The longer side; 0 where empty.
inline double ExtentOf(const Bounds& bounds) { return bounds.isEmpty() ? 0 : bounds.sizes().maxCoeff(); }

/// Bounds of the outline and the centre of mass, world frame.
Bounds BoundsOf(const Body& body);
std::vector<Bounds> BoundsOf(const std::vector<Body>& bodies);

/// What a picture of these bodies should show: the movable ones and `points`, and of the fixed ones those that are not
/// much larger, such as races and drums; floors and walls are clipped.
Bounds ViewOf(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds, const std::vector<Vec2>& points);

/// Median extent of the movable bodies that have an outline [m]; 0 without any.
double MedianExtent(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds);

}  // namespace lcpbench
