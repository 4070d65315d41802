#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "model/geometry/double_double.h"
#include "model/geometry/smooth_curve.h"

namespace lcpbench {

/// Which of a pair's stationary points is meant. A search along general curves starts at s1, s2 where they are given;
/// otherwise it takes the local minimum (of a path joint: any stationary point with D != 0) whose gap is closest to
/// nominal_gap. Circles and lines have one local minimum at most and closed forms that need neither. A Bezier curve's
/// start is held to its neighbourhood.
struct SearchStart {
  std::optional<double> s1;
  std::optional<double> s2;
  double nominal_gap = 0;  ///< [m]
  /// From a start value, also up to SmoothCurve::kBezierMargin beyond the ends of a Bezier curve, on its continuation.
  bool beyond_ends = false;
};

/// The closest points of two features. World frame; 1 and 2 are the bodies.
struct ClosestPoints {
  Vec2 n;        ///< unit normal, ALWAYS from body 2 to body 1; t = Perp(n)
  double d = 0;  ///< signed gap [m]: p1 - p2 = d n, d < 0 penetrating
  Vec2 R1;       ///< contact arm p1 - x1 [m], from the centre of mass
  Vec2 R2;       ///< contact arm p2 - x2 [m]
  /// R1 x n and R2 x n [m], the columns of J. Taken with the arm to the centre of curvature where that is shorter (the
  /// row is the same), so that a disc about its centre of mass gets an exact zero.
  double moment1 = 0;
  double moment2 = 0;
  CurvaturePair curvature1;
  CurvaturePair curvature2;
  /// Where a general curve can be flat, what counts as curved [1/m]; joins |kappa1| + |kappa2| in the test of D.
  double curvature_floor = 0;
  /// Curve parameters of p1, p2 (feature.h); none for a vertex. For information and as the next search's start: no row
  /// depends on them, and angles (in (-pi, pi]) come from the library's atan2.
  std::optional<double> s1;
  std::optional<double> s2;

  bool has_vertex() const { return curvature1.is_vertex() || curvature2.is_vertex(); }
  /// What D is compared with: 1 of vertex and edge, the curvatures of two edges [1/m].
  double curvature_scale() const {
    return has_vertex() ? 1 : std::abs(curvature1.s) + std::abs(curvature2.s) + curvature_floor;
  }
  /// D = r1 s2 + s1 r2 + d s1 s2: the curvature of the distance along the edges, > 0 at a local minimum.
  double D() const {
    return curvature1.r * curvature2.s + curvature1.s * curvature2.r + d * (curvature1.s * curvature2.s);
  }
};

/// What a pair of features must satisfy to give a row.
enum class Regularity {
  kLocalMinimum,  ///< contact: D > 0, above rounding
  kNonzeroD,      ///< path joint: D != 0, beyond rounding; either side of the edge
};

/// D counts as zero up to this: times |kappa1| + |kappa2| (+ curvature_floor) for two edges, as it is for vertex and
/// edge.
inline constexpr double kSingularD = 1e-10;

/// The closest points of two features.  [docs/model.md section 2]
///   vertex or arc / straight (q on the edge's line):   d = n.(c - q) - rho,   n the edge's normal
///   vertex or arc / vertex or arc:                     d = sigma |c1 - c2| - (rho1 + rho2),
///                                                      n = sigma (c1 - c2) / |c1 - c2|,  sigma = sign(rho1 + rho2)
///   anything / ellipse, superellipse, Bezier curve:    SearchStationaryPoints (below)
/// with c the centre of curvature or the vertex and rho the signed radius: +R convex, -R concave, 0 vertex. A general
/// curve enters by its 2-jet at the closest point, its osculating circle there, and so must be searched anew at every
/// configuration. [docs/model.md section 4]
///
/// The first two are closed forms, O(1), evaluated in double; in DoubleDouble where an arc is nearly straight
/// (kFarCenter) or the edges nearly match (docs/geometry.md).
/// Corrects the paper's gap and normal of concave arcs and its gap of an arc on a straight edge, errata 2, 5 and 11.
/// [docs/model.md section 11]
/// Swapping the features swaps the result bit by bit (n changes sign).
/// @throws InputError naming the condition and both features, for invalid geometry (RequireValid), vertex/vertex,
///         straight/straight, equal radii of a convex and a concave arc, a search that does not converge or leaves a
///         Bezier curve, and wherever `required` does not hold
ClosestPoints FindClosestPoints(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                const SearchStart& start = {}, Regularity required = Regularity::kLocalMinimum);

/// The same closest points with bodies 1 and 2 exchanged.
ClosestPoints Swapped(const ClosestPoints& c);

/// The stationary points of the distance that a search found, and, where one of its starts led to none, why.
struct StationaryPoints {
  std::vector<ClosestPoints> points;
  std::string failure;  ///< in words, for the error that a caller may throw
  /// The failure is that the stationary point lies beyond the end of a Bezier curve.
  bool is_beyond_end = false;
};

/// Closest points of two features of which at least one is an ellipse, superellipse or Bezier curve. Unknown are the
/// places on the general curves alone, because a vertex or arc is where its centre is and a straight edge is its
/// normal:
///   centre q (vertex or arc) / curve:  c'.(q - c) = 0
///   straight, outward normal N / curve: c'.N = 0 with the outward normals opposite
///   curve / curve:                      c1' x c2' = 0 with the outward normals opposite, c2'.(p1 - p2) = 0
/// With start values (s1, s2): Newton's method from there; a curve pair with one start value takes those places of the
/// other curve that face it. Without: every stationary point that samples of one curve bracket. In DoubleDouble, so
/// that n, d and the curvatures are accurate to the last digit of a double whatever D. 3 to 15 microseconds, without
/// start values 0.05 to 0.5 ms. docs/geometry.md says how, and why these equations.
/// Swapping the features swaps every result bit by bit.
/// @param feature1, feature2  valid; two general curves, or one and any other feature
/// @param angles  exact ones take about 10 microseconds each and need the features' theta
StationaryPoints SearchStationaryPoints(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                        const SearchStart& start, Angles angles = Angles::kRounded);

/// A double keeps 16 digits of a length; beyond this ratio the closed forms would lose more than one of them.
inline constexpr double kFarCenter = 16;

}  // namespace lcpbench
