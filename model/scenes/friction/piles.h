#pragma once

#include "model/contact/system.h"

namespace lcpbench {

// Round bodies that hold each other by friction, and structures of stones and cards, by the numbers that their facts
// are about [docs/friction.md section 8]. SI units, angles in rad.

/// Discs that grow upwards in wedges of two walls, each `alpha` from the vertical: every disc touches both walls and
/// the one below. Without depth the forces of one disc are unbounded if mu > tan alpha, and bounded if mu < tan alpha.
ContactSystem Wedges(int wedges, int layers, double alpha, double mu);

/// A disc on two others of its size on a floor, phi from the line of centres to the vertical, phi >= pi / 6. It stands
/// if and only if mu >= tan(phi / 2) between discs, and at the ground a third of that.
ContactSystem ThreeDiscs(double phi, double mu_top, double mu_ground);

/// Equal discs in rows of `base`, base - 1, ..., 1, each over the gap of two that touch in the row below. Rows of 2 to
/// 6 stand from these mu on: 0.268 (tan 15 deg), 0.434, 0.473, 0.498, 0.513.
ContactSystem Pyramids(int pyramids, int base, double mu);

/// A house of cards: `levels` rows of pairs that lean on each other, levels pairs in the lowest, plates between. Cards
/// of length 1 between the centres of their round ends, of radius 0.02, `angle` from the vertical. One pair stands if
/// and only if mu >= LeastCardFriction(angle); no house stands below that.
ContactSystem CardHouse(int levels, double angle, double mu);
double LeastCardFriction(double angle);

/// Half-circle arches of equal stones between the radii 1 and inner < 1, two contacts a joint. Of 5 stones and more, a
/// solution at rest exists for inner <= 0.8 and mu >= 0.5, and none for inner >= 0.95.
ContactSystem Arches(int arches, int stones, double inner, double mu);

}  // namespace lcpbench
