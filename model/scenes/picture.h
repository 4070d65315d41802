#pragma once

#include <Eigen/Core>
#include <string>

#include "model/assembly.h"
#include "model/system.h"

namespace lcpbench {

/// A picture of a contact system and, where given, of its solution: a self-contained SVG document, y up, equal axes,
/// fitted to the movable bodies and the contacts. Bodies are filled lightly, their edges coloured by kind; fixed bodies
/// are hatched on the material side and clipped; every row is marked at its contact point with its normal; forces are
/// arrows, on body 1, of a length proportional to f. Colours are told apart by the colour-blind [Okabe, Ito 2008] and
/// doubled by shapes. Rows much wider than high are broken into strips. A legend below gives both scales. Every body is
/// an element with its name, mass and state as its tooltip. Identifiers start with the system's name, so that pictures
/// of different systems can share a page.
///
/// @param lcp  AssembleContactLcp(system)
/// @param f    n forces, or nullptr
/// @param w    n gap accelerations, or nullptr; rows are classified (f > 0, w > 0, both zero) only where both are given
/// @throws InputError if f or w has not n entries
std::string RenderSvg(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                      const Eigen::VectorXd* w);

}  // namespace lcpbench
