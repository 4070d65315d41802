#include "benchmarks/campaign/result_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string_view>
#include <utility>

#include "benchmarks/collection/plan.h"
#include "result_fields_text.h"
#include "solvers/lcp/rounding_floor.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;
using Answer = MeasuredAnswer;
using Described = DescribedProblem;

// Negative: not known.
Json KnownNumber(double value) { return value < 0 ? Json(nullptr) : RoundedNumber(value); }
Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

// Getters of members.
template <auto Member>
Json OfAnswer(const Answer& of) {
  return of.*Member < 0 ? Json(nullptr) : Json(of.*Member);
}
template <auto Member>
Json SecondsOf(const Answer& of) {
  return KnownNumber(of.*Member);
}
template <auto Member, typename Source>
Json OfTask(const Source& of) {
  return of.task.*Member;
}
template <auto Member, typename Source>
Json Of(const Source& of) {
  return of.*Member;
}
template <auto Member>
Json Metric(const Answer& of) {
  const double value = of.verdict.metrics.*Member;
  return value == -1 ? Json(nullptr) : RoundedNumber(value);
}
template <auto Member>
Json OfVerdict(const Answer& of) {
  return of.verdict.*Member;
}
bool HasRay(const Answer& of) {
  return of.result.status == LcpStatus::kInfeasible && of.verdict.farkas && of.verdict.farkas->accepted;
}
template <auto Member>
Json FieldOfPlan(const Described& of) {
  return of.planned.entry->*Member;
}
template <auto Member>
Json Property(const Described& of) {
  return OrNull(of.planned.entry->properties.*Member);
}

constexpr FieldOf<LineSource> kLine[] = {
    {"solver", OfTask<&Task::solver>},
    {"size_class", OfTask<&Task::about>},
    {"tier", Of<&LineSource::tier>},
    {"kind", Of<&LineSource::kind>},
    {"pass", Of<&LineSource::pass>},
    {"first", OfTask<&Task::first>},
    {"count", [](const LineSource& of) { return Json(of.task.count()); }},
    {"excluded", OfTask<&Task::excluded>},
    {"environment", [](const LineSource& of) { return Json(of.environment); }},
};

constexpr FieldOf<Answer> kColumns[] = {
    {"rho", Metric<&Metrics::rho>},
    {"backward_error", Metric<&Metrics::backward_error>},
    {"w_error", Metric<&Metrics::w_error>},
    {"f_error", Metric<&Metrics::f_error>},
    {"best_tier",
     [](const Answer& of) { return of.verdict.best_tier > 0 ? Json(of.verdict.best_tier) : Json(nullptr); }},
    {"iterations",
     [](const Answer& of) { return of.result.iterations < 0 ? Json(nullptr) : Json(of.result.iterations); }},
    {"first_s", SecondsOf<&Answer::first_s>},
    {"factor_share",
     [](const Answer& of) {
       return KnownNumber(of.result.factor_s >= 0 && of.first_s > 0 ? of.result.factor_s / of.first_s : -1);
     }},
};

constexpr FieldOf<Answer> kExceptions[] = {
    {"claim", [](const Answer& of) { return Json(ToString(of.result.status)); }},
    {"passes", OfVerdict<&Verdict::passes>},
    {"at_floor", OfVerdict<&Verdict::at_floor>},
    {"false_success", OfVerdict<&Verdict::false_success>},
    {"false_infeasible", OfVerdict<&Verdict::false_infeasible>},
    {"proved_infeasible", [](const Answer& of) { return Json(HasRay(of) && of.verdict.farkas->proved); }},
    {"infeasible_within_rounding", [](const Answer& of) { return Json(HasRay(of) && !of.verdict.farkas->proved); }},
    {"force_min",
     [](const Answer& of) {
       return HasRay(of) && !of.verdict.farkas->proved ? RoundedNumber(of.verdict.farkas->force_min) : Json(nullptr);
     }},
    {"below_floor",
     [](const Answer& of) {
       const LcpStatus claim = of.result.status;
       const bool has_claim = claim == LcpStatus::kSolved || claim == LcpStatus::kInfeasible;
       return Json(!of.verdict.passes && !has_claim && IsBelowFloor(of.verdict.metrics, of.verdict.requested));
     }},
    {"reason", OfVerdict<&Verdict::reason>},
    {"detail", [](const Answer& of) { return Json(of.result.detail); }},
};

constexpr FieldOf<Answer> kRareColumns[] = {
    {"formed_on_host_s", SecondsOf<&Answer::formed_on_host_s>},
    {"model_rho", [](const Answer& of) { return KnownNumber(of.verdict.model_rho); }},
    {"penetration", Metric<&Metrics::penetration>},
    {"adhesion", Metric<&Metrics::adhesion>},
    {"separation", Metric<&Metrics::separation>},
    {"cone", Metric<&Metrics::cone>},
    {"dissipation", Metric<&Metrics::dissipation>},
    {"joints", Metric<&Metrics::joints>},
    {"beyond_bounds", Metric<&Metrics::beyond_bounds>},
    {"friction_power", Metric<&Metrics::friction_power>},
    {"created", Metric<&Metrics::created>},
    {"energy", Metric<&Metrics::energy>},
};

