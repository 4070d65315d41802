#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/reference_solves.h"
#include "solvers/exact/bounded_reference.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/exact/modes/mode_search.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

struct CertifyFiles {
  double time_limit_s = 3600;
  Index most_rows_of_proofs = ExactOptions{}.most_rows_of_proofs;
  Index most_exact_rows = 400;
  std::int64_t most_modes = ExactOptions{}.most_modes;
  bool rounded = false;
  std::vector<std::string> files;
  ReadingOptions reading;

  void Declare(CLI::App& app) {
    app.add_option("--time-limit", time_limit_s, "Seconds per problem, between exact solves")->check(PositiveSeconds());
    app.add_option("--proofs-up-to", most_rows_of_proofs,
                   "Rows up to which ranks, and uniqueness where it needs a program of its own, are proved")
        ->check(AtLeast(0));
    app.add_option("--exact-up-to", most_exact_rows,
                   "Rows up to which the answer is exact; larger problems get one in some 60 digits with proved bounds")
        ->check(AtLeast(0));
    app.add_option("--modes-up-to", most_modes,
                   "Modes up to which all are tried, of problems with friction or bounded rows: 4096 are those of 6 "
                   "contacts, 65536 of 8; above, one solution is looked for")
        ->check(AtLeast(0));
    app.add_flag("--rounded", rounded, "Only doubles, no fractions");
    AddReadingOptions(app, &reading);
    app.add_option("FILE", files, "As of lcpbench solve; - for JSON lines on standard input")->required();
  }

  int Run() const {
    const auto certify = [&](const LcpRecord& record, const std::string& where, const std::string& line) {
      const bool exact = record.problem.size() <= most_exact_rows;
      if (!exact && HasFractions(line)) {
        throw InputError(where + ": expected doubles beyond --exact-up-to rows, found fractions");
      }
      // A line may have fractions, which its problem rounds.
      const bool as_written = !line.empty() && !record.symmetrized;
      const LcpProblem& problem = record.problem;
      const auto solve = [&] {
        const ExactLcp given = as_written ? ParseExactLcp(line, where) : ExactFrom(problem);
        return Solve(given, problem);
      };
      const Json answer = exact ? solve() : problem.is_plain() ? Bound(problem) : BoundModes(problem);
      std::cout << answer.dump() << std::endl;
    };
    return ForEachProblem(files, reading, certify);
  }

 private:
  Json Solve(const ExactLcp& problem, const LcpProblem& rounded_problem) const {
    ExactOptions options = FromSolvers(rounded_problem, time_limit_s);
    options.most_rows_of_proofs = most_rows_of_proofs;
    options.most_modes = most_modes;
    const double start = SteadyNow();
    const ExactAnswer answer = Certify(problem, options);
    const double time_s = SteadyNow() - start;
    const bool is_plain = problem.is_plain();
    Json record = {
        {"id", problem.id}, {"n", problem.size}, {"status", ToString(answer.status)}, {"certified", answer.certified}};
    if (!is_plain) record["complete"] = answer.complete;
    if (!answer.fault.empty()) record["fault"] = answer.fault;
    if (is_plain) record.update({{"rank_A", *answer.rank}, {"rank_is_proved", answer.rank_is_proved}});
    if (answer.is_solved()) {
      const bool has_least_norm = !answer.f_least_norm.empty() || answer.f.empty();
      if (is_plain) {
        record["nullity_on_active"] = answer.nullity_on_active;
        record["degenerate"] = has_least_norm ? Json(answer.degenerate) : Json(nullptr);
      } else {
        record.update({{"proof", "modes"}, {"modes", answer.modes}, {"w_unique", OrNull(answer.w_unique)}});
      }
      record["f_unique"] = OrNull(answer.f_unique);
      Add("w", answer.w, &record);
      Add("f", answer.f, &record);
      if (is_plain && has_least_norm) Add("f_minnorm", answer.f_least_norm, &record);
    }
    if (!is_plain && answer.complete) {
      if (answer.is_solved()) {
        record.update({{"components", answer.components}, {"pieces", PiecesOf(answer)}});
      } else {
        record["infeasible_by"] = answer.ray.empty() ? "modes" : "normal-ray";
      }
    }
    if (!answer.ray.empty()) Add("ray", answer.ray, &record);
    record.update({{is_plain ? "exact_solves" : "tried", answer.steps}, {"time_s", time_s}, {"detail", answer.detail}});
    return record;
  }

