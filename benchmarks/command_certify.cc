#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/commands.h"
#include "benchmarks/exact_guess.h"
#include "benchmarks/input_files.h"
#include "solvers/exact/exact_lcp.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

struct CertifyArguments {
  double time_limit_s = 3600;
  Index most_rows_of_proofs = ExactOptions{}.most_rows_of_proofs;
  bool rounded = false;
  std::vector<std::string> files;
};

// As in the oracle's records: name_exact as "p/q", and name rounded to doubles.
void Add(const char* name, const std::vector<Rational>& values, bool rounded, Json* record) {
  if (values.empty()) return;
  std::vector<double> doubles;
  std::vector<std::string> exact;
  for (const Rational& value : values) {
    doubles.push_back(value.convert_to<double>());
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

int Certify(const CertifyArguments& arguments) {
  if (!(arguments.time_limit_s > 0)) throw InputError("--time-limit: expected seconds > 0");
  if (arguments.most_rows_of_proofs < 0) throw InputError("--proofs-up-to: expected a number of rows >= 0");
  ExactOptions options;
  options.time_limit_s = arguments.time_limit_s;
  options.most_rows_of_proofs = arguments.most_rows_of_proofs;
  options.guess = GuessBySolvers;
  return ForEachLine(arguments.files, [&](const std::string& line, const std::string& where) {
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
  certify->add_option("--time-limit", arguments->time_limit_s, "Seconds per problem, between exact solves")
      ->capture_default_str();
  certify
      ->add_option("--proofs-up-to", arguments->most_rows_of_proofs,
                   "Rows up to which ranks, and uniqueness where it needs a program of its own, are proved")
      ->capture_default_str();
  certify->add_flag("--rounded", arguments->rounded, "Only doubles, no fractions");
  certify->add_option("FILE", arguments->files, "JSON lines; - for standard input")->required();
  certify->callback([arguments, &run] { run = [arguments] { return Certify(*arguments); }; });
}

}  // namespace lcpbench
