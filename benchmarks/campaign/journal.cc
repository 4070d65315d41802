#include "benchmarks/campaign/journal.h"

#include <algorithm>
#include <cstdio>
#include <tuple>
#include <utility>

#include "benchmarks/campaign/median_interval.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kJudge = "judge";

Json MembersOf(const Task& task, const std::string& size_class, double tier, const char* kind, int pass,
               const std::string& environment_hash) {
  Json line;
  line["solver"] = task.solver;
  line["size_class"] = size_class;
  line["tier"] = tier;
  line["kind"] = kind;
  line["pass"] = pass;
  line["first"] = task.first;
  line["count"] = task.end - task.begin;
  line["excluded"] = task.excluded;
  line["environment"] = environment_hash;
  return line;
}

Json Rounded(const std::optional<double>& value) { return value ? RoundedNumber(*value) : Json(nullptr); }

Json Rounded(const std::vector<std::optional<double>>& values) {
  Json array = Json::array();
  for (const std::optional<double>& value : values) array.push_back(Rounded(value));
  return array;
}

const TierVerdict* VerdictAt(const JudgeReply& reply, double tier) {
  for (const TierVerdict& verdict : reply.verdicts) {
    if (verdict.tier == tier) return &verdict;
  }
  return nullptr;
}

// Nothing where the answer was called solved and is verified, with nothing more to say.
Json ExceptionOf(std::size_t at, const Judged& judged, double tier) {
  const JudgeReply& reply = judged.reply;
  if (!judged.excluded.empty())
    return {{"at", at}, {"claim", "excluded"}, {"passes", false}, {"reason", judged.excluded}};
  const TierVerdict* verdict = VerdictAt(reply, tier);
  TierVerdict none;
  none.reason = reply.detail;
  if (verdict == nullptr) verdict = &none;
  if (reply.claim == "solved" && verdict->passes && !verdict->at_floor) return nullptr;
  return {{"at", at},
          {"claim", reply.claim},
          {"passes", verdict->passes},
          {"at_floor", verdict->at_floor},
          {"false_success", verdict->false_success},
          {"false_infeasible", verdict->false_infeasible},
          {"proved_infeasible", verdict->proved_infeasible},
          {"reason", verdict->reason},
          {"detail", reply.detail}};
}

}  // namespace

const char* KindKey(PassKind kind) {
  switch (kind) {
    case PassKind::kFresh:
      return "fresh";
    case PassKind::kParts:
      return "parts";
    case PassKind::kAgain:
      return "again";
  }
  return "unknown";
}

std::string TierText(double tier) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3e", tier);
  return text;
}

TaskKey::TaskKey(const Task& task, const std::string& of_class, double of_tier)
    : solver(task.solver), size_class(of_class), first(task.first), tier(TierText(of_tier)) {}

TaskKey::TaskKey(const nlohmann::json& line)
    : solver(line.at("solver").get<std::string>()),
      size_class(line.at("size_class").get<std::string>()),
      first(line.at("first").get<std::size_t>()),
      tier(TierText(line.at("tier").get<double>())) {}

Journal::Journal(const std::string& path)
    : file_(path, "a pass of a campaign", [this](const nlohmann::json& line) { Note(line); }) {}

bool Journal::Has(const TaskKey& key, const std::string& kind, int pass) const {
  return done_.count({key, kind, pass}) > 0;
}

const Journal::Judgement* Journal::Find(const TaskKey& key) const {
  const auto found = judged_.find(key);
  return found == judged_.end() ? nullptr : &found->second;
}

double Journal::FastProbe() const {
  constexpr std::size_t kOneIn = 10;
  return probes_.empty() ? std::numeric_limits<double>::infinity() : probes_[probes_.size() / kOneIn];
}

void Journal::Note(const nlohmann::json& line) {
  const TaskKey key(line);
  const auto kind = line.at("kind").get<std::string>();
  done_.insert({key, kind, line.at("pass").get<int>()});
  if (!line.at("excluded").get<std::string>().empty()) return;
  const auto median_of = [](const nlohmann::json& times, const auto& counts) {
    std::vector<double> known;
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (times[k].is_number() && counts(k)) known.push_back(times[k].template get<double>());
    }
    return known.empty() ? 0 : MedianOf(std::move(known));
  };
  Judgement& judged = judged_[key];
  if (kind == kJudge) {
    judged.attempted = line.at("attempted").get<std::size_t>();
    for (const nlohmann::json& exception : line.at("exceptions")) {
      const auto at = exception.at("at").get<std::size_t>();
      const auto claim = exception.at("claim").get<std::string>();
      if (!exception.at("passes").get<bool>()) judged.unverified.insert(at);
      if (claim == "time_limit" || claim == "killed" || claim == "excluded") judged.out_of_time.insert(at);
    }
    judged.median_s = median_of(line.at("first_s"), [&](std::size_t k) { return judged.unverified.count(k) == 0; });
    return;
  }
  const nlohmann::json& disturbance = line.at("disturbance");
  if (!disturbance.is_null()) {
    const auto probe_s = disturbance.at("probe_s").get<double>();
    probes_.insert(std::upper_bound(probes_.begin(), probes_.end(), probe_s), probe_s);
  }
  if (kind != KindKey(PassKind::kFresh)) return;
  const nlohmann::json& times = line.at("fresh_s");
  for (const nlohmann::json& time : times) judged.timed_s += time.is_number() ? time.get<double>() : 0;
  if (const double median_s = median_of(times, [](std::size_t) { return true; }); median_s > 0) {
    judged.median_s = median_s;
  }
}

