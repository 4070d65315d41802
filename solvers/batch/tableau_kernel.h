#pragma once

#include <cstddef>
#include <limits>
#include <utility>

#include "solvers/batch/kernel.h"
#include "solvers/batch/row_assembly.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/linear_algebra/vector_register.h"

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

/// Solves one group of N rows or fewer, one problem per lane (docs/solvers/batch.md).
///
/// The tableau T starts as A, of which the lower triangle is kept, q as b. Exchanging row k, with a = T_kk:
///     T_ij -= T_ik T_kj / a,   T_kj /= |a|,   T_kk = -1 / a,   and q_i, q_k as if q were another column,
/// which is its own inverse. Then q_i = w_i outside F and -f_i in F, so `sign_` (-0 in F) turns both into what must not
/// be negative. Two neighbouring rows are exchanged in one pass, because the stores of T are what takes the time: n^2 /
/// 2 of them, and twice as many fused operations. Nothing here depends on another lane but whether a pass is made at
/// all, which changes no bits in a lane that moves nothing (its multipliers are 0).
template <int N>
class TableauKernel {
 public:
  explicit TableauKernel(BatchGroup* group) : group_(*group) {
    for (int k = 0; k < kLaneCount; ++k) f_[N + k] = L::Set(0);
  }

  void Solve() {
    for (int i = group_.rows; i < N; ++i) {
      b_[i] = L::Set(0);
      for (int j = 0; j <= i; ++j) matrix_[At(i, j)] = L::Set(0);
    }
    const M usable = AssembleRows(&group_, matrix_, b_);
    TakeJoints();
    Run();
    group_.met &= L::Bits(usable);
    group_.close &= L::Bits(usable);
    alignas(64) double squares[kLaneCount];
    L::Store(squares, rho_square_);
    for (int l = 0; l < kLaneCount; ++l) group_.rho[l] = __builtin_sqrt(squares[l]);
  }

