#pragma once

#include "model/contact/system.h"
#include "model/geometry/curve.h"

namespace lcpbench {

// Scenes on slopes, floors and steps, by the numbers that their facts are about [docs/friction.md section 8]. SI units,
// angles in rad.

/// Boxes of width x height stacked on a slope, each a little narrower than the one below; `stacks` of them. A stack
/// rests if and only if tan slope <= min(mu, width / (boxes height)).
ContactSystem SlopeStacks(int stacks, int boxes, double slope, double mu, double width, double height);

/// Discs of radius 0.5 on a slope that do not touch each other, with round holes of `hole` times their radius (0:
/// none). With I = beta m r^2 a disc rolls if and only if tan slope <= mu (1 + 1 / beta), by the friction
/// m g sin slope beta / (1 + beta).
ContactSystem DiscsOnSlope(int discs, double slope, double mu, double hole);

/// A disc of radius r that rolls at centre speed v on an arc of radius rho, `angle` from its top (convex) or bottom
/// (concave): f_n = m (g cos angle -+ v^2 / (rho +- r)), f_t = m g sin angle / 3 at the acceleration level.
ContactSystem DiscOnArc(Side side, double rho, double r, double angle, double v, double mu);

/// Ladders of length 2 that lean against walls of their own at `angle` from the floor, mu at both ends: they stand if
/// and only if tan angle >= (1 - mu^2) / (2 mu).
ContactSystem Ladders(int ladders, double angle, double mu);

/// Wheels of radius r that a horizontal force F at the centre pulls against a step of height k < r. A solution that
/// lifts the wheel without slip at the edge exists if and only if F (r - k) > m g sqrt(2 r k - k^2).
ContactSystem WheelsAtStep(int wheels, double r, double k, double F, double mu);

/// Ellipses with semi-axes a and b that roll on a floor, turned by `angle` and spinning at omega.
ContactSystem RollingOvals(int ovals, double a, double b, double angle, double omega, double mu);

}  // namespace lcpbench
