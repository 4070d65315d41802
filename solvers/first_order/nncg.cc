#include "solvers/first_order/nncg.h"

#include <cmath>
#include <optional>

#include "solvers/first_order/first_order_engine.h"
#include "solvers/first_order/sweeps/conjugate_sweeps.h"

namespace lcpbench {

class NncgEngine final : public FirstOrderEngine, public RowEngine {
 public:
  explicit NncgEngine(const NncgOptions& options)
      : FirstOrderEngine({.form = options.form,
                          .coloured = options.coloured,
                          .needs_symmetry = true,
                          .end_when_hopeless = options.end_when_hopeless,
                          .hopeful_iterations = options.least_iterations,
                          .default_limit = NncgOptions::kDefaultIterations}),
        iteration_(options.direction == NncgOptions::Direction::kOptimal) {}
  static constexpr bool kSolvesByFaces = true;

  void Prepare(const LcpProblem& problem) {
    PrepareRows(problem);
    iteration_.Reserve(rows_.scaled.size, rows_.rows->ImageSize());
  }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    TakeProblem(problem, options);
    SolveTaken(options, result);
  }
  bool SolveRows(const RowTask& task, LcpResult* result) override {
    if (!TakeRows(task)) return false;
    iteration_.Reserve(rows_.scaled.size, rows_.rows->ImageSize());
    SolveTaken(task.options, result);
    return result->status != LcpStatus::kNumericalFailure;
  }

 private:
  void SolveTaken(const LcpOptions& options, LcpResult* result) {
    iteration_.Start(*rows_.rows, rows_.scaled);
    Iterate(options, result, [&]() -> std::optional<double> {
      iteration_.BeginIteration(rows_.x);
      StepSums forward;
      StepSums backward;
      bool in_time = Sweep(false, 1.0, &forward) && Sweep(true, 1.0, &backward);
      if (in_time && !rows_.rows->ImageIsRoot()) {
        in_time = ForAllRows(false, [&](Index begin, Index end) { rows_.rows->AddToImage(begin, end, &rows_.x); });
      }
      if (!in_time) return {};
      iteration_.EndIteration(forward.energy + backward.energy, backward.residual, &rows_.x);
      return std::sqrt(backward.residual);
    });
  }

  ConjugateSweeps iteration_;
};

void NncgOptions::Read(SettingsReader* reader) {
  form = ReadRowForm(reader);
  coloured = reader->Choice("sweep", "coloured", {"symmetric", "coloured"}) == "coloured";
  const bool is_optimal = reader->Choice("direction", "optimal", {"optimal", "fletcher-reeves"}) == "optimal";
  direction = is_optimal ? Direction::kOptimal : Direction::kFletcherReeves;
}

template class EngineSolver<NncgOptions, NncgEngine>;

}  // namespace lcpbench
