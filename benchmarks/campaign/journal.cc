#include "benchmarks/campaign/journal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/measure/quantile.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kJudge = "judge";

std::string TierText(double tier) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3e", tier);
  return text;
}

Json Rounded(const std::vector<std::optional<double>>& values) {
  Json array = Json::array();
  for (const std::optional<double>& value : values) array.push_back(value ? RoundedNumber(*value) : Json(nullptr));
  return array;
}

// Only where there was one: nearly no line has any.
void AddRetry(const Reply& reply, const Json& at, Json* line) {
  if (!reply.retried.empty()) (*line)["retried"].push_back({{"at", at}, {"detail", reply.retried}});
}

// The times of a list; a missing one becomes infinity.
std::vector<double> Times(const nlohmann::json& list) {
  std::vector<double> times;
  for (const nlohmann::json& time : list) {
    times.push_back(time.is_number() ? time.get<double>() : std::numeric_limits<double>::infinity());
  }
  return times;
}

// The field of a problem's answer at the k-th tier; null without an answer.
Json FieldAt(const Judged& judged, std::size_t k, const char* name) {
  return k < judged.reply.records.size() ? Json(judged.reply.records[k].at(name)) : Json(nullptr);
}

// Null where the answer was called solved and is verified, with nothing more to say.
Json ExceptionOf(std::size_t at, const Judged& judged, std::size_t k) {
  const bool is_excluded = !judged.excluded.empty();
  const bool is_refused = !judged.not_taken.empty();
  Json exception = {{"at", at}};
  if (is_excluded || is_refused || judged.reply.records.empty()) {
    LcpResult none;
    none.detail = is_refused ? judged.not_taken : judged.reply.detail;
    Verdict verdict;
    verdict.reason = is_excluded ? judged.excluded : none.detail;
    for (const auto& field : ExceptionFields()) exception[field.name] = field.value({none, verdict});
    exception["claim"] = is_excluded  ? "excluded"
                         : is_refused ? ToString(LcpStatus::kUnsupported)
                                      : judged.reply.outcome;
    return exception;
  }
  for (const auto& field : ExceptionFields()) exception[field.name] = FieldAt(judged, k, field.name);
  if (exception["claim"] == "solved" && exception["passes"] == true && exception["at_floor"] == false) return nullptr;
  return exception;
}

std::map<TaskKey, std::size_t> PlannedKeys(const std::vector<Task>& tasks, const std::vector<Task>& sequences) {
  std::map<TaskKey, std::size_t> keys;
  for (const Task& task : tasks) {
    for (const double tier : task.judged) keys[TaskKey(task, tier)] = task.count();
  }
  for (const Task& pass : sequences) keys[TaskKey(pass, pass.tier)] = 0;
  return keys;
}

}  // namespace

const char* KindKey(PassKind kind) {
  constexpr std::array kKeys = {"fresh", "parts", "again"};
  return kKeys.at(static_cast<std::size_t>(kind));
}

TaskKey::TaskKey(const Task& task, double of_tier)
    : solver(task.solver), about(task.about), first(task.first), tier(TierText(of_tier)), mode(task.mode) {}

TaskKey::TaskKey(const nlohmann::json& line)
    : solver(line.at("solver").get<std::string>()),
      about(line.at(line.contains("sequence") ? "sequence" : "size_class").get<std::string>()),
      first(line.contains("sequence") ? 0 : line.at("first").get<std::size_t>()),
      tier(TierText(line.at("tier").get<double>())),
      mode(line.contains("sequence") ? line.at("mode").get<std::string>() : "") {}

LineKey KeyOfLine(const nlohmann::json& line) {
  if (line.contains("sequence")) return {TaskKey(line), "", line.at("round").get<int>()};
  return {TaskKey(line), line.at("kind").get<std::string>(), line.at("pass").get<int>()};
}

Journal::Journal(const std::string& folder, const std::vector<Task>& tasks, const std::vector<Task>& sequences,
                 const Launches& launches, int rounds, std::string environment_hash)
    : environment_hash_(std::move(environment_hash)),
      planned_(PlannedKeys(tasks, sequences)),
      launches_(launches),
      rounds_(rounds) {
  const auto open = [&](const char* file, const char* expected) {
    return std::make_unique<AppendOnlyFile>(folder + "/" + file, expected, [this](const auto& line) {
      RequireNew(line);
      Note(line);
    });
  };
  streams_ = open(kStreamsFile, "a pass of this campaign");
  if (!sequences.empty()) steps_ = open(kStepsFile, "a pass over a sequence of this campaign");
}

