#pragma once

#include <type_traits>

#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/first_order/sweeps/row_kernel.h"

/// Internal to solvers/first_order/sweeps/: what one row, or several independent ones, do with their w.
namespace lcpbench {

enum class StepKind {
  kSweep,     ///< a Gauss-Seidel step in place; its value is the change of f
  kGradient,  ///< from one vector to another; its value is the new f
  kResidual,  ///< nothing moves
  kGaps,      ///< nothing moves; w goes where f does otherwise
};

/// @tparam kMixed    ScaledProblem::mixed
/// @tparam kHasRate  whether a row's rate may be other than 1; where it is 1, a sweep's steps are the residuals
/// @tparam Sum       ProductSum, or SumOneByOne where rows are taken one by one
template <bool kMixed, bool kHasRate, StepKind kind, typename Sum>
class ProjectedStep {
 public:
  static constexpr StepKind kKind = kind;
  static constexpr bool kOneByOne = std::is_same_v<Sum, SumOneByOne>;
  static constexpr bool kSumsResidual = kHasRate || kind != StepKind::kSweep;

  LCPBENCH_ALWAYS_INLINE ProjectedStep(const ScaledProblem& scaled, double rate, const double* from, double* to)
      : from_(from), to_(to), gain_(scaled.gain.data()), floor_(scaled.floor.data()), rate_(rate) {}

  /// T: one row, or consecutive ones by fours or eights. Comparisons are ordered so that a NaN stays.
  template <HalfOfEight kHalf = HalfOfEight::kNone, typename T>
  LCPBENCH_ALWAYS_INLINE T Take(Index row, const T& w) {
    const T old = Load<T>(from_ + row);
    T rate = Filled<T>(rate_);
    T floor = Filled<T>(0);
    if constexpr (kMixed && kHasRate) rate *= Load<T>(gain_ + row);
    if constexpr (kMixed) floor = Load<T>(floor_ + row);
    if constexpr (kSumsResidual) {
      T residual = old < w ? old : w;
      if constexpr (kMixed) residual = floor != Filled<T>(0) ? w : residual;
      residual_.template Add<kHalf>(residual, residual);
    }
    if constexpr (kind == StepKind::kGaps) Store(to_ + row, w);
    if constexpr (kind == StepKind::kGaps || kind == StepKind::kResidual) return w;
    const T moved = old - (kHasRate ? rate * w : w);
    const T next = AtLeast(floor, moved);
    Store(to_ + row, next);
    const T change = next - old;
    change_.template Add<kHalf>(change, change);
    if constexpr (kind == StepKind::kGradient) return next;
    const T mean = w + 0.5 * change;  // the diagonal is 1; rows without one do not change
    energy_.template Add<kHalf>(change, mean);
    return change;
  }

  LCPBENCH_ALWAYS_INLINE void AddTo(StepSums* sums) const {
    sums->residual += kSumsResidual ? residual_.Total() : change_.Total();
    sums->change += change_.Total();
    sums->energy += energy_.Total();
  }

 private:
  const double* from_;
  double* to_;
  const double* gain_;
  const double* floor_;
  double rate_;
  Sum residual_;
  Sum change_;
  Sum energy_;
};

/// The passes of a layout by its functions
///     bool OneByOne() const;         whether rows are taken one by one, always true if kAlwaysOneByOne
///     template <typename Step> void Visit(Index begin, Index end, bool backward, const Point& from, Array* image,
///                                         Step* step) const;
/// which calls step->Take for every row, and keeps the image of where f goes (nullptr where nothing moves).
template <typename Layout, bool kAlwaysOneByOne>
class LaidOutRows : public RowKernel {
 public:
  void Sweep(Index begin, Index end, bool backward, double omega, Point* x, StepSums* sums) const final {
    Pass<StepKind::kSweep>(begin, end, backward, omega, *x, x->f.data(), &x->image, sums);
  }
  void GradientStep(Index begin, Index end, double step, const Point& y, Point* next, StepSums* sums) const final {
    Pass<StepKind::kGradient>(begin, end, false, step, y, next->f.data(), &next->image, sums);
  }
  double ResidualSquares(Index begin, Index end, const Point& x, Array* w) const final {
    StepSums sums;
    if (w == nullptr) {
      Pass<StepKind::kResidual>(begin, end, false, 0, x, nullptr, nullptr, &sums);
    } else {
      Pass<StepKind::kGaps>(begin, end, false, 0, x, w->data(), nullptr, &sums);
    }
    return sums.residual;
  }

 protected:
  const ScaledProblem& scaled_;

 private:
  friend Layout;
  explicit LaidOutRows(const ScaledProblem& scaled) : scaled_(scaled) {}

  template <StepKind kKind>
  void Pass(Index begin, Index end, bool backward, double rate, const Point& from, double* to, Array* image,
            StepSums* sums) const {
    constexpr bool moves = kKind == StepKind::kSweep || kKind == StepKind::kGradient;
    const auto with = [&](auto&& step) {
      static_cast<const Layout*>(this)->Visit(begin, end, backward, from, image, &step);
      step.AddTo(sums);
    };
    const auto of_sums = [&](auto sum, auto mixed) {
      using Sum = typename decltype(sum)::type;
      if (moves && (rate != 1 || scaled_.has_idle)) {
        with(ProjectedStep<mixed, moves, kKind, Sum>(scaled_, rate, from.f.data(), to));
      } else {
        with(ProjectedStep<mixed, false, kKind, Sum>(scaled_, rate, from.f.data(), to));
      }
    };
    const auto of_rows = [&](auto sum) {
      scaled_.mixed ? of_sums(sum, std::true_type()) : of_sums(sum, std::false_type());
    };
    if constexpr (!kAlwaysOneByOne) {
      if (!static_cast<const Layout*>(this)->OneByOne()) return of_rows(std::type_identity<ProductSum>());
    }
    of_rows(std::type_identity<SumOneByOne>());
  }
};

}  // namespace lcpbench
