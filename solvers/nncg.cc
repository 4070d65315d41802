#include "solvers/nncg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "solvers/sweeps/paced_passes.h"
#include "solvers/sweeps/row_work.h"
#include "solvers/sweeps/stopping_test.h"
#include "solvers/sweeps/sweep_loop.h"
#include "solvers/sweeps/vector_ops.h"

namespace lcpbench {
namespace {

// A vector over the rows and its image.
struct Point {
  Array f;
  Array image;

  void Reserve(const RowWork& work) {
    f.assign(work.f.size(), 0.0);
    image.assign(work.image.size(), 0.0);
  }
};

// A plane whose Gram determinant is below this share of its product of squares is a line but for rounding.
constexpr double kParallel = 64 * std::numeric_limits<double>::epsilon();

// Coefficients of the step from x: along the sweep's own step z, and along the previous step p.
struct Combination {
  double along_sweep = 1;
  double along_previous = 0;
};

}  // namespace

struct NncgSolver::Workspace {
  RowWork rows;  // f: the iterate; the sweeps move it from x to y
  StoppingTest test;
  Point x;         // where the sweep began
  Point previous;  // p, the previous step
  Point extra;     // what the extrapolation adds to y
  bool has_previous = false;
  double last_change = 0;  // |z|^2 of the previous iteration

  Combination Optimal() const;
  Combination FletcherReeves();
  void Extrapolate(NncgOptions::Direction direction);
};

// argmin over (a, c) of E(x + a z + c p), E(f) = f.Af/2 + b.f.
Combination NncgSolver::Workspace::Optimal() const {
  const bool root = rows.rows->ImageIsRoot();
  const Array& y_left = root ? rows.image : rows.f;
  const Array& x_left = root ? x.image : x.f;
  const Array& p_left = root ? previous.image : previous.f;
  const Array& y_right = rows.image;
  const Array& x_right = x.image;
  const Array& p_right = previous.image;
  ProductSum zz;
  ProductSum zp;
  ProductSum pp;
  ProductSum gz;
  ProductSum gp;
  const auto add_images = [&](auto get, std::size_t i) {
    const auto x_l = get(x_left, i);
    const auto x_r = get(x_right, i);
    const auto z_l = get(y_left, i) - x_l;
    const auto z_r = get(y_right, i) - x_r;
    const auto p_r = get(p_right, i);
    zz.Add(z_l, z_r);
    zp.Add(z_l, p_r);
    pp.Add(get(p_left, i), p_r);
    gz.Add(x_l, z_r);
    gp.Add(x_l, p_r);
  };
  const auto lanes = [](const Array& from, std::size_t i) { return Load(&from[i]); };
  const auto number = [](const Array& from, std::size_t i) { return from[i]; };
  ForLanes(
      y_right.size(), [&](std::size_t i) { add_images(lanes, i); }, [&](std::size_t i) { add_images(number, i); });
  const auto add_rows = [&](auto get, std::size_t i) {
    const auto b = get(rows.scaled.b, i);
    gz.Add(b, get(rows.f, i) - get(x.f, i));
    gp.Add(b, get(previous.f, i));
  };
  ForLanes(
      rows.f.size(), [&](std::size_t i) { add_rows(lanes, i); }, [&](std::size_t i) { add_rows(number, i); });
  const double determinant = zz.Total() * pp.Total() - zp.Total() * zp.Total();
  if (!has_previous || !(determinant > kParallel * zz.Total() * pp.Total())) {
    return {zz.Total() > 0 ? -gz.Total() / zz.Total() : 1.0, 0.0};
  }
  return {(zp.Total() * gp.Total() - pp.Total() * gz.Total()) / determinant,
          (zp.Total() * gz.Total() - zz.Total() * gp.Total()) / determinant};
}

Combination NncgSolver::Workspace::FletcherReeves() {
  const double change = DotOfDifferences(rows.f, x.f, rows.f, x.f);
  const double ratio = has_previous && last_change > 0 ? change / last_change : 0.0;
  last_change = change;
  return {1.0, ratio > 1 ? 0.0 : ratio};
}

void NncgSolver::Workspace::Extrapolate(NncgOptions::Direction direction) {
  const bool optimal = direction == NncgOptions::Direction::kOptimal;
  const Combination c = optimal ? Optimal() : FletcherReeves();
  const double more = c.along_sweep - 1;
  for (std::size_t i = 0; i < rows.image.size(); ++i) {
    extra.image[i] = more * (rows.image[i] - x.image[i]) + c.along_previous * previous.image[i];
  }
  bool clipped = false;
  for (std::size_t k = 0; k < rows.f.size(); ++k) {
    const double wanted = more * (rows.f[k] - x.f[k]) + c.along_previous * previous.f[k];
    extra.f[k] = wanted;
    if (rows.f[k] + wanted >= 0 || rows.scaled.IsFree(static_cast<Index>(k))) continue;
    clipped = true;
    extra.f[k] = -rows.f[k];
    rows.rows->AddRowToImage(static_cast<Index>(k), extra.f[k] - wanted, &extra.image);
  }
  double part = 1;
  if (clipped && optimal) {
    // The plane's minimum is out of bounds: the least energy on the way from y to its projection.
    const bool root = rows.rows->ImageIsRoot();
    const double slope = Dot(root ? rows.image : rows.f, extra.image) + Dot(rows.scaled.b, extra.f);
    const double curvature = Dot(root ? extra.image : extra.f, extra.image);
    part = curvature > 0 ? std::clamp(-slope / curvature, 0.0, 1.0) : 0.0;
  }
  for (std::size_t k = 0; k < rows.f.size(); ++k) {
    const double next = extra.f[k] == -rows.f[k] && part == 1 ? 0.0 : rows.f[k] + part * extra.f[k];
    previous.f[k] = next - x.f[k];
    rows.f[k] = next;
  }
  for (std::size_t i = 0; i < rows.image.size(); ++i) {
    const double next = rows.image[i] + part * extra.image[i];
    previous.image[i] = next - x.image[i];
    rows.image[i] = next;
  }
  has_previous = true;
}

NncgOptions NncgOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("nncg", settings);
  NncgOptions options;
  options.form = ReadRowForm(&reader);
  options.coloured = reader.Choice("sweep", "symmetric", {"symmetric", "coloured"}) == "coloured";
  if (reader.Choice("direction", "optimal", {"optimal", "fletcher-reeves"}) == "fletcher-reeves") {
    options.direction = Direction::kFletcherReeves;
  }
  reader.Finish();
  return options;
}

