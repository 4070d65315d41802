#include "benchmarks/motions/sequence.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

// What is not finite is written as null.
Json Describe(const Verdict& verdict) {
  Json judged;
  judged["passes"] = verdict.passes;
  judged["best_tier"] = verdict.best_tier > 0 ? Json(verdict.best_tier) : Json(nullptr);
  judged["rho"] = verdict.metrics.rho;
  judged["backward_error"] = verdict.metrics.backward_error;
  judged["false_success"] = verdict.false_success;
  judged["reason"] = verdict.reason;
  if (verdict.farkas) {
    judged["ray_accepted"] = verdict.farkas->accepted;
    judged["ray_proved"] = verdict.farkas->proved;
  }
  return judged;
}

}  // namespace

std::vector<int> PreviousRows(RowMatching* matching, const MotionProblem& met) {
  std::vector<int> previous;
  for (const std::optional<int>& row : matching->Follow(met.system, met.rows)) previous.push_back(row.value_or(-1));
  return previous;
}

ActiveSetChange ActiveSetHistory::Follow(const LcpProblem& problem, const std::vector<int>& previous,
                                         const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  const Eigen::VectorXd& D = problem.DiagonalA();
  ActiveSetChange change;
  std::vector<bool> active;
  std::vector<bool> stays(active_.size(), false);
  for (std::size_t k = 0; k < previous.size(); ++k) {
    const auto i = static_cast<Index>(k);
    const int row = static_cast<int>(k);
    active.push_back(problem.is_bilateral(i) || (D[i] > 0 ? D[i] : 1.0) * f[i] > w[i]);
    if (previous[k] < 0) {
      change.entered.push_back(row);
      continue;
    }
    const auto before = static_cast<std::size_t>(previous[k]);
    stays[before] = true;
    if (active[k] && !active_[before]) change.activated.push_back(row);
    if (!active[k] && active_[before]) change.deactivated.push_back(row);
  }
  for (std::size_t k = 0; k < stays.size(); ++k) {
    if (!stays[k]) change.left.push_back(static_cast<int>(k));
  }
  active_ = std::move(active);
  return change;
}

SequenceWriter::SequenceWriter(std::ostream& out, std::string solver, double tolerance, Contents contents)
    : out_(out), solver_(std::move(solver)), tolerance_(tolerance), contents_(contents) {}

void SequenceWriter::BeginStep(int step) {
  step_ = step;
  acceleration_written_ = false;
  written_of_step_ = 0;
}

void SequenceWriter::Write(const MotionProblem& met) {
  if (met.kind == MotionProblemKind::kAcceleration) {
    if (acceleration_written_) return;
    acceleration_written_ = true;
  }
  const Verdict verdict = Verify(met.problem, met.result, tolerance_);
  counts_.rows.push_back(met.problem.size());
  if (met.result.status != LcpStatus::kSolved) ++counts_.failed;
  if (!verdict.passes) ++counts_.not_passed;
  if (verdict.false_success) ++counts_.false_successes;

  const ActiveSetChange change =
      history_.Follow(met.problem, PreviousRows(&matching_, met), met.result.f, verdict.metrics.w);
  Json motion;
  motion["step"] = step_;
  motion["time"] = met.time;
  motion["kind"] = ToString(met.kind);
  motion["entered"] = change.entered;
  motion["left"] = change.left;
  motion["activated"] = change.activated;
  motion["deactivated"] = change.deactivated;
  motion["solver"] = solver_;
  motion["tolerance"] = tolerance_;
  motion["claim"] = ToString(met.result.status);
  motion["iterations"] = met.result.iterations;
  motion["verdict"] = Describe(verdict);
  motion["detail"] = met.result.detail;

  if (contents_.with_forces) {
    motion["f"] = std::vector<double>(met.result.f.begin(), met.result.f.end());
    motion["w"] = std::vector<double>(verdict.metrics.w.begin(), verdict.metrics.w.end());
  }

  std::string id = met.problem.id() + "-step" + std::to_string(step_);
  if (++written_of_step_ > 1) id += "-" + std::to_string(written_of_step_);
  std::string line = FormatLcpRecord(met.problem, contents_.with_matrix, std::nullopt, id);
  line.pop_back();  // the closing brace
  // A library's message may hold any bytes; the line must stay valid JSON.
  line += ",\"motion\":" + motion.dump(-1, ' ', false, Json::error_handler_t::replace) + "}";
  out_ << line << '\n' << std::flush;
}

}  // namespace lcpbench
