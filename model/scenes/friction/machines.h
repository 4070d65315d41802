#pragma once

#include "model/contact/system.h"

namespace lcpbench {

// Joints and friction together, by the numbers that their facts are about [docs/friction.md section 8]. SI units,
// angles in rad.

/// Weightless beads on a drum, linked by rods between their contact points, 2 delta apart. Its ends are pulled along
/// the next chords by 1 N and by `pull`. It rests if and only if pull lies between 1 / r and r, r = CapstanRatio.
ContactSystem Capstans(int chains, int beads, double delta, double pull, double mu);
/// ((cos delta + mu sin delta) / (cos delta - mu sin delta))^beads, for mu tan delta < 1.
double CapstanRatio(int beads, double delta, double mu);

/// Boxes on a floor, pinned to each other, the first one pulled by `share` times mu times the weight of all. All slide
/// if and only if share > 1.
ContactSystem PulledChains(int chains, int boxes, double share, double mu);

/// Pairs of pinned wheels that carry a plank, which a rod at its lower face holds; every wheel is turned by `share`
/// times what the friction of half of the plank's weight bears. The wheels stand if and only if share <= 1.
ContactSystem FrictionDrives(int drives, double share, double mu);

/// A pinned lever whose round tip, `lean` from the normal, is pressed by a torque of 1 Nm against a pinned cam, which a
/// torque turns in the direction that draws the lever in. Where mu >= CamLockFriction(lean) it holds against any
/// torque; below, against CamHolds(lean, mu) and no more.
ContactSystem LockedCams(int cams, double lean, double torque, double mu);
double CamLockFriction(double lean);
double CamHolds(double lean, double mu);  ///< [Nm]

}  // namespace lcpbench
