#pragma once

#include <cstring>

#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/first_order/sweeps/scaled_problem.h"
#include "solvers/first_order/sweeps/vector_ops.h"
#include "solvers/lcp/problem.h"

/// Internal to solvers/first_order/sweeps/: what one row, or several independent ones, do with their w.
namespace lcpbench {

template <typename T>
LCPBENCH_ALWAYS_INLINE T LoadAs(const double* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <typename T>
LCPBENCH_ALWAYS_INLINE T Filled(double value) {
  return value - T{};
}
template <typename T>
LCPBENCH_ALWAYS_INLINE void StoreTo(double* to, const T& value) {
  std::memcpy(to, &value, sizeof value);
}

/// Comparisons are ordered so that a NaN stays.
template <bool kMixed, typename T>
LCPBENCH_ALWAYS_INLINE T NaturalResidual(const T& w, const T& f, const T& floor) {
  const T least = f < w ? f : w;
  if constexpr (kMixed) {
    return floor != Filled<T>(0) ? w : least;
  } else {
    return least;
  }
}

/// kGradient false: a Gauss-Seidel step in place, whose value is the change of f. true: a step from one vector to
/// another, whose value is the new f.
template <bool kMixed, bool kGradient>
class ProjectedStep {
 public:
  ProjectedStep(const ScaledProblem& scaled, double rate, const double* from, double* to)
      : from_(from), to_(to), gain_(scaled.gain.data()), floor_(scaled.floor.data()), rate_(rate) {}

  /// T: one row, or consecutive ones by fours or eights.
  template <HalfOfEight kHalf = HalfOfEight::kNone, typename T>
  LCPBENCH_ALWAYS_INLINE T Take(Index row, const T& w) {
    const T old = LoadAs<T>(from_ + row);
    T rate = Filled<T>(rate_);
    T floor = Filled<T>(0);
    if constexpr (kMixed) {
      rate *= LoadAs<T>(gain_ + row);
      floor = LoadAs<T>(floor_ + row);
    }
    const T residual = NaturalResidual<kMixed>(w, old, floor);
    residual_.template Add<kHalf>(residual, residual);
    const T moved = old - rate * w;
    const T next = AtLeast(floor, moved);
    StoreTo(to_ + row, next);
    const T change = next - old;
    change_.template Add<kHalf>(change, change);
    if constexpr (kGradient) {
      return next;
    } else {
      energy_.template Add<kHalf>(change, w + 0.5 * change);  // the diagonal is 1; rows without one do not change
      return change;
    }
  }

  void AddTo(StepSums* sums) const {
    sums->residual += residual_.Total();
    sums->change += change_.Total();
    sums->energy += energy_.Total();
  }

 private:
  const double* from_;
  double* to_;
  const double* gain_;
  const double* floor_;
  double rate_;
  ProductSum residual_;
  ProductSum change_;
  ProductSum energy_;
};

/// Adds up the natural residual; nothing moves.
template <bool kMixed>
class ResidualOnly {
 public:
  ResidualOnly(const ScaledProblem& scaled, const double* f) : f_(f), floor_(scaled.floor.data()) {}

  template <HalfOfEight kHalf = HalfOfEight::kNone, typename T>
  LCPBENCH_ALWAYS_INLINE T Take(Index row, const T& w) {
    T floor = Filled<T>(0);
    if constexpr (kMixed) floor = LoadAs<T>(floor_ + row);
    const T residual = NaturalResidual<kMixed>(w, LoadAs<T>(f_ + row), floor);
    residual_.template Add<kHalf>(residual, residual);
    return w;
  }
  double Total() const { return residual_.Total(); }

 private:
  const double* f_;
  const double* floor_;
  ProductSum residual_;
};

/// Calls `run` with the step of the problem's kind (with bilateral or held rows, or without) and adds up its sums.
template <bool kGradient, typename Run>
void RunStep(const ScaledProblem& scaled, double rate, const Array& from, Array* to, StepSums* sums, const Run& run) {
  const auto with = [&](auto step) {
    run(&step);
    step.AddTo(sums);
  };
  if (scaled.mixed) {
    with(ProjectedStep<true, kGradient>(scaled, rate, from.data(), to->data()));
  } else {
    with(ProjectedStep<false, kGradient>(scaled, rate, from.data(), to->data()));
  }
}
template <typename Run>
double RunResidual(const ScaledProblem& scaled, const Array& f, const Run& run) {
  const auto with = [&](auto step) {
    run(&step);
    return step.Total();
  };
  return scaled.mixed ? with(ResidualOnly<true>(scaled, f.data())) : with(ResidualOnly<false>(scaled, f.data()));
}

}  // namespace lcpbench
