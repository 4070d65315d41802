#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// One cell of a campaign: a solver on a problem at a tier. What the runner asks a worker for, and what comes back,
/// travels as one JSON line each.
struct CellRequest {
  std::string manifest;        ///< path; the worker reads it, and its references, once
  std::string problem;         ///< id
  std::string solver;          ///< registry key
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
  std::string reason;
};

/// What a worker found.
struct CellReply {
  std::string claim;  ///< the solver's status; or how its process ended: crashed, killed, out_of_memory
  std::int64_t iterations = -1;
  std::string detail;
  std::vector<CellVerdict> verdicts;
  nlohmann::json metrics = nlohmann::json::object();  ///< by key; null where not known or not finite
  std::vector<double> setup_s;
  std::vector<double> solve_s;    ///< of every repetition
  std::vector<double> convert_s;  ///< of solvers in worker processes of their own
  std::optional<double> peak_bytes;
};

std::string FormatRequest(const CellRequest& request);
/// @throws InputError for what is no request
CellRequest ParseRequest(const std::string& line);
std::string FormatReply(const CellReply& reply);
/// @throws InputError for what is no reply
CellReply ParseReply(const std::string& line);

}  // namespace lcpbench