constexpr FieldOf<Answer> kOfTheLine[] = {{"peak_bytes", OfAnswer<&Answer::peak_bytes>}};

constexpr TimeField kTimes[] = {
    {"fresh_s", PassKind::kFresh, &PassEntry::seconds},     {"problem_s", PassKind::kParts, &PassEntry::problem_s},
    {"prepare_s", PassKind::kParts, &PassEntry::prepare_s}, {"convert_s", PassKind::kParts, &PassEntry::convert_s},
    {"solve_s", PassKind::kParts, &PassEntry::solve_s},     {"again_s", PassKind::kAgain, &PassEntry::seconds},
};

constexpr FieldOf<PassSource> kPass[] = {
    {"sequence", OfTask<&Task::about>},
    {"solver", OfTask<&Task::solver>},
    {"tier", OfTask<&Task::tier>},
    {"mode", OfTask<&Task::mode>},
    {"deadline_s",
     [](const PassSource& of) { return of.task.deadline_s > 0 ? Json(of.task.deadline_s) : Json(nullptr); }},
    {"round", Of<&PassSource::round>},
    {"excluded", OfTask<&Task::excluded>},
};

constexpr FieldOf<Described> kProblem[] = {
    {"problem", FieldOfPlan<&ManifestEntry::id>},
    {"set", [](const Described& of) { return Json(of.set); }},
    {"family", FieldOfPlan<&ManifestEntry::family>},
    {"grid", FieldOfPlan<&ManifestEntry::grid>},
    {"base", FieldOfPlan<&ManifestEntry::base>},
    {"weight", [](const Described& of) { return Json(of.planned.weight); }},
    {"origin", FieldOfPlan<&ManifestEntry::origin>},
    {"fill", FieldOfPlan<&ManifestEntry::fill>},
    {"size_class", [](const Described& of) { return Json(of.planned.size_class->key); }},
    {"rows", [](const Described& of) { return Json(of.problem.size()); }},
    {"bilateral", [](const Described& of) { return Json(of.problem.bilateral_rows().size()); }},
    {"friction", [](const Described& of) { return Json(of.planned.entry->properties.friction); }},
    {"bounded", [](const Described& of) { return Json(of.planned.entry->properties.bounded); }},
    {"redundancy", Property<&ProblemProperties::redundancy>},
    {"condition", [](const Described& of) { return OrNull(of.planned.entry->properties.condition.value); }},
    {"mass_ratio", Property<&ProblemProperties::mass_ratio>},
    {"fraction_active",
     [](const Described& of) {
       const std::optional<AnswerProperties>& answer = of.planned.entry->answer;
       return answer ? Json(answer->fraction_active) : Json(nullptr);
     }},
    {"reference", [](const Described& of) { return Json(of.planned.entry->reference.kind); }},
    {"reference_status", [](const Described& of) { return Json(of.planned.entry->reference.status); }},
    {"counts", [](const Described& of) { return Json(IsInMeans(of.set, *of.planned.entry)); }},
    {"oracle_s", [](const Described& of) { return OrNull(of.oracle_s); }},
    {"check_s", [](const Described& of) { return of.check_s ? RoundedNumber(*of.check_s) : Json(nullptr); }},
    {"floor", [](const Described& of) { return OrNull(of.floor); }},
};

// What each record of result_fields.json is, in the order of that file.
constexpr std::pair<const char*, const char*> kMeanings[] = {
    {"problem", "A line of problems.jsonl"},
    {"line", "What every line of streams.jsonl begins with"},
    {"judge", "What follows in a line of kind judge (pass 0); a list has an entry for each attempted problem"},
    {"exception", "An entry of `exceptions`"},
    {"fresh", "What follows in a line of kind fresh; a list has an entry for each problem of the task"},
    {"parts", "Of kind parts (pass 1), with clock reads in between, for explanation only"},
    {"again", "Of kind again (pass 1)"},
    {"disturbance", "Of a timed line"},
    {"pass", "What every line of steps.jsonl begins with: a pass of a solver over a sequence, in a round"},
    {"steps", "What follows where it was run; a list of numbers has an entry for each step that was reached"},
    {"step_verdict", "An entry of `verdicts`"},
    {"retry",
     "An entry of `retried`, which a line of streams.jsonl or steps.jsonl has where something other than the campaign "
     "killed a worker (SIGKILL, SIGTERM): the solve, or the pass, was tried once more, and the line says what came of "
     "that. Killed again it is `crashed`, or of a solver in a process of its own, which alone was killed, a numerical "
     "failure that says so"},
};

