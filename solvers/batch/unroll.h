#pragma once

#include <utility>

/// Internal to solvers/batch/: loops whose indices are constants, for kernels that keep arrays in registers.
namespace lcpbench {
namespace {

#define LCPBENCH_INLINE_LAMBDA __attribute__((always_inline))

/// f(integral_constant<int, k>) for all k.
template <int... k, typename F>
[[gnu::always_inline]] inline void EachUnrolled(std::integer_sequence<int, k...> /*indices*/, const F& f) {
  (f(std::integral_constant<int, k>{}), ...);
}

/// 2 v and last - v, constants where v is one.
template <int v>
constexpr auto Twice(std::integral_constant<int, v> /*v*/) {
  return std::integral_constant<int, 2 * v>{};
}
constexpr int Twice(int v) { return 2 * v; }
template <int last, int v>
constexpr auto Mirror(std::integral_constant<int, v> /*v*/) {
  return std::integral_constant<int, last - v>{};
}
template <int last>
constexpr int Mirror(int v) {
  return last - v;
}

}  // namespace
}  // namespace lcpbench
