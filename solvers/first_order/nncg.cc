#include "solvers/first_order/nncg.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "solvers/first_order/sweeps/first_order_engine.h"

namespace lcpbench {
namespace {

// A plane whose Gram determinant is below this share of its product of squares is a line but for rounding.
constexpr double kParallel = 1e-10;

// A projection breaks the conjugacy of the previous step. Most iterates are none the worse for it, but where rows with
// almost no force are projected again and again, the residual hovers. Once it has not fallen for this many iterations,
// and for half as many as there are rows, every kProjections projected extrapolations in a row end in a restart.
constexpr std::int64_t kHovering = 32;
constexpr int kProjections = 2;

// Rows that are looked through one by one for projections where one of them is projected.
constexpr Index kBlock = 32;

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

// rows_.x is the iterate; the sweeps move it from x to y.
class NncgEngine final : public FirstOrderEngine {
 public:
  explicit NncgEngine(const NncgOptions& options)
      : FirstOrderEngine({.form = options.form,
                          .coloured = options.coloured,
                          .self_check = options.self_check,
                          .needs_symmetry = true,
                          .end_when_hopeless = options.end_when_hopeless,
                          .hopeful_iterations = options.least_iterations,
                          .default_limit = NncgOptions::kDefaultIterations}),
        optimal_(options.direction == NncgOptions::Direction::kOptimal) {}

  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  const Array& Left(const Point& point) const { return rows_.rows->ImageIsRoot() ? point.image : point.f; }
  Products MakeProducts(double energy) const;
  Combination FletcherReeves();
  void Extrapolate(double energy);
  void Watch(double residual);
  void Restart();

  const bool optimal_;
  Point x_;         // where the sweep began
  Point previous_;  // p, the previous step
  Point extra_;     // what the extrapolation adds to y
  bool has_previous_ = false;
  double previous_w_ = 0;   // p.w at x less p.A p
  double last_change_ = 0;  // |z|^2 of the previous iteration
  double least_residual_ = 0;
  std::int64_t hovering_ = 0;  // iterations since it was found
  int projections_ = 0;        // extrapolations in a row that were projected
};

// `energy` is what the sweep gained: z.w + z.A z / 2.
Products NncgEngine::MakeProducts(double energy) const {
  const Array& y_left = Left(rows_.x);
  const Array& x_left = Left(x_);
  const Array& p_left = Left(previous_);
  ProductSum zz;
  ProductSum zp;
  ProductSum pp;
  ForEntries(rows_.x.image.size(), [&](const auto& at) {
    const auto z = at(y_left) - at(x_left);
    const auto p = at(previous_.image);
    zz.Add(z, at(rows_.x.image) - at(x_.image));
    zp.Add(z, p);
    pp.Add(at(p_left), p);
  });
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
  const double change = DotOfDifferences(rows_.x.f, x_.f, rows_.x.f, x_.f);
  const double ratio = has_previous_ && last_change_ > 0 ? change / last_change_ : 0.0;
  last_change_ = change;
  return {1.0, ratio > 1 ? 0.0 : ratio};
}

void NncgEngine::Extrapolate(double energy) {
  Point& y = rows_.x;
  Products of;
  if (optimal_) of = MakeProducts(energy);
  const Combination c = optimal_ ? LeastEnergy(of) : FletcherReeves();
  const double more = c.along_sweep - 1;
  const auto extend = [&](const Array& to, const Array& from, const Array& step, Index k) {
    return c.along_previous * step[k] + more * (to[k] - from[k]);
  };
  for (Index i = 0; i < y.image.size(); ++i) extra_.image[i] = extend(y.image, x_.image, previous_.image, i);
  double slope = more * (of.zw + of.zz) + c.along_previous * (of.pw + of.zp);  // extra.w at y
  bool clipped = false;
  for (Index begin = 0; begin < y.f.size(); begin += kBlock) {
    const Index end = std::min(begin + kBlock, y.f.size());
    for (Index k = begin; k < end; ++k) extra_.f[k] = extend(y.f, x_.f, previous_.f, k);
    if ((y.f + extra_.f).segment(begin, end - begin).minCoeff() >= 0) continue;
    for (Index k = begin; k < end; ++k) {
      const double wanted = extra_.f[k];
      if (y.f[k] + wanted >= 0 || rows_.scaled.IsFree(k)) continue;
      clipped = true;
      extra_.f[k] = -y.f[k];
      const double back = extra_.f[k] - wanted;
      rows_.rows->AddRowToImage(k, back, &extra_.image);
      slope += back * rows_.rows->W(k, y);
    }
  }
  double part = 1;
  double sweep_extra = more * of.zz + c.along_previous * of.zp;  // z.A extra
  if (clipped && optimal_) {
    // The plane's minimum is out of bounds: the least energy on the way from y to its projection.
    const double curvature = Dot(Left(extra_), extra_.image);
    part = curvature > 0 ? std::clamp(-slope / curvature, 0.0, 1.0) : 0.0;
    sweep_extra = Dot(Left(extra_), y.image) - Dot(Left(extra_), x_.image);
  }
  previous_w_ = of.zw + part * (slope - sweep_extra);
  const auto move_on = [part](Array* y_part, const Array& extra, const Array& from, Array* step) {
    for (Index i = 0; i < from.size(); ++i) {
      const double next = (*y_part)[i] + part * extra[i];
      (*step)[i] = next - from[i];
      (*y_part)[i] = next;
    }
  };
  move_on(&y.f, extra_.f, x_.f, &previous_.f);
  move_on(&y.image, extra_.image, x_.image, &previous_.image);
  has_previous_ = true;
  projections_ = clipped ? projections_ + 1 : 0;
  if (hovering_ > std::max<std::int64_t>(kHovering, y.f.size() / 2) && projections_ >= kProjections) Restart();
}

void NncgEngine::Watch(double residual) {
  ++hovering_;
  if (residual >= least_residual_) return;
  least_residual_ = residual;
  hovering_ = 0;
}

void NncgEngine::Restart() {
  has_previous_ = false;
  previous_.f.setZero();
  previous_.image.setZero();
  projections_ = 0;
}

NncgOptions NncgOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("nncg", settings);
  NncgOptions options;
  options.form = ReadRowForm(&reader);
  options.coloured = reader.Choice("sweep", "coloured", {"symmetric", "coloured"}) == "coloured";
  if (reader.Choice("direction", "optimal", {"optimal", "fletcher-reeves"}) == "fletcher-reeves") {
    options.direction = Direction::kFletcherReeves;
  }
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

void NncgEngine::Prepare(const LcpProblem& problem) {
  PrepareRows(problem);
  for (Point* point : {&x_, &previous_, &extra_}) *point = rows_.x;
}

void NncgEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  Restart();
  least_residual_ = std::numeric_limits<double>::infinity();
  hovering_ = 0;
  Run(problem, options, result, [&]() -> std::optional<double> {
    x_ = rows_.x;
    StepSums forward;
    StepSums backward;
    bool in_time = Sweep(false, 1.0, &forward) && Sweep(true, 1.0, &backward);
    if (in_time && !rows_.rows->ImageIsRoot()) {
      in_time = ForAllRows(false, [&](Index begin, Index end) { rows_.rows->AddToImage(begin, end, &rows_.x); });
    }
    if (!in_time) return {};
    Watch(backward.residual);
    Extrapolate(forward.energy + backward.energy);
    return std::sqrt(backward.residual);
  });
}

template class EngineSolver<NncgOptions, NncgEngine>;

}  // namespace lcpbench
