#include "benchmarks/campaign/result_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string_view>

#include "benchmarks/collection/plan.h"
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
Json Planned(const Described& of) {
  return of.planned.entry->*Member;
}
template <auto Member>
Json Property(const Described& of) {
  return OrNull(of.planned.entry->properties.*Member);
}

constexpr FieldOf<LineSource> kLine[] = {
    {{"solver", "name", "", "key"}, OfTask<&Task::solver>},
    {{"size_class", "name", "", "key, of campaign.json"}, OfTask<&Task::about>},
    {{"tier", "positive", "", "that it is judged at"}, Of<&LineSource::tier>},
    {{"kind", "name", "", "judge, fresh, parts or again"}, Of<&LineSource::kind>},
    {{"pass", "count", "", "0 of kind judge, else from 1"}, Of<&LineSource::pass>},
    {{"first", "count", "", "place of the task's first problem in its class"}, OfTask<&Task::first>},
    {{"count", "count", "", "problems of the task"}, [](const LineSource& of) { return Json(of.task.count()); }},
    {{"excluded", "text", "", "the declared rule by which none of it is run, then nothing more follows; else empty"},
     OfTask<&Task::excluded>},
    {{"environment", "text", "", "hash, of campaign.json"}, [](const LineSource& of) { return Json(of.environment); }},
};

constexpr FieldOf<Answer> kColumns[] = {
    {{"rho", "[nonnegative?]", "", "`lcpbench list metrics`, as the three that follow; null: not known"},
     Metric<&Metrics::rho>},
    {{"backward_error", "[nonnegative?]", "", ""}, Metric<&Metrics::backward_error>},
    {{"w_error", "[nonnegative?]", "", ""}, Metric<&Metrics::w_error>},
    {{"f_error", "[nonnegative?]", "", ""}, Metric<&Metrics::f_error>},
    {{"best_tier", "[nonnegative?]", "", "the strictest that it passes; null: none"},
     [](const Answer& of) { return of.verdict.best_tier > 0 ? Json(of.verdict.best_tier) : Json(nullptr); }},
    {{"iterations", "[nonnegative?]", "", "in the solver's own unit"},
     [](const Answer& of) { return of.result.iterations < 0 ? Json(nullptr) : Json(of.result.iterations); }},
    {{"first_s", "[nonnegative?]", "s", "fresh time of this one observed solve by a new solver object"},
     SecondsOf<&Answer::first_s>},
    {{"factor_share", "[nonnegative?]", "", "of it, in numeric factorizations; null: in another process"},
     [](const Answer& of) {
       return KnownNumber(of.result.factor_s >= 0 && of.first_s > 0 ? of.result.factor_s / of.first_s : -1);
     }},
};

constexpr ResultField kPlace[] = {{"at", "count", "", "place in the lists"}};

constexpr FieldOf<Answer> kExceptions[] = {
    {{"claim", "name", "",
      "the solver's status; or crashed, killed, out_of_memory; or excluded: not tried, by the rule in `reason`"},
     [](const Answer& of) { return Json(ToString(of.result.status)); }},
    {{"passes", "boolean", "", "verified"}, OfVerdict<&Verdict::passes>},
    {{"at_floor", "boolean", "", "verified thanks to the problem's rounding floor only"},
     OfVerdict<&Verdict::at_floor>},
    {{"false_success", "boolean", "", "called solved, and is not verified"}, OfVerdict<&Verdict::false_success>},
    {{"false_infeasible", "boolean", "", "called infeasible, though a solution is known"},
     OfVerdict<&Verdict::false_infeasible>},
    {{"proved_infeasible", "boolean", "",
      "called infeasible, and the ray proves it without any rounding; in lines without `infeasible_within_rounding`: "
      "and the ray is accepted"},
     [](const Answer& of) { return Json(HasRay(of) && of.verdict.farkas->proved); }},
    {{"infeasible_within_rounding", "boolean", "",
      "called infeasible, and the ray is accepted, but proves it within rounding only"},
     [](const Answer& of) { return Json(HasRay(of) && !of.verdict.farkas->proved); }},
    {{"force_min", "nonnegative?", "",
      "least sum of |A_ii^1/2 f_i| of any solution, where called infeasible within rounding only; else null"},
     [](const Answer& of) {
       return HasRay(of) && !of.verdict.farkas->proved ? RoundedNumber(of.verdict.farkas->force_min) : Json(nullptr);
     }},
    {{"below_floor", "boolean", "",
      "not verified and no claim, but as good as rounding lets its forces be, and the tier below that "
      "(solvers/lcp/rounding_floor.h)"},
     [](const Answer& of) {
       const LcpStatus claim = of.result.status;
       const bool has_claim = claim == LcpStatus::kSolved || claim == LcpStatus::kInfeasible;
       return Json(!of.verdict.passes && !has_claim && IsBelowFloor(of.verdict.metrics, of.verdict.requested));
     }},
    {{"reason", "text", "", "why it is not verified"}, OfVerdict<&Verdict::reason>},
    {{"detail", "text", "", "what the solver, or its end, says"},
     [](const Answer& of) { return Json(of.result.detail); }},
};