void Journal::RequireNew(const nlohmann::json& line) const {
  RequireFields(line);
  const LineKey line_key = KeyOfLine(line);
  const auto& [key, kind, pass] = line_key;
  const auto planned = planned_.find(key);
  if (planned == planned_.end()) {
    const auto is_known = [this](auto TaskKey::*field, const auto& value) {
      return std::any_of(planned_.begin(), planned_.end(), [&](const auto& of) { return of.first.*field == value; });
    };
    if (!is_known(&TaskKey::solver, key.solver)) throw InputError("solver '" + key.solver + "'");
    if (!is_known(&TaskKey::about, key.about)) throw InputError("size class or sequence '" + key.about + "'");
    if (!is_known(&TaskKey::tier, key.tier)) throw InputError("tier " + key.tier);
    throw InputError("a task of '" + key.solver + "' that it does not have");
  }
  const bool is_sequence = line.contains("sequence");
  const int least = is_sequence || kind == kJudge ? 0 : 1;
  const int most = is_sequence                         ? rounds_ - 1
                   : kind == kJudge                    ? 0
                   : kind == KindKey(PassKind::kFresh) ? launches_.near + launches_.repeats
                                                       : 1;
  const nlohmann::json& number = line.at(is_sequence ? "round" : "pass");
  if (number != pass || pass < least || pass > most) {
    throw InputError((is_sequence ? "round " : "pass ") + number.dump());
  }
  if (done_.count(line_key) > 0) {
    throw InputError("a second line of " + key.solver + " on " + key.about + " at " + key.tier +
                     (is_sequence ? ", " + key.mode + ", round " : ", " + kind + ", pass ") + std::to_string(pass));
  }
  if (is_sequence || !line.at("excluded").get<std::string>().empty()) return;
  if (kind == KindKey(PassKind::kFresh) && line.at("fresh_s").size() != planned->second) {
    throw InputError(std::to_string(line["fresh_s"].size()) + " times");
  }
  if (kind != kJudge) return;
  const auto attempted = line.at("attempted").get<std::size_t>();
  if (attempted > planned->second) throw InputError("attempted " + line.at("attempted").dump());
  for (const nlohmann::json& exception : line.at("exceptions")) {
    if (exception.at("at").get<std::size_t>() >= attempted)
      throw InputError("an exception at " + exception["at"].dump());
  }
}

void Journal::Synchronise() {
  for (AppendOnlyFile* file : {streams_.get(), steps_.get()}) {
    if (file != nullptr) file->Synchronise();
  }
}

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
  const auto& [key, kind, pass] = *done_.insert(KeyOfLine(line)).first;
  if (!line.at("excluded").get<std::string>().empty()) return;
  Judgement& judged = judged_[key];
  if (line.contains("sequence")) {
    if (pass > 0) return;
    const auto outcome = line.at("outcome").get<std::string>();
    judged.completed = outcome == "completed";
    if (outcome == "budget" || outcome == "killed") judged.out_of_time.insert(0);
    return;
  }
  if (kind == kJudge) {
    judged.attempted = line.at("attempted").get<std::size_t>();
    judged.first_s = Times(line.at("first_s"));
    for (const nlohmann::json& exception : line.at("exceptions")) {
      const auto at = exception.at("at").get<std::size_t>();
      const auto claim = exception.at("claim").get<std::string>();
      if (!exception.at("passes").get<bool>()) judged.unverified.insert(at);
      if (claim == "excluded" || claim == ToString(LcpStatus::kUnsupported)) judged.not_run.insert(at);
      const bool is_over = claim == "time_limit" && !exception.at("passes").get<bool>();
      if (is_over || claim == "killed" || claim == "excluded") judged.out_of_time.insert(at);
    }
    return;
  }
  const nlohmann::json& disturbance = line.at("disturbance");
  if (!disturbance.is_null()) {
    const auto probe_s = disturbance.at("probe_s").get<double>();
    probes_.insert(std::upper_bound(probes_.begin(), probes_.end(), probe_s), probe_s);
  }
  if (kind != KindKey(PassKind::kFresh)) return;
  const std::vector<double>& times = judged.launches[pass] = Times(line.at("fresh_s"));
  if (pass > launches_.others) return;
  for (const nlohmann::json& at : line.at("failed")) judged.changed.insert(at.get<std::size_t>());
  judged.quickest_s.resize(std::max(judged.quickest_s.size(), times.size()), std::numeric_limits<double>::infinity());
  for (std::size_t place = 0; place < times.size(); ++place) {
    judged.quickest_s[place] = std::min(judged.quickest_s[place], times[place]);
  }
}

bool Journal::IsOff(const Judgement& judged, int launch) const {
  constexpr std::size_t kLeast = 3;
  const auto own = judged.launches.find(launch);
  if (own == judged.launches.end() || judged.launches.size() < kLeast) return false;
  std::vector<double> levels;
  for (std::size_t place = 0; place < own->second.size(); ++place) {
    if (!std::isfinite(own->second[place])) continue;
    std::vector<double> times;
    for (const auto& [number, of_launch] : judged.launches) {
      const bool is_there = number <= launches_.near && place < of_launch.size();
      if (is_there && std::isfinite(of_launch[place])) times.push_back(of_launch[place]);
    }
    levels.push_back(own->second[place] / MedianOf(std::move(times)));
  }
  return !levels.empty() && std::abs(MedianOf(std::move(levels)) - 1) > kOff;
}

