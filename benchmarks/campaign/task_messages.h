#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/measure/speed_probe.h"
#include "solvers/lcp/fresh_pass.h"

namespace lcpbench {

// What the runner of a campaign asks a worker for, and what comes back: one JSON line each.

/// A problem of a manifest, or of its fill-ups.
struct ProblemName {
  std::string manifest;  ///< path; the worker reads it, and its references, once
  std::string id;
};

/// Solve one problem and judge the answer.
struct JudgeRequest {
  ProblemName problem;
  std::string solver;          ///< registry key
  double tier = 0;             ///< the tolerance asked for
  std::vector<double> judged;  ///< tiers that the answer is judged at
  double time_limit_s = 0;
};

/// One verdict at a tier. A solver whose settings do not depend on the tolerance is judged at all tiers by one run.
struct TierVerdict {
  double tier = 0;
  bool passes = false;
  std::optional<double> best_tier;
  bool at_floor = false;
  bool false_success = false;
  bool false_infeasible = false;
  bool proved_infeasible = false;  ///< claimed infeasible, and the ray is accepted (verify.h)
  std::string reason;
};

/// What a worker found.
struct JudgeReply {
  std::string claim;  ///< the solver's status; or how its process ended: crashed, killed, out_of_memory
  std::int64_t iterations = -1;
  std::string detail;
  std::vector<TierVerdict> verdicts;
  nlohmann::json metrics = nlohmann::json::object();  ///< by key; null where not known or not finite
  std::optional<double> fresh_s;                      ///< from arrays to f, of this one solve by a new solver object
  std::optional<double> formed_on_host_s;             ///< of it, forming A here for a program of protocol version 1
  std::optional<double> factor_share;  ///< numeric factorizations by fresh_s; not known of other processes
  std::optional<double> peak_bytes;
  std::optional<std::int64_t> allocations;  ///< of the solve from arrays to f by a new solver object
};

/// Run a timed pass over a stream (fresh_pass.h); every answer is judged afterwards.
struct TimedRequest {
  std::vector<ProblemName> stream;
  std::string solver;
  PassRequest pass;            ///< its other_b are made by the worker: AnotherB with `other_b_seed`
  std::vector<double> judged;  ///< tiers that the answers are judged at
  std::uint64_t other_b_seed = 1;
};

/// Times by the place in the stream; empty where a problem was not timed.
struct TimedReply {
  std::string outcome = "completed";  ///< or how the process ended: crashed, killed, out_of_memory
  std::string detail;
  std::vector<std::optional<double>> seconds;
  std::vector<std::optional<double>> problem_s, prepare_s, convert_s, solve_s;  ///< of PassKind::kParts
  std::vector<std::vector<std::uint32_t>> failed;  ///< by tier of `judged`: places of answers that are not verified
  std::optional<Disturbance> disturbance;
};

std::string FormatRequest(const JudgeRequest& request);
std::string FormatRequest(const TimedRequest& request);
/// Whether a worker's line asks for a timed pass.
bool IsTimedRequest(const nlohmann::json& line);
/// @throws InputError for what is no request
JudgeRequest ParseJudgeRequest(const nlohmann::json& line);
TimedRequest ParseTimedRequest(const nlohmann::json& line);

std::string FormatReply(const JudgeReply& reply);
std::string FormatReply(const TimedReply& reply);
/// @throws InputError for what is no reply
JudgeReply ParseJudgeReply(const std::string& line);
TimedReply ParseTimedReply(const std::string& line);

/// A number with four digits, which is what a clock and a reader want; null where it is not finite. A campaign has
/// millions of them.
nlohmann::ordered_json RoundedNumber(double value);

}  // namespace lcpbench
