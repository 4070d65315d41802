#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "model/geometry/double_double.h"
#include "model/geometry/smooth_curve.h"

namespace lcpbench {

/// A system of `count` equations for as many places on curves, at given places.
template <std::size_t count>
struct CurveEquations {
  std::array<DoubleDouble, count> step;  ///< Newton's step, in tau (oval) or s (Bezier)
  double residual = 0;                   ///< how far from solved: in radians, or parts of the curves' size
};

/// A place on each of one or two curves.
template <std::size_t count>
using CurvePlaces = std::array<CurvePlace<DoubleDouble>, count>;

/// Where Newton's method ended.
template <std::size_t count>
struct NewtonEnding {
  CurvePlaces<count> places;
  bool converged = false;
  bool nearly_solved = false;  ///< the equations hold roughly, whether converged or not
};

namespace safeguarded_newton {

// Steps are in tau or s, of order 1 over the whole curve.
inline constexpr int kMostSteps = 100;
inline constexpr int kMostHalvings = 40;
inline constexpr double kLongestOvalStep = 0.5;
inline constexpr double kLongestBezierStep = 0.1;
// Far above the rounding of DoubleDouble, far below that of double: one more step is taken from here, which squares it.
inline constexpr double kConvergedStep = 1e-18;
// Below this the residual may be rounding, which no step decreases.
inline constexpr double kSmallStep = 1e-12;
// A residual this small counts as a solution where the Jacobian is singular.
inline constexpr double kNearlySolved = 1e-6;
// What a residual must decrease by, as a part of what a linear function would.
inline constexpr double kSufficientDecrease = 1e-4;

inline double LongestStep(const SmoothCurve& curve) { return curve.is_oval() ? kLongestOvalStep : kLongestBezierStep; }

}  // namespace safeguarded_newton

/// Newton's method for places on curves, in DoubleDouble: steps bounded by half a radian of an oval or a tenth of a
/// Bezier curve, and halved until the residual decreases. Ends when a step is below 1e-18, and takes one more.
/// @param evaluate  places -> CurveEquations<count>
template <std::size_t count, class Evaluate>
NewtonEnding<count> SafeguardedNewton(const std::array<const SmoothCurve*, count>& curves, CurvePlaces<count> places,
                                      const Evaluate& evaluate) {
  using namespace safeguarded_newton;
  CurveEquations<count> now = evaluate(places);
  const auto stopped = [&] { return NewtonEnding<count>{places, false, now.residual <= kNearlySolved}; };
  for (int i = 0; i < kMostSteps; ++i) {
    // The longest part of the step, in units of what each curve allows.
    double excess = 0;
    double length = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double part = std::abs(now.step[k].hi);
      if (!std::isfinite(part)) return stopped();
      excess = std::max(excess, part / LongestStep(*curves[k]));
      length = std::max(length, part);
    }
    const auto moved = [&](double factor) {
      CurvePlaces<count> to;
      for (std::size_t k = 0; k < count; ++k) to[k] = curves[k]->Moved(places[k], DoubleDouble(factor) * now.step[k]);
      return to;
    };
    if (length <= kConvergedStep) return {moved(1), true, true};
    double factor = excess > 1 ? 1 / excess : 1;
    CurvePlaces<count> next = moved(factor);
    CurveEquations<count> then = evaluate(next);
    for (int k = 0; !(then.residual <= (1 - kSufficientDecrease * factor) * now.residual) && length > kSmallStep; ++k) {
      if (k == kMostHalvings) return stopped();
      factor /= 2;
      next = moved(factor);
      then = evaluate(next);
    }
    places = next;
    now = then;
  }
  return stopped();
}

}  // namespace lcpbench