constexpr std::array kLineKinds = {"judge", "fresh", "parts", "again"};

struct Kind {
  const char* key;
  bool (*fits)(const nlohmann::json& value);
  const char* words;
  const char* schema;  // JSON Schema
};
using Value = nlohmann::json;
constexpr Kind kKinds[] = {
    {"name", [](const Value& v) { return v.is_string() && !v.get_ref<const std::string&>().empty(); },
     "a text that is not empty", R"({"type": "string", "minLength": 1})"},
    {"text", [](const Value& v) { return v.is_string(); }, "a text", R"({"type": "string"})"},
    {"boolean", [](const Value& v) { return v.is_boolean(); }, "true or false", R"({"type": "boolean"})"},
    {"count", [](const Value& v) { return v.is_number_unsigned(); }, "a whole number >= 0",
     R"({"type": "integer", "minimum": 0})"},
    {"number", [](const Value& v) { return v.is_number(); }, "a number", R"({"type": "number"})"},
    {"nonnegative", [](const Value& v) { return v.is_number() && v >= 0; }, "a number >= 0",
     R"({"type": "number", "minimum": 0})"},
    {"positive", [](const Value& v) { return v.is_number() && v > 0; }, "a number > 0",
     R"({"type": "number", "exclusiveMinimum": 0})"},
    {"object", [](const Value& v) { return v.is_object(); }, "an object", R"({"type": "object"})"},
    {"list", [](const Value& v) { return v.is_array(); }, "a list", R"({"type": "array"})"},
};

// The type of a field in its parts.
struct Type {
  explicit Type(std::string_view text) {
    is_list = text.front() == '[';
    if (is_list) text = text.substr(1, text.size() - 2);
    allows_null = text.back() == '?';
    if (allows_null) text.remove_suffix(1);
    kind = &*std::find_if(std::begin(kKinds), std::end(kKinds), [text](const Kind& one) { return one.key == text; });
  }
  bool Fits(const nlohmann::json& value) const {
    const auto fits = [this](const nlohmann::json& one) { return (allows_null && one.is_null()) || kind->fits(one); };
    return is_list ? value.is_array() && std::all_of(value.begin(), value.end(), fits) : fits(value);
  }
  std::string Words() const {
    return std::string(is_list ? "a list, each " : "") + kind->words + (allows_null ? " or null" : "");
  }
  Json Schema() const {
    Json schema = Json::parse(kind->schema);
    if (allows_null) schema["type"] = {schema["type"], "null"};
    return is_list ? Json{{"type", "array"}, {"items", schema}} : schema;
  }

  bool is_list;
  bool allows_null;
  const Kind* kind;
};

// @param place  of the record in its line, "" for the line
void RequireRecord(const nlohmann::json& value, std::string_view record, const std::string& place = "") {
  if (!value.is_object()) throw InputError("field '" + place + "' that is not an object");
  for (const auto& [key, field] : ResultSchemaJson().at(std::string(record)).items()) {
    const auto found = value.find(key);
    const Type type(field.at("type").get_ref<const std::string&>());
    const std::string name = "field '" + place + (place.empty() ? "" : "/") + key + "'";
    if (found == value.end() && field.contains("optional")) continue;
    if (found == value.end()) throw InputError("no " + name + " (" + type.Words() + ")");
    if (!type.Fits(*found)) {
      throw InputError(name + " that is not " + type.Words() + ": " +
                       (found->is_structured() ? found->type_name() : found->dump()));
    }
  }
}

void RequireRecords(const nlohmann::json& line, const char* list, std::string_view record) {
  if (!line.contains(list)) return;
  if (!line[list].is_array()) throw InputError(std::string("field '") + list + "' that is not a list");
  for (std::size_t k = 0; k < line[list].size(); ++k) {
    RequireRecord(line[list][k], record, std::string(list) + "/" + std::to_string(k));
  }
}

}  // namespace

void RequireFields(const nlohmann::json& line) {
  const bool is_pass = line.contains("sequence");
  if (!is_pass && line.contains("problem")) return RequireRecord(line, "problem");
  if (!is_pass && !line.contains("kind")) throw InputError("no field 'problem', 'sequence' or 'kind'");
  RequireRecord(line, is_pass ? "pass" : "line");
  RequireRecords(line, "retried", "retry");
  const bool has_kind = is_pass || std::find(kLineKinds.begin(), kLineKinds.end(), line["kind"]) != kLineKinds.end();
  if (!has_kind) throw InputError("kind " + line["kind"].dump());
  if (!line["excluded"].get_ref<const std::string&>().empty()) return;
  if (is_pass) {
    RequireRecord(line, "steps");
    return RequireRecords(line, "verdicts", "step_verdict");
  }
  RequireRecord(line, line["kind"].get_ref<const std::string&>());
  RequireRecords(line, "exceptions", "exception");
  if (line.contains("disturbance") && !line["disturbance"].is_null())
    RequireRecord(line["disturbance"], "disturbance", "disturbance");
}