 private:
  [[gnu::noinline]] void Run() {
    Scale();
    if (any_joint_) Sweep(true, false);
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      Sweep(false, sweep >= kUpwardSweeps && sweep % 2 != 0);
      if (!L::Any(moved_)) break;
    }
    WriteForces();
    Check();
    const int most = group_.shift > 0 ? kMostRefinements : 1;
    for (int k = 0; k < most; ++k) {
      const M poor = L::Set(kGoodEnough * kGoodEnough) < rho_square_;
      if (!L::Any(poor)) break;
      Refine(poor);
    }
    Judge();
    StoreForces();
  }

  using L = Lanes;
  using V = L::V;
  using M = L::M;
  static constexpr int kLaneCount = L::kWidth;
  static constexpr int kPanels = N / 2;
  static constexpr int kEntries = N * (N + 1) / 2;
  static constexpr unsigned kAllLanes = (1U << kLaneCount) - 1;
  // Up to this size everything is unrolled and vectors stay in registers; above, only the pass of an exchange is, and
  // not where it has more instructions (SSE2) than a first-level cache holds.
  static constexpr bool kUnroll = N <= 12;
  static constexpr bool kUnrollPass = kUnroll || kLaneCount > 2;
  // After three sweeps nine lanes in ten of the scene families are done at 10 rows, after twelve 99 in a hundred at 30;
  // a lane that cycles costs its neighbours the rest.
  static constexpr int kMaxSweeps = 12;
  static constexpr int kUpwardSweeps = 3;
  static constexpr int kMostRefinements = 4;  // with a shift
  static constexpr double kLeastPivot = tableau::kLeastPivot;
  static constexpr double kNoise = tableau::kNoise;
  static constexpr double kGoodEnough = tableau::kGoodEnoughInLanes;
  // No products of three numbers of these sizes leave the doubles (as LcpProblem::has_extreme_matrix).
  static constexpr double kMostDiagonal = 0x1p192;
  static constexpr double kMostUnitOfB = 0x1p224;

  static constexpr int At(int i, int j) { return i * (i + 1) / 2 + j; }  // j <= i

  // f(j) for j < i, unrolled if asked for; then i is a constant.
  template <bool is_unrolled = kUnroll, typename I, typename F>
  [[gnu::always_inline]] static void EachUpTo(I i, const F& f) {
    if constexpr (is_unrolled) {
      EachUnrolled(std::make_integer_sequence<int, I::value>{}, f);
    } else {
      for (int j = 0; j < i; ++j) f(j);
    }
  }
  template <int end, bool is_unrolled = kUnroll, typename F>
  [[gnu::always_inline]] static void Each(const F& f) {
    EachUpTo<is_unrolled>(std::integral_constant<int, end>{}, f);
  }

  void TakeJoints() {
    std::uint32_t joints = 0;
    for (int l = 0; l < kLaneCount; ++l) joints |= group_.items[l].joints;
    for (int i = 0; i < N; ++i) joint_[i] = L::FromBits(0);
    any_joint_ = joints != 0;
    if (any_joint_) LoadJoints();
  }
  [[gnu::noinline]] void LoadJoints() {
    for (int i = 0; i < N; ++i) {
      unsigned bits = 0;
      for (int l = 0; l < kLaneCount; ++l) bits |= (group_.items[l].joints >> i & 1U) << l;
      joint_[i] = L::FromBits(bits);
    }
  }

  void Scale() {
    const V one = L::Set(1);
    const V zero = L::Set(0);
    V largest = zero;
    Each<N>([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V d = matrix_[At(i, i)];
      const M acts = zero < d;
      const V s = L::Select(acts, L::ScaleOfDiagonal(d), one);
      scale_[i] = s;
      const V q = b_[i] * s;
      q_[i] = q;
      sign_[i] = zero;
      largest = L::Max(largest, L::Masked(acts, L::Abs(q)));
    });
    const V t = L::ScaleOfLargest(largest);
    b_scale_ = t;
    inverse_b_scale_ = one / t;
    V norm = zero;
    Each<N>([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V q = q_[i] * t;
      q_[i] = q;
      norm = L::Fma(q, q, norm);
    });
    b_square_ = L::Select(zero < norm, norm, one);
    const V shift = L::Set(group_.shift);
    Each<N>([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V s = scale_[i];
      EachUpTo(i, [&](auto j) LCPBENCH_INLINE_LAMBDA { tableau_[At(i, j)] = matrix_[At(i, j)] * s * scale_[j]; });
      const V d = matrix_[At(i, i)] * s * s;
      tableau_[At(i, i)] = L::Fma(d, shift, d);
      least_[i] = L::Set(kLeastPivot) * d;
    });
    noise_ = L::Set(-kNoise);
    pivots_ = zero;
  }

  // Rows that a lane wants to move: bilateral ones first, then those with the wrong sign.
  M Wanted(int k, bool joints) const {
    if (joints) return joint_[k] & ~L::SignOf(sign_[k]);
    return (L::Xor(q_[k], sign_[k]) < noise_) & ~joint_[k];
  }

  // By panels, up or down.
  void Sweep(bool joints, bool down) {
    moved_ = L::FromBits(0);
    if (down) {
      Each<kPanels>([&](auto panel) LCPBENCH_INLINE_LAMBDA { VisitPanel(Mirror<kPanels - 1>(panel), joints); });
    } else {
      Each<kPanels>([&](auto panel) LCPBENCH_INLINE_LAMBDA { VisitPanel(panel, joints); });
    }
  }

  template <typename P>
  [[gnu::always_inline]] void VisitPanel(P panel, bool joints) {
    if (L::Any(Wanted(2 * panel, joints) | Wanted(2 * panel + 1, joints))) StepPanel(panel, joints);
  }

  // What an exchange of row k does to the rest: row i becomes row i - x_i y with x the old column k, y = x `inverse`;
  // row k itself is multiplied by `factor`. Lanes that do not move have inverse 0 and factor 1.
  struct Move {
    V inverse, factor, diagonal;
  };
  [[gnu::always_inline]] Move Decide(int k, bool joints, V a) {
    const V sign = sign_[k];
    const V size = L::Xor(a, sign);
    const M m = Wanted(k, joints) & (least_[k] < size);
    moved_ |= m;
    const V inverse_size = L::Set(1) / size;
    const V inverse = L::Masked(m, L::Xor(inverse_size, sign));
    const V factor = L::Select(m, inverse_size, L::Set(1));
    sign_[k] = L::Xor(sign, L::Masked(m, L::Set(-0.0)));
    q_[k] = q_[k] * factor;
    noise_ = L::Min(noise_, L::Set(-kNoise) * L::Masked(m, L::Abs(q_[k])));
    pivots_ = pivots_ + L::Masked(m, L::Set(1));
    return {inverse, factor, L::Select(m, L::Set(0) - inverse, a)};
  }

  // Exchanges rows k and k + 1 where lanes want that, both in one pass over the tableau: it is the stores that count.
  template <typename P>
  [[gnu::noinline]] void StepPanel(P panel, bool joints) {
    const int k = 2 * panel;
    const int l = k + 1;
    const V kq = q_[k];
    const V lk = tableau_[At(l, k)];
    const Move first = Decide(k, joints, tableau_[At(k, k)]);
    const V first_y = lk * first.inverse;
    const V first_q = kq * first.inverse;
    q_[l] = L::Fnma(lk, first_q, q_[l]);
    const V lq = q_[l];
    const V moved_lk = lk * first.factor;
    const Move second = Decide(l, joints, L::Fnma(lk, first_y, tableau_[At(l, l)]));
    const V second_y = moved_lk * second.inverse;
    const V second_q = lq * second.inverse;
    tableau_[At(k, k)] = L::Fnma(moved_lk, second_y, first.diagonal);
    tableau_[At(l, k)] = moved_lk * second.factor;
    tableau_[At(l, l)] = second.diagonal;
    q_[k] = L::Fnma(moved_lk, second_q, q_[k]);

    V y0[N];
    V y1[N];
    y0[k] = y0[l] = y1[k] = y1[l] = L::Set(0);
    Each<kPanels, kUnrollPass>([&](auto pair) LCPBENCH_INLINE_LAMBDA {
      if (pair == panel) return;
      const auto i = Twice(pair);
      V x0[2];
      V x1[2];
      for (int r = 0; r < 2; ++r) {
        x0[r] = tableau_[pair < panel ? At(k, i + r) : At(i + r, k)];
        x1[r] = L::Fnma(x0[r], first_y, tableau_[pair < panel ? At(l, i + r) : At(i + r, l)]);
        y0[i + r] = x0[r] * first.inverse;
        y1[i + r] = x1[r] * second.inverse;
        q_[i + r] = L::Fnma(x1[r], second_q, L::Fnma(x0[r], first_q, q_[i + r]));
      }
      V* const upper = tableau_ + At(i, 0);
      V* const lower = tableau_ + At(i + 1, 0);
      EachUpTo<kUnrollPass>(i, [&](auto j) LCPBENCH_INLINE_LAMBDA {
        if (kUnroll && j / 2 == panel) return;  // else overwritten below
        upper[j] = L::Fnma(x1[0], y1[j], L::Fnma(x0[0], y0[j], upper[j]));
        lower[j] = L::Fnma(x1[1], y1[j], L::Fnma(x0[1], y0[j], lower[j]));
      });
      upper[i] = L::Fnma(x1[0], y1[i], L::Fnma(x0[0], y0[i], upper[i]));
      lower[i] = L::Fnma(x1[1], y1[i], L::Fnma(x0[1], y0[i], lower[i]));
      lower[i + 1] = L::Fnma(x1[1], y1[i + 1], L::Fnma(x0[1], y0[i + 1], lower[i + 1]));
      for (int r = 0; r < 2; ++r) {
        tableau_[pair < panel ? At(k, i + r) : At(i + r, k)] = L::Fnma(x1[r], second_y, x0[r] * first.factor);
        tableau_[pair < panel ? At(l, i + r) : At(i + r, l)] = x1[r] * second.factor;
      }
    });
  }

  // Forces of the basic point, in given units.
  void WriteForces() {
    const V zero = L::Set(0);
    V size = zero;
    Each<N>([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V force = L::Masked(L::SignOf(sign_[i]), zero - q_[i]);
      f_[i] = L::Select(joint_[i], force, L::Max(force, zero)) * (scale_[i] * inverse_b_scale_);
      size = size + L::Abs(force);
    });
    size_ = size;
  }

  // w by the given A and b; which lanes have rows with small backward errors only; and an upper bound of rho^2, at most
  // 4 times too large: it takes D_ii = 1 for rows and D_ii = 4 for b, because A is scaled so that 1 <= D_ii < 4.
  void Check() {
    const V limit = L::Set(group_.row_limit);
    // Min and Max give their second operand where one is NaN, so that a w that is none passes no test.
    V sum = L::Set(0);
    M met = L::FromBits(kAllLanes);
    M solid = met;
    Each<N>([&](auto i) LCPBENCH_INLINE_LAMBDA {
      V even = b_[i];
      V odd = L::Set(0);
      Each<N>([&](auto j) LCPBENCH_INLINE_LAMBDA {
        const V a = matrix_[j <= i ? At(i, j) : At(j, i)];
        if (j % 2 == 0) {
          even = L::Fma(a, f_[j], even);
        } else {
          odd = L::Fma(a, f_[j], odd);
        }
      });
      const V w = even + odd;
      w_[i] = w;
      const V d = matrix_[At(i, i)];
      const V force = d * f_[i];
      const V defect = L::Select(joint_[i], w, L::Min(force, w));
      const V r = defect * scale_[i] * b_scale_;
      sum = L::Fma(r, r, sum);
      // (|A| |f|)_i is at least both |A f|_i and A_ii f_i: most rows pass by that alone.
      const V b = b_[i];
      const V least = L::Max(L::Abs(force), L::Abs(w - b)) + L::Abs(b);
      met &= L::Abs(defect) <= limit * least;
      solid &= ((d == L::Set(0)) | (L::Set(1 / kMostDiagonal) <= d)) & (d <= L::Set(kMostDiagonal));
    });
    rows_met_ = met;
    solid_ = solid & (L::Set(1 / kMostUnitOfB) <= b_scale_) & (b_scale_ <= L::Set(kMostUnitOfB));
    rho_square_ = L::Set(4) * sum / b_square_;
  }

  // f_F -= A_FF^-1 w_F in the lanes of `poor`, kept where rho falls.
  [[gnu::noinline]] void Refine(M poor) {
    const V rho = rho_square_;
    V before[N];
    for (int i = 0; i < N; ++i) {
      before[i] = q_[i];
      w_[i] = L::Masked(poor & L::SignOf(sign_[i]), w_[i] * scale_[i] * b_scale_);
    }
    for (int i = 0; i < N; ++i) {
      V sum = q_[i];
      for (int j = 0; j < N; ++j) sum = L::Fnma(tableau_[j <= i ? At(i, j) : At(j, i)], w_[j], sum);
      q_[i] = L::Select(poor & L::SignOf(sign_[i]), sum, before[i]);
    }
    WriteForces();
    Check();
    const M worse = rho < rho_square_;
    if (!L::Any(worse)) return;
    for (int i = 0; i < N; ++i) q_[i] = L::Select(worse, before[i], q_[i]);
    WriteForces();
    Check();
  }

  void Judge() {
    // SmallPivoting::Answer::rounding, squared, with D_ii = 4 for forces and b.
    // By the lane's own rows: what it is worth must not depend on its neighbours.
    constexpr double kRounding = 2 * std::numeric_limits<double>::epsilon() * 2 * 2;
    alignas(64) double rows_of[kLaneCount];
    for (int l = 0; l < kLaneCount; ++l) rows_of[l] = group_.items[l].n;
    const V n = L::Load(rows_of);
    const V part = L::Set(kRounding) * (n + L::Set(8)) * size_;
    const V rounding = n * (part * part) / b_square_;
    const M clear = rounding <= L::Set(group_.rounding_limit * group_.rounding_limit);
    const M right = solid_ & clear & (rho_square_ <= L::Set(group_.rho_limit * group_.rho_limit));
    M rows = rows_met_;
    if (L::Bits(right & rows) != kAllLanes) rows = WholeRowsMeet();
    group_.met = L::Bits(right & rows);
    const M close = rho_square_ <= L::Set(group_.close_rho_limit * group_.close_rho_limit);
    group_.close = L::Bits(solid_ & close & rows);
  }

  // As in Check, with the whole of (|A| |f| + |b|)_i.
  [[gnu::noinline]] M WholeRowsMeet() const {
    const V limit = L::Set(group_.row_limit);
    M met = L::FromBits(kAllLanes);
    for (int i = 0; i < N; ++i) {
      V size = L::Abs(b_[i]);
      for (int j = 0; j < N; ++j) size = L::Fma(L::Abs(matrix_[j <= i ? At(i, j) : At(j, i)]), L::Abs(f_[j]), size);
      const V force = matrix_[At(i, i)] * f_[i];
      const V defect = L::Abs(L::Select(joint_[i], w_[i], L::Min(force, w_[i])));
      met &= defect <= limit * size;
    }
    return met;
  }

  void StoreForces() {
    double* to[kLaneCount];
    int n = group_.items[0].n;
    for (int l = 0; l < kLaneCount; ++l) {
      to[l] = group_.items[l].f;
      if (group_.items[l].n != n) n = 0;
    }
    if (n == N) {
      StoreAll(to, N);
    } else if (n > 0) {
      StoreAll(to, n);
    } else {
      for (int i = 0; i < N; ++i) {
        alignas(64) double values[kLaneCount];
        L::Store(values, f_[i]);
        for (int l = 0; l < kLaneCount; ++l) {
          if (i < group_.items[l].n) to[l][i] = values[l];
        }
      }
    }
    alignas(64) double pivots[kLaneCount];
    L::Store(pivots, pivots_);
    for (int l = 0; l < kLaneCount; ++l) group_.pivots[l] = static_cast<int>(pivots[l]);
  }
  [[gnu::always_inline]] void StoreAll(double* const* to, int n) const {
    for (int j = 0; j < n; j += kLaneCount) {
      V part[kLaneCount];
      const int count = n - j < kLaneCount ? n - j : kLaneCount;
      for (int k = 0; k < kLaneCount; ++k) part[k] = f_[j + k];
      L::StoreTransposed(part, to, static_cast<std::size_t>(j), count);
    }
  }

  BatchGroup& group_;
  V tableau_[kEntries];
  V matrix_[kEntries];  // in given units
  V q_[N], b_[N], sign_[N], least_[N], scale_[N], w_[N];
  V f_[N + kLaneCount];  // read in whole blocks
  M joint_[N];
  M moved_, rows_met_, solid_;
  V noise_, pivots_, b_scale_, inverse_b_scale_, b_square_, rho_square_, size_;
  bool any_joint_;
};

// By the smallest even size that holds all lanes' rows.
template <int N = 2>
void SolveGroup(BatchGroup* group) {
  if (group->rows <= N) {
    TableauKernel<N>(group).Solve();
  } else if constexpr (N < kBatchMaxRows) {
    SolveGroup<N + 2>(group);
  }
}

}  // namespace
}  // namespace lcpbench
