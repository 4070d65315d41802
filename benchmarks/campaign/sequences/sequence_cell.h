#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lcpbench {

/// One cell of a campaign's sequences: a solver's pass over all problems of a sequence, in order. What the campaign
/// asks a worker for, and what comes back, travels as one JSON line each.
struct SequenceRequest {
  std::string sequence;  ///< id; the member tells the request from one for a single problem
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

/// How a pass ended, and what it found.
struct SequenceReply {
  std::string outcome;  ///< completed; budget; or how the worker ended: crashed, killed, out_of_memory
  std::string detail;   ///< the reason, where it was not completed
  nlohmann::ordered_json results = nlohmann::ordered_json::object();  ///< from `reached` on as in steps.jsonl
};

std::string FormatSequenceRequest(const SequenceRequest& request);
/// Whether a worker's line asks for a sequence.
bool IsSequenceRequest(const std::string& line);
/// @throws InputError for what is no request
SequenceRequest ParseSequenceRequest(const std::string& line);
std::string FormatSequenceReply(const SequenceReply& reply);
/// @throws InputError for what is no reply
SequenceReply ParseSequenceReply(const std::string& line);

/// What is found where the worker ended before it could tell: no step counts as reached.
nlohmann::ordered_json NothingReached(const std::vector<double>& judged, int steps);

}  // namespace lcpbench
