#include "benchmarks/collection/references.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/measure/reference_solves.h"
#include "solvers/exact/bounded_reference.h"
#include "solvers/exact/modes/mode_proof.h"
#include "solvers/exact/modes/mode_search.h"
#include "solvers/io/gzip_file.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

// The id of a line; where it stands first, as in our files, without parsing the numbers behind it.
std::string IdOf(const std::string& line, const std::string& where) {
  constexpr std::string_view kStart = R"({"id":")";
  if (line.starts_with(kStart)) {
    const std::size_t end = line.find_first_of("\"\\", kStart.size());
    if (end != std::string::npos && line[end] == '"') return line.substr(kStart.size(), end - kStart.size());
  }
  const nlohmann::json json = ParseJsonObject(line, where);
  return JsonField(json, where)["id"].String();
}

Eigen::VectorXd Numbers(const JsonField& field, Index size) {
  const std::vector<double> numbers = field.Numbers(static_cast<std::size_t>(size));
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
}

Eigen::VectorXd ToDoubles(const std::vector<Rational>& values) {
  Eigen::VectorXd doubles(static_cast<Index>(values.size()));
  for (size_t k = 0; k < values.size(); ++k) doubles[static_cast<Index>(k)] = values[k].convert_to<double>();
  return doubles;
}

Json ToJson(const Eigen::VectorXd& values) { return std::vector<double>(values.begin(), values.end()); }

// |D^-1/2 b|_2
double LoadScale(const LcpProblem& problem) {
  double squared = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    const double d = problem.DiagonalA()[i] > 0 ? problem.DiagonalA()[i] : 1;
    squared += problem.b()[i] * problem.b()[i] / d;
  }
  return std::sqrt(squared);
}

// ----- proved answers

// The line of the file of references, as far as all lines begin alike.
Json LineOf(const LcpProblem& problem, const ReferenceSummary& reference) {
  return {{"id", problem.id()}, {"kind", reference.kind}, {"status", reference.status}};
}

// @param w_unique  none: nothing is said of it, for A is positive semidefinite
void WriteSolved(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w,
                 std::optional<bool> f_unique, std::optional<bool> w_unique, const char* name_of_f,
                 Examined* examined) {
  // Doubles of exact zeros are zeros, and of nothing else in the range of these numbers.
  examined->entry.answer = MeasureAnswer(problem, f, w, 0);
  ReferenceSummary& reference = examined->entry.reference;
  reference.kind = "certified";
  reference.status = "solved";
  reference.f_unique = f_unique;
  // f + w > 0 everywhere is the property itself; where it fails, only a unique f says that no other f has it.
  const bool is_strict = examined->entry.answer->degenerate == 0;
  if (problem.is_plain() && (is_strict || f_unique.value_or(false))) reference.strictly_complementary = is_strict;
  Json line = LineOf(problem, reference);
  line["f_unique"] = f_unique ? Json(*f_unique) : Json(nullptr);
  if (w_unique) line["w_unique"] = *w_unique;
  line["w"] = ToJson(w);
  line[name_of_f] = ToJson(f);
  examined->reference_line = line.dump();
}

// @param ray  none: proved by enumeration
void WriteInfeasible(const LcpProblem& problem, const std::optional<Eigen::VectorXd>& ray, Examined* examined) {
  ReferenceSummary& reference = examined->entry.reference;
  reference.kind = "certified";
  reference.status = "infeasible";
  Json line = LineOf(problem, reference);
  if (ray) line["ray"] = ToJson(*ray);
  examined->reference_line = line.dump();
}

std::optional<Eigen::VectorXd> Solve(const LcpProblem& problem, const ExamineOptions& options);

