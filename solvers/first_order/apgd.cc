#include "solvers/first_order/apgd.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "solvers/first_order/first_order_engine.h"

namespace lcpbench {

// rows_.x is x_k.
class ApgdEngine final : public FirstOrderEngine {
 public:
  explicit ApgdEngine(const ApgdOptions& options)
      : FirstOrderEngine(
            {.form = options.form, .needs_symmetry = true, .default_limit = ApgdOptions::kDefaultIterations}),
        restart_(options.restart) {}
  static constexpr bool kSolvesByFaces = true;

  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  bool Step(double lipschitz, StepSums* sums);
  double Curvature() const;

  const bool restart_;
  Point before_;  // x_{k-1}
  Point y_;
  Point next_;
};

// next = projection of y - w(y) / lipschitz, with its image.
bool ApgdEngine::Step(double lipschitz, StepSums* sums) {
  const RowKernel& kernel = *rows_.rows;
  kernel.StartImage(&next_.image);
  const bool in_time = ForAllRows(
      false, [&](Index begin, Index end) { kernel.GradientStep(begin, end, 1 / lipschitz, y_, &next_, sums); });
  if (!in_time || kernel.ImageIsRoot()) return in_time;
  return ForAllRows(false, [&](Index begin, Index end) { kernel.AddToImage(begin, end, &next_); });
}

// d.A d, d = next_ - y_
double ApgdEngine::Curvature() const {
  return rows_.rows->ImageIsRoot() ? DotOfDifferences(next_.image.size(), next_.image, y_.image, next_.image, y_.image)
                                   : DotOfDifferences(next_.f.size(), next_.f, y_.f, next_.image, y_.image);
}

void ApgdOptions::Read(SettingsReader* reader) {
  form = ReadRowForm(reader);
  restart = reader->YesOrNo("restart", restart);
}

void ApgdEngine::Prepare(const LcpProblem& problem) {
  PrepareRows(problem);
  for (Point* point : {&before_, &y_, &next_}) *point = rows_.x;
}

void ApgdEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  // A has a unit diagonal: its largest eigenvalue is between 1 and the trace.
  const auto trace = static_cast<double>(rows_.scaled.size);
  double lipschitz = 1;
  double momentum = 1;             // t_k; 0: starts anew
  double of_momentum = lipschitz;  // the lipschitz that momentum belongs to
  before_.f.setZero();
  before_.image.setZero();
  TakeProblem(problem, options);
  Iterate(options, result, [&]() -> std::optional<double> {
    lipschitz = std::max(ApgdOptions::kDecay * lipschitz, ApgdOptions::kLeast);
    double next_momentum = 1;
    StepSums sums;
    for (;;) {
      next_momentum = momentum == 0 ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum * lipschitz / of_momentum)) / 2;
      const double beta = momentum == 0 ? 0 : (momentum - 1) / next_momentum;
      y_.f = rows_.x.f + beta * (rows_.x.f - before_.f);
      y_.image = rows_.x.image + beta * (rows_.x.image - before_.image);
      sums = {};
      if (!Step(lipschitz, &sums)) return {};
      const double curvature = Curvature();
      if (!(curvature > lipschitz * sums.change) || lipschitz >= trace) break;
      lipschitz =
          std::min(trace, std::max(ApgdOptions::kGrowth * lipschitz, ApgdOptions::kMargin * curvature / sums.change));
    }
    // The step from y against the way of the iterates: the momentum points uphill.
    const bool uphill = DotOfDifferences(y_.f.size(), y_.f, next_.f, next_.f, rows_.x.f) > 0;
    std::swap(before_, rows_.x);
    std::swap(rows_.x, next_);
    momentum = restart_ && uphill ? 0 : next_momentum;
    of_momentum = lipschitz;
    return std::sqrt(sums.residual);
  });
}

template class EngineSolver<ApgdOptions, ApgdEngine>;

}  // namespace lcpbench