NncgSolver::NncgSolver(NncgOptions options) : options_(options), work_(std::make_unique<Workspace>()) {}
NncgSolver::~NncgSolver() = default;

std::string NncgSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (!problem.IsNumericallySymmetric()) return "A is not symmetric";
  return WhyNoRows(problem, options_.form);
}

void NncgSolver::DoPrepare(const LcpProblem& problem) {
  work_->rows.Prepare(problem, options_.form, options_.coloured);
  work_->test.Prepare(problem);
  for (Point* point : {&work_->x, &work_->previous, &work_->extra}) point->Reserve(work_->rows);
}

void NncgSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) {
  Workspace& work = *work_;
  RowWork& rows = work.rows;
  rows.Start(options.initial_f);
  work.has_previous = false;
  PacedPasses passes(options, *rows.rows, rows.scaled.size);
  bool over = work.test.Begin(options, kDefaultIterations, &rows, &passes, result);
  while (!over) {
    work.x.f = rows.f;
    work.x.image = rows.image;
    StepSums forward;
    StepSums backward;
    bool in_time = RunSweep(false, 1.0, &rows, &passes, &forward) && RunSweep(true, 1.0, &rows, &passes, &backward);
    if (in_time && !rows.rows->ImageIsRoot()) {
      in_time = passes.Run(
          false, [&](Index begin, Index end) { rows.rows->AddToImage(begin, end, rows.f, &rows.image); });
    }
    if (!in_time) {
      work.test.EndOutOfTime();
      break;
    }
    work.Extrapolate(options_.direction);
    over = work.test.Continue(std::sqrt(backward.residual));
  }
  work.test.Finish();
}

}  // namespace lcpbench
