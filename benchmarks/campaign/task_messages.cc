#include "benchmarks/campaign/task_messages.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

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
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgeRequest, problem, solver, tier, judged, time_limit_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TierVerdict, tier, passes, best_tier, at_floor, false_success, false_infeasible,
                                   proved_infeasible, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgeReply, claim, iterations, detail, verdicts, metrics, fresh_s, formed_on_host_s,
                                   factor_share, peak_bytes, allocations)
// Without other_b, which the worker makes.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PassRequest, kind, tolerance, time_limit_s, warm_up, order, group, budget_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedRequest, stream, solver, pass, judged, other_b_seed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedReply, outcome, detail, seconds, problem_s, prepare_s, convert_s, solve_s,
                                   failed, disturbance)

namespace {

// A library's message may hold any bytes.
std::string Dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

template <typename Message>
Message Parse(const Json& json, const char* expected) {
  try {
    return json.get<Message>();
  } catch (const Json::exception& error) {
    throw InputError(std::string("expected ") + expected + ": " + error.what());
  }
}

}  // namespace

std::string FormatRequest(const JudgeRequest& request) { return Dump(request); }
std::string FormatRequest(const TimedRequest& request) { return Dump(request); }
bool IsTimedRequest(const Json& line) { return line.is_object() && line.contains("pass"); }
JudgeRequest ParseJudgeRequest(const Json& line) { return Parse<JudgeRequest>(line, "a problem to judge"); }
TimedRequest ParseTimedRequest(const Json& line) { return Parse<TimedRequest>(line, "a pass to time"); }

std::string FormatReply(const JudgeReply& reply) { return Dump(reply); }
std::string FormatReply(const TimedReply& reply) { return Dump(reply); }
JudgeReply ParseJudgeReply(const std::string& line) {
  return Parse<JudgeReply>(Json::parse(line, nullptr, false), "a judgement");
}
TimedReply ParseTimedReply(const std::string& line) {
  return Parse<TimedReply>(Json::parse(line, nullptr, false), "a pass's times");
}

nlohmann::ordered_json RoundedNumber(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[24];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

}  // namespace lcpbench
