#pragma once

#include <cstddef>

#include "solvers/batch/kernel.h"

namespace lcpbench {
namespace {

template <typename L, int N>
class TableauKernel {
 public:
  explicit TableauKernel(BatchGroup* group) : group_(*group) {
    double* next = group->workspace;
    const auto take = [&next](int vectors) {
      double* start = next;
      next += vectors * W;
      return start;
    };
    matrix_ = take(kEntries + W);
    tableau_ = take(kEntries + W);
    q_ = take(N);
    b_ = take(N);
    diagonal_ = take(N);
    scale_ = take(N);
    sign_ = take(N);
    f_ = take(N);
    w_ = take(N);
  }

  void Solve() {
    Load();
    bool any_joint = false;
    for (int i = 0; i < N; ++i) any_joint |= L::Any(joint_[i]);
    if (any_joint) {
      for (int k = 0; k < N; k += B) StepPanel<true>(k);
    }
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      moved_ = L::FromBits(0);
      for (int k = 0; k < N; k += B) StepPanel<false>(k);
      if (!L::Any(moved_)) break;
    }
    WriteForces();
    V rho = Residual();
    const M poor = L::Less(L::Set(kGoodEnough * kGoodEnough), rho);
    if (L::Any(poor)) rho = Refine(poor, rho);
    Judge(rho);
    StoreForces();
  }

 private:
  using V = typename L::V;
  using M = typename L::M;
  static constexpr int W = L::kWidth;
  static constexpr int B = 2;
  static constexpr int kEntries = N * (N + 1) / 2;
  static constexpr int kMaxSweeps = 12;
  static constexpr double kLeastPivot = 1e-11;
  static constexpr double kNoise = 1e-14;
  static constexpr double kGoodEnough = 1e-13;

  static constexpr int At(int i, int j) { return (i * (i + 1) / 2 + j) * W; }  // j <= i
  static V Get(const double* from, int i) { return L::Load(from + i * W); }
  static void Put(double* to, int i, V v) { L::Store(to + i * W, v); }

