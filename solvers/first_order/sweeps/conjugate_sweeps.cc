#include "solvers/first_order/sweeps/conjugate_sweeps.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

// The products u.A v of the sweep's step z and the previous step p, and u.w at x. Those with w are sums of the size of
// |z|^2 while f.Af is of the size of 1, so they are never taken as differences: near the solution nothing would be
// left.
struct ConjugateSweeps::Products {
  double zz = 0;
  double zp = 0;
  double pp = 0;
  double zw = 0;
  double pw = 0;
};

// Coefficients of the step from x: along z, and along p.
struct ConjugateSweeps::Combination {
  double along_sweep = 1;
  double along_previous = 0;
};

void ConjugateSweeps::Reserve(Index max_rows, Index max_image) {
  for (Point* point : {&x_, &previous_, &extra_}) {
    if (point->f.size() < max_rows) point->f.resize(max_rows);
    if (point->image.size() < max_image) point->image.resize(max_image);
  }
}

void ConjugateSweeps::Start(const RowKernel& rows, const ScaledProblem& scaled) {
  rows_ = &rows;
  scaled_ = &scaled;
  size_ = scaled.size;
  image_size_ = rows.ImageSize();
  Restart();
  last_change_ = 0;
  least_residual_ = std::numeric_limits<double>::infinity();
  hovering_ = 0;
}

void ConjugateSweeps::Restart() {
  has_previous_ = false;
  previous_.f.head(size_).setZero();
  previous_.image.head(image_size_).setZero();
  projections_ = 0;
}

void ConjugateSweeps::BeginIteration(const Point& x) {
  x_.f.head(size_) = x.f.head(size_);
  x_.image.head(image_size_) = x.image.head(image_size_);
}

// argmin over (a, c) of the energy at x + a z + c p.
ConjugateSweeps::Combination ConjugateSweeps::LeastEnergy(const Products& of) {
  const double determinant = of.zz * of.pp - of.zp * of.zp;
  if (!(determinant > kParallel * of.zz * of.pp)) return {of.zz > 0 ? -of.zw / of.zz : 1.0, 0.0};
  return {(of.zp * of.pw - of.pp * of.zw) / determinant, (of.zp * of.zw - of.zz * of.pw) / determinant};
}

// `energy` is what the sweeps gained: z.w + z.A z / 2.
ConjugateSweeps::Products ConjugateSweeps::MakeProducts(const Point& y, double energy) const {
  const Array& y_left = Left(y);
  const Array& x_left = Left(x_);
  const Array& p_left = Left(previous_);
  ProductSum zz;
  ProductSum zp;
  ProductSum pp;
  ForEntries(image_size_, [&](const auto& at) {
    const auto z = at(y_left) - at(x_left);
    const auto p = at(previous_.image);
    zz.Add(z, at(y.image) - at(x_.image));
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

ConjugateSweeps::Combination ConjugateSweeps::FletcherReeves(const Point& y) {
  const double change = DotOfDifferences(size_, y.f, x_.f, y.f, x_.f);
  const double ratio = has_previous_ && last_change_ > 0 ? change / last_change_ : 0.0;
  last_change_ = change;
  return {1.0, ratio > 1 ? 0.0 : ratio};
}

// extra_ = the way from y to the point of the plane, projected. True if rows were: *slope, extra.w at y, follows.
bool ConjugateSweeps::Extend(const Combination& c, const Point& y, double* slope) {
  const double more = c.along_sweep - 1;
  const auto extend = [&](const Array& to, const Array& from, const Array& step, Index k) {
    return c.along_previous * step[k] + more * (to[k] - from[k]);
  };
  for (Index i = 0; i < image_size_; ++i) extra_.image[i] = extend(y.image, x_.image, previous_.image, i);
  bool clipped = false;
  for (Index begin = 0; begin < size_; begin += kBlock) {
    const Index end = std::min(begin + kBlock, size_);
    for (Index k = begin; k < end; ++k) extra_.f[k] = extend(y.f, x_.f, previous_.f, k);
    if ((y.f.segment(begin, end - begin) + extra_.f.segment(begin, end - begin)).minCoeff() >= 0) continue;
    for (Index k = begin; k < end; ++k) {
      const double wanted = extra_.f[k];
      if (y.f[k] + wanted >= 0 || scaled_->IsFree(k)) continue;
      clipped = true;
      extra_.f[k] = -y.f[k];
      const double back = extra_.f[k] - wanted;
      rows_->AddRowToImage(k, back, &extra_.image);
      *slope += back * rows_->W(k, y);
    }
  }
  return clipped;
}

void ConjugateSweeps::EndIteration(double energy, double residual, Point* x) {
  Point& y = *x;
  ++hovering_;
  if (residual < least_residual_) {
    least_residual_ = residual;
    hovering_ = 0;
  }
  Products of;
  if (optimal_) of = MakeProducts(y, energy);
  const Combination c = optimal_ ? LeastEnergy(of) : FletcherReeves(y);
  const double more = c.along_sweep - 1;
  double slope = more * (of.zw + of.zz) + c.along_previous * (of.pw + of.zp);  // extra.w at y
  const bool clipped = Extend(c, y, &slope);
  double part = 1;
  double sweep_extra = more * of.zz + c.along_previous * of.zp;  // z.A extra
  if (clipped && optimal_) {
    // The plane's minimum is out of bounds: the least energy on the way from y to its projection.
    const double curvature = Dot(image_size_, Left(extra_), extra_.image);
    part = curvature > 0 ? std::clamp(-slope / curvature, 0.0, 1.0) : 0.0;
    sweep_extra = Dot(image_size_, Left(extra_), y.image) - Dot(image_size_, Left(extra_), x_.image);
  }
  previous_w_ = of.zw + part * (slope - sweep_extra);
  const auto move_on = [part](Index size, Array* y_part, const Array& extra, const Array& from, Array* step) {
    for (Index i = 0; i < size; ++i) {
      const double next = (*y_part)[i] + part * extra[i];
      (*step)[i] = next - from[i];
      (*y_part)[i] = next;
    }
  };
  move_on(size_, &y.f, extra_.f, x_.f, &previous_.f);
  move_on(image_size_, &y.image, extra_.image, x_.image, &previous_.image);
  has_previous_ = true;
  projections_ = clipped ? projections_ + 1 : 0;
  if (hovering_ > std::max<std::int64_t>(kHovering, size_ / 2) && projections_ >= kProjections) Restart();
}

}  // namespace lcpbench
