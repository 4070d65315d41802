#include "benchmarks/campaign/sequences/sequence_cell.h"

#include <numeric>

#include "support/input_error.h"

namespace lcpbench {

using Json = nlohmann::ordered_json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SequenceRequest, sequence, file, sha256, solver, tier, judged, warm, deadline_s,
                                   time_per_row_s, least_s, most_s, budget_s)

std::string FormatSequenceRequest(const SequenceRequest& request) { return nlohmann::json(request).dump(); }

bool IsSequenceRequest(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  return json.is_object() && json.contains("sequence");
}

SequenceRequest ParseSequenceRequest(const std::string& line) {
  try {
    return nlohmann::json::parse(line).get<SequenceRequest>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(std::string("expected a request for a sequence: ") + error.what());
  }
}

std::string FormatSequenceReply(const SequenceReply& reply) {
  // A library's message may hold any bytes.
  const Json json = {{"outcome", reply.outcome}, {"detail", reply.detail}, {"results", reply.results}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SequenceReply ParseSequenceReply(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    return {json.at("outcome").get<std::string>(), json.at("detail").get<std::string>(), json.at("results")};
  } catch (const Json::exception& error) {
    throw InputError(std::string("expected a sequence's reply: ") + error.what());
  }
}

Json NothingReached(const std::vector<double>& judged, int steps) {
  std::vector<int> all(static_cast<std::size_t>(steps));
  std::iota(all.begin(), all.end(), 0);
  Json results;
  results["reached"] = 0;
  results["claims"] = Json::object();
  results["verdicts"] = Json::array();
  for (const double tier : judged) {
    results["verdicts"].push_back(
        {{"tier", tier}, {"passed", 0}, {"failed", steps}, {"false_successes", 0}, {"failed_steps", all}});
  }
  for (const char* field : {"late", "preempted", "latency_s", "iterations", "rho", "backward_error", "w_error"}) {
    results[field] = Json::array();
  }
  return results;
}

}  // namespace lcpbench