// True where an answer is proved; then it is written into `examined`. With friction or bounded rows, w counts as that
// of every solution only where all modes say so.
bool CertifyInto(const LcpProblem& problem, const ExamineOptions& options, Examined* examined) {
  constexpr std::int64_t kModesOfEightContacts = 65536;
  ExactOptions certify = FromSolvers(problem, options.time_limit_s);
  certify.most_modes = kModesOfEightContacts;
  certify.guessed_modes = [&] {
    const std::optional<Eigen::VectorXd> f = Solve(problem, options);
    if (!f) return std::vector<std::string>();
    return std::vector{ProveModes(problem, *f).modes, ModesOf(problem, *f)};
  };
  certify.follows_path = problem.size() <= options.path_up_to;
  ExactLcp exact = ExactFrom(problem);
  exact.has_factors = exact.has_factors || problem.facts().positive_semidefinite;  // as a formula's problem has it
  const ExactAnswer answer = Certify(exact, certify);
  const bool is_plain = problem.is_plain(), is_infeasible = !answer.is_solved(), has_ray = !answer.ray.empty();
  ReferenceSummary& reference = examined->entry.reference;
  if (!answer.certified) {
    if (!is_plain) reference.detail = answer.detail;
    return false;
  }
  if (is_infeasible) {
    WriteInfeasible(problem, has_ray ? std::optional(ToDoubles(answer.ray)) : std::nullopt, examined);
    if (!is_plain) reference.detail = has_ray ? "by a ray of normal forces" : "by all modes";
    return true;
  }
  const bool has_least_norm = !answer.f_least_norm.empty();
  if (!is_plain) {
    // Rows that contradict each other by roundings may ask for forces so large that doubles cannot balance them.
    const Eigen::VectorXd f = ToDoubles(has_least_norm ? answer.f_least_norm : answer.f);
    LcpReference rounded;
    rounded.floor = RoundingFloor(problem, f);
    if (!PassesTier(ComputeMetrics(problem, f, &rounded), 1e-9)) return false;
  }
  const std::optional<bool> w_unique = is_plain ? std::nullopt : std::optional(answer.w_unique.value_or(false));
  WriteSolved(problem, ToDoubles(has_least_norm ? answer.f_least_norm : answer.f), ToDoubles(answer.w), answer.f_unique,
              w_unique, has_least_norm ? "f_minnorm" : "f", examined);
  if (is_plain) {
    reference.nullity_on_active = answer.nullity_on_active;
    if (!has_least_norm) reference.detail = answer.detail;
    return true;
  }
  reference.detail = "modes " + answer.modes;
  if (answer.pieces.size() > 1) reference.detail += ", of " + std::to_string(answer.pieces.size()) + " pieces";
  return true;
}

// An answer of a problem with any A, proved by its gaps alone. Where there may be others, w is of this one only.
void WriteProved(const LcpProblem& problem, const std::vector<Rational>& f, const std::vector<Rational>& w,
                 std::optional<bool> f_unique, const ExamineOptions& options, Examined* examined) {
  const bool w_unique = problem.facts().positive_semidefinite || f_unique.value_or(false);
  WriteSolved(problem, ToDoubles(f), ToDoubles(w), f_unique, w_unique, "f", examined);
  if (problem.size() <= options.bounded_up_to) return;
  examined->entry.reference = {};
  examined->entry.reference.detail = "none above " + std::to_string(options.bounded_up_to) + " rows";
  examined->reference_line.clear();
}

// An answer that is known in advance.
void Confirm(const LcpProblem& problem, const Eigen::VectorXd& known_f, const ExamineOptions& options,
             Examined* examined) {
  const std::vector<Rational> f(known_f.begin(), known_f.end());
  const std::optional<std::vector<Rational>> w = GapsOfAnswer(problem, f);
  if (!w) throw InputError(problem.id() + ": the answer known in advance does not solve the problem");
  WriteProved(problem, f, *w, problem.facts().f_unique, options, examined);
}

// Answers a problem whose A is not positive semidefinite.
void Enumerate(const LcpProblem& problem, const ExamineOptions& options, Examined* examined) {
  // Those of ours that take any A; what they say of their answers is not asked.
  std::vector<Eigen::VectorXd> guesses;
  for (const char* key : {"pgs", "ipopt-ncp"}) {
    if (!FindSolver(key).available) continue;
    LcpOptions lcp;
    lcp.time_limit_s = options.large_time_limit_s;
    LcpResult result;
    MakeSolver(key)->Solve(problem, lcp, &result);
    guesses.push_back(std::move(result.f));
  }
  const ExactAnswer answer = SolveByEnumeration(problem, guesses);
  ReferenceSummary& reference = examined->entry.reference;
  if (answer.is_solved()) {
    const std::optional<bool> unique = problem.facts().f_unique ? problem.facts().f_unique : answer.f_unique;
    WriteProved(problem, answer.f, answer.w, unique, options, examined);
    return;
  }
  if (answer.status == ExactAnswer::Status::kInfeasible) WriteInfeasible(problem, {}, examined);
  reference.detail = answer.detail;
}

