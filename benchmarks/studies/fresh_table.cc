#include "benchmarks/studies/fresh_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

template <typename... Numbers>
std::string Text(const char* format, Numbers... numbers) {
  char text[64];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// Three digits.
std::string Digits(double value) {
  constexpr double kHundred = 100;
  return value >= kHundred ? Text("%.0f", value) : Text("%.3g", value);
}

std::string TimeText(double seconds) {
  if (std::isnan(seconds)) return "–";
  if (std::isinf(seconds)) return "∞";
  for (const auto& [unit, name] : {std::pair(1e-6, " ns"), {1e-3, " µs"}, {1.0, " ms"}}) {
    if (seconds < unit) return Digits(seconds / unit * 1e3) + name;
  }
  return Digits(seconds) + " s";
}

std::string RatioText(double ratio) {
  if (std::isnan(ratio)) return "–";
  return std::isinf(ratio) ? "∞" : Digits(ratio);
}

// The share is never rounded up to all.
std::string ShareText(double share) {
  constexpr double kPercent = 100;
  return std::isnan(share) ? "–" : Text("%.1f %%", std::floor(share * kPercent * 10 + 1e-6) / 10);
}

// The best right peer; where none is right, the one with the least median of those that are right on as much as any.
struct Rival {
  const FreshTimes* times = nullptr;
  bool is_right = true;  // else it is marked
};

// Few problems prove little.
std::size_t TurnsOfBest(const FreshGroup& group) { return std::min(kLeastTurns, group.weights.size()); }

Rival RivalOf(const FreshGroup& group) {
  if (const FreshTimes* best = BestOf(group, false)) return {best, true};
  double most = 0;
  for (const FreshTimes& times : group.solvers) {
    const FreshSummary summary = Summarize(times, group.weights);
    if (!times.is_own && summary.problems >= TurnsOfBest(group)) most = std::max(most, summary.right);
  }
  const FreshTimes* best = most > 0 ? BestOf(group, false, most) : nullptr;
  return {best, best == nullptr};
}

double RatioToRival(const FreshGroup& group, const FreshTimes& times) {
  const Rival rival = RivalOf(group);
  return rival.times != nullptr ? RatioTo(times.seconds, rival.times->seconds, group.weights) : kUnknown;
}

void WriteGroup(const FreshGroup& group, std::ostream& out) {
  const std::vector<double> fastest = FastestPeer(group);
  const FreshTimes* best_own = BestOf(group, true);
  const FreshTimes* best_peer = BestOf(group, false);
  for (const FreshTimes& times : group.solvers) {
    const FreshSummary summary = Summarize(times, group.weights);
    const bool is_best = &times == best_own || &times == best_peer;
    const char* mark = is_best ? "**" : "";
    out << "| " << group.size_class << " | " << summary.problems << " | " << mark << times.solver << mark << " | "
        << ShareText(summary.right) << " | " << TimeText(summary.median_s) << " | " << TimeText(summary.p90_s) << " | "
        << TimeText(summary.p99_s) << " | ";
    if (times.is_own) {
      const double to_own = best_own != nullptr ? RatioTo(times.seconds, best_own->seconds, group.weights) : kUnknown;
      out << RatioText(RatioToRival(group, times)) << (RivalOf(group).is_right ? "" : "*") << " | "
          << RatioText(RatioTo(times.seconds, fastest, group.weights)) << " | " << RatioText(to_own) << " |\n";
    } else {
      out << " | | |\n";
    }
  }
}

// A line per origin, a column per size class.
void WriteGoals(const std::string& solver, const std::vector<FreshGroup>& groups, std::ostream& out) {
  std::vector<std::string> classes;
  std::vector<std::string> origins;
  std::map<std::pair<std::string, std::string>, std::string> cells;
  const auto note = [](const std::string& key, std::vector<std::string>* keys) {
    if (std::find(keys->begin(), keys->end(), key) == keys->end()) keys->push_back(key);
  };
  for (const FreshGroup& group : groups) {
    for (const FreshTimes& times : group.solvers) {
      if (times.solver != solver) continue;
      note(group.origin, &origins);
      const Rival rival = RivalOf(group);
      std::string& cell = cells[{group.origin, group.size_class}];
      cell = RatioText(RatioToRival(group, times)) + (rival.is_right ? "" : "*");
      if (rival.times != nullptr) cell += " " + rival.times->solver;
    }
    note(group.size_class, &classes);
  }
  out << "\n`" << solver << "`: its time over that of the best right peer of the class\n\n| origin |";
  for (const std::string& size_class : classes) out << ' ' << size_class << " |";
  out << "\n| --- |";
  for (std::size_t k = 0; k < classes.size(); ++k) out << " --- |";
  for (const std::string& origin : origins) {
    out << "\n| " << origin << " |";
    for (const std::string& size_class : classes) out << ' ' << cells[{origin, size_class}] << " |";
  }
  out << '\n';
}

}  // namespace

