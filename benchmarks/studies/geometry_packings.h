#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "model/contact/system.h"
#include "model/detection/detection.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// Bodies that touch, for timing the way from outlines to rows. The same bits for the same seed on every machine.
struct Packing {
  std::vector<Body> bodies;
  std::vector<Outline> outlines;  ///< of the bodies, in their frames
  DetectionOptions options;       ///< within which every gap of a touching pair lies

  std::vector<const Outline*> OutlinePointers() const;
};

/// Packings of any number of contacts.
struct PackingFamily {
  std::string_view key;
  /// @param contacts  wanted, >= 100; detection finds about as many, to 20 %: a packing has a boundary
  Packing (*make)(int contacts, std::uint64_t seed);
};

///   disc-pile    the scene of that name: discs of many sizes, two contacts each, to rounding
///   ellipses     one ellipse many times on an affine image of the hexagonal packing, three contacts each
///   mixed-wall   rows of discs, rounded boxes, capsules and ellipses of several widths between parallel lines
/// The last two have every body moved and turned at random, by less than the tolerance, so that gaps and penetrations
/// differ and no two edges are exactly flush.
std::span<const PackingFamily> AllPackings();

}  // namespace lcpbench