// ----- solved and bounded answers

// By our solvers, as good as the verifier finds it; none where it does not pass 1e-9.
std::optional<Eigen::VectorXd> Solve(const LcpProblem& problem, const ExamineOptions& options) {
  std::optional<Eigen::VectorXd> best;
  double best_rho = std::numeric_limits<double>::infinity();
  const bool is_start = problem.size() <= options.bounded_up_to;  // of a refinement, the nearer the better
  for (const double tolerance : {1e-12, 1e-9}) {
    if (tolerance < 1e-9 && !is_start) continue;
    LcpOptions lcp;
    lcp.tolerance = tolerance;
    lcp.time_limit_s = is_start ? options.time_limit_s : options.large_time_limit_s;
    LcpResult result;
    MakeSolver("auto")->Solve(problem, lcp, &result);
    const Metrics metrics = ComputeMetrics(problem, result.f);
    if (PassesTier(metrics, 1e-9) && metrics.rho < best_rho) {
      best_rho = metrics.rho;
      best = result.f;
    }
    if (result.status == LcpStatus::kSolved) break;
  }
  return best;
}

BoundedReference Bound(const LcpProblem& problem, const Eigen::VectorXd& f, const ExamineOptions& options) {
  BoundedOptions bounded;
  bounded.time_limit_s = options.time_limit_s;
  return RefineReference(problem, f, bounded);
}

void Write(const LcpProblem& problem, const BoundedReference& bounded, Examined* examined) {
  const Eigen::VectorXd f = ToDoubles(bounded.f);
  ReferenceSummary& reference = examined->entry.reference;
  reference = {};
  reference.kind = "bounded";
  reference.status = "solved";
  reference.proof = ToString(bounded.proof);
  reference.energy_bound = bounded.energy_bound;
  reference.energy_shift = bounded.energy_shift;
  reference.w_bound = bounded.w_bound;
  reference.f_bound = bounded.f_bound;
  reference.detail = bounded.detail;
  if (bounded.proof == BoundedReference::Proof::kActiveRows) {
    // f > 0 on the rows with w = 0 is part of the proof, and that there is no other f.
    reference.f_unique = true;
    reference.nullity_on_active = 0;
    reference.strictly_complementary = true;
    examined->entry.answer = MeasureAnswer(problem, f, bounded.w, 0);
  } else {
    constexpr double kNegligible = 1e-12;
    examined->entry.answer = MeasureAnswer(problem, f, bounded.w, kNegligible * LoadScale(problem));
  }
  Json line = LineOf(problem, reference);
  line["proof"] = reference.proof;
  line["energy_bound"] = bounded.energy_bound;
  line["energy_shift"] = bounded.energy_shift;
  line["w_bound"] = bounded.w_bound;
  line["w"] = ToJson(bounded.w);
  line["f"] = ToJson(f);
  examined->reference_line = line.dump();
}

// A problem with friction or bounded rows. Nothing is known of other answers.
void Write(const LcpProblem& problem, const ModeProof& proof, Examined* examined) {
  constexpr double kNegligible = 1e-12;
  ReferenceSummary& reference = examined->entry.reference;
  reference = {};
  reference.kind = "bounded";
  reference.status = "solved";
  reference.proof = ToString(proof.proof);
  if (proof.proof == ModeProof::Proof::kModes) {
    reference.f_bound = proof.f_bound;
  } else {
    reference.energy_shift = proof.b_shift;
    reference.mu_shift = proof.mu_shift;
  }
  Eigen::VectorXd w;
  problem.ComputeW(proof.f, &w);
  examined->entry.answer = MeasureAnswer(problem, proof.f, w, kNegligible * LoadScale(problem));
  Json line = LineOf(problem, reference);
  line["proof"] = reference.proof;
  line["w_unique"] = false;
  line["f"] = ToJson(proof.f);
  examined->reference_line = line.dump();
}

