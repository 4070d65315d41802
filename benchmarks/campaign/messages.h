#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "solvers/lcp/fresh_pass.h"
#include "support/input_error.h"
#include "support/process_watch.h"

// std::optional as null or a value.
template <typename Value>
struct nlohmann::adl_serializer<std::optional<Value>> {
  static void to_json(json& to, const std::optional<Value>& from) { to = from ? json(*from) : json(nullptr); }
  static void from_json(const json& from, std::optional<Value>& to) {
    to = from.is_null() ? std::nullopt : std::optional<Value>(from.get<Value>());
  }
};

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

/// Run a timed pass over a stream (fresh_pass.h); every answer is judged afterwards.
struct TimedRequest {
  std::vector<ProblemName> stream;
  std::string solver;
  // Another solver, stream, launch or run than that of the request before has a process of its own.
  int launch = 0;
  int run = 0;                 ///< how often the launch was run again
  PassRequest pass;            ///< its other_b are made by the worker: AnotherB with `other_b_seed`
  std::vector<double> judged;  ///< tiers that the answers are judged at
  std::uint64_t other_b_seed = 1;
};

/// Run a solver over all problems of a sequence, in order.
struct SequenceRequest {
  std::string file;  ///< ReadSequenceFile
  std::string sha256;
  std::string solver;          ///< registry key
  double tier = 0;             ///< the tolerance asked for
  std::vector<double> judged;  ///< tiers that the answers are judged at
  bool warm = false;           ///< every step starts from the answer to the one before
  double deadline_s = 0;       ///< of a step's set-up and solve; 0: none
  SolveLimits limits;          ///< without a deadline
  double budget_s = 0;         ///< of the pass: no further step is begun after it
};

/// How a request ended.
struct Reply {
  std::string outcome = "completed";  ///< or how the worker's process ended: crashed, killed, out_of_memory
  std::string detail;                 ///< the reason, where it was not completed
  /// How a worker, or that of a solver in a process of its own, ended that something else killed, before a new one
  /// tried again. "": none did.
  std::string retried;
};

struct JudgeReply : Reply {
  std::vector<nlohmann::json> records;  ///< DescribeAnswer at every tier of `judged`; empty where not completed
};

struct TimedReply : Reply {
  /// Lists of the pass's TimeFields over the stream; empty where a problem was not timed.
  std::map<std::string, std::vector<std::optional<double>>> times;
  std::vector<std::vector<std::uint32_t>> failed;  ///< by tier of `judged`: places of answers that are not verified
  std::optional<Disturbance> disturbance;
};

struct SequenceReply : Reply {       ///< `outcome` may be budget, too
  nlohmann::json results = nullptr;  ///< DescribeSteps; null where the process ended
};

/// What a worker tells before what it does next: how long that may take [s], and its name in texts.
using BeginPhase = std::function<void(double limit_s, const std::string& name)>;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Disturbance, probe_s, cpu_share, switches)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SolveLimits, time_per_row_s, least_s, most_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProblemName, manifest, id)
// Without other_b, which the worker makes.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PassRequest, kind, tolerance, time_limit_s, longest_s, warm_up, settle_s, order)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgeRequest, problem, solver, tier, judged, time_limit_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedRequest, stream, solver, launch, run, pass, judged, other_b_seed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SequenceRequest, file, sha256, solver, tier, judged, warm, deadline_s, limits,
                                   budget_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgeReply, outcome, detail, retried, records)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedReply, outcome, detail, retried, times, failed, disturbance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SequenceReply, outcome, detail, retried, results)

/// A message as one line.
template <typename Message>
std::string Format(const Message& message) {
  // A library's message may hold any bytes.
  return nlohmann::json(message).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// @throws InputError for a line that is no such message
template <typename Message>
Message Parse(const std::string& line) {
  try {
    return nlohmann::json::parse(line).get<Message>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(std::string("expected a message between a campaign and its worker: ") + error.what());
  }
}

}  // namespace lcpbench