  static Json PiecesOf(const ExactAnswer& answer) {
    Json pieces = Json::array();
    for (const ModePiece& piece : answer.pieces) {
      pieces.push_back({{"modes", piece.modes},
                        {"dimension", piece.dimension},
                        {"vertices", ExactList(piece.f.vertices)},
                        {"rays", ExactList(piece.f.rays)},
                        {"lines", ExactList(piece.f.lines)}});
    }
    return pieces;
  }

  static Json ExactList(const std::vector<RationalVector>& points) {
    Json list = Json::array();
    for (const RationalVector& point : points) {
      list.push_back(Json::array());
      for (const Rational& value : point) list.back().push_back(value.str());
    }
    return list;
  }

  // The same fields as far as they make sense, and the bounds (bounded_reference.h).
  Json Bound(const LcpProblem& problem) const {
    BoundedOptions options;
    options.time_limit_s = time_limit_s;
    const double begin = SteadyNow();
    const LcpResult start = SolveNearly(problem);
    const BoundedReference reference = RefineReference(problem, start.f, options);
    const double time_s = SteadyNow() - begin;
    Json record = {{"id", problem.id()},
                   {"n", problem.size()},
                   {"status", "bounded"},
                   {"certified", reference.proof != BoundedReference::Proof::kNearbyProblem},
                   {"proof", ToString(reference.proof)},
                   {"energy_bound", reference.energy_bound},
                   {"energy_shift", reference.energy_shift},
                   {"w_bound", reference.w_bound},
                   {"f_bound", OrNull(reference.f_bound)},
                   {"f_unique", reference.f_bound ? Json(true) : Json(nullptr)},
                   {"active", reference.active},
                   {"dependent", reference.dependent},
                   {"w", std::vector<double>(reference.w.begin(), reference.w.end())}};
    Add("f", reference.f, &record);
    record.update({{"start", ToString(start.status)},
                   {"refinements", reference.refinements},
                   {"time_s", time_s},
                   {"detail", reference.detail}});
    return record;
  }

  // The same of a problem with friction or bounded rows (mode_proof.h).
  Json BoundModes(const LcpProblem& problem) const {
    const double start = SteadyNow();
    const ModeProof proof = GuessModes(problem).proof;
    const double time_s = SteadyNow() - start;
    const bool certified = proof.proof == ModeProof::Proof::kModes;
    Eigen::VectorXd w;
    problem.ComputeW(proof.f, &w);
    Json record = {{"id", problem.id()},       {"n", problem.size()},
                   {"status", "bounded"},      {"certified", certified},
                   {"complete", false},        {"proof", ToString(proof.proof)},
                   {"modes", proof.modes},     {"f_bound", certified ? Json(proof.f_bound) : Json(nullptr)},
                   {"b_shift", proof.b_shift}, {"mu_shift", proof.mu_shift}};
    for (const auto& [name, values] : {std::pair{"w", w}, std::pair{"f", proof.f}}) {
      record[name] = std::vector<double>(values.begin(), values.end());
    }
    record.update({{"time_s", time_s}, {"detail", ""}});
    return record;
  }

  // As in the oracle's records: name_exact as "p/q", and name rounded to doubles.
  void Add(const std::string& name, const std::vector<Rational>& values, Json* record) const {
    Json numbers = Json::array(), exact = Json::array();
    for (const Rational& value : values) {
      numbers.push_back(RoundToNearest(value));
      exact.push_back(value.str());
    }
    (*record)[name] = numbers;
    if (!rounded) (*record)[name + "_exact"] = exact;
  }
};

}  // namespace

void AddCertifyCommand(CLI::App& app, CommandRun& run) {
  AddCommand<CertifyFiles>(app, run, "certify", "Solves LCPs exactly, in rational numbers, with proofs");
}

}  // namespace lcpbench