// A problem that has an exact ray: solvable but for roundings?
void LookNearby(const LcpProblem& problem, const ExamineOptions& options, Examined* examined) {
  const std::optional<Eigen::VectorXd> f = Solve(problem, options);
  if (!f.has_value()) return;
  const BoundedReference bounded = Bound(problem, *f, options);
  if (bounded.energy_shift > kRounding * LoadScale(problem)) return;
  Write(problem, bounded, examined);
  examined->entry.reference.detail =
      "no solution as its doubles say it, by an exact ray; the bounds are for a problem nearby";
}

}  // namespace

References::References(const Manifest& manifest, const std::string& folder) {
  if (manifest.references.empty()) return;
  name_ = (std::filesystem::path(folder) / manifest.references).string();
  LineReader lines(name_);
  std::string line;
  while (lines.Next(&line)) {
    std::string id = IdOf(line, name_ + ":" + std::to_string(lines.number()));
    lines_[std::move(id)] = std::move(line);
  }
}

std::string References::Line(const std::string& id) const {
  const auto line = lines_.find(id);
  return line == lines_.end() ? "" : line->second;
}

std::optional<KnownAnswer> References::Find(const LcpProblem& problem) const {
  const auto line = lines_.find(problem.id());
  if (line == lines_.end()) return std::nullopt;
  const std::string where = name_ + ": '" + problem.id() + "'";
  const nlohmann::json json = ParseJsonObject(line->second, where);
  const JsonField record(json, where);
  using Status = LcpReference::Status;
  KnownAnswer answer;
  answer.reference.status =
      record["status"].Choice<Status>({{"solved", Status::kSolved}, {"infeasible", Status::kInfeasible}});
  if (record.Has("kind")) record["kind"].Choice<bool>({{"certified", true}, {"bounded", true}});
  const bool is_unique = record.Knows("f_unique") && record["f_unique"].Boolean();
  if (answer.reference.status == Status::kInfeasible) return answer;
  const bool is_w_unique = !record.Has("w_unique") || record["w_unique"].Boolean();
  if (is_w_unique) answer.reference.w = Numbers(record["w"], problem.size());
  answer.f = Numbers(record[record.Has("f_minnorm") ? "f_minnorm" : "f"], problem.size());
  answer.reference.floor = RoundingFloor(problem, answer.f);
  if (is_unique) answer.reference.f = answer.f;
  return answer;
}

Examined Examine(const LcpProblem& problem, const ExamineOptions& options,
                 const std::optional<Eigen::VectorXd>& known_f) {
  Examined examined;
  examined.entry.id = problem.id();
  examined.entry.sha256 = ContentHash(problem);
  examined.entry.properties = MeasureProperties(problem);
  if (known_f) {
    Confirm(problem, *known_f, options, &examined);
    return examined;
  }
  const bool is_symmetric = problem.Asymmetry() == 0;
  if (is_symmetric && problem.size() <= options.exact_up_to && CertifyInto(problem, options, &examined)) {
    const bool is_infeasible = examined.entry.reference.status == "infeasible";
    if (is_infeasible && problem.is_plain()) LookNearby(problem, options, &examined);
    return examined;
  }
  if (!problem.facts().positive_semidefinite && problem.is_plain() && problem.size() <= kMostGuessedRows) {
    Enumerate(problem, options, &examined);
    if (examined.entry.reference.kind == "certified" || !is_symmetric) return examined;
  }
  const std::optional<Eigen::VectorXd> f = Solve(problem, options);
  if (!f.has_value()) {
    examined.entry.reference.detail = "not solved to 1e-9";
  } else if (problem.size() <= options.bounded_up_to && !problem.is_plain()) {
    const bool is_small = problem.size() <= options.modes_up_to;
    Write(problem, is_small ? ProveModes(problem, *f) : ProveNearby(problem, *f), &examined);
  } else if (problem.size() <= options.bounded_up_to && problem.facts().positive_semidefinite) {
    Write(problem, Bound(problem, *f, options), &examined);
  } else {
    examined.entry.reference.detail = problem.size() > options.bounded_up_to
                                          ? "none above " + std::to_string(options.bounded_up_to) + " rows"
                                          : "A is not known to be positive semidefinite";
    constexpr double kNegligible = 1e-8;
    examined.entry.answer = MeasureAnswer(problem, *f, ComputeMetrics(problem, *f).w, kNegligible * LoadScale(problem));
  }
  return examined;
}

}  // namespace lcpbench
