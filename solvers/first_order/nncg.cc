#include "solvers/first_order/nncg.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "solvers/first_order/sweeps/paced_passes.h"
#include "solvers/first_order/sweeps/row_work.h"
#include "solvers/first_order/sweeps/stopping_test.h"
#include "solvers/first_order/sweeps/sweep_loop.h"
#include "solvers/first_order/sweeps/vector_ops.h"

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
constexpr double kParallel = 1e-10;

// Rows that are looked through one by one for projections where one of them is projected.
constexpr std::size_t kBlock = 32;

// Products of the sweep's step z and the previous step p: u.A v, and u.w at x. Those with w are sums of the size of
// |z|^2 while f.Af is of the size of 1, so they are never taken as differences: near the solution nothing would be
// left.
struct Products {
  double zz = 0;
  double zp = 0;
  double pp = 0;
  double zw = 0;
  double pw = 0;
};

// Coefficients of the step from x: along z, and along p.
struct Combination {
  double along_sweep = 1;
  double along_previous = 0;
};

// argmin over (a, c) of the energy at x + a z + c p.
Combination LeastEnergy(const Products& of) {
  const double determinant = of.zz * of.pp - of.zp * of.zp;
  if (!(determinant > kParallel * of.zz * of.pp)) return {of.zz > 0 ? -of.zw / of.zz : 1.0, 0.0};
  return {(of.zp * of.pw - of.pp * of.zw) / determinant, (of.zp * of.zw - of.zz * of.pw) / determinant};
}

}  // namespace

struct NncgSolver::Workspace {
  RowWork rows;  // f: the iterate; the sweeps move it from x to y
  StoppingTest test;
  Point x;         // where the sweep began
  Point previous;  // p, the previous step
  Point extra;     // what the extrapolation adds to y
  bool has_previous = false;
  double previous_w = 0;   // p.w at x less p.A p
  double last_change = 0;  // |z|^2 of the previous iteration

  const Array& Left(const Array& f, const Array& image) const { return rows.rows->ImageIsRoot() ? image : f; }
  Products MakeProducts(double energy) const;
  Combination FletcherReeves();
  bool WantBlock(const Combination& c, std::size_t begin, std::size_t end);
  void Extrapolate(NncgOptions::Direction direction, double energy);
};

// `energy` is what the sweep gained: z.w + z.A z / 2.
Products NncgSolver::Workspace::MakeProducts(double energy) const {
  const Array& y_left = Left(rows.f, rows.image);
  const Array& x_left = Left(x.f, x.image);
  const Array& p_left = Left(previous.f, previous.image);
  ProductSum zz;
  ProductSum zp;
  ProductSum pp;
  const auto add = [&](auto get, std::size_t i) {
    const auto z = get(y_left, i) - get(x_left, i);
    const auto p = get(previous.image, i);
    zz.Add(z, get(rows.image, i) - get(x.image, i));
    zp.Add(z, p);
    pp.Add(get(p_left, i), p);
  };
  ForLanes(
      rows.image.size(), [&](std::size_t i) { add([](const Array& a, std::size_t j) { return Load(&a[j]); }, i); },
      [&](std::size_t i) { add([](const Array& a, std::size_t j) { return a[j]; }, i); });
  Products of;
  of.zz = zz.Total();
  of.zw = energy - of.zz / 2;
  if (!has_previous) return of;
  of.zp = zp.Total();
  of.pp = pp.Total();
  of.pw = previous_w + of.pp;
  return of;
}

Combination NncgSolver::Workspace::FletcherReeves() {
  const double change = DotOfDifferences(rows.f, x.f, rows.f, x.f);
  const double ratio = has_previous && last_change > 0 ? change / last_change : 0.0;
  last_change = change;
  return {1.0, ratio > 1 ? 0.0 : ratio};
}

// extra.f for a block of rows, before projection. True if that leads out of bounds somewhere.
bool NncgSolver::Workspace::WantBlock(const Combination& c, std::size_t begin, std::size_t end) {
  const double more = c.along_sweep - 1;
  LaneMask out{};
  bool one_out = false;
  std::size_t k = begin;
  for (; k + kLanes <= end; k += kLanes) {
    const Lanes y = Load(&rows.f[k]);
    const Lanes wanted = more * (y - Load(&x.f[k])) + c.along_previous * Load(&previous.f[k]);
    Store(&extra.f[k], wanted);
    out |= y + wanted < 0;
  }
  for (; k < end; ++k) {
    extra.f[k] = more * (rows.f[k] - x.f[k]) + c.along_previous * previous.f[k];
    one_out = one_out || rows.f[k] + extra.f[k] < 0;
  }
  return one_out || (out[0] | out[1] | out[2] | out[3]) != 0;
}

