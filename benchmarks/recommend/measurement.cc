#include "benchmarks/recommend/measurement.h"

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "benchmarks/measure/quantile.h"
#include "solvers/lcp/solver.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Null where it is not finite.
double NumberAt(const nlohmann::json& numbers, size_t step) {
  const nlohmann::json& number = numbers.at(step);
  return number.is_number() ? number.get<double>() : kInfinity;
}

std::string Percent(double share) { return FormatNumber(100 * share, share < 0.01 ? "%.1g %%" : "%.0f %%"); }

// "1e-6"
std::string TierText(double tier) {
  return boost::algorithm::replace_first_copy(FormatNumber(tier, "%.0e"), "e-0", "e-");
}

int PassedAt(const Measurement& measured, double tier) {
  const auto found = measured.passed.find(tier);
  return found == measured.passed.end() ? 0 : found->second;
}

// The solver's own words for most steps that were not solved.
std::string MostFrequentFailure(const Measurement& measured) {
  std::string failure;
  int steps = 0;
  for (const auto& [claim, count] : measured.claims) {
    const int failed = claim == ToString(LcpStatus::kInfeasible) ? count - measured.proofs : count;
    if (claim == ToString(LcpStatus::kSolved) || failed <= steps) continue;
    failure = claim;
    steps = failed;
  }
  return failure;
}

std::string WhyNotVerified(const Measurement& measured, double tolerance) {
  if (measured.outcome != "completed") return measured.outcome + ": " + measured.detail;
  const int steps = static_cast<int>(measured.latency_s.size());
  const int failed = steps - PassedAt(measured, tolerance);
  std::string text;
  // Strictest first.
  for (const auto& [tier, passed] : measured.passed) {
    if (tier > tolerance && passed == steps) {
      text = "meets " + TierText(tier) + " only";
      break;
    }
  }
  if (text.empty() && failed == steps) text = "not verified";
  if (failed < steps) {
    const std::string count = "fails " + std::to_string(failed) + " of " + std::to_string(steps) + " steps";
    text = text.empty() ? count : count + ", " + text;
  }
  const std::string claim = MostFrequentFailure(measured);
  if (!claim.empty()) text += " (" + claim + ")";
  if (measured.false_successes > 0) text += ", claims success falsely";
  return text;
}

}  // namespace

Passes::Passes(std::string solver, bool warm, size_t steps) : calm_(steps), all_(steps) {
  found_.solver = std::move(solver);
  found_.warm = warm;
  found_.latency_s.assign(steps, kInfinity);
}

void Passes::Add(const SequenceReply& reply, bool disturbed, double tolerance) {
  const nlohmann::json& results = reply.results;
  found_.outcome = reply.outcome;
  found_.detail = reply.detail;
  found_.claims = results.at("claims").get<std::map<std::string, int>>();
  std::set<size_t> failed;
  for (const nlohmann::json& verdict : results.at("verdicts")) {
    const auto tier = verdict.at("tier").get<double>();
    const int passed = verdict.at("passed").get<int>();
    found_.passed[tier] = found_.passes == 0 ? passed : std::min(found_.passed[tier], passed);
    if (tier != tolerance) continue;
    failed = verdict.at("failed_steps").get<std::set<size_t>>();
    found_.false_successes = std::max(found_.false_successes, verdict.at("false_successes").get<int>());
  }
  const auto preempted = results.at("preempted").get<std::set<size_t>>();
  const auto reached = results.at("reached").get<size_t>();
  found_.proofs = 0;
  for (size_t step = 0; step < reached; ++step) {
    const double latency = NumberAt(results.at("latency_s"), step);
    all_[step].push_back(latency);
    if (!disturbed && preempted.count(step) == 0) calm_[step].push_back(latency);
    found_.latency_s[step] = MedianOf(calm_[step].empty() ? all_[step] : calm_[step]);
    found_.raw_max_s = std::max(found_.raw_max_s, latency);
    // What is right without forces is a proof.
    if (results.at("rho").at(step).is_null() && !failed.contains(step)) {
      ++found_.proofs;
    } else {
      found_.rho = std::max(found_.rho, NumberAt(results.at("rho"), step));
    }
  }
  if (static_cast<size_t>(found_.proofs) == reached) found_.rho = kInfinity;
  if (disturbed) ++found_.disturbed;
  ++found_.passes;
}

Assessment Assess(const Measurement& measured, const RecommendationRequest& request) {
  Assessment found;
  found.measured = measured;
  const std::vector<double>& latency = measured.latency_s;
  found.p50_s = Quantile(latency, 0.5);
  found.p99_s = Quantile(latency, 0.99);
  found.max_s = Quantile(latency, 1);
  const auto steps = static_cast<double>(latency.size());
  if (request.deadline_s) {
    const auto in_time =
        std::count_if(latency.begin(), latency.end(), [&](double time) { return time <= *request.deadline_s; });
    found.in_time = static_cast<double>(in_time) / steps;
  }
  found.verified = PassedAt(measured, request.tolerance) / steps;
  found.time_s = request.by_tail ? found.p99_s : found.p50_s;
  const bool in_time = !request.deadline_s || found.p99_s <= *request.deadline_s;
  const bool verified = measured.outcome == "completed" && found.verified == 1;
  found.meets = verified && in_time;
  if (!verified) found.shortcoming = WhyNotVerified(measured, request.tolerance);
  // The verdict says enough where a pass ended early.
  if (!in_time && measured.outcome == "completed") {
    found.shortcoming += (found.shortcoming.empty() ? "" : "; ") + std::string("deadline missed in ") +
                         Percent(1 - found.in_time) + " of the steps";
  }
  return found;
}

std::vector<Assessment> RankMeasurements(const std::vector<Measurement>& measurements,
                                         const RecommendationRequest& request) {
  std::vector<Assessment> ranked;
  ranked.reserve(measurements.size());
  for (const Measurement& measured : measurements) ranked.push_back(Assess(measured, request));
  const auto key = [](const Assessment& each) {
    const double verified = each.meets ? 1 : each.verified;
    return std::make_tuple(each.meets ? 0 : 1, -verified, each.meets ? 0.0 : -each.in_time, each.time_s);
  };
  std::stable_sort(ranked.begin(), ranked.end(),
                   [&](const Assessment& a, const Assessment& b) { return key(a) < key(b); });
  return ranked;
}

}  // namespace lcpbench