double WeightedQuantile(const std::vector<double>& values, const std::vector<double>& weights, double level) {
  constexpr double kRounding = 1e-9;  // of sums of weights, relative
  if (values.empty()) return kUnknown;
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  double all = 0;
  for (const std::size_t k : order) all += weights[k];
  double below = 0;
  std::size_t at = 0;
  for (; at < order.size(); ++at) {
    below += weights[order[at]] / all;
    if (below >= level - kRounding) break;
  }
  at = std::min(at, order.size() - 1);
  const bool is_exact = below <= level + kRounding && level > 0;
  const std::size_t after = is_exact ? std::min(at + 1, order.size() - 1) : at;
  const double low = values[order[at]];
  const double high = values[order[after]];
  return low == high ? low : (low + high) / 2;
}

FreshSummary Summarize(const FreshTimes& times, const std::vector<double>& weights) {
  std::vector<double> turns, turn_weights, verified, verified_weights;
  double all = 0;
  double right = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double seconds = times.seconds[k];
    if (std::isnan(seconds)) continue;
    turns.push_back(seconds);
    turn_weights.push_back(weights[k]);
    all += weights[k];
    if (std::isinf(seconds)) continue;
    right += weights[k];
    verified.push_back(seconds);
    verified_weights.push_back(weights[k]);
  }
  constexpr double kP90 = 0.9;
  constexpr double kP99 = 0.99;
  FreshSummary summary;
  summary.problems = turns.size();
  summary.right = turns.empty() ? kUnknown : right / all;
  summary.median_s = WeightedQuantile(turns, turn_weights, 0.5);
  summary.p90_s = WeightedQuantile(verified, verified_weights, kP90);
  summary.p99_s = turns.size() < kLeastForP99 ? kUnknown : WeightedQuantile(verified, verified_weights, kP99);
  return summary;
}

const FreshTimes* BestOf(const FreshGroup& group, bool own, double least) {
  constexpr double kRounding = 1e-12;
  const FreshTimes* best = nullptr;
  double best_s = kInfinity;
  for (const FreshTimes& times : group.solvers) {
    if (times.is_own != own) continue;
    const FreshSummary summary = Summarize(times, group.weights);
    if (summary.problems < TurnsOfBest(group) || !(summary.right >= least - kRounding) || !(summary.median_s < best_s))
      continue;
    best = &times;
    best_s = summary.median_s;
  }
  return best;
}

double RatioTo(const std::vector<double>& seconds, const std::vector<double>& other,
               const std::vector<double>& weights) {
  std::vector<double> ratios, of_ratios;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (std::isnan(seconds[k]) || !std::isfinite(other[k])) continue;
    ratios.push_back(seconds[k] / other[k]);
    of_ratios.push_back(weights[k]);
  }
  return WeightedQuantile(ratios, of_ratios, 0.5);
}

std::vector<double> FastestPeer(const FreshGroup& group) {
  std::vector<double> fastest(group.weights.size(), kInfinity);
  for (const FreshTimes& times : group.solvers) {
    if (times.is_own) continue;
    for (std::size_t k = 0; k < fastest.size(); ++k) {
      if (times.seconds[k] < fastest[k]) fastest[k] = times.seconds[k];
    }
  }
  return fastest;
}

void WriteFreshTables(const std::vector<FreshGroup>& groups, std::ostream& out) {
  std::string origin;
  std::vector<std::string> own;
  for (const FreshGroup& group : groups) {
    if (group.origin != origin) {
      origin = group.origin;
      out << "\n### " << origin
          << "\n\n| rows | problems | solver | right | median | p90 | p99 | / best right peer | / fastest peer | / "
             "best "
             "own |\n| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    }
    WriteGroup(group, out);
    for (const FreshTimes& times : group.solvers) {
      if (times.is_own && std::find(own.begin(), own.end(), times.solver) == own.end()) own.push_back(times.solver);
    }
  }
  out << "\nRatios are weighted medians over problems of the solver's time by the other's, where the other is right. "
         "**Bold**: the "
         "best of ours and of the peers that is right on 99 %. *: no peer is; the best of those that are right on as "
         "much as any.\n";
  for (const std::string& solver : own) WriteGoals(solver, groups, out);
}

}  // namespace lcpbench