void NncgSolver::Workspace::Extrapolate(NncgOptions::Direction direction, double energy) {
  const bool optimal = direction == NncgOptions::Direction::kOptimal;
  Products of;
  if (optimal) of = MakeProducts(energy);
  const Combination c = optimal ? LeastEnergy(of) : FletcherReeves();
  const double more = c.along_sweep - 1;
  for (std::size_t i = 0; i < rows.image.size(); ++i) {
    extra.image[i] = more * (rows.image[i] - x.image[i]) + c.along_previous * previous.image[i];
  }
  double slope = more * (of.zw + of.zz) + c.along_previous * (of.pw + of.zp);  // extra.w at y
  bool clipped = false;
  for (std::size_t begin = 0; begin < rows.f.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, rows.f.size());
    if (!WantBlock(c, begin, end)) continue;
    for (std::size_t k = begin; k < end; ++k) {
      const auto row = static_cast<Index>(k);
      const double wanted = extra.f[k];
      if (rows.f[k] + wanted >= 0 || rows.scaled.IsFree(row)) continue;
      clipped = true;
      extra.f[k] = -rows.f[k];
      const double back = extra.f[k] - wanted;
      rows.rows->AddRowToImage(row, back, &extra.image);
      slope += back * rows.rows->W(row, rows.f, rows.image);
    }
  }
  double part = 1;
  double sweep_extra = more * of.zz + c.along_previous * of.zp;  // z.A extra
  if (clipped && optimal) {
    // The plane's minimum is out of bounds: the least energy on the way from y to its projection.
    const Array& left = Left(extra.f, extra.image);
    const double curvature = Dot(left, extra.image);
    part = curvature > 0 ? std::clamp(-slope / curvature, 0.0, 1.0) : 0.0;
    sweep_extra = Dot(left, rows.image) - Dot(left, x.image);
  }
  previous_w = of.zw + part * (slope - sweep_extra);
  for (std::size_t k = 0; k < rows.f.size(); ++k) {
    const double next = rows.f[k] + part * extra.f[k];
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
  options.coloured = reader.Choice("sweep", "coloured", {"symmetric", "coloured"}) == "coloured";
  if (reader.Choice("direction", "optimal", {"optimal", "fletcher-reeves"}) == "fletcher-reeves") {
    options.direction = Direction::kFletcherReeves;
  }
  options.end_when_hopeless = reader.YesOrNo("end-when-hopeless", options.end_when_hopeless);
  constexpr double kMost = 100000;
  options.least_iterations = static_cast<std::int64_t>(
      reader.Number("least-iterations", static_cast<double>(options.least_iterations), 0, kMost));
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

NncgSolver::NncgSolver(NncgOptions options) : options_(options), work_(std::make_unique<Workspace>()) {
  work_->test.SetSelfCheck(options.self_check);
}
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

void NncgSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  Workspace& work = *work_;
  RowWork& rows = work.rows;
  rows.Start(problem, options.initial_f);
  work.has_previous = false;
  work.test.EndWhenHopeless(options_.end_when_hopeless, options_.least_iterations);
  PacedPasses passes(options, *rows.rows, rows.scaled.size);
  bool over = work.test.Begin(problem, options, kDefaultIterations, &rows, &passes, result);
  while (!over) {
    work.x.f = rows.f;
    work.x.image = rows.image;
    StepSums forward;
    StepSums backward;
    bool in_time = RunSweep(false, 1.0, &rows, &passes, &forward) && RunSweep(true, 1.0, &rows, &passes, &backward);
    if (in_time && !rows.rows->ImageIsRoot()) {
      in_time =
          passes.Run(false, [&](Index begin, Index end) { rows.rows->AddToImage(begin, end, rows.f, &rows.image); });
    }
    if (!in_time) {
      work.test.EndOutOfTime();
      break;
    }
    work.Extrapolate(options_.direction, forward.energy + backward.energy);
    over = work.test.Continue(std::sqrt(backward.residual));
  }
  work.test.Finish();
}

}  // namespace lcpbench
