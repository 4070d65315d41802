#include "solvers/first_order/apgd.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "solvers/first_order/sweeps/first_order_engine.h"
#include "solvers/first_order/sweeps/vector_ops.h"

namespace lcpbench {
namespace {

void Extrapolate(const Array& x, const Array& before, double beta, Array* y) {
  ForLanes(
      x.size(), [&](std::size_t i) { Store(&(*y)[i], Load(&x[i]) + beta * (Load(&x[i]) - Load(&before[i]))); },
      [&](std::size_t i) { (*y)[i] = x[i] + beta * (x[i] - before[i]); });
}

}  // namespace

// rows_.f is x_k.
class ApgdEngine final : public FirstOrderEngine<ApgdOptions> {
 public:
  using FirstOrderEngine::FirstOrderEngine;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    return problem.IsNumericallySymmetric() ? WhyNoRows(problem, options_.form) : WhyNotSymmetric(problem);
  }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  bool Step(double lipschitz, PacedPasses* passes, StepSums* sums);
  double Curvature() const;

  Array before_, before_image_;  // x_{k-1}
  Array y_, y_image_;
  Array next_, next_image_;
};

// next = projection of y - w(y) / lipschitz, with its image.
bool ApgdEngine::Step(double lipschitz, PacedPasses* passes, StepSums* sums) {
  const RowKernel& kernel = *rows_.rows;
  kernel.StartImage(&next_image_);
  if (!passes->Run(false, [&](Index begin, Index end) {
        kernel.GradientStep(begin, end, 1 / lipschitz, y_, y_image_, &next_, &next_image_, sums);
      })) {
    return false;
  }
  return kernel.ImageIsRoot() ||
         passes->Run(false, [&](Index begin, Index end) { kernel.AddToImage(begin, end, next_, &next_image_); });
}

// d.A d, d = next_ - y_
double ApgdEngine::Curvature() const {
  return rows_.rows->ImageIsRoot() ? DotOfDifferences(next_image_, y_image_, next_image_, y_image_)
                                   : DotOfDifferences(next_, y_, next_image_, y_image_);
}

ApgdOptions ApgdOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("apgd", settings);
  ApgdOptions options;
  options.form = ReadRowForm(&reader);
  options.restart = reader.YesOrNo("restart", options.restart);
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

void ApgdEngine::Prepare(const LcpProblem& problem) {
  FirstOrderEngine::Prepare(problem, true);
  for (Array* array : {&before_, &y_, &next_}) array->assign(rows_.f.size(), 0.0);
  for (Array* array : {&before_image_, &y_image_, &next_image_}) {
    array->assign(rows_.image.size(), 0.0);
  }
}

void ApgdEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  rows_.Start(problem, options.initial_f);
  PacedPasses passes(options, *rows_.rows, rows_.scaled.size);
  bool over = test_.Begin(problem, options, ApgdOptions::kDefaultIterations, &rows_, &passes, result);
  before_ = rows_.f;
  before_image_ = rows_.image;
  // A has a unit diagonal: its largest eigenvalue is between 1 and the trace.
  const auto trace = static_cast<double>(rows_.scaled.size);
  double lipschitz = 1;
  double momentum = 1;
  double of_momentum = lipschitz;  // the lipschitz that momentum belongs to
  while (!over) {
    lipschitz = std::max(ApgdOptions::kDecay * lipschitz, ApgdOptions::kLeast);
    double next_momentum = 1;
    StepSums sums;
    bool in_time = true;
    for (;;) {
      next_momentum = momentum == 0 ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum * lipschitz / of_momentum)) / 2;
      const double beta = momentum == 0 ? 0 : (momentum - 1) / next_momentum;
      Extrapolate(rows_.f, before_, beta, &y_);
      Extrapolate(rows_.image, before_image_, beta, &y_image_);
      sums = {};
      in_time = Step(lipschitz, &passes, &sums);
      if (!in_time) break;
      const double curvature = Curvature();
      if (!(curvature > lipschitz * sums.change) || lipschitz >= trace) break;
      lipschitz =
          std::min(trace, std::max(ApgdOptions::kGrowth * lipschitz, ApgdOptions::kMargin * curvature / sums.change));
    }
    if (!in_time) {
      test_.EndOutOfTime();
      break;
    }
    // The step from y against the way of the iterates: the momentum points uphill.
    const bool uphill = DotOfDifferences(y_, next_, next_, rows_.f) > 0;
    std::swap(before_, rows_.f);
    std::swap(before_image_, rows_.image);
    std::swap(rows_.f, next_);
    std::swap(rows_.image, next_image_);
    momentum = options_.restart && uphill ? 0 : next_momentum;
    of_momentum = lipschitz;
    over = test_.Continue(std::sqrt(sums.residual));
  }
  test_.Finish();
}

template class EngineSolver<ApgdOptions, ApgdEngine>;

}  // namespace lcpbench
