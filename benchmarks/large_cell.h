#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "benchmarks/oracle.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// What the study of large problems runs in processes of their own: one solve, or the oracle of one problem. Both
/// descriptions and outcomes travel as JSON.

struct LargeProblem {
  std::string family;
  int size = 0;
  std::uint64_t seed = 1;
  double mass_ratio = 1;  ///< above 1: SpreadMasses

  bool operator==(const LargeProblem&) const = default;
  LcpProblem Make() const;
};

struct SolveCell {
  LargeProblem problem;
  std::string solver;
  double tolerance = 1e-9;
  double time_limit_s = 60;
  bool cpu_time = false;    ///< times are of the processor, of all threads; time limits stay those of the wall clock
  std::string answer_file;  ///< f is written here where it is verified; empty: nowhere
};

struct SolveOutcome {
  std::string verdict;  ///< "verified", or what it is instead, in a word or two
  std::string detail;   ///< the solver's, or the judge's
  bool verified = false;
  double setup_s = -1;  ///< the fastest of a few runs, as solve_s; of a peer: conversions and its own preparation
  double solve_s = -1;  ///< of a peer: the library's call alone
  std::int64_t iterations = -1;
  double rho = -1;
  double backward_error = -1;
  double floor = -1;  ///< of rho, by rounding of f; these three are negative where they are not finite numbers
  /// Resident from set-up to the end of the solve, the problem included; of a peer: of its worker.
  double peak_bytes = -1;
};

struct OracleCell {
  LargeProblem problem;
  bool cpu_time = false;
  std::string answer_file;
};

struct OracleOutcome {
  int bodies = 0;  ///< that can move and touch an active row
  Index active = 0;
  Factorisation best;     ///< K, in body space
  double contact_s = -1;  ///< in contact space; negative where not measured
};

/// Solves that take less than this are repeated [s], a few times; solvers are set up anew each time.
inline constexpr double kRepeatBelow = 0.1;
/// Above so many rows contact space is not measured: finding independent rows takes much longer than all solves.
inline constexpr int kLargestContactSpace = 100'000;

/// @throws InputError for unknown keys
SolveOutcome RunSolveCell(const SolveCell& cell);
/// @throws InputError where the file has no answer, or there is no CHOLMOD
OracleOutcome RunOracleCell(const OracleCell& cell);

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LargeProblem, family, size, seed, mass_ratio)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SolveCell, problem, solver, tolerance, time_limit_s, cpu_time, answer_file)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SolveOutcome, verdict, detail, verified, setup_s, solve_s, iterations, rho,
                                   backward_error, floor, peak_bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OracleCell, problem, cpu_time, answer_file)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Factorisation, name, order_s, analyse_s, factor_s, solve_s, fill, flops)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OracleOutcome, bodies, active, best, contact_s)

}  // namespace lcpbench
