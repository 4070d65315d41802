#include "benchmarks/campaign/cell.h"

#include "solvers/lcp/input_error.h"

namespace lcpbench {

using Json = nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Disturbance, probe_s, cpu_share, switches)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CellRequest, manifest, problem, solver, mode, tier, judged, time_limit_s,
                                   repetitions, min_time_s, budget_s)

namespace {

template <typename Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <typename Value>
std::optional<Value> FromNull(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<Value>();
}

Json ToJson(const std::optional<CellAllocations>& allocations) {
  if (!allocations) return nullptr;
  return {
      {"first", allocations->first}, {"first_bytes", allocations->first_bytes}, {"later", OrNull(allocations->later)}};
}

std::optional<CellAllocations> AllocationsFrom(const Json& json) {
  if (json.is_null()) return std::nullopt;
  CellAllocations allocations;
  json.at("first").get_to(allocations.first);
  json.at("first_bytes").get_to(allocations.first_bytes);
  allocations.later = FromNull<std::int64_t>(json.at("later"));
  return allocations;
}

Json ToJson(const CellVerdict& verdict) {
  return {{"tier", verdict.tier},
          {"passes", verdict.passes},
          {"best_tier", OrNull(verdict.best_tier)},
          {"at_floor", verdict.at_floor},
          {"false_success", verdict.false_success},
          {"false_infeasible", verdict.false_infeasible},
          {"proved_infeasible", verdict.proved_infeasible},
          {"reason", verdict.reason}};
}

CellVerdict VerdictFrom(const Json& json) {
  CellVerdict verdict;
  json.at("tier").get_to(verdict.tier);
  json.at("passes").get_to(verdict.passes);
  verdict.best_tier = FromNull<double>(json.at("best_tier"));
  json.at("at_floor").get_to(verdict.at_floor);
  json.at("false_success").get_to(verdict.false_success);
  json.at("false_infeasible").get_to(verdict.false_infeasible);
  json.at("proved_infeasible").get_to(verdict.proved_infeasible);
  json.at("reason").get_to(verdict.reason);
  return verdict;
}

}  // namespace

std::string FormatRequest(const CellRequest& request) { return Json(request).dump(); }

CellRequest ParseRequest(const std::string& line) {
  try {
    return Json::parse(line).get<CellRequest>();
  } catch (const Json::exception& error) {
    throw InputError(std::string("expected a request for a cell: ") + error.what());
  }
}

std::string FormatReply(const CellReply& reply) {
  Json json;
  json["claim"] = reply.claim;
  json["iterations"] = reply.iterations;
  json["detail"] = reply.detail;
  json["verdicts"] = Json::array();
  for (const CellVerdict& verdict : reply.verdicts) json["verdicts"].push_back(ToJson(verdict));
  json["metrics"] = reply.metrics;
  json["setup_s"] = reply.setup_s;
  json["first_s"] = OrNull(reply.first_s);
  json["solve_s"] = reply.solve_s;
  json["convert_s"] = reply.convert_s;
  json["factor_s"] = OrNull(reply.factor_s);
  json["factor_of_s"] = OrNull(reply.factor_of_s);
  json["peak_bytes"] = OrNull(reply.peak_bytes);
  json["allocations"] = ToJson(reply.allocations);
  json["counters"] = reply.counters;
  json["disturbance"] = OrNull(reply.disturbance);
  // A library's message may hold any bytes.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

CellReply ParseReply(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    CellReply reply;
    json.at("claim").get_to(reply.claim);
    json.at("iterations").get_to(reply.iterations);
    json.at("detail").get_to(reply.detail);
    for (const Json& verdict : json.at("verdicts")) reply.verdicts.push_back(VerdictFrom(verdict));
    reply.metrics = json.at("metrics");
    json.at("setup_s").get_to(reply.setup_s);
    reply.first_s = FromNull<double>(json.at("first_s"));
    json.at("solve_s").get_to(reply.solve_s);
    json.at("convert_s").get_to(reply.convert_s);
    reply.factor_s = FromNull<double>(json.at("factor_s"));
    reply.factor_of_s = FromNull<double>(json.at("factor_of_s"));
    reply.peak_bytes = FromNull<double>(json.at("peak_bytes"));
    reply.allocations = AllocationsFrom(json.at("allocations"));
    reply.counters = json.at("counters");
    reply.disturbance = FromNull<Disturbance>(json.at("disturbance"));
    return reply;
  } catch (const Json::exception& error) {
    throw InputError(std::string("expected a cell's reply: ") + error.what());
  }
}

}  // namespace lcpbench
