#include <algorithm>
#include <cmath>
#include <cstdio>

#include "benchmarks/motions/motion_study.h"

namespace lcpbench {
namespace {

using Cells = std::vector<std::string>;

std::string Short(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return value == 0 ? "0" : text;
}

std::string Signed(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%+.3e", value);
  return value == 0 ? "0" : text;
}

const Cells kHeader = {"solver",  "tolerance", "energy drift", "energy error", "penetration/m", "joint/m", "distance/m",
                       "us/step", "worst rho", "solves",       "failed",       "unverified",    "false"};

Cells CellsOf(const MotionOutcome& outcome) {
  char time[32];
  std::snprintf(time, sizeof time, "%.1f", 1e6 * outcome.solve_time_s / std::max(1, outcome.steps));
  return {outcome.solver,
          Short(outcome.tolerance),
          Signed(outcome.energy_drift),
          Short(outcome.energy_error),
          Short(outcome.penetration),
          Short(outcome.joint_error),
          Short(outcome.distance),
          outcome.steps > 0 && outcome.solves > 0 ? time : "-",
          Short(outcome.rho),
          std::to_string(outcome.solves),
          std::to_string(outcome.failed),
          std::to_string(outcome.not_passed),
          std::to_string(outcome.false_successes)};
}

// The first column to the left, numbers to the right.
std::string Aligned(const std::vector<Cells>& rows) {
  std::vector<std::size_t> widths(kHeader.size(), 0);
  for (const Cells& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text;
  for (const Cells& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string blank(widths[k] - row[k].size(), ' ');
      text += (k == 0 ? "" : "  ") + (k == 0 ? row[k] + blank : blank + row[k]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string FormatMotionTable(const std::vector<MotionOutcome>& outcomes) {
  std::string text;
  for (auto begin = outcomes.begin(); begin != outcomes.end();) {
    const auto end = std::find_if(begin, outcomes.end(), [&](const MotionOutcome& outcome) {
      return outcome.scene != begin->scene || outcome.level != begin->level;
    });
    std::vector<Cells> rows = {kHeader};
    std::string stops;
    for (auto outcome = begin; outcome != end; ++outcome) {
      rows.push_back(CellsOf(*outcome));
      if (outcome->stopped.empty()) continue;
      stops += outcome->solver + " at " + Short(outcome->tolerance) + " stopped after " +
               std::to_string(outcome->steps) + " steps: " + outcome->stopped + '\n';
    }
    text += (text.empty() ? "" : "\n") + begin->scene + ", " + std::string(ToString(begin->level)) + " level\n" +
            Aligned(rows) + stops;
    begin = end;
  }
  return text;
}

}  // namespace lcpbench