constexpr FieldOf<Answer> kOfTheLine[] = {
    {{"peak_bytes", "nonnegative?", "B", "the most of any; null: in another process"}, OfAnswer<&Answer::peak_bytes>},
    {{"formed_on_host_s", "[nonnegative?]", "s",
      "of first_s, forming A here; only of programs of protocol version 1, and nowhere else"},
     SecondsOf<&Answer::formed_on_host_s>},
};

constexpr ResultField kJudge[] = {
    {"attempted", "count", "", "problems that had their turn within the budget, the first ones: the lists' length"},
    {"exceptions", "list", "", "every problem that was not called solved and verified without a flag"},
};

constexpr TimeField kTimes[] = {
    {{"fresh_s", "[positive?]", "s", "from the caller's arrays to f; null: not timed in this pass"},
     PassKind::kFresh,
     &PassEntry::seconds},
    {{"problem_s", "[nonnegative?]", "s", "LcpProblem from the arrays"}, PassKind::kParts, &PassEntry::problem_s},
    {{"prepare_s", "[nonnegative?]", "s", "LcpSolver::Prepare"}, PassKind::kParts, &PassEntry::prepare_s},
    {{"convert_s", "[nonnegative?]", "s", "of foreign libraries: conversions inside the solve"},
     PassKind::kParts,
     &PassEntry::convert_s},
    {{"solve_s", "[nonnegative?]", "s", "the rest of the solve"}, PassKind::kParts, &PassEntry::solve_s},
    {{"again_s", "[positive?]", "s",
      "the same matrix with another b (benchmarks/collection/recipes/recipe.h), right after a solve with the given "
      "one"},
     PassKind::kAgain,
     &PassEntry::seconds},
};

constexpr ResultField kTimed[] = {
    {"outcome", "name", "",
     "completed; crashed, killed, out_of_memory: how the process ended, then each problem was run by itself and those "
     "at which it ended again are in `failed`"},
    {"detail", "text", "", "the reason, where it was not completed"},
    {"failed", "list", "", "places of answers that are not verified at this tier"},
    {"disturbance", "object?", "", "what the machine did meanwhile"},
};

constexpr ResultField kDisturbance[] = {
    {"probe_s", "nonnegative", "s", "a fixed chain of operations: the inverse of the clock rate"},
    {"cpu_share", "nonnegative", "", "processor time by wall-clock time"},
    {"switches", "count", "", "how often the thread lost the processor"},
    {"reruns", "count", "", "how often the pass was run again"},
    {"disturbed", "boolean", "", "and still was disturbed"},
};

constexpr FieldOf<PassSource> kPass[] = {
    {{"sequence", "name", "", "id"}, OfTask<&Task::about>},
    {{"solver", "name", "", "key"}, OfTask<&Task::solver>},
    {{"tier", "positive", "", "asked for"}, OfTask<&Task::tier>},
    {{"mode", "name", "",
      "cold: every step from f = 0; warm: from the solver's own answer to the step before, carried over by the "
      "identity "
      "of rows; deadline-0.1ms, ...: warm at the strictest tier, within the deadline"},
     OfTask<&Task::mode>},
    {{"deadline_s", "positive?", "s", "of a step; null: none"},
     [](const PassSource& of) { return of.task.deadline_s > 0 ? Json(of.task.deadline_s) : Json(nullptr); }},
    {{"round", "count", "", "from 0"}, Of<&PassSource::round>},
    {{"excluded", "text", "", "the rule by which it is not run, then nothing more follows; else empty"},
     OfTask<&Task::excluded>},
};

constexpr ResultField kSteps[] = {
    {"outcome", "name", "", "completed; budget: ended by `pass_budget_s`; crashed, killed, out_of_memory"},
    {"detail", "text", "", "the reason, where it was not completed"},
    {"steps", "count", "", "of the sequence"},
    {"reached", "count", "", "steps: the lists' length"},
    {"claims", "object", "", "status: steps"},
    {"verdicts", "list", "", "at `tier`; of direct methods and of deadlines at all tiers"},
    {"late", "list", "",
     "indices of steps whose answer came after the deadline plus 10 % or 20 us: it counts as none, and the next step "
     "starts where this one did"},
    {"preempted", "list", "",
     "indices of steps in which the solver's thread lost the processor to something else; own solvers"},
    {"latency_s", "[nonnegative?]", "s",
     "one interval from the caller's arrays to f, set-up inside, for peers as for our own"},
    {"iterations", "[nonnegative?]", "", "in the solver's own unit"},
    {"rho", "[nonnegative?]", "", "null: late, or not finite"},
    {"backward_error", "[nonnegative?]", "", "null: late, or not finite"},
    {"w_error", "[nonnegative?]", "", "null: late, not finite, or w is not known"},
    {"environment", "text", "", "hash, of campaign.json"},
};

