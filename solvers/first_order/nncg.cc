#include "solvers/first_order/nncg.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "solvers/first_order/sweeps/first_order_engine.h"
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

// rows_.f is the iterate; the sweeps move it from x to y.
class NncgEngine final : public FirstOrderEngine<NncgOptions> {
 public:
  using FirstOrderEngine::FirstOrderEngine;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    return problem.IsNumericallySymmetric() ? WhyNoRows(problem, options_.form) : WhyNotSymmetric(problem);
  }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  const Array& Left(const Array& f, const Array& image) const { return rows_.rows->ImageIsRoot() ? image : f; }
  Products MakeProducts(double energy) const;
  Combination FletcherReeves();
  bool WantBlock(const Combination& c, std::size_t begin, std::size_t end);
  void Extrapolate(double energy);

  Point x_;         // where the sweep began
  Point previous_;  // p, the previous step
  Point extra_;     // what the extrapolation adds to y
  bool has_previous_ = false;
  double previous_w_ = 0;   // p.w at x less p.A p
  double last_change_ = 0;  // |z|^2 of the previous iteration
};

// `energy` is what the sweep gained: z.w + z.A z / 2.
Products NncgEngine::MakeProducts(double energy) const {
  const Array& y_left = Left(rows_.f, rows_.image);
  const Array& x_left = Left(x_.f, x_.image);
  const Array& p_left = Left(previous_.f, previous_.image);
  ProductSum zz;
  ProductSum zp;
  ProductSum pp;
  const auto add = [&](auto get, std::size_t i) {
    const auto z = get(y_left, i) - get(x_left, i);
    const auto p = get(previous_.image, i);
    zz.Add(z, get(rows_.image, i) - get(x_.image, i));
    zp.Add(z, p);
    pp.Add(get(p_left, i), p);
  };
  ForLanes(
      rows_.image.size(), [&](std::size_t i) { add([](const Array& a, std::size_t j) { return Load(&a[j]); }, i); },
      [&](std::size_t i) { add([](const Array& a, std::size_t j) { return a[j]; }, i); });
  Products of;
  of.zz = zz.Total();
  of.zw = energy - of.zz / 2;
  if (!has_previous_) return of;
  of.zp = zp.Total();
  of.pp = pp.Total();
  of.pw = previous_w_ + of.pp;
  return of;
}

Combination NncgEngine::FletcherReeves() {
  const double change = DotOfDifferences(rows_.f, x_.f, rows_.f, x_.f);
  const double ratio = has_previous_ && last_change_ > 0 ? change / last_change_ : 0.0;
  last_change_ = change;
  return {1.0, ratio > 1 ? 0.0 : ratio};
}

// extra.f for a block of rows, before projection. True if that leads out of bounds somewhere.
bool NncgEngine::WantBlock(const Combination& c, std::size_t begin, std::size_t end) {
  const double more = c.along_sweep - 1;
  LaneMask out{};
  bool one_out = false;
  std::size_t k = begin;
  for (; k + kLanes <= end; k += kLanes) {
    const Lanes y = Load(&rows_.f[k]);
    const Lanes wanted = more * (y - Load(&x_.f[k])) + c.along_previous * Load(&previous_.f[k]);
    Store(&extra_.f[k], wanted);
    out |= y + wanted < 0;
  }
  for (; k < end; ++k) {
    extra_.f[k] = more * (rows_.f[k] - x_.f[k]) + c.along_previous * previous_.f[k];
    one_out = one_out || rows_.f[k] + extra_.f[k] < 0;
  }
  return one_out || (out[0] | out[1] | out[2] | out[3]) != 0;
}

void NncgEngine::Extrapolate(double energy) {
  const bool optimal = options_.direction == NncgOptions::Direction::kOptimal;
  Products of;
  if (optimal) of = MakeProducts(energy);
  const Combination c = optimal ? LeastEnergy(of) : FletcherReeves();
  const double more = c.along_sweep - 1;
  for (std::size_t i = 0; i < rows_.image.size(); ++i) {
    extra_.image[i] = more * (rows_.image[i] - x_.image[i]) + c.along_previous * previous_.image[i];
  }
  double slope = more * (of.zw + of.zz) + c.along_previous * (of.pw + of.zp);  // extra.w at y
  bool clipped = false;
  for (std::size_t begin = 0; begin < rows_.f.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, rows_.f.size());
    if (!WantBlock(c, begin, end)) continue;
    for (std::size_t k = begin; k < end; ++k) {
      const auto row = static_cast<Index>(k);
      const double wanted = extra_.f[k];
      if (rows_.f[k] + wanted >= 0 || rows_.scaled.IsFree(row)) continue;
      clipped = true;
      extra_.f[k] = -rows_.f[k];
      const double back = extra_.f[k] - wanted;
      rows_.rows->AddRowToImage(row, back, &extra_.image);
      slope += back * rows_.rows->W(row, rows_.f, rows_.image);
    }
  }
  double part = 1;
  double sweep_extra = more * of.zz + c.along_previous * of.zp;  // z.A extra
  if (clipped && optimal) {
    // The plane's minimum is out of bounds: the least energy on the way from y to its projection.
    const Array& left = Left(extra_.f, extra_.image);
    const double curvature = Dot(left, extra_.image);
    part = curvature > 0 ? std::clamp(-slope / curvature, 0.0, 1.0) : 0.0;
    sweep_extra = Dot(left, rows_.image) - Dot(left, x_.image);
  }
  previous_w_ = of.zw + part * (slope - sweep_extra);
  for (std::size_t k = 0; k < rows_.f.size(); ++k) {
    const double next = rows_.f[k] + part * extra_.f[k];
    previous_.f[k] = next - x_.f[k];
    rows_.f[k] = next;
  }
  for (std::size_t i = 0; i < rows_.image.size(); ++i) {
    const double next = rows_.image[i] + part * extra_.image[i];
    previous_.image[i] = next - x_.image[i];
    rows_.image[i] = next;
  }
  has_previous_ = true;
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

void NncgEngine::Prepare(const LcpProblem& problem) {
  FirstOrderEngine::Prepare(problem, options_.coloured);
  for (Point* point : {&x_, &previous_, &extra_}) point->Reserve(rows_);
}

void NncgEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  rows_.Start(problem, options.initial_f);
  has_previous_ = false;
  test_.EndWhenHopeless(options_.end_when_hopeless, options_.least_iterations);
  PacedPasses passes(options, *rows_.rows, rows_.scaled.size);
  bool over = test_.Begin(problem, options, NncgOptions::kDefaultIterations, &rows_, &passes, result);
  while (!over) {
    x_.f = rows_.f;
    x_.image = rows_.image;
    StepSums forward;
    StepSums backward;
    bool in_time = RunSweep(false, 1.0, &passes, &forward) && RunSweep(true, 1.0, &passes, &backward);
    if (in_time && !rows_.rows->ImageIsRoot()) {
      in_time =
          passes.Run(false, [&](Index begin, Index end) { rows_.rows->AddToImage(begin, end, rows_.f, &rows_.image); });
    }
    if (!in_time) {
      test_.EndOutOfTime();
      break;
    }
    Extrapolate(forward.energy + backward.energy);
    over = test_.Continue(std::sqrt(backward.residual));
  }
  test_.Finish();
}

template class EngineSolver<NncgOptions, NncgEngine>;

}  // namespace lcpbench
