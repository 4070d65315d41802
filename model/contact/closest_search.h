#pragma once

#include <string>
#include <vector>

#include "model/contact/closest_points.h"
#include "model/geometry/double_double.h"

namespace lcpbench {

/// Why a search found nothing.
enum class SearchFailure {
  kNone,
  kStartNotFinite,
  kNoStationaryPoint,  ///< without start: no change of sign was bracketed
  kDiverged,           ///< Newton's method did not converge, or converged to normals that do not face each other
  kSingular,           ///< it came to a place where D = 0
  kBeyondEnd,          ///< the stationary point lies beyond the end of a Bezier curve
};

/// The stationary points of the distance that a search found, and, where one of its starts led to none, why.
struct StationaryPoints {
  std::vector<ClosestPoints> points;
  SearchFailure failure = SearchFailure::kNone;
  std::string failure_text;  ///< in words, for the error that a caller may throw
};

/// Closest points of two features of which at least one is an ellipse, superellipse or Bezier curve. Unknown are the
/// places on the general curves alone, because a vertex or arc is where its centre is and a straight edge is its
/// normal:
///   centre q (vertex or arc) / curve:  c'.(q - c) = 0
///   straight, outward normal N / curve: c'.N = 0 with the outward normals opposite
///   curve / curve:                      c1' x c2' = 0 with the outward normals opposite, c2'.(p1 - p2) = 0
/// These stay regular at d = 0, where "the connecting line is normal to both" degenerates, and their Jacobians, taken
/// exactly from the 2-jets, are singular only where D = 0.
///
/// With start values (s1, s2): Newton's method from there (safeguarded_newton.h). Everything is evaluated in
/// DoubleDouble, so that n, d and the curvatures are accurate to the last digit of a double whatever D: the residuals'
/// rounding is below 1e-30 of the lengths. A curve pair with one start value takes those places of the other curve that
/// face it.
///
/// Without: every stationary point that can be bracketed. Along one curve (the Bezier curve of a mixed pair), at
/// kCurveSamples parameters spread evenly over it and at the places that face kCurveSamples normals of the other curve
/// (or, for a centre, kCurveSamples directions of the plane; so neither flat nor sharp parts go unseen), the residual
/// is computed with the other curve's facing place, which is known in closed form for ovals and is the root of a
/// quadratic for Bezier curves; each change of sign is narrowed and then finished by Newton's method. Two stationary
/// points closer together than the samples can escape. About 0.05 to 0.5 ms, against 3 to 15 microseconds from start
/// values.
///
/// The owner of the normal is the straight edge or the curve; of two curved edges, body 2's by convention. Swapping the
/// features swaps every result bit by bit but for that owner.
/// @param feature1, feature2  valid; two general curves, or one and any other feature
/// @param angles  exact ones take about 10 microseconds each and need the features' theta
StationaryPoints SearchStationaryPoints(const PlacedFeature& feature1, const PlacedFeature& feature2,
                                        const SearchStart& start, Angles angles = Angles::kRounded);

}  // namespace lcpbench