constexpr ResultField kStepVerdict[] = {
    {"tier", "positive", "", "judged at"},
    {"passed", "count", "", "steps"},
    {"failed", "count", "", "steps, those that were not reached among them"},
    {"false_successes", "count", "", "steps"},
    {"failed_steps", "list", "", "indices"},
};

constexpr ResultField kRetry[] = {
    {"at", "count?", "", "place in the lists of a line of kind judge; null: of others"},
    {"detail", "text", "", "how the first worker ended; of several solves, each"},
};

constexpr FieldOf<Described> kProblem[] = {
    {{"problem", "name", "", "id"}, Planned<&ManifestEntry::id>},
    {{"set", "name", "", "name of its manifest"}, [](const Described& of) { return Json(of.set); }},
    {{"family", "name", "", "scene, hard case or folder"}, Planned<&ManifestEntry::family>},
    {{"grid", "text", "", "the property that its neighbours differ in"}, Planned<&ManifestEntry::grid>},
    {{"base", "name", "", "of the variants of one recipe, or of the steps of one motion, the same"},
     Planned<&ManifestEntry::base>},
    {{"weight", "positive", "",
      "what it counts in medians, shares and intervals: 1/k for the k problems of the campaign that have that base, "
      "times "
      "what makes the origins of a size class weigh the same"},
     [](const Described& of) { return Json(of.planned.weight); }},
    {{"origin", "name", "", "placed, motion, recorded, literature"}, Planned<&ManifestEntry::origin>},
    {{"fill", "boolean", "", "of a further seed, to fill up a stream"}, Planned<&ManifestEntry::fill>},
    {{"size_class", "name", "", "key, of campaign.json"},
     [](const Described& of) { return Json(of.planned.size_class->key); }},
    {{"rows", "count", "", ""}, [](const Described& of) { return Json(of.problem.size()); }},
    {{"bilateral", "count", "", "rows"}, [](const Described& of) { return Json(of.problem.bilateral_rows().size()); }},
    {{"redundancy", "nonnegative?", "", "as the manifest has it, like the three that follow; null: not known"},
     Property<&ProblemProperties::redundancy>},
    {{"condition", "nonnegative?", "", ""},
     [](const Described& of) { return OrNull(of.planned.entry->properties.condition.value); }},
    {{"mass_ratio", "nonnegative?", "", ""}, Property<&ProblemProperties::mass_ratio>},
    {{"fraction_active", "nonnegative?", "", ""},
     [](const Described& of) {
       const std::optional<AnswerProperties>& answer = of.planned.entry->answer;
       return answer ? Json(answer->fraction_active) : Json(nullptr);
     }},
    {{"reference", "name", "", "certified, bounded or none"},
     [](const Described& of) { return Json(of.planned.entry->reference.kind); }},
    {{"counts", "boolean", "", "in means"}, [](const Described& of) { return Json(IsInMeans(of.set)); }},
    {{"oracle_s", "positive?", "s", "what an oracle pays (benchmarks/measure/oracle.h); null: not known"},
     [](const Described& of) { return OrNull(of.oracle_s); }},
    {{"floor", "nonnegative?", "", "rounding floor that verdicts are relative to; null: not known"},
     [](const Described& of) { return OrNull(of.floor); }},
};

constexpr ResultField kGroup[] = {{"group", "positive", "", "so many problems share a pair of clock reads"}};

std::vector<TimeField> TimesOf(PassKind kind) {
  std::vector<TimeField> fields;
  std::copy_if(std::begin(kTimes), std::end(kTimes), std::back_inserter(fields),
               [kind](const TimeField& field) { return field.kind == kind; });
  return fields;
}

template <typename... Tables>
RecordSchema Schema(const char* record, const char* meaning, const Tables&... tables) {
  RecordSchema schema{record, meaning, {}};
  (schema.fields.insert(schema.fields.end(), std::begin(tables), std::end(tables)), ...);
  return schema;
}

constexpr std::array kLineKinds = {"judge", "fresh", "parts", "again"};

// Fields that a line may lack: of programs of protocol version 1 only, and younger than stored campaigns.
bool IsOptional(const ResultField& field) {
  constexpr std::string_view kOptional[] = {"formed_on_host_s", "infeasible_within_rounding", "force_min",
                                            "below_floor"};
  return std::find(std::begin(kOptional), std::end(kOptional), field.name) != std::end(kOptional);
}

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

