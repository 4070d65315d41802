#include "benchmarks/campaign/messages.h"

#include "support/input_error.h"

// Of std::optional, as null or a value.
template <typename Value>
struct nlohmann::adl_serializer<std::optional<Value>> {
  static void to_json(json& to, const std::optional<Value>& from) { to = from ? json(*from) : json(nullptr); }
  static void from_json(const json& from, std::optional<Value>& to) {
    to = from.is_null() ? std::nullopt : std::optional<Value>(from.get<Value>());
  }
};

namespace lcpbench {

using Json = nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Disturbance, probe_s, cpu_share, switches)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProblemName, manifest, id)
// Without other_b, which the worker makes.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PassRequest, kind, tolerance, time_limit_s, warm_up, order, group, budget_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgeRequest, problem, solver, tier, judged, time_limit_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedRequest, stream, solver, pass, judged, other_b_seed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SequenceRequest, sequence, file, sha256, solver, tier, judged, warm, deadline_s,
                                   time_per_row_s, least_s, most_s, budget_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgeReply, outcome, detail, records)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedReply, outcome, detail, times, failed, disturbance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SequenceReply, outcome, detail, results)

template <typename Message>
std::string Format(const Message& message) {
  // A library's message may hold any bytes.
  return Json(message).dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <typename Message>
Message Parse(const std::string& line) {
  try {
    return Json::parse(line).get<Message>();
  } catch (const Json::exception& error) {
    throw InputError(std::string("expected a message between a campaign and its worker: ") + error.what());
  }
}

template std::string Format(const JudgeRequest& request);
template std::string Format(const TimedRequest& request);
template std::string Format(const SequenceRequest& request);
template std::string Format(const JudgeReply& reply);
template std::string Format(const TimedReply& reply);
template std::string Format(const SequenceReply& reply);
template JudgeReply Parse(const std::string& line);
template TimedReply Parse(const std::string& line);
template SequenceReply Parse(const std::string& line);

Request ParseRequest(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (json.is_object() && json.contains("sequence")) return Parse<SequenceRequest>(line);
  if (json.is_object() && json.contains("pass")) return Parse<TimedRequest>(line);
  return Parse<JudgeRequest>(line);
}

}  // namespace lcpbench
