#include "benchmarks/collection/examine.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/exact_guess.h"
#include "solvers/exact/exact_lcp.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

Eigen::VectorXd ToDoubles(const std::vector<Rational>& values) {
  Eigen::VectorXd doubles(static_cast<Index>(values.size()));
  for (size_t k = 0; k < values.size(); ++k) doubles[static_cast<Index>(k)] = values[k].convert_to<double>();
  return doubles;
}

Json ToJson(const Eigen::VectorXd& values) { return std::vector<double>(values.begin(), values.end()); }

// True where a proved answer is known, and written into `examined`.
bool Certify(const LcpProblem& problem, const ExamineOptions& options, Examined* examined) {
  ExactOptions exact_options;
  exact_options.time_limit_s = options.time_limit_s;
  exact_options.guess = GuessBySolvers;
  const ExactLcp exact = ExactFrom(problem);
  const ExactAnswer answer = SolveExactly(exact, exact_options);
  const bool solved = answer.status == ExactAnswer::Status::kSolved;
  const bool infeasible = answer.status == ExactAnswer::Status::kInfeasible;
  if (!(solved || infeasible) || !FindFault(exact, answer).empty()) return false;

  ReferenceSummary& reference = examined->reference;
  reference.kind = "certified";
  reference.status = ToString(answer.status);
  Json line;
  line["id"] = problem.id();
  line["kind"] = reference.kind;
  line["status"] = reference.status;
  if (infeasible) {
    line["ray"] = ToJson(ToDoubles(answer.ray));
  } else {
    const bool least_norm = !answer.f_least_norm.empty();
    const Eigen::VectorXd w = ToDoubles(answer.w);
    const Eigen::VectorXd f = ToDoubles(least_norm ? answer.f_least_norm : answer.f);
    // Doubles of exact zeros are zeros, and of nothing else in the range of these numbers.
    examined->answer = MeasureAnswer(problem, f, w, 0);
    reference.f_unique = answer.f_unique;
    reference.nullity_on_active = answer.nullity_on_active;
    // f + w > 0 everywhere is the property itself; where it fails, only a unique f says that no other f has it.
    if (examined->answer->degenerate == 0) {
      reference.strictly_complementary = true;
    } else if (answer.f_unique.has_value() && *answer.f_unique) {
      reference.strictly_complementary = false;
    }
    if (!least_norm) reference.detail = answer.detail;
    line["f_unique"] = reference.f_unique.has_value() ? Json(*reference.f_unique) : Json(nullptr);
    line["w"] = ToJson(w);
    line[least_norm ? "f_minnorm" : "f"] = ToJson(f);
  }
  examined->reference_line = line.dump();
  return true;
}

// An answer by our solvers, judged by the verifier.
bool Solve(const LcpProblem& problem, Examined* examined) {
  LcpOptions options;
  options.tolerance = 1e-10;
  constexpr double kTimeLimit = 300;
  options.time_limit_s = kTimeLimit;
  LcpResult result;
  MakeSolver("auto")->Solve(problem, options, &result);
  const Metrics metrics = ComputeMetrics(problem, result.f);
  if (!PassesTier(metrics, 1e-9)) return false;
  double scale = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    const double d = problem.DiagonalA()[i] > 0 ? problem.DiagonalA()[i] : 1;
    scale = std::max(scale, std::abs(problem.b()[i]) / std::sqrt(d));
  }
  constexpr double kNegligible = 1e-8;
  examined->answer = MeasureAnswer(problem, result.f, metrics.w, kNegligible * scale);
  return true;
}

}  // namespace

Examined Examine(const LcpProblem& problem, const ExamineOptions& options) {
  Examined examined;
  examined.sha256 = ContentHash(problem);
  examined.properties = MeasureProperties(problem);
  if (problem.size() <= options.exact_up_to && Certify(problem, options, &examined)) return examined;
  if (!Solve(problem, &examined)) examined.reference.detail = "not solved";
  return examined;
}

}  // namespace lcpbench
