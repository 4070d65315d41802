#pragma once

#include <functional>
#include <memory>

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of ShiftSolver.
struct ShiftOptions {
  /// As RelaxationOptions::make_plain.
  std::function<std::unique_ptr<LcpSolver>()> make_plain;

  /// Without make_plain. @throws InputError for any setting
  static ShiftOptions FromSettings(const Settings& settings);
};

/// Coulomb's law as the fixed point of relaxations: each round solves the relaxation (relaxation.h) with the gaps
/// shifted by what the last one slips, b_n + mu |w_t|, and then takes a few steps of mode-newton from there [De Saxce,
/// Feng 1991; Acary, Cadoux, Lemarechal, Malick 2011]. Only b changes between rounds, and each starts at the forces of
/// the last.
///
/// Takes what the relaxation takes. No guarantee: rounds may cycle (docs/friction.md section 5 has the rate of one
/// contact). Iterations are rounds and Newton steps; the default limit is 60 rounds. kSolved is claimed only for an f
/// that passes as the verifier judges; other ends leave the best f.
using ShiftSolver = EngineSolver<ShiftOptions, class ShiftEngine>;
extern template class EngineSolver<ShiftOptions, ShiftEngine>;

}  // namespace lcpbench