  void Load() {
    int n = 0;
    bool uniform = true;
    unsigned bits[N] = {};
    for (int l = 0; l < W; ++l) {
      const BatchItem& item = group_.items[l];
      if (item.n > n) n = item.n;
      uniform &= item.n == group_.items[0].n;
      for (std::uint32_t rest = item.joints; rest != 0; rest &= rest - 1) {
        bits[__builtin_ctz(rest)] |= 1U << static_cast<unsigned>(l);
      }
    }
    for (int i = 0; i < N; ++i) joint_[i] = L::FromBits(bits[i]);
    if (uniform) {
      const double* from[W];
      for (int l = 0; l < W; ++l) from[l] = group_.items[l].A;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; j += W) {
          const int left = n - j;
          L::LoadTransposed(from, static_cast<std::size_t>(i * n + j), left < W ? left : W, tableau_ + At(i, j));
        }
      }
      for (int l = 0; l < W; ++l) from[l] = group_.items[l].b;
      for (int j = 0; j < n; j += W) {
        alignas(64) double part[W * W];
        const int left = n - j < W ? n - j : W;
        L::LoadTransposed(from, static_cast<std::size_t>(j), left, part);
        for (int k = 0; k < left; ++k) Put(b_, j + k, Get(part, k));
      }
    } else {
      LoadMixed(n);
    }
    Scale(n);
  }

  // Lanes of different sizes: the rows that a lane does not have are those of the unit matrix.
  [[gnu::noinline]] void LoadMixed(int n) {
    for (int l = 0; l < W; ++l) {
      const BatchItem& item = group_.items[l];
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
          tableau_[At(i, j) + l] = i < item.n ? item.A[i * item.n + j] : (i == j ? 1.0 : 0.0);
        }
        b_[i * W + l] = i < item.n ? item.b[i] : 0.0;
      }
    }
  }

  void Scale(int n) {
    const V one = L::Set(1);
    const V zero = L::Set(0);
    V largest = zero;
    for (int i = 0; i < n; ++i) {
      const V d = L::Load(tableau_ + At(i, i));
      const M acts = L::Less(zero, d);
      const V s = L::Select(acts, L::HalvedExponent(d, 1535), one);
      Put(scale_, i, s);
      const V q = L::Mul(Get(b_, i), s);
      Put(b_, i, q);
      largest = L::Max(largest, L::Masked(acts, L::Abs(q)));
    }
    const V top = L::Min(largest, L::Set(0x1p1022));
    const V t = L::Select(L::Less(zero, top), L::NegatedExponent(top, 2046), one);
    b_scale_ = t;
    V norm = zero;
    for (int i = 0; i < n; ++i) {
      const V q = L::Mul(Get(b_, i), t);
      Put(b_, i, q);
      Put(q_, i, q);
      norm = L::Fma(q, q, norm);
    }
    b_square_ = L::Select(L::Less(zero, norm), norm, one);
    for (int i = 0; i < n; ++i) {
      const V s = Get(scale_, i);
      for (int j = 0; j <= i; ++j) {
        const V a = L::Mul(L::Mul(L::Load(tableau_ + At(i, j)), s), Get(scale_, j));
        L::Store(tableau_ + At(i, j), a);
        L::Store(matrix_ + At(i, j), a);
      }
      Put(diagonal_, i, L::Load(matrix_ + At(i, i)));
      Put(sign_, i, zero);
    }
    for (int i = n; i < N; ++i) {
      for (int j = 0; j <= i; ++j) {
        L::Store(tableau_ + At(i, j), i == j ? one : zero);
        L::Store(matrix_ + At(i, j), i == j ? one : zero);
      }
      Put(diagonal_, i, one);
      Put(scale_, i, one);
      Put(q_, i, zero);
      Put(b_, i, zero);
      Put(sign_, i, zero);
    }
    noise_ = L::Set(-kNoise);
    pivots_ = zero;
  }

  template <bool kJoints>
  M Wanted(int k) const {
    if (kJoints) return L::Without(joint_[k], L::SignOf(Get(sign_, k)));
    return L::Without(L::Less(L::Xor(Get(q_, k), Get(sign_, k)), noise_), joint_[k]);
  }

  template <bool kJoints>
  void StepPanel(int k0) {
    M any = Wanted<kJoints>(k0);
    for (int c = 1; c < B; ++c) any = L::Either(any, Wanted<kJoints>(k0 + c));
    if (!L::Any(any)) return;

    V u[B][N], x[B][N], y[B][N];
    for (int c = 0; c < B; ++c) {
      const int k = k0 + c;
      for (int i = 0; i < k; ++i) u[c][i] = L::Load(tableau_ + At(k, i));
      for (int i = k; i < N; ++i) u[c][i] = L::Load(tableau_ + At(i, k));
    }
    int rank = 0;
    for (int c = 0; c < B; ++c) {
      const int k = k0 + c;
      const V sign = Get(sign_, k);
      const V a = u[c][k];
      const V size = L::Xor(a, sign);
      const M can = L::Less(L::Mul(L::Set(kLeastPivot), Get(diagonal_, k)), size);
      const M m = L::Both(Wanted<kJoints>(k), can);
      if (!L::Any(m)) continue;
      moved_ = L::Either(moved_, m);
      const V inverse_size = L::Div(L::Set(1), size);
      const V inverse = L::Masked(m, L::Xor(inverse_size, sign));
      const V factor = L::Select(m, inverse_size, L::Set(1));
      V* __restrict xc = x[rank];
      V* __restrict yc = y[rank];
      ++rank;
      const V qk = Get(q_, k);
      const V qy = L::Mul(qk, inverse);
      for (int i = 0; i < N; ++i) {
        xc[i] = u[c][i];
        yc[i] = L::Mul(xc[i], inverse);
        u[c][i] = L::Mul(xc[i], factor);
        Put(q_, i, L::Fnma(xc[i], qy, Get(q_, i)));
      }
      for (int o = 0; o < B; ++o) {
        if (o == c) continue;
        const V before = u[o][k];
        const V yo = yc[k0 + o];
        for (int i = 0; i < N; ++i) u[o][i] = L::Fnma(xc[i], yo, u[o][i]);
        u[o][k] = L::Mul(before, factor);
      }
      u[c][k] = L::Select(m, L::Sub(L::Set(0), inverse), a);
      const V moved = L::Mul(qk, factor);
      Put(q_, k, moved);
      Put(sign_, k, L::Xor(sign, L::Masked(m, L::Set(-0.0))));
      noise_ = L::Min(noise_, L::Mul(L::Set(-kNoise), L::Masked(m, L::Abs(moved))));
      pivots_ = L::Add(pivots_, L::Masked(m, L::Set(1)));
    }
    if (rank == 0) return;
    if (rank == 1) {
      Trail<1>(k0, x, y);
    } else {
      Trail<2>(k0, x, y);
    }
    for (int c = 0; c < B; ++c) {
      const int k = k0 + c;
      for (int i = 0; i < k; ++i) L::Store(tableau_ + At(k, i), u[c][i]);
      for (int i = k; i < N; ++i) L::Store(tableau_ + At(i, k), u[c][i]);
    }
  }

  template <int R>
  void TrailRow(double* __restrict row, int from, int to, const V* xi, const V (*y)[N]) {
    for (int j = from; j < to; ++j) {
      V t = L::Load(row + j * W);
      for (int r = 0; r < R; ++r) t = L::Fnma(xi[r], y[r][j], t);
      L::Store(row + j * W, t);
    }
  }

  template <int R>
  void Trail([[maybe_unused]] int k0, const V (*x)[N], const V (*y)[N]) {
    for (int i = 0; i < N; ++i) {
      double* row = tableau_ + At(i, 0);
      V xi[R];
      for (int r = 0; r < R; ++r) xi[r] = x[r][i];
      TrailRow<R>(row, 0, i + 1, xi, y);
    }
  }

  // Forces of the basic point, in scaled units.
  void WriteForces() {
    const V zero = L::Set(0);
    for (int i = 0; i < N; ++i) {
      const V force = L::Masked(L::SignOf(Get(sign_, i)), L::Sub(zero, Get(q_, i)));
      Put(f_, i, L::Select(joint_[i], force, L::Max(force, zero)));
    }
  }

  // An upper bound of rho^2, at most 4 times too large: rows count with D_ii = 1 and b with D_ii = 4, because A is scaled
  // so that 1 <= D_ii < 4.
  V Residual() {
    V sum = L::Set(0);
    for (int i = 0; i < N; ++i) {
      V even = Get(b_, i);
      V odd = L::Set(0);
      for (int j = 0; j < N; ++j) {
        const V a = L::Load(matrix_ + (j <= i ? At(i, j) : At(j, i)));
        if (j % 2 == 0) {
          even = L::Fma(a, Get(f_, j), even);
        } else {
          odd = L::Fma(a, Get(f_, j), odd);
        }
      }
      const V w = L::Add(even, odd);
      Put(w_, i, w);
      const V force = L::Mul(Get(diagonal_, i), Get(f_, i));
      const V r = L::Select(joint_[i], w, L::Min(w, force));
      sum = L::Fma(r, r, sum);
    }
    return L::Div(L::Mul(L::Set(4), sum), b_square_);
  }

  // f_F -= A_FF^-1 w_F in the lanes of `poor`, kept where rho falls.
  [[gnu::noinline]] V Refine(M poor, V rho) {
    V before[N];
    for (int i = 0; i < N; ++i) {
      before[i] = Get(q_, i);
      Put(w_, i, L::Masked(L::Both(poor, L::SignOf(Get(sign_, i))), Get(w_, i)));
    }
    for (int i = 0; i < N; ++i) {
      V sum = Get(q_, i);
      for (int j = 0; j < N; ++j) {
        sum = L::Fnma(L::Load(tableau_ + (j <= i ? At(i, j) : At(j, i))), Get(w_, j), sum);
      }
      Put(q_, i, L::Select(L::SignOf(Get(sign_, i)), sum, before[i]));
    }
    WriteForces();
    const V after = Residual();
    const M worse = L::Less(rho, after);
    if (!L::Any(worse)) return after;
    for (int i = 0; i < N; ++i) Put(q_, i, L::Select(worse, before[i], Get(q_, i)));
    WriteForces();
    return Residual();
  }

  void Judge(V rho) {
    const V zero = L::Set(0);
    M met = L::LessEqual(rho, L::Set(group_.rho_limit * group_.rho_limit));
    const V limit = L::Set(group_.row_limit);
    M rows = met;
    for (int i = 0; i < N; ++i) {
      const V w = Get(w_, i);
      const V b = Get(b_, i);
      const V force = L::Mul(Get(diagonal_, i), Get(f_, i));
      const V defect = L::Abs(L::Select(joint_[i], w, L::Min(w, force)));
      const V least = L::Add(L::Max(L::Abs(L::Sub(w, b)), L::Abs(force)), L::Abs(b));
      rows = L::Both(rows, L::LessEqual(defect, L::Mul(limit, least)));
      met = L::Both(met, L::LessEqual(zero, Get(diagonal_, i)));
    }
    if (L::Any(L::Without(met, rows))) rows = JudgeRows(met);
    group_.met = L::Bits(L::Both(met, rows));
  }

  // As Judge, with the whole of (|A| |f| + |b|)_i.
  [[gnu::noinline]] M JudgeRows(M met) const {
    const V limit = L::Set(group_.row_limit);
    for (int i = 0; i < N; ++i) {
      const V w = Get(w_, i);
      V sum = L::Abs(Get(b_, i));
      for (int j = 0; j < N; ++j) {
        const V a = L::Load(matrix_ + (j <= i ? At(i, j) : At(j, i)));
        sum = L::Add(sum, L::Abs(L::Mul(a, Get(f_, j))));
      }
      const V force = L::Mul(Get(diagonal_, i), Get(f_, i));
      const V defect = L::Abs(L::Select(joint_[i], w, L::Min(w, force)));
      met = L::Both(met, L::LessEqual(defect, L::Mul(limit, sum)));
    }
    return met;
  }

  void StoreForces() {
    const V inverse = L::Div(L::Set(1), b_scale_);
    for (int i = 0; i < N; ++i) Put(f_, i, L::Mul(Get(f_, i), L::Mul(Get(scale_, i), inverse)));
    alignas(64) double pivots[W];
    L::Store(pivots, pivots_);
    for (int l = 0; l < W; ++l) {
      group_.pivots[l] = static_cast<int>(pivots[l]);
      const BatchItem& item = group_.items[l];
      for (int i = 0; i < item.n; ++i) item.f[i] = f_[i * W + l];
    }
  }

  BatchGroup& group_;
  double *matrix_, *tableau_, *q_, *b_, *diagonal_, *scale_, *sign_, *f_, *w_;
  M joint_[N];
  M moved_;
  V noise_, pivots_, b_scale_, b_square_;
};

template <typename L>
void SolveGroup(BatchGroup* group) {
  int n = 0;
  for (int l = 0; l < L::kWidth; ++l) n = group->items[l].n > n ? group->items[l].n : n;
  switch ((n + 1) / 2) {
#define LCPBENCH_CASE(half) case half: TableauKernel<L, 2 * half>(group).Solve(); break;
    LCPBENCH_CASE(1) LCPBENCH_CASE(2) LCPBENCH_CASE(3) LCPBENCH_CASE(4)
    LCPBENCH_CASE(5) LCPBENCH_CASE(6) LCPBENCH_CASE(8) LCPBENCH_CASE(10)
    LCPBENCH_CASE(12) LCPBENCH_CASE(15)
  }
}

}  // namespace
}  // namespace lcpbench
