#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/large_cell.h"

namespace lcpbench {

/// What is measured: solvers x families x mass ratios x sizes x seeds, every cell in a process of its own.
struct LargeStudy {
  std::vector<std::string> families;
  std::vector<int> sizes;  ///< rows, ascending
  std::vector<std::uint64_t> seeds;
  std::vector<double> mass_ratios = {1};
  std::vector<std::string> solvers;  ///< registry keys, peers among them
  double tolerance = 1e-9;
  bool cpu_time = false;       ///< of solves and K, instead of wall time: for a machine that does other things
  double time_limit_s = 60;    ///< of one solve at kTimedSize rows, see TimeLimit
  double memory_limit_gb = 8;  ///< address space of a cell [1e9 bytes]: what the largest problems may take at most
};

/// Checks every key and number. @throws InputError naming what does not fit
void ValidateStudy(const LargeStudy& study);

/// In proportion to the rows, between kLeastTimeLimitS and thrice the study's.
inline constexpr double kTimedSize = 1e5;
inline constexpr double kLeastTimeLimitS = 2;
double TimeLimit(const LargeStudy& study, int size);

/// Keys of the own solvers that are meant for large problems, in the registry's order: those that no size rule of the
/// suites stops, without plain sweeps, which need thousands of them, and formulations for a general optimiser.
std::vector<std::string> LargeOwnSolvers();
/// Keys of the peers in this build that no size rule stops at `size` rows.
std::vector<std::string> LargePeers(int size);

struct LargeRow {
  LargeProblem problem;
  std::string solver;
  SolveOutcome outcome;
  std::optional<OracleOutcome> oracle;  ///< of the problem
  std::string why_no_k;                 ///< where `oracle` is absent

  /// Set-up + solve; of a peer the solve alone, because its set-up is ours: conversions and what goes through pipes.
  double total_s() const;
  /// total_s() / K; negative where there is no K or no verified answer.
  double in_k() const;
};

/// Runs all cells, problem by problem; K is measured with the first verified answer. A cell that crashes, hangs,
/// exhausts memory or is excluded by a size limit (exclusion_rules.h) is a row that says so.
/// @param begin  told what comes next, before every cell
/// @param done   receives the rows of a problem when it is finished
std::vector<LargeRow> RunLargeStudy(const LargeStudy& study, const std::function<void(const std::string& what)>& begin,
                                    const std::function<void(const std::vector<LargeRow>& rows)>& done);

/// The arguments by which RunLargeStudy runs this program again, and what the program then has to do: one cell, its
/// outcome as JSON on standard output. @throws InputError for what is no cell
inline constexpr const char* kSolveCellOption = "--solve-cell";
inline constexpr const char* kOracleCellOption = "--oracle-cell";
void PrintSolveCell(const std::string& cell);
void PrintOracleCell(const std::string& cell);

}  // namespace lcpbench