// ResultField::type in its parts.
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
  static const std::vector<RecordSchema> schemas = ResultSchema();
  const auto schema =
      std::find_if(schemas.begin(), schemas.end(), [record](const auto& one) { return one.record == record; });
  for (const ResultField& field : schema->fields) {
    const auto found = value.find(field.name);
    const Type type(field.type);
    const std::string name = "field '" + place + (place.empty() ? "" : "/") + field.name + "'";
    if (found == value.end() && IsOptional(field)) continue;
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
  for (const RecordSchema& schema : ResultSchema()) {
    Json& record = records[schema.record] = {{"description", schema.meaning}, {"type", "object"}};
    record["required"] = Json::array();
    for (const ResultField& field : schema.fields) {
      if (!IsOptional(field)) record["required"].push_back(field.name);
      Json& property = record["properties"][field.name] = Type(field.type).Schema();
      if (*field.meaning != 0) property["description"] = field.meaning;
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
std::span<const FieldOf<MeasuredAnswer>> ExceptionFields() { return kExceptions; }
std::span<const TimeField> TimeFields() { return kTimes; }
std::span<const FieldOf<PassSource>> PassFields() { return kPass; }
std::span<const ResultField> StepFields() { return kSteps; }
std::span<const FieldOf<DescribedProblem>> ProblemFields() { return kProblem; }

nlohmann::json DescribeAnswer(const MeasuredAnswer& answer) {
  nlohmann::json record;
  for (const auto fields : {ColumnFields(), ExceptionFields(), std::span<const FieldOf<Answer>>(kOfTheLine)}) {
    for (const FieldOf<Answer>& field : fields) record[field.name] = field.value(answer);
  }
  return record;
}

std::vector<RecordSchema> ResultSchema() {
  return {
      Schema("problem", "A line of problems.jsonl", kProblem),
      Schema("line", "What every line of streams.jsonl begins with", kLine),
      Schema("judge", "What follows in a line of kind judge (pass 0); a list has an entry for each attempted problem",
             kJudge, kColumns, kOfTheLine),
      Schema("exception", "An entry of `exceptions`", kPlace, kExceptions),
      Schema("fresh", "What follows in a line of kind fresh; a list has an entry for each problem of the task", kGroup,
             TimesOf(PassKind::kFresh), kTimed),
      Schema("parts", "Of kind parts (pass 1), with clock reads in between, for explanation only",
             TimesOf(PassKind::kParts), kTimed),
      Schema("again", "Of kind again (pass 1)", TimesOf(PassKind::kAgain), kTimed),
      Schema("disturbance", "Of a timed line", kDisturbance),
      Schema("pass", "What every line of steps.jsonl begins with: a pass of a solver over a sequence, in a round",
             kPass),
      Schema("steps", "What follows where it was run; a list of numbers has an entry for each step that was reached",
             kSteps),
      Schema("step_verdict", "An entry of `verdicts`", kStepVerdict),
      Schema(
          "retry",
          "An entry of `retried`, which a line of streams.jsonl or steps.jsonl has where something other than the "
          "campaign killed a worker (SIGKILL, SIGTERM): the solve, or the pass, was tried once more, and the line "
          "says what came of that. Killed again it is `crashed`, or of a solver in a process of its own, which alone "
          "was killed, a numerical failure that says so",
          kRetry),
  };
}

std::string ResultSchemaMarkdown() {
  std::string text =
      "# Fields of a campaign's lines\n\nWritten by `lcpbench list fields` (benchmarks/campaign/result_fields.h). "
      "[RESULTS.md](RESULTS.md) says what the files are for. Types: a name is a text that is not empty, a count a "
      "whole "
      "number >= 0, nonnegative a number >= 0; [nonnegative] is a list of these, and a question mark allows null.\n";
  for (const RecordSchema& schema : ResultSchema()) {
    text += std::string("\n## ") + schema.record + "\n\n" + schema.meaning +
            ".\n\n| field | type | unit | meaning |\n| --- | --- | --- | --- |\n";
    for (const ResultField& field : schema.fields) {
      text +=
          std::string("| `") + field.name + "` | " + field.type + " | " + field.unit + " | " + field.meaning + " |\n";
    }
  }
  return text;
}

Json ResultSchemaJson() {
  Json json;
  for (const RecordSchema& schema : ResultSchema()) {
    for (const ResultField& field : schema.fields) {
      json[schema.record][field.name] = {{"type", field.type}, {"unit", field.unit}, {"meaning", field.meaning}};
      if (IsOptional(field)) json[schema.record][field.name]["optional"] = true;
    }
  }
  return json;
}

Json RoundedNumber(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[24];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

}  // namespace lcpbench
