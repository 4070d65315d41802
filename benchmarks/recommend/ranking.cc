#include "benchmarks/recommend/ranking.h"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cstdio>
#include <tuple>

#include "benchmarks/measure/quantile.h"

namespace lcpbench {
namespace {

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
    if (claim == "solved" || count <= steps) continue;
    failure = claim;
    steps = count;
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
  // Of a pass that ended early the verdict says enough.
  if (!in_time && measured.outcome == "completed") {
    found.shortcoming += (found.shortcoming.empty() ? "" : "; ") + std::string("deadline missed in ") +
                         Percent(1 - found.in_time) + " of the steps";
  }
  return found;
}

}  // namespace

std::string FormatNumber(double value, const char* format) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
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
