#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
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

/// Run a timed pass over a stream (fresh_pass.h); every answer is judged afterwards.
struct TimedRequest {
  std::vector<ProblemName> stream;
  std::string solver;
  PassRequest pass;            ///< its other_b are made by the worker: AnotherB with `other_b_seed`
  std::vector<double> judged;  ///< tiers that the answers are judged at
  std::uint64_t other_b_seed = 1;
};

/// Run a solver over all problems of a sequence, in order.
struct SequenceRequest {
  std::string sequence;  ///< id
  std::string file;      ///< ReadSequenceFile
  std::string sha256;
  std::string solver;          ///< registry key
  double tier = 0;             ///< the tolerance asked for
  std::vector<double> judged;  ///< tiers that the answers are judged at
  bool warm = false;           ///< every step starts from the answer to the one before
  double deadline_s = 0;       ///< of a step's set-up and solve; 0: none
  // Without a deadline a solve may take time_per_row_s times its rows, within [least_s, most_s].
  double time_per_row_s = 0;
  double least_s = 0;
  double most_s = 0;
  double budget_s = 0;  ///< of the pass: no further step is begun after it
};

/// How a request ended.
struct Reply {
  std::string outcome = "completed";  ///< or how the worker's process ended: crashed, killed, out_of_memory
  std::string detail;                 ///< the reason, where it was not completed
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

/// As one line. Instances: the messages above.
template <typename Message>
std::string Format(const Message& message);

/// @throws InputError for a line that is no such message
template <typename Message>
Message Parse(const std::string& line);

using Request = std::variant<JudgeRequest, TimedRequest, SequenceRequest>;
/// @throws InputError for what is no request
Request ParseRequest(const std::string& line);

}  // namespace lcpbench
