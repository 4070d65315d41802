#include <algorithm>
#include <cmath>
#include <cstdio>

#include "benchmarks/motions/motion_study.h"

namespace lcpbench {
namespace {

std::string Text(const char* format, double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return value == 0 ? "0" : text;
}

std::string Short(double value) { return Text("%.1e", value); }

std::string TimePerStep(const MotionOutcome& outcome) {
  if (outcome.steps == 0 || outcome.solves == 0) return "-";
  return Text("%.1f", 1e6 * outcome.solve_time_s / outcome.steps);
}

struct Column {
  const char* title;
  std::string (*cell)(const MotionOutcome&);
};
constexpr Column kColumns[] = {{"solver", [](const MotionOutcome& o) { return o.solver; }},
                               {"tolerance", [](const MotionOutcome& o) { return Short(o.tolerance); }},
                               {"energy drift", [](const MotionOutcome& o) { return Text("%+.3e", o.energy_drift); }},
                               {"energy error", [](const MotionOutcome& o) { return Short(o.energy_error); }},
                               {"penetration/m", [](const MotionOutcome& o) { return Short(o.penetration); }},
                               {"joint/m", [](const MotionOutcome& o) { return Short(o.joint_error); }},
                               {"distance/m", [](const MotionOutcome& o) { return Short(o.distance); }},
                               {"us/step", TimePerStep},
                               {"worst rho", [](const MotionOutcome& o) { return Short(o.rho); }},
                               {"solves", [](const MotionOutcome& o) { return std::to_string(o.solves); }},
                               {"failed", [](const MotionOutcome& o) { return std::to_string(o.failed); }},
                               {"unverified", [](const MotionOutcome& o) { return std::to_string(o.not_passed); }},
                               {"false", [](const MotionOutcome& o) { return std::to_string(o.false_successes); }}};

// A block's lines, the first column to the left, numbers to the right.
std::string Aligned(const std::vector<MotionOutcome>& block) {
  std::vector<std::string> lines(block.size() + 1);
  for (const Column& column : kColumns) {
    std::vector<std::string> cells = {column.title};
    for (const MotionOutcome& outcome : block) cells.push_back(column.cell(outcome));
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const std::string blank(width - cells[k].size(), ' ');
      lines[k] += lines[k].empty() ? cells[k] + blank : "  " + blank + cells[k];
    }
  }
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

}  // namespace

std::string FormatMotionTable(const std::vector<MotionOutcome>& outcomes) {
  std::string text;
  for (auto begin = outcomes.begin(); begin != outcomes.end();) {
    const auto end = std::find_if(begin, outcomes.end(), [&](const MotionOutcome& outcome) {
      return outcome.scene != begin->scene || outcome.level != begin->level;
    });
    text += (text.empty() ? "" : "\n") + begin->scene + ", " + std::string(ToString(begin->level)) + " level\n" +
            Aligned({begin, end});
    for (; begin != end; ++begin) {
      if (begin->stopped.empty()) continue;
      text += begin->solver + " at " + Short(begin->tolerance) + " stopped after " + std::to_string(begin->steps) +
              " steps: " + begin->stopped + '\n';
    }
  }
  return text;
}

}  // namespace lcpbench
