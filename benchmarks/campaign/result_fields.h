#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "solvers/lcp/fresh_pass.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {

// How the values of the fields of a campaign's files of lines (RESULTS.md) are taken. What a field is says
// report/lcpbench_report/statistics/result_fields.json, which is part of this program, the reader checks lines by, and
// benchmarks/FIELDS.md shows.

/// A field with its value in a record of `Source`.
template <typename Source>
struct FieldOf {
  const char* name;
  nlohmann::ordered_json (*value)(const Source& source);
};

/// A record of all fields, in their order.
template <typename Source>
nlohmann::ordered_json RecordOf(std::span<const FieldOf<Source>> fields, const Source& source) {
  nlohmann::ordered_json record;
  for (const FieldOf<Source>& field : fields) record[field.name] = field.value(source);
  return record;
}

/// What every line of streams.jsonl begins with.
struct LineSource {
  const Task& task;
  double tier;
  const char* kind;
  int pass;
  const std::string& environment;
};
std::span<const FieldOf<LineSource>> LineFields();

/// An answer, judged at one tier, with what it cost. What is negative is not known.
struct MeasuredAnswer {
  const LcpResult& result;
  const Verdict& verdict;
  double first_s = -1;
  double peak_bytes = -1;
  double formed_on_host_s = -1;
};
/// The lists of a judge line, each with an entry for every problem that had its turn.
std::span<const FieldOf<MeasuredAnswer>> ColumnFields();
/// Further lists, which a judge line has only where one of their entries is known.
std::span<const FieldOf<MeasuredAnswer>> RareColumnFields();
/// The fields of an entry of a judge line's `exceptions`, besides `at`.
std::span<const FieldOf<MeasuredAnswer>> ExceptionFields();
/// All of these, and what only the whole line has: what a worker tells of one problem at one tier.
nlohmann::json DescribeAnswer(const MeasuredAnswer& answer);

/// The times of a pass, a list each over the problems of the task.
struct TimeField {
  const char* name;
  PassKind kind;
  double PassEntry::*seconds;
};
std::span<const TimeField> TimeFields();

/// What a line of steps.jsonl begins with; the sequence's runner makes what follows.
struct PassSource {
  const Task& task;
  int round;
};
std::span<const FieldOf<PassSource>> PassFields();

/// What problems.jsonl is made of.
struct DescribedProblem {
  const std::string& set;
  const PlannedProblem& planned;
  const LcpProblem& problem;
  std::optional<double> oracle_s = {};
  std::optional<double> check_s = {};
  std::optional<double> floor = {};
};
std::span<const FieldOf<DescribedProblem>> ProblemFields();

/// Checks that a line of problems.jsonl, streams.jsonl or steps.jsonl has every field of its records, with its type.
/// @throws InputError naming the first that is missing or of another type
void RequireFields(const nlohmann::json& line);

/// result_fields.json: {record: {field: {type, unit, meaning, optional}}}. A type is name (a text that is not empty),
/// text, boolean, count, number, nonnegative, positive, object or list; [type] is a list of these, and a '?' behind it
/// allows null. A line may lack what is optional: it is of programs of protocol version 1 only, or younger than stored
/// campaigns.
const nlohmann::ordered_json& ResultSchemaJson();
/// The same as docs/formats/campaign_lines.schema.json and as benchmarks/FIELDS.md.
nlohmann::ordered_json ResultJsonSchema();
std::string ResultSchemaMarkdown();

/// A number with four digits, which is what a clock and a reader want; null where it is not finite. A campaign has
/// millions of them.
nlohmann::ordered_json RoundedNumber(double value);

}  // namespace lcpbench