void Journal::Append(AppendOnlyFile* file, const std::vector<Json>& lines) {
  if (lines.empty()) return;
  file->Append(lines);
  for (const Json& line : lines) Note(nlohmann::json(line));
}

template <typename Complete>
void Journal::WriteByTier(const Task& task, const char* kind, int pass, const Complete& complete) {
  std::vector<Json> lines;
  for (std::size_t k = 0; k < task.judged.size(); ++k) {
    const double tier = task.judged[k];
    // Some lines of a direct method may have been written before the campaign was killed.
    if (Has(TaskKey(task, tier), kind, pass)) continue;
    lines.push_back(RecordOf<LineSource>(LineFields(), {task, tier, kind, pass, environment_hash_}));
    complete(k, &lines.back());
  }
  Append(streams_.get(), lines);
}

void Journal::WriteJudged(const Task& task, const std::vector<Judged>& judged) {
  WriteByTier(task, kJudge, 0, [&judged](std::size_t k, Json* line) {
    (*line)["attempted"] = judged.size();
    const auto column = [&](const char* name) {
      Json& values = (*line)[name] = Json::array();
      for (const Judged& one : judged) values.push_back(FieldAt(one, k, name));
    };
    for (const auto& field : ColumnFields()) column(field.name);
    Json peak = nullptr;
    Json exceptions = Json::array();
    for (std::size_t at = 0; at < judged.size(); ++at) {
      const Json bytes = FieldAt(judged[at], k, "peak_bytes");
      if (bytes.is_number() && (peak.is_null() || bytes > peak)) peak = bytes;
      Json exception = ExceptionOf(at, judged[at], k);
      if (!exception.is_null()) exceptions.push_back(std::move(exception));
    }
    for (const auto& field : RareColumnFields()) {
      const auto is_known = [&](const Judged& one) { return FieldAt(one, k, field.name).is_number(); };
      if (std::any_of(judged.begin(), judged.end(), is_known)) column(field.name);
    }
    (*line)["peak_bytes"] = peak;
    (*line)["exceptions"] = std::move(exceptions);
    for (std::size_t at = 0; at < judged.size(); ++at) AddRetry(judged[at].reply, at, line);
  });
}

void Journal::WriteExcluded(const Task& task) {
  if (task.sequence != nullptr) {
    Append(steps_.get(), {RecordOf<PassSource>(PassFields(), {task, 0})});
  } else {
    WriteByTier(task, kJudge, 0, [](std::size_t, Json*) {});
  }
}

void Journal::WriteTimed(const Task& task, PassKind kind, int launch, const TimedRun& run) {
  const TimedReply& reply = run.reply;
  WriteByTier(task, KindKey(kind), launch, [&](std::size_t k, Json* line) {
    (*line)["outcome"] = reply.outcome;
    (*line)["detail"] = reply.detail;
    if (kind == PassKind::kFresh) (*line)["began_s"] = run.began_s;
    AddRetry(reply, nullptr, line);
    for (const TimeField& field : TimeFields()) {
      if (field.kind != kind) continue;
      const auto times = reply.times.find(field.name);
      (*line)[field.name] = times == reply.times.end() ? Json::array() : Rounded(times->second);
    }
    (*line)["failed"] = k < reply.failed.size() ? Json(reply.failed[k]) : Json::array();
    Json& disturbance = (*line)["disturbance"] = nullptr;
    if (!reply.disturbance) return;
    disturbance = {{"probe_s", RoundedNumber(reply.disturbance->probe_s)},
                   {"cpu_share", RoundedNumber(reply.disturbance->cpu_share)},
                   {"switches", reply.disturbance->switches},
                   {"reruns", run.reruns},
                   {"disturbed", run.disturbed}};
  });
}

void Journal::WritePass(const Task& task, int round, const SequenceReply& reply) {
  Json line = RecordOf<PassSource>(PassFields(), {task, round});
  const auto steps = static_cast<int>(task.sequence->problems);
  nlohmann::json rest = reply.results.is_null() ? StepRecord(task.judged).Results(steps) : reply.results;
  rest["outcome"] = reply.outcome;
  rest["detail"] = reply.detail;
  rest["steps"] = steps;
  rest["environment"] = environment_hash_;
  for (const auto& [field, about] : ResultSchemaJson().at("steps").items()) line[field] = rest.at(field);
  AddRetry(reply, nullptr, &line);
  Append(steps_.get(), {line});
}

}  // namespace lcpbench
