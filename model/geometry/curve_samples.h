#pragma once

#include <functional>
#include <vector>

#include "model/geometry/smooth_curve.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// How densely a curve is sampled to bracket stationary points.
inline constexpr int kCurveSamples = 128;

/// The parameters (tau or s, SmoothCurve) a curve is sampled at, ascending: kCurveSamples spread evenly, ends and
/// inflections, and those with the given outward normals. An oval's first comes again at the end, a turn later.
std::vector<double> CurveSamples(const SmoothCurve& curve, const std::vector<Vec2>& outward_normals);

/// kCurveSamples directions, evenly spread over the plane.
std::vector<Vec2> EvenDirections();

/// The normals that face a curve's evenly spread points and its ends.
std::vector<Vec2> FacingNormals(const SmoothCurve& curve);

/// Narrows a bracket of a sign change of f to about 1e-9 of itself, by bisection: f may be steep or flat at its ends.
double NarrowedSignChange(double low, double high, const std::function<double(double)>& f);

}  // namespace lcpbench
