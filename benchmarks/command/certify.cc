#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/measure/exact_guess.h"
#include "solvers/exact/bounded_reference.h"
#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

struct CertifyArguments {
  double time_limit_s = 3600;
  Index most_rows_of_proofs = ExactOptions{}.most_rows_of_proofs;
  Index most_exact_rows = 400;
  bool rounded = false;
  std::vector<std::string> files;
};

// As in the oracle's records: name_exact as "p/q", and name rounded to doubles.
void Add(const char* name, const std::vector<Rational>& values, bool rounded, Json* record) {
  if (values.empty()) return;
  std::vector<double> doubles;
  std::vector<std::string> exact;
  for (const Rational& value : values) {
    doubles.push_back(RoundToNearest(value));
    if (!rounded) exact.push_back(value.str());
  }
  (*record)[name] = doubles;
  if (!rounded) (*record)[std::string(name) + "_exact"] = exact;
}

std::string FormatAnswer(const ExactLcp& problem, const ExactAnswer& answer, const std::string& fault, double time_s,
                         bool rounded) {
  Json record;
  record["id"] = problem.id;
  record["n"] = problem.size;
  record["status"] = ToString(answer.status);
  record["certified"] = fault.empty() && (answer.status == ExactAnswer::Status::kSolved ||
                                          answer.status == ExactAnswer::Status::kInfeasible);
  if (!fault.empty()) record["fault"] = fault;
  record["rank_A"] = answer.rank;
  record["rank_is_proved"] = answer.rank_is_proved;
  if (answer.status == ExactAnswer::Status::kSolved) {
    record["nullity_on_active"] = answer.nullity_on_active;
    record["f_unique"] = answer.f_unique.has_value() ? Json(*answer.f_unique) : Json(nullptr);
    record["degenerate"] = answer.f_least_norm.empty() ? Json(nullptr) : Json(answer.degenerate);
    Add("w", answer.w, rounded, &record);
    Add("f", answer.f, rounded, &record);
    Add("f_minnorm", answer.f_least_norm, rounded, &record);
  }
  Add("ray", answer.ray, rounded, &record);
  record["exact_solves"] = answer.pivots;
  record["time_s"] = time_s;
  record["detail"] = answer.detail;
  return record.dump();
}

// The same fields as far as they make sense, and the bounds (bounded_reference.h).
std::string FormatBounds(const LcpProblem& problem, const LcpResult& start, const BoundedReference& reference,
                         double time_s, bool rounded) {
  const bool as_given = reference.proof != BoundedReference::Proof::kNearbyProblem;
  Json record;
  record["id"] = problem.id();
  record["n"] = problem.size();
  record["status"] = "bounded";
  record["certified"] = as_given;
  record["proof"] = ToString(reference.proof);
  record["energy_bound"] = reference.energy_bound;
  record["energy_shift"] = reference.energy_shift;
  record["w_bound"] = reference.w_bound;
  record["f_bound"] = reference.f_bound.has_value() ? Json(*reference.f_bound) : Json(nullptr);
  record["f_unique"] = reference.f_bound.has_value() ? Json(true) : Json(nullptr);
  record["active"] = reference.active;
  record["dependent"] = reference.dependent;
  record["w"] = std::vector<double>(reference.w.begin(), reference.w.end());
  Add("f", reference.f, rounded, &record);
  record["start"] = ToString(start.status);
  record["refinements"] = reference.refinements;
  record["time_s"] = time_s;
  record["detail"] = reference.detail;
  return record.dump();
}

std::string Bound(const LcpProblem& problem, const CertifyArguments& arguments) {
  const double begin = SteadyNow();
  const LcpResult start = SolveNearly(problem);
  BoundedOptions options;
  options.time_limit_s = arguments.time_limit_s;
  const BoundedReference reference = RefineReference(problem, start.f, options);
  return FormatBounds(problem, start, reference, SteadyNow() - begin, arguments.rounded);
}

int Certify(const CertifyArguments& arguments) {
  if (!(arguments.time_limit_s > 0)) throw InputError("--time-limit: expected seconds > 0");
  if (arguments.most_rows_of_proofs < 0) throw InputError("--proofs-up-to: expected a number of rows >= 0");
  if (arguments.most_exact_rows < 0) throw InputError("--exact-up-to: expected a number of rows >= 0");
  ExactOptions options;
  options.time_limit_s = arguments.time_limit_s;
  options.most_rows_of_proofs = arguments.most_rows_of_proofs;
  options.guess = GuessBySolvers;
  return ForEachLine(arguments.files, [&](const std::string& line, const std::string& where) {
    const LcpRecord record = ParseLcpRecord(line, where);
    if (record.problem.size() > arguments.most_exact_rows) {
      if (HasFractions(line)) {
        throw InputError(where + ": expected doubles beyond --exact-up-to rows, found fractions");
      }
      std::cout << Bound(record.problem, arguments) << std::endl;
      return;
    }
    const ExactLcp problem = ParseExactLcp(line, where);
    const double start = SteadyNow();
    const ExactAnswer answer = SolveExactly(problem, options);
    const std::string fault = FindFault(problem, answer);
    std::cout << FormatAnswer(problem, answer, fault, SteadyNow() - start, arguments.rounded) << std::endl;
  });
}

}  // namespace

void AddCertifyCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<CertifyArguments>();
  CLI::App* certify = app.add_subcommand("certify", "Solves LCPs exactly, in rational numbers, with proofs");
  certify->add_option("--time-limit", arguments->time_limit_s, "Seconds per problem, between exact solves");
  certify->add_option("--proofs-up-to", arguments->most_rows_of_proofs,
                      "Rows up to which ranks, and uniqueness where it needs a program of its own, are proved");
  certify->add_option(
      "--exact-up-to", arguments->most_exact_rows,
      "Rows up to which the answer is exact; larger problems get one in some 60 digits with proved bounds");
  certify->add_flag("--rounded", arguments->rounded, "Only doubles, no fractions");
  certify->add_option("FILE", arguments->files, "JSON lines; - for standard input")->required();
  certify->callback([arguments, &run] { run = [arguments] { return Certify(*arguments); }; });
}

}  // namespace lcpbench
