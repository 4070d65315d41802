#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/speed_probe.h"

namespace lcpbench {

// How a cell is solved: every time from a cold start, with what it works on in the caches or not.
inline constexpr const char* kColdStart = "cold";
inline constexpr const char* kColdCache = "cold-cache";

/// One cell of a campaign: a solver on a problem at a tier. What the runner asks a worker for, and what comes back,
/// travels as one JSON line each.
struct CellRequest {
  std::string manifest;  ///< path; the worker reads it, and its references, once
  std::string problem;   ///< id
  std::string solver;    ///< registry key
  std::string mode = kColdStart;
  double tier = 0;             ///< the tolerance asked for
  std::vector<double> judged;  ///< tiers that the answer is judged at
  double time_limit_s = 0;
  int repetitions = 0;    ///< of this round, at most; one where the solve fails or takes long
  double min_time_s = 0;  ///< of a repetition: solves that take less are repeated within it
  double budget_s = 0;    ///< no further repetition is begun after it
};

/// One verdict at a tier. A solver whose settings do not depend on the tolerance is judged at all tiers by one run.
struct CellVerdict {
  double tier = 0;
  bool passes = false;
  std::optional<double> best_tier;
  bool at_floor = false;
  bool false_success = false;
  bool false_infeasible = false;
  bool proved_infeasible = false;  ///< claimed infeasible, and the ray is accepted (verify.h)
  std::string reason;
};

/// Allocations of a solve, without those of its set-up.
struct CellAllocations {
  std::int64_t first = 0;  ///< of the first solve of a new solver
  std::int64_t first_bytes = 0;
  std::optional<std::int64_t> later;  ///< of one that follows others, where there was one
};

/// What a worker found.
struct CellReply {
  std::string claim;  ///< the solver's status; or how its process ended: crashed, killed, out_of_memory
  std::int64_t iterations = -1;
  std::string detail;
  std::vector<CellVerdict> verdicts;
  nlohmann::json metrics = nlohmann::json::object();  ///< by key; null where not known or not finite
  std::vector<double> setup_s;
  std::optional<double> first_s;   ///< the first solve after set-up
  std::vector<double> solve_s;     ///< of every repetition
  std::vector<double> convert_s;   ///< of solvers in worker processes of their own
  std::optional<double> factor_s;  ///< in numeric factorisations, of a solve that took factor_of_s
  std::optional<double> factor_of_s;
  std::optional<double> peak_bytes;
  std::optional<CellAllocations> allocations;
  nlohmann::json counters;                 ///< of the first solve, by name (hardware_counters.h); null: none
  std::optional<Disturbance> disturbance;  ///< of the solves; where they are another process's, cpu_share is 1
  // The runner's part: how often the cell was run again because the machine disturbed it, and whether it still did.
  int reruns = 0;
  bool disturbed = false;
};

std::string FormatRequest(const CellRequest& request);
/// @throws InputError for what is no request
CellRequest ParseRequest(const std::string& line);
std::string FormatReply(const CellReply& reply);
/// @throws InputError for what is no reply
CellReply ParseReply(const std::string& line);

}  // namespace lcpbench