void Journal::Append(const std::vector<Json>& lines) {
  if (lines.empty()) return;
  file_.Append(lines);
  for (const Json& line : lines) Note(nlohmann::json(line));
}

void Journal::WriteJudged(const Task& task, const std::string& size_class, const std::vector<Judged>& judged,
                          const std::string& environment_hash) {
  std::vector<Json> lines;
  for (const double tier : task.judged) {
    // Of a direct method's lines some may have been written before the campaign was killed.
    if (Has(TaskKey(task, size_class, tier), kJudge, 0)) continue;
    Json line = MembersOf(task, size_class, tier, kJudge, 0, environment_hash);
    line["attempted"] = judged.size();
    constexpr const char* kMetrics[] = {"rho", "backward_error", "gap_rel", "w_error", "f_error"};
    const auto column = [&](const char* name, const auto& value_of) {
      Json& values = line[name] = Json::array();
      for (const Judged& one : judged) values.push_back(value_of(one.reply));
    };
    for (const char* metric : kMetrics) {
      column(metric, [metric](const JudgeReply& reply) -> Json {
        const auto found = reply.metrics.find(metric);
        return found == reply.metrics.end() || !found->is_number() ? Json(nullptr)
                                                                   : RoundedNumber(found->get<double>());
      });
    }
    column("best_tier", [tier](const JudgeReply& reply) {
      const TierVerdict* verdict = VerdictAt(reply, tier);
      return verdict != nullptr && verdict->best_tier ? Json(*verdict->best_tier) : Json(nullptr);
    });
    column("iterations",
           [](const JudgeReply& reply) { return reply.iterations < 0 ? Json(nullptr) : Json(reply.iterations); });
    column("first_s", [](const JudgeReply& reply) { return Rounded(reply.fresh_s); });
    column("factor_share", [](const JudgeReply& reply) { return Rounded(reply.factor_share); });
    column("allocations",
           [](const JudgeReply& reply) { return reply.allocations ? Json(*reply.allocations) : Json(nullptr); });
    const bool is_version_1 = std::any_of(judged.begin(), judged.end(),
                                          [](const Judged& one) { return one.reply.formed_on_host_s.has_value(); });
    if (is_version_1) {
      column("formed_on_host_s", [](const JudgeReply& reply) { return Rounded(reply.formed_on_host_s); });
    }
    std::optional<double> peak;
    Json exceptions = Json::array();
    for (std::size_t k = 0; k < judged.size(); ++k) {
      if (const auto& bytes = judged[k].reply.peak_bytes) peak = std::max(peak.value_or(0), *bytes);
      if (Json exception = ExceptionOf(k, judged[k], tier); !exception.is_null()) {
        exceptions.push_back(std::move(exception));
      }
    }
    line["peak_bytes"] = peak ? Json(*peak) : Json(nullptr);
    line["exceptions"] = std::move(exceptions);
    lines.push_back(std::move(line));
  }
  Append(lines);
}

void Journal::WriteExcluded(const Task& task, const std::string& size_class, const std::string& environment_hash) {
  std::vector<Json> lines;
  for (const double tier : task.judged) {
    if (Has(TaskKey(task, size_class, tier), kJudge, 0)) continue;
    lines.push_back(MembersOf(task, size_class, tier, kJudge, 0, environment_hash));
  }
  Append(lines);
}

void Journal::WriteTimed(const Task& task, const std::string& size_class, PassKind kind, int pass, std::uint32_t group,
                         const TimedReply& reply, int reruns, bool disturbed, const std::string& environment_hash) {
  std::vector<Json> lines;
  for (std::size_t k = 0; k < task.judged.size(); ++k) {
    const double tier = task.judged[k];
    if (Has(TaskKey(task, size_class, tier), KindKey(kind), pass)) continue;
    Json line = MembersOf(task, size_class, tier, KindKey(kind), pass, environment_hash);
    line["outcome"] = reply.outcome;
    line["detail"] = reply.detail;
    switch (kind) {
      case PassKind::kFresh:
        line["group"] = group;
        line["fresh_s"] = Rounded(reply.seconds);
        break;
      case PassKind::kParts:
        line["problem_s"] = Rounded(reply.problem_s);
        line["prepare_s"] = Rounded(reply.prepare_s);
        line["convert_s"] = Rounded(reply.convert_s);
        line["solve_s"] = Rounded(reply.solve_s);
        break;
      case PassKind::kAgain:
        line["again_s"] = Rounded(reply.seconds);
        break;
    }
    line["failed"] = k < reply.failed.size() ? Json(reply.failed[k]) : Json::array();
    line["disturbance"] = nullptr;
    if (reply.disturbance) {
      line["disturbance"] = {{"probe_s", RoundedNumber(reply.disturbance->probe_s)},
                             {"cpu_share", RoundedNumber(reply.disturbance->cpu_share)},
                             {"switches", reply.disturbance->switches},
                             {"reruns", reruns},
                             {"disturbed", disturbed}};
    }
    lines.push_back(std::move(line));
  }
  Append(lines);
}

}  // namespace lcpbench
