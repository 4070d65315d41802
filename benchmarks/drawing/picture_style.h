#pragma once

#include <array>
#include <string_view>

#include "model/geometry/feature.h"

namespace lcpbench {

// How pictures and animations tell things apart: the colours of Okabe and Ito (2008), told apart by the colour-blind.
// Edges, forces and joints share none; what matters most, contact forces, has the strongest.

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
inline constexpr std::string_view kInkColor = "#222222";
inline constexpr std::string_view kSoftInkColor = "#6B7280";
inline constexpr std::string_view kBodyFill = "#F1F3F5";
/// Ground and stripes of fixed bodies, and of driven ones: fixed bodies that move as prescribed.
inline constexpr std::array<std::string_view, 2> kFixedFill{"#ECECEC", "#9A9A9A"};
inline constexpr std::array<std::string_view, 2> kDrivenFill{"#F3E8C8", "#A98A3A"};

EdgeKind KindOf(const OutlineCurve& curve);
inline const EdgeStyle& StyleOf(EdgeKind kind) { return kEdgeStyles[static_cast<std::size_t>(kind)]; }

}  // namespace lcpbench
