#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

#include "model/contact/assembly.h"
#include "model/contact/loads.h"
#include "model/contact/system.h"

namespace lcpbench {

/// What a picture shows besides the system and its solution.
struct PictureExtras {
  /// Springs, dampers and gravity are drawn where given; not owned.
  const Loads* loads = nullptr;
  /// Follows the counts in the title line, such as the solver and the time; not too long.
  std::string caption;
};

/// A picture of a contact system and, where given, of its solution: a self-contained SVG document, y up, equal axes,
/// fitted to the movable bodies, the contacts and fixed bodies of a like size. Bodies are filled lightly, holes left
/// open, their edges coloured by kind (drawn_scene.h); fixed bodies are hatched, driven ones (that move as
/// prescribed) in a colour of their own with an arrow for their motion; unbounded ones (floors, the rim of a track) are
/// hatched on the material side and clipped. Every contact is marked at its point with its normal, by a shape that says
/// whether it bears force, and by a colour of its own where it slides; contacts with friction show the force of both
/// rows in the friction cone; joints, rods, ropes, springs and dampers have the usual symbols; forces are arrows, on
/// body 1 (on body 2 where body 1 is fixed), of a length proportional to f, with their values where there is room. Line
/// widths shrink with the bodies, and what could not be read is left out. Rows much wider than high are broken into
/// strips. A legend below gives the counts and both scales. Every body is an element with its name, mass and state as
/// its tooltip. Identifiers start with the system's name, so that pictures of different systems can share a page.
///
/// @param lcp  AssembleInstant(system, h)
/// @param f    n forces, or nullptr
/// @param w    n gap accelerations, or nullptr; rows are classified (f > 0, w > 0, both zero) only where both are given
/// @throws InputError if f or w has not n entries
std::string RenderSvg(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                      const Eigen::VectorXd* w, const PictureExtras& extras = {});

/// The answer that a picture shows.
struct PictureSolution {
  Eigen::VectorXd f;    ///< n forces
  Eigen::VectorXd w;    ///< n gap accelerations, of the verifier
  std::string caption;  ///< the solver and its verdict, in a few words
};

/// The answer of one solver whatever the verdict, or, without a key, the first verified answer of any solver of this
/// build; nothing where there is none, or no row.
/// @param solver_key  a registry key, or ""
/// @param limit_s  wall clock of the solver, > 0; without a key of all that are tried, and at most kPictureLimit
/// @throws InputError as MakeSolver
std::optional<PictureSolution> SolveForPicture(const LcpProblem& problem, const std::string& solver_key,
                                               double limit_s = std::numeric_limits<double>::infinity());
inline constexpr double kPictureLimit = 60;  ///< [s]

}  // namespace lcpbench
