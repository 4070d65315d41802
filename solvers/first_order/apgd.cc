#include "solvers/first_order/apgd.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "solvers/first_order/sweeps/paced_passes.h"
#include "solvers/first_order/sweeps/row_work.h"
#include "solvers/first_order/sweeps/stopping_test.h"
#include "solvers/first_order/sweeps/vector_ops.h"

namespace lcpbench {
namespace {

void Extrapolate(const Array& x, const Array& before, double beta, Array* y) {
  ForLanes(
      x.size(), [&](std::size_t i) { Store(&(*y)[i], Load(&x[i]) + beta * (Load(&x[i]) - Load(&before[i]))); },
      [&](std::size_t i) { (*y)[i] = x[i] + beta * (x[i] - before[i]); });
}

}  // namespace

struct ApgdSolver::Workspace {
  RowWork rows;  // f: x_k
  StoppingTest test;
  Array before;  // x_{k-1}
  Array before_image;
  Array y;
  Array y_image;
  Array next;
  Array next_image;

  bool Step(double lipschitz, PacedPasses* passes, StepSums* sums);
  double Curvature() const;
};

// next = projection of y - w(y) / lipschitz, with its image.
bool ApgdSolver::Workspace::Step(double lipschitz, PacedPasses* passes, StepSums* sums) {
  const RowKernel& kernel = *rows.rows;
  kernel.StartImage(&next_image);
  if (!passes->Run(false, [&](Index begin, Index end) {
        kernel.GradientStep(begin, end, 1 / lipschitz, y, y_image, &next, &next_image, sums);
      })) {
    return false;
  }
  return kernel.ImageIsRoot() ||
         passes->Run(false, [&](Index begin, Index end) { kernel.AddToImage(begin, end, next, &next_image); });
}

// d.A d, d = next - y
double ApgdSolver::Workspace::Curvature() const {
  return rows.rows->ImageIsRoot() ? DotOfDifferences(next_image, y_image, next_image, y_image)
                                  : DotOfDifferences(next, y, next_image, y_image);
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

ApgdSolver::ApgdSolver(ApgdOptions options) : options_(options), work_(std::make_unique<Workspace>()) {
  work_->test.SetSelfCheck(options.self_check);
}
ApgdSolver::~ApgdSolver() = default;

std::string ApgdSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (!problem.IsNumericallySymmetric()) return "A is not symmetric";
  return WhyNoRows(problem, options_.form);
}

void ApgdSolver::DoPrepare(const LcpProblem& problem) {
  Workspace& work = *work_;
  work.rows.Prepare(problem, options_.form, true);
  work.test.Prepare(problem);
  for (Array* array : {&work.before, &work.y, &work.next}) array->assign(work.rows.f.size(), 0.0);
  for (Array* array : {&work.before_image, &work.y_image, &work.next_image}) {
    array->assign(work.rows.image.size(), 0.0);
  }
}

void ApgdSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  Workspace& work = *work_;
  RowWork& rows = work.rows;
  rows.Start(problem, options.initial_f);
  PacedPasses passes(options, *rows.rows, rows.scaled.size);
  bool over = work.test.Begin(problem, options, kDefaultIterations, &rows, &passes, result);
  work.before = rows.f;
  work.before_image = rows.image;
  // A has a unit diagonal: its largest eigenvalue is between 1 and the trace.
  const auto trace = static_cast<double>(rows.scaled.size);
  double lipschitz = 1;
  double momentum = 1;
  double of_momentum = lipschitz;  // the lipschitz that momentum belongs to
  while (!over) {
    lipschitz = std::max(kDecay * lipschitz, kLeast);
    double next_momentum = 1;
    StepSums sums;
    bool in_time = true;
    for (;;) {
      next_momentum = momentum == 0 ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum * lipschitz / of_momentum)) / 2;
      const double beta = momentum == 0 ? 0 : (momentum - 1) / next_momentum;
      Extrapolate(rows.f, work.before, beta, &work.y);
      Extrapolate(rows.image, work.before_image, beta, &work.y_image);
      sums = {};
      in_time = work.Step(lipschitz, &passes, &sums);
      if (!in_time) break;
      const double curvature = work.Curvature();
      if (!(curvature > lipschitz * sums.change) || lipschitz >= trace) break;
      lipschitz = std::min(trace, std::max(kGrowth * lipschitz, kMargin * curvature / sums.change));
    }
    if (!in_time) {
      work.test.EndOutOfTime();
      break;
    }
    // The step from y against the way of the iterates: the momentum points uphill.
    const bool uphill = DotOfDifferences(work.y, work.next, work.next, rows.f) > 0;
    std::swap(work.before, rows.f);
    std::swap(work.before_image, rows.image);
    std::swap(rows.f, work.next);
    std::swap(rows.image, work.next_image);
    momentum = options_.restart && uphill ? 0 : next_momentum;
    of_momentum = lipschitz;
    over = work.test.Continue(std::sqrt(sums.residual));
  }
  work.test.Finish();
}

}  // namespace lcpbench
