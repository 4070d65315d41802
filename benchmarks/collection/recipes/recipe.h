#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem on its way from a scene to the collection: the bodies, and rows that have a geometry each. Rows that were
/// added by a change stand last and have that of the row they were made from. A problem by a formula has no geometry.
struct Instance {
  ContactSystem system;
  std::vector<RowInfo> rows;
  LcpProblem problem;
  std::optional<Eigen::VectorXd> known_f = std::nullopt;  ///< its exact answer, of a formula (FormulaProblem)
};

/// One change of a generated problem, by name (kChanges in recipe.cc, which says what each leaves as it was), with its
/// one number.
struct Change {
  std::string name;
  double amount = 0;
  bool operator==(const Change&) const = default;
};

std::vector<std::string> AllChanges();

/// h of the problems of systems with friction [s].
inline constexpr double kInstantStep = 0.01;

/// The system's problem (AssembleInstant) after the changes, whose random choices are by the seed. Changes of edges
/// come first, wherever they stand in the list: rows are made from the edges. The same bits on every machine.
/// @throws InputError for an unknown change, a number that it refuses, and as AssembleContactLcp
Instance Changed(ContactSystem system, const std::vector<Change>& changes, std::uint64_t seed);

/// How a problem is made: a scene family or hard case, its size and seed, and changes in their order, of the same seed;
/// or a time step of a scene's motion (motion_steps.h); or a published formula (formulas.h), `changes` its parameter.
/// Everything that a problem's bits depend on.
struct Recipe {
  std::string scene;
  int rows = 0;
  std::uint64_t seed = 1;
  std::vector<Change> changes;
  /// From 1: the LCP of this time step. 0: the scene as it is placed. Problems of motions have no changes.
  int motion_step = 0;
  bool operator==(const Recipe&) const = default;
};

/// "<scene>-n<rows>-s<seed>", "-<change>-<amount>" for every change, "-motion-step<k>" for a step of a motion.
std::string RecipeId(const Recipe& recipe);

/// What dependent samples have in common: the id without changes, "<scene>-n<rows>-s<seed>", or, for all steps of one
/// motion, "<scene>-n<rows>-s<seed>-motion".
std::string BaseOf(const Recipe& recipe);

/// A problem of the recipe's id. A step of a motion costs all steps up to it.
/// @throws InputError naming the recipe, for an unknown scene, and as Changed
Instance MakeInstance(const Recipe& recipe);

/// How many constraints are of which kind: contacts by their two features' kinds ("arc on straight", concave edges as
/// "concave arc"), in alphabetical order, others by type ("pin").
std::map<std::string, int> CountKinds(const ContactSystem& system);

/// The same problem under another name.
LcpProblem WithId(const LcpProblem& given, std::string id);

/// ratio^u for ratio > 0 and u in [0, 1], by the leading 53 binary digits of u and repeated square roots: IEEE + * and
/// sqrt only, and so the same bits on every machine, which std::pow does not promise. Relative error below 1e-14.
double PortablePower(double ratio, double u);

/// Another right-hand side for the same matrix, as the next step of a driver with constant geometry has it:
///     b' = b - A d,   d_i = 0.1 |D^-1/2 b|_inf D_ii^-1/2 u_i,   D = diag A,
/// u_i uniform in [0, 1) on unilateral rows and in [-1, 1) on bilateral ones, 0 on friction rows and where A_ii = 0.
/// Where f is feasible for b, f + d is for b', so that the problem stays solvable (but for roundings where rows depend
/// on each other). Deterministic by seed.  O(entries of the given form)
Eigen::VectorXd AnotherB(const LcpProblem& problem, std::uint64_t seed);

}  // namespace lcpbench
