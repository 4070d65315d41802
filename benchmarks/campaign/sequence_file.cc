#include "benchmarks/campaign/sequence_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/sequence_problems.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/reference_solves.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void RequireHash(const std::string& name, const std::string& expected, const std::string& found) {
  if (expected == found) return;
  throw InputError(name + ": expected the sequence with SHA-256 " + expected + ", found " + found);
}

// Redundant rows whose doubles nearly contradict themselves have exact answers of huge forces: the w of these, rounded,
// is not w any more, and their floor would excuse everything.
constexpr double kLargestFloorOfW = 1e-12;
constexpr double kStrictestTier = 1e-9;
constexpr double kFloorTimeLimit = 10;  // [s]

// The least that is known: a smaller one than the strictest tier changes no verdict.
double FloorOf(const LcpProblem& problem, double exact_floor) {
  if (exact_floor <= kStrictestTier) return exact_floor;
  return std::min(exact_floor, FindReferenceFloor(problem, kStrictestTier, kFloorTimeLimit).value_or(exact_floor));
}

// FormatLcpRecord with more members. That writes a dense matrix as coordinates; here it stays dense, as what solvers
// are given.
std::string Line(const SequenceStep& step) {
  std::string line = FormatLcpRecord(step.problem);
  Json more;
  if (step.problem.given_form() == MatrixForm::kDense) {
    more = Json::parse(line);
    more["A"] = Json::array();
    for (const auto& row : step.problem.DenseA().rowwise()) {
      more["A"].push_back(std::vector<double>(row.begin(), row.end()));
    }
    line.clear();
  }
  if (step.reference.w) {
    more["status"] = ToString(LcpStatus::kSolved);
    more["w"] = std::vector<double>(step.reference.w->begin(), step.reference.w->end());
  }
  more["floor"] = step.reference.floor ? Json(*step.reference.floor) : Json(nullptr);
  more["previous"] = step.previous;
  if (line.empty()) return more.dump() + "\n";
  // The line without its closing brace goes on with more members.
  line.back() = ',';
  return line + more.dump().substr(1) + "\n";
}

LcpReference ReferenceOf(const SequenceProblem& met) {
  LcpReference reference;
  const LcpProblem& problem = met.problem;
  const bool solved = met.result != nullptr && met.result->status == LcpStatus::kSolved;
  const double exact_floor = solved ? RoundingFloor(problem, met.result->f) : std::numeric_limits<double>::infinity();
  // With a detail it is the answer to a problem that differs a little (exact_solver.h): its w is not this one's.
  if (solved && met.result->detail.empty() && exact_floor <= kLargestFloorOfW) {
    reference.w = ComputeMetrics(problem, met.result->f).w;
  }
  const double floor = FloorOf(problem, exact_floor);
  if (std::isfinite(floor)) reference.floor = floor;
  return reference;
}

SequenceStep ParseStep(const std::string& line, const std::string& where, std::size_t rows_before) {
  LcpRecord record = ParseLcpRecord(line, where);
  SequenceStep step{std::move(record.problem), {}, std::move(record.reference)};
  const nlohmann::json json = ParseJsonObject(line, where);
  const JsonField more(json, where);
  for (const JsonField& row : more["previous"].Items()) step.previous.push_back(row.Integer());
  step.reference.floor = more["floor"].NumberOrNull();
  RequirePrevious(step.previous, step.problem.size(), rows_before, where);
  return step;
}

}  // namespace

void RequirePrevious(const std::vector<int>& previous, Index rows, std::size_t rows_before, const std::string& where) {
  const bool fits = std::all_of(previous.begin(), previous.end(),
                                [=](int row) { return row >= -1 && row < static_cast<int>(rows_before); });
  if (fits && static_cast<Index>(previous.size()) == rows) return;
  throw InputError(where + ": field 'previous': expected a row of the line before, or -1, for every row");
}

std::string SequencePath(const std::string& folder, const std::string& id) {
  return (fs::path(folder) / "sequences" / (id + ".jsonl.gz")).string();
}

void WriteSequenceFile(const SequenceEntry& entry, const std::string& folder, const std::string& path) {
  std::vector<SequenceStep> steps;
  SequenceHash hash;
  const std::string end = ForEachProblemOf(entry, folder, [&](const SequenceProblem& met) {
    Interruption::Check();
    steps.push_back({met.problem, met.previous, ReferenceOf(met)});
    hash.Add(met.problem);
  });
  if (!end.empty()) throw InputError(entry.id + ": " + end);
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  RequireHash(entry.id, entry.sha256, hash.Result());
  WriteSequenceSteps(steps, path);
}

std::string WriteSequenceSteps(const std::vector<SequenceStep>& steps, const std::string& path) {
  std::string text;
  SequenceHash hash;
  for (const SequenceStep& step : steps) {
    hash.Add(step.problem);
    text += Line(step);
  }
  WriteGzipFile(path, text);
  return hash.Result();
}

std::vector<SequenceStep> ReadSequenceFile(const std::string& path, const std::string& sha256) {
  LineReader lines(path);
  std::vector<SequenceStep> steps;
  SequenceHash hash;
  std::string line;
  std::size_t rows_before = 0;
  while (lines.Next(&line)) {
    steps.push_back(ParseStep(line, path + ":" + std::to_string(steps.size() + 1), rows_before));
    hash.Add(steps.back().problem);
    rows_before = steps.back().previous.size();
  }
  RequireHash(path, sha256, hash.Result());
  return steps;
}

bool IsSequenceFile(const std::string& path, const std::string& sha256) {
  if (!fs::exists(path)) return false;
  try {
    ReadSequenceFile(path, sha256);
    return true;
  } catch (const InputError& error) {
    std::cerr << "note: made anew: " << error.what() << std::endl;
    return false;
  }
}

Eigen::VectorXd CarryOver(const Eigen::VectorXd& f, const std::vector<int>& previous) {
  Eigen::VectorXd carried = Eigen::VectorXd::Zero(static_cast<Index>(previous.size()));
  for (std::size_t k = 0; k < previous.size(); ++k) {
    if (previous[k] >= 0) carried[static_cast<Index>(k)] = f[previous[k]];
  }
  return carried;
}

}  // namespace lcpbench
