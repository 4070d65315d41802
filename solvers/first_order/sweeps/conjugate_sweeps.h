#pragma once

#include <cstdint>

#include "solvers/first_order/sweeps/row_kernel.h"

/// Internal to solvers/.
namespace lcpbench {

/// The iteration of NncgSolver (nncg.h), on any rows: a forward and a backward sweep, which the caller makes, then a
/// step in the plane of what they did and of the previous step. After enough iterations without progress, in which
/// projections break the conjugacy, the previous step is forgotten. Only Reserve allocates.
class ConjugateSweeps {
 public:
  /// @param optimal  NncgOptions::Direction
  explicit ConjugateSweeps(bool optimal = true) : optimal_(optimal) {}

  void Reserve(Index max_rows, Index max_image);
  /// A solve on these rows, which must outlive it.
  void Start(const RowKernel& rows, const ScaledProblem& scaled);
  /// Forgets the previous step.
  void Restart();

  /// Notes x, from which the sweeps set out.
  void BeginIteration(const Point& x);
  /// Moves x on from where the sweeps ended.
  /// @param energy    what both sweeps gained
  /// @param residual  the sum of squares that the second one saw
  void EndIteration(double energy, double residual, Point* x);

 private:
  struct Products;
  struct Combination;

  const Array& Left(const Point& point) const { return rows_->ImageIsRoot() ? point.image : point.f; }
  Products MakeProducts(const Point& y, double energy) const;
  Combination FletcherReeves(const Point& y);
  static Combination LeastEnergy(const Products& of);
  bool Extend(const Combination& c, const Point& y, double* slope);

  const bool optimal_;
  const RowKernel* rows_ = nullptr;
  const ScaledProblem* scaled_ = nullptr;
  Index size_ = 0, image_size_ = 0;
  Point x_;         // where the sweeps set out
  Point previous_;  // p, the previous step
  Point extra_;     // what the extrapolation adds to where the sweeps ended
  bool has_previous_ = false;
  double previous_w_ = 0;   // p.w at x less p.A p
  double last_change_ = 0;  // |z|^2 of the previous iteration
  double least_residual_ = 0;
  std::int64_t hovering_ = 0;  // iterations since it was found
  int projections_ = 0;        // extrapolations in a row that were projected
};

}  // namespace lcpbench