Json ResultJsonSchema() {
  Json json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
               {"title", "Lines of problems.jsonl, streams.jsonl and steps.jsonl of a campaign's folder"},
               {"description",
                "Written by `lcpbench list fields --schema`. A line is one of problem, stream_line, "
                "pass_line; further members are allowed."},
               {"oneOf", Json::array()}};
  Json& records = json["$defs"];
  for (const auto& [name, meaning] : kMeanings) {
    Json& record = records[name] = {{"description", meaning}, {"type", "object"}};
    record["required"] = Json::array();
    for (const auto& [key, field] : ResultSchemaJson().at(name).items()) {
      if (!field.contains("optional")) record["required"].push_back(key);
      Json& property = record["properties"][key] = Type(field["type"].get_ref<const std::string&>()).Schema();
      if (!field["meaning"].get_ref<const std::string&>().empty()) property["description"] = field["meaning"];
    }
  }
  const auto ref = [](const std::string& record) { return Json{{"$ref", "#/$defs/" + record}}; };
  const auto list_of = [&ref](const char* record) { return Json{{"type", "array"}, {"items", ref(record)}}; };
  const auto is = [](const char* field, const char* word) {
    return Json{{"required", {field}}, {"properties", {{field, {{"const", word}}}}}};
  };
  records["judge"]["properties"]["exceptions"] = list_of("exception");
  records["steps"]["properties"]["verdicts"] = list_of("step_verdict");
  Json kinds = Json::array();
  Json keys = Json::array();
  for (const char* kind : kLineKinds) {
    if (kind != std::string_view("judge")) {
      records[kind]["properties"]["disturbance"] = {{"anyOf", {{{"type", "null"}}, ref("disturbance")}}};
    }
    kinds.push_back({{"if", is("kind", kind)}, {"then", ref(kind)}});
    keys.push_back(kind);
  }
  records["line"]["properties"]["kind"] = {{"enum", keys}};
  const auto whole = [&](const char* begin, const Json& rest) {
    return Json{{"allOf", {ref(begin), {{"if", is("excluded", "")}, {"then", rest}}}},
                {"properties", {{"retried", list_of("retry")}}}};
  };
  records["stream_line"] = whole("line", {{"allOf", kinds}});
  records["pass_line"] = whole("pass", ref("steps"));
  for (const char* line : {"problem", "stream_line", "pass_line"}) json["oneOf"].push_back(ref(line));
  return json;
}

std::span<const FieldOf<LineSource>> LineFields() { return kLine; }
std::span<const FieldOf<MeasuredAnswer>> ColumnFields() { return kColumns; }
std::span<const FieldOf<MeasuredAnswer>> RareColumnFields() { return kRareColumns; }
std::span<const FieldOf<MeasuredAnswer>> ExceptionFields() { return kExceptions; }
std::span<const TimeField> TimeFields() { return kTimes; }
std::span<const FieldOf<PassSource>> PassFields() { return kPass; }
std::span<const FieldOf<DescribedProblem>> ProblemFields() { return kProblem; }

nlohmann::json DescribeAnswer(const MeasuredAnswer& answer) {
  nlohmann::json record;
  for (const auto fields :
       {ColumnFields(), RareColumnFields(), ExceptionFields(), std::span<const FieldOf<Answer>>(kOfTheLine)}) {
    for (const FieldOf<Answer>& field : fields) record[field.name] = field.value(answer);
  }
  return record;
}

std::string ResultSchemaMarkdown() {
  std::string text =
      "# Fields of a campaign's lines\n\nWritten by `lcpbench list fields` (benchmarks/campaign/result_fields.h). "
      "[RESULTS.md](RESULTS.md) says what the files are for. Types: a name is a text that is not empty, a count a "
      "whole "
      "number >= 0, nonnegative a number >= 0; [nonnegative] is a list of these, and a question mark allows null.\n";
  for (const auto& [record, meaning] : kMeanings) {
    text += std::string("\n## ") + record + "\n\n" + meaning +
            ".\n\n| field | type | unit | meaning |\n| --- | --- | --- | --- |\n";
    for (const auto& [name, field] : ResultSchemaJson().at(record).items()) {
      text += "| `" + name + "`";
      for (const char* column : {"type", "unit", "meaning"})
        text += " | " + field[column].get_ref<const std::string&>();
      text += " |\n";
    }
  }
  return text;
}

const Json& ResultSchemaJson() {
  static const Json schema = Json::parse(kResultFields);
  return schema;
}

Json RoundedNumber(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[24];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

}  // namespace lcpbench
