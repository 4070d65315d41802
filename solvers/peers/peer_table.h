#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "solvers/lcp/method_class.h"

namespace lcpbench {

/// How a library is reached.
enum class PeerRoute {
  kCompiled,  ///< its C or C++ interface
  kPython,    ///< its Python module, by an interpreter within the worker: the time has some 50 to 200 us of Python's
};

/// Another project whose solvers run here, each project in a worker program of its own (solvers/peers/protocol/): these
/// libraries clash in one process, keep global state, or crash.
struct PeerProject {
  std::string_view folder;                 ///< of solvers/peers/; the program is lcpbench-worker-FOLDER
  std::string_view library;                ///< "Bullet", as people know it
  std::string_view licence;                ///< SPDX expression of the library as it is shipped
  PeerRoute route = PeerRoute::kCompiled;  ///< how its worker reaches it
};

/// What one solver is given for its own stopping options, by requested tier.
///
/// The rule for tuned keys is the same effort for every library; docs/peers.md states it, and where it fails.
/// Limits of iterations are so high that the time limit decides.
struct TierSettings {
  std::array<double, 3> tolerances;  ///< for the tiers 1e-3, 1e-6, 1e-9
  double most_iterations;            ///< or sweeps; 0: the library's own limit
  std::string_view bounds;           ///< what the solver stops at: the quantity that the tolerance bounds
};

/// The law of friction that a solver answers for (docs/friction.md section 1).
enum class FrictionLaw {
  kNone,          ///< takes no friction rows
  kCoulomb,       ///< of planar contacts
  kSpatial,       ///< Coulomb's in space, where a planar contact has a second tangent without loads
  kSweptBounds,   ///< bounds from the normal forces of the same sweep: where sweeps end at a fixed point, Coulomb's
  kFrozenBounds,  ///< bounds from the normal forces without friction, computed once
  kRelaxation,    ///< the associated law
};
/// In words: "Coulomb", "frozen bounds", ...; "" for kNone.
std::string_view ToString(FrictionLaw law);

/// How a problem with friction is given to a solver that knows none, in the worker and on the clock.
enum class Transformation {
  kNone,
  kFourRows,      ///< Coulomb's law as an LCP that is not symmetric (solvers/friction/four_rows.h)
  kRelaxation,    ///< the relaxed law as an LCP (solvers/friction/relaxation.h)
  kLaggedBounds,  ///< bounded rows, again and again until the bounds settle (solvers/friction/lagged_bounds.h)
};

/// One of its solvers.
struct PeerEntry {
  const PeerProject& project;  ///< whose it is
  std::string_view key;        ///< as in the registry
  std::string_view method;     ///< one line
  /// None for keys that end in "-default", being the library's own options untouched, and for solvers without a
  /// tolerance (pivoting codes, exact arithmetic), of which one run stands for every tier.
  std::optional<TierSettings> tiers = std::nullopt;
  /// What limits its size.
  MethodClass method_class = MethodClass::kDenseMatrix;
  /// So many sweeps whatever is asked for, as its users run it.
  bool fixed_effort = false;
  FrictionLaw law = FrictionLaw::kNone;  ///< that its answers obey
  /// Other than kNone: the solver `within` is given what the transformation makes of a problem, and no plain ones.
  Transformation transformation = Transformation::kNone;
  std::string_view within = {};  ///< the key of another entry of the project

  /// LcpSolver::TakesFriction.
  bool takes_friction() const { return law != FrictionLaw::kNone; }
  /// LcpSolver::TakesBounded: codes whose friction rows have bounds.
  bool takes_bounded() const {
    return law == FrictionLaw::kSweptBounds || law == FrictionLaw::kFrozenBounds ||
           transformation == Transformation::kLaggedBounds;
  }
  /// With the diagonal shift that engines use (constraint force mixing).
  bool is_shifted() const { return key.find("-cfm") != std::string_view::npos; }
  /// The library's own options, or a fixed effort: the adapter passes no tolerance.
  bool has_library_defaults() const { return key.ends_with("-default") || fixed_effort; }
};

/// All peers, in the report's order: those of the table, and behind a tuned key KEY-default where the library's own
/// options are no other key's.
std::span<const PeerEntry> AllPeers();

/// A solver that people ask for and that is not among the peers.
struct LeftOutSolver {
  std::string_view name;    ///< as people know it
  std::string_view reason;  ///< why, as a clause
};
/// All of them.
std::span<const LeftOutSolver> SolversLeftOut();

/// The tolerance for the loosest tier that is not looser than `tolerance`; that of 1e-9 for stricter ones.
/// @throws std::logic_error where the key is not that of a peer with tiers, here and below
double TierTolerance(std::string_view key, double tolerance);
/// Largest number of iterations, the same at all tiers.
double TierIterations(std::string_view key);

}  // namespace lcpbench
