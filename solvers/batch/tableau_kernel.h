#pragma once

#include <cstddef>
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

constexpr int kRowsInTurn = RowsInTurn(Lanes::kWidth);

/// Solves one group of N rows or fewer, one problem per lane (docs/solvers/batch.md).
///
/// The tableau T starts as A, of which the lower triangle is kept, q as b. Exchanging row k, with a = T_kk:
///     T_ij -= T_ik T_kj / a,   T_kj /= |a|,   T_kk = -1 / a,   and q_i, q_k as if q were another column,
/// which is its own inverse. Then q_i = w_i outside F and -f_i in F, so `sign_` (-0 in F) turns both into what must not
/// be negative. Nothing here depends on another lane but whether a pass is made at all, which changes no bits in a lane
/// that moves nothing (its multipliers are 0).
///
/// Up to kRowsInTurn rows are taken in turn, the same ones in all lanes, two in one pass. Of more rows every lane
/// exchanges its own, the wrong one of greatest q_k^2 / |T_kk|: then with x the column T_.k, but x_k = a - sign a, and
/// y = x / a, all but the diagonal becomes T - x y^T, whatever k is; the diagonal is kept apart. T itself waits until
/// kPending exchanges have come together, because to read and to write it is what takes the time.
template <int N>
class TableauKernel {
 public:
  void Solve(BatchGroup* group) {
    group_ = group;
    n_ = kInTurn ? N : (group->rows + 1) / 2 * 2;
    for (int k = 0; k < kLaneCount; ++k) f_[row_count() + k] = L::Set(0);
    for (int i = group->rows; i < row_count(); ++i) {
      b_[i] = L::Set(0);
      for (int j = 0; j <= i; ++j) matrix_[Place(i, j)] = L::Set(0);
    }
    const M usable = AssembleRows(group, matrix_, b_);
    TakeJoints();
    SolveRows();
    group->met &= L::Bits(usable);
    group->close &= L::Bits(usable);
    alignas(64) double squares[kLaneCount];
    L::Store(squares, rho_square_);
    for (int l = 0; l < kLaneCount; ++l) group->rho[l] = __builtin_sqrt(squares[l]);
  }

 private:
  using L = Lanes;
  using V = L::V;
  using M = L::M;
  using Choice = L::Choice;

  [[gnu::noinline]] void SolveRows() {
    Scale();
    if constexpr (kInTurn) {
      SweepRows();
    } else {
      ExchangeRows();
    }
    WriteForces();
    Check();
    const int most = group_->shift > 0 ? kMostRefinements : 1;
    for (int k = 0; k < most; ++k) {
      const M poor = L::Set(kGoodEnough * kGoodEnough) < rho_square_;
      if (!L::Any(poor)) break;
      if constexpr (!kInTurn) CatchUp();
      Refine(poor);
    }
    Judge();
    StoreForces();
  }

  static constexpr int kLaneCount = L::kWidth;
  static constexpr int kPanels = N / 2;
  static constexpr int kEntries = N * (N + 1) / 2;
  static constexpr unsigned kAllLanes = (1U << kLaneCount) - 1;
  static constexpr bool kInTurn = N <= kRowsInTurn;
  // Up to this size everything is unrolled and vectors stay in registers; above, only the pass of an exchange is, and
  // not where it has more instructions (SSE2) than a first-level cache holds.
  static constexpr bool kUnroll = N <= 12;
  static constexpr bool kUnrollPass = kUnroll || kLaneCount > 2;
  // In turn: after three sweeps nine lanes in ten of the scene families are done at 10 rows; a lane that cycles costs
  // its neighbours the rest.
  static constexpr int kMaxSweeps = 12;
  static constexpr int kUpwardSweeps = 3;
  static constexpr int kPending = 4;
  static constexpr int kPivotsPerRow = 3;
  static constexpr int kMostRefinements = 4;  // with a shift
  static constexpr double kLeastPivot = tableau::kLeastPivot;
  static constexpr double kNoise = tableau::kNoise;
  static constexpr double kGoodEnough = tableau::kGoodEnoughInLanes;
  // More than any q_i^2 / |T_ii|: bilateral rows come first.
  static constexpr double kFirst = 0x1p512;
  // No products of three numbers of these sizes leave the doubles (as LcpProblem::has_extreme_matrix).
  static constexpr double kMostDiagonal = 0x1p192;
  static constexpr double kMostUnitOfB = 0x1p224;

  static constexpr int Place(int i, int j) { return i * (i + 1) / 2 + j; }  // j <= i
  int row_count() const { return kInTurn ? N : n_; }
  static constexpr int PlaceOfAny(int i, int j) { return j <= i ? Place(i, j) : Place(j, i); }

  // f(j) for j < i, unrolled if asked for; then i is a constant.
  template <bool is_unrolled = kUnroll, typename I, typename F>
  [[gnu::always_inline]] static void EachUpTo(I i, const F& f) {
    if constexpr (is_unrolled) {
      EachUnrolled(std::make_integer_sequence<int, I::value>{}, f);
    } else {
      for (int j = 0; j < i; ++j) f(j);
    }
  }
  template <bool is_unrolled = kUnroll, typename F>
  [[gnu::always_inline]] static void EachPanel(const F& f) {
    EachUpTo<is_unrolled>(std::integral_constant<int, N / 2>{}, f);
  }
  template <typename F>
  [[gnu::always_inline]] void Each(const F& f) const {
    if constexpr (kInTurn) {
      EachUpTo(std::integral_constant<int, N>{}, f);
    } else {
      EachUpTo(n_, f);
    }
  }

  void TakeJoints() {
    alignas(64) std::uint64_t joints[kLaneCount];
    for (int l = 0; l < kLaneCount; ++l) joints[l] = group_->items[l].joints;
    M bits;
    __builtin_memcpy(&bits, joints, sizeof bits);
    any_joint_ = L::Any(bits != 0);
    for (int i = 0; i < n_; ++i) joint_[i] = L::FromSigns(bits << (63 - i));
  }

  void Scale() {
    const V one = L::Set(1);
    const V zero = L::Set(0);
    V largest = zero;
    Each([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V d = matrix_[Place(i, i)];
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
    Each([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V q = q_[i] * t;
      q_[i] = q;
      norm = L::Fma(q, q, norm);
    });
    b_square_ = L::Select(zero < norm, norm, one);
    const V shift = L::Set(group_->shift);
    Each([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V s = scale_[i];
      EachUpTo(i, [&](auto j) LCPBENCH_INLINE_LAMBDA { tableau_[Place(i, j)] = matrix_[Place(i, j)] * s * scale_[j]; });
      const V d = matrix_[Place(i, i)] * s * s;
      tableau_[Place(i, i)] = L::Fma(d, shift, d);
      // Lanes that are done multiply column 0 of T by 0, whose diagonal has to be a number, too.
      if constexpr (!kInTurn) pivot_[i] = tableau_[Place(i, i)];
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

  void SweepRows() {
    if (any_joint_) Sweep(true, false);
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      Sweep(false, sweep >= kUpwardSweeps && sweep % 2 != 0);
      if (!L::Any(moved_)) break;
    }
  }

  // By panels, up or down.
  void Sweep(bool joints, bool down) {
    moved_ = L::FromBits(0);
    if (down) {
      EachPanel([&](auto panel) LCPBENCH_INLINE_LAMBDA { VisitPanel(Mirror<kPanels - 1>(panel), joints); });
    } else {
      EachPanel([&](auto panel) LCPBENCH_INLINE_LAMBDA { VisitPanel(panel, joints); });
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
    const V lk = tableau_[Place(l, k)];
    const Move first = Decide(k, joints, tableau_[Place(k, k)]);
    const V first_y = lk * first.inverse;
    const V first_q = kq * first.inverse;
    q_[l] = L::Fnma(lk, first_q, q_[l]);
    const V lq = q_[l];
    const V moved_lk = lk * first.factor;
    const Move second = Decide(l, joints, L::Fnma(lk, first_y, tableau_[Place(l, l)]));
    const V second_y = moved_lk * second.inverse;
    const V second_q = lq * second.inverse;
    tableau_[Place(k, k)] = L::Fnma(moved_lk, second_y, first.diagonal);
    tableau_[Place(l, k)] = moved_lk * second.factor;
    tableau_[Place(l, l)] = second.diagonal;
    q_[k] = L::Fnma(moved_lk, second_q, q_[k]);

    V y0[N];
    V y1[N];
    y0[k] = y0[l] = y1[k] = y1[l] = L::Set(0);
    EachPanel<kUnrollPass>([&](auto pair) LCPBENCH_INLINE_LAMBDA {
      if (pair == panel) return;
      const auto i = Twice(pair);
      V x0[2];
      V x1[2];
      for (int r = 0; r < 2; ++r) {
        x0[r] = tableau_[pair < panel ? Place(k, i + r) : Place(i + r, k)];
        x1[r] = L::Fnma(x0[r], first_y, tableau_[pair < panel ? Place(l, i + r) : Place(i + r, l)]);
        y0[i + r] = x0[r] * first.inverse;
        y1[i + r] = x1[r] * second.inverse;
        q_[i + r] = L::Fnma(x1[r], second_q, L::Fnma(x0[r], first_q, q_[i + r]));
      }
      V* const upper = tableau_ + Place(i, 0);
      V* const lower = tableau_ + Place(i + 1, 0);
      EachUpTo<kUnrollPass>(i, [&](auto j) LCPBENCH_INLINE_LAMBDA {
        if (kUnroll && j / 2 == panel) return;  // else overwritten below
        upper[j] = L::Fnma(x1[0], y1[j], L::Fnma(x0[0], y0[j], upper[j]));
        lower[j] = L::Fnma(x1[1], y1[j], L::Fnma(x0[1], y0[j], lower[j]));
      });
      upper[i] = L::Fnma(x1[0], y1[i], L::Fnma(x0[0], y0[i], upper[i]));
      lower[i] = L::Fnma(x1[1], y1[i], L::Fnma(x0[1], y0[i], lower[i]));
      lower[i + 1] = L::Fnma(x1[1], y1[i + 1], L::Fnma(x0[1], y0[i + 1], lower[i + 1]));
      for (int r = 0; r < 2; ++r) {
        tableau_[pair < panel ? Place(k, i + r) : Place(i + r, k)] = L::Fnma(x1[r], second_y, x0[r] * first.factor);
        tableau_[pair < panel ? Place(l, i + r) : Place(i + r, l)] = x1[r] * second.factor;
      }
    });
  }

  // Each lane keeps the best row so far to exchange: its q^2 and |T_kk|, and what the exchange needs.
  struct Candidate {
    V square = L::Set(0), size = L::Set(1), q = L::Set(0), pivot = L::Set(1);
    V y[kPending] = {};  // of the pending exchanges
    M row{};
  };
  template <bool joints, int pending>
  [[gnu::always_inline]] void Consider(int i, V q, V d, V sign, V noise, Candidate* best) const {
    const V size = L::Xor(d, sign);
    const Choice can = L::Less(least_[i], size);
    V square = q * q;
    V value = L::Xor(q, sign);
    if constexpr (joints) {
      square = L::Select(joint_[i], L::Set(kFirst), square);
      value = L::Select(joint_[i], L::Select(L::SignOf(sign), L::Set(1), L::Set(-kFirst)), value);
    }
    const Choice gains = L::Less(best->square * size, square * best->size);
    const auto is_better = static_cast<Choice>(L::Less(value, noise) & can & gains);
    best->square = L::Select(is_better, square, best->square);
    best->size = L::Select(is_better, size, best->size);
    best->q = L::Select(is_better, q, best->q);
    best->pivot = L::Select(is_better, d, best->pivot);
    for (int p = 0; p < pending; ++p) best->y[p] = L::Select(is_better, y_[p][i], best->y[p]);
    best->row = reinterpret_cast<M>(L::Select(is_better, reinterpret_cast<V>(M{} + i), reinterpret_cast<V>(best->row)));
  }

  void ExchangeRows() {
    Candidate best;
    for (int i = 0; i < row_count(); ++i) Consider<true, 0>(i, q_[i], pivot_[i], sign_[i], noise_, &best);
    pending_ = 0;
    bool joints = any_joint_;
    const int most = kPivotsPerRow * row_count();
    for (int k = 0; k < most && L::Any(L::Set(0) < best.square); ++k) {
      if (joints) joints = CloseJoints(best);
      if (pending_ == kPending) CatchUp();
      if (joints) {
        ExchangeOneOf<true>(&best);
      } else {
        ExchangeOneOf<false>(&best);
      }
      ++pending_;
    }
  }

  // The joints of lanes that exchange another row stay as they are. False if that are all.
  [[gnu::noinline]] bool CloseJoints(const Candidate& best) {
    const M is_open = L::Set(kFirst) <= best.square;
    for (int i = 0; i < row_count(); ++i) least_[i] = L::Select(joint_[i] & ~is_open, L::Set(kFirst), least_[i]);
    return L::Any(is_open);
  }

  template <bool joints, int pending = 0>
  void ExchangeOneOf(Candidate* best) {
    if (pending_ == pending) {
      Exchange<joints, pending>(best);
    } else if constexpr (pending + 1 < kPending) {
      ExchangeOneOf<joints, pending + 1>(best);
    }
  }

  // Exchanges row k of each lane that moves, and finds the next.
  template <bool joints, int pending>
  [[gnu::noinline]] void Exchange(Candidate* next) {
    const M moves = L::Set(0) < next->square;
    const M k = next->row & moves;
    const V a = next->pivot;
    V y_k[pending + 1];
    for (int p = 0; p < pending; ++p) y_k[p] = next->y[p];
    const V inverse = L::Masked(moves, L::Set(1) / a);
    const V size = L::Abs(inverse);
    const V change = next->q * inverse;
    const V x_k = a - L::Xor(L::Set(1), L::Masked(L::SignOf(a), L::Set(-0.0)));
    const V q_new = next->q * size;
    const V noise = L::Min(noise_, L::Set(-kNoise) * L::Abs(q_new));
    noise_ = noise;
    pivots_ = pivots_ + L::Masked(moves, L::Set(1));
    const M row = k | ~moves;
    // Entry (i, k) is at the larger one of k (k + 1) / 2 + i and i (i + 1) / 2 + k.
    M below = L::LanePlaces((k * (k + 1)) >> 1);
    M beside = L::LanePlaces(k);
    Candidate best;
    for (int i = 0; i < row_count(); ++i) {
      V x = L::GatherLanes(tableau_, L::Larger(below, beside));
      below += kLaneCount;
      beside += (i + 1LL) * kLaneCount;
      for (int p = 0; p < pending; ++p) x = L::Fnma(x_[p][i], y_k[p], x);
      const Choice is_k = L::Equal(row, M{} + i);
      x = L::Select(is_k, x_k, x);
      const V y = x * inverse;
      x_[pending][i] = x;
      y_[pending][i] = y;
      const V d = L::Select(is_k, -inverse, L::Fnma(x, y, pivot_[i]));
      const V q = L::Select(is_k, q_new, L::Fnma(x, change, q_[i]));
      const V sign = L::Select(is_k, L::Xor(sign_[i], L::Set(-0.0)), sign_[i]);
      pivot_[i] = d;
      q_[i] = q;
      sign_[i] = sign;
      Consider<joints, (pending + 1) % kPending>(i, q, d, sign, noise, &best);
    }
    *next = best;
  }

  // The tableau after all exchanges.
  template <int count = kPending>
  void CatchUp() {
    if (pending_ == count) {
      Update<count>();
      pending_ = 0;
    } else if constexpr (count > 1) {
      CatchUp<count - 1>();
    }
  }
  template <int count>
  [[gnu::noinline]] void Update() {
    for (int i = 0; i < row_count(); i += 2) {
      V x[2][count];
      for (int p = 0; p < count; ++p) {
        x[0][p] = x_[p][i];
        x[1][p] = x_[p][i + 1];
      }
      V* const upper = tableau_ + Place(i, 0);
      V* const lower = tableau_ + Place(i + 1, 0);
      for (int j = 0; j <= i; ++j) {
        V u = upper[j];
        V l = lower[j];
        for (int p = 0; p < count; ++p) {
          const V y = y_[p][j];
          u = L::Fnma(x[0][p], y, u);
          l = L::Fnma(x[1][p], y, l);
        }
        upper[j] = u;
        lower[j] = l;
      }
    }
  }

  // Forces of the basic point, in given units.
  void WriteForces() {
    const V zero = L::Set(0);
    V size = zero;
    Each([&](auto i) LCPBENCH_INLINE_LAMBDA {
      const V force = L::Masked(L::SignOf(sign_[i]), zero - q_[i]);
      f_[i] = L::Select(joint_[i], force, L::Max(force, zero)) * (scale_[i] * inverse_b_scale_);
      size = size + L::Abs(force);
    });
    size_ = size;
  }

  // w by the given A and b; which lanes have rows with small backward errors only; and an upper bound of rho^2, at most
  // 4 times too large: it takes D_ii = 1 for rows and D_ii = 4 for b, because A is scaled so that 1 <= D_ii < 4.
  void Check() {
    const V limit = L::Set(group_->row_limit);
    // Min and Max give their second operand where one is NaN, so that a w that is none passes no test.
    V sum = L::Set(0);
    M met = L::FromBits(kAllLanes);
    M solid = met;
    V least_row = L::Set(kFirst);
    MultiplyForces();
    for (int i = 0; i < row_count(); ++i) {
      const V w = w_[i];
      const V d = matrix_[Place(i, i)];
      const V force = d * f_[i];
      const V defect = L::Select(joint_[i], w, L::Min(force, w));
      const V r = defect * scale_[i] * b_scale_;
      sum = L::Fma(r, r, sum);
      // (|A| |f|)_i is at least both |A f|_i and A_ii f_i: most rows pass by that alone.
      const V b = b_[i];
      const V least = L::Max(L::Abs(force), L::Abs(w - b)) + L::Abs(b);
      met &= L::Abs(defect) <= limit * least;
      least_row = L::Min(least_row, L::Select(d == L::Set(0), L::Set(kFirst), least * (scale_[i] * b_scale_)));
      solid &= ((d == L::Set(0)) | (L::Set(1 / kMostDiagonal) <= d)) & (d <= L::Set(kMostDiagonal));
    }
    rows_met_ = met;
    least_row_ = least_row;
    solid_ = solid & (L::Set(1 / kMostUnitOfB) <= b_scale_) & (b_scale_ <= L::Set(kMostUnitOfB));
    rho_square_ = L::Set(4) * sum / b_square_;
  }

  // w = A f + b, by pairs of rows, each entry of A read once.
  void MultiplyForces() {
    for (int i = 0; i < row_count(); i += 2) {
      const V* const upper = matrix_ + Place(i, 0);
      const V* const lower = matrix_ + Place(i + 1, 0);
      const V f_u = f_[i];
      const V f_l = f_[i + 1];
      V u[2] = {b_[i], L::Set(0)};
      V l[2] = {b_[i + 1], L::Set(0)};
      for (int j = 0; j < i; j += 2) {
        for (int c = 0; c < 2; ++c) {
          const V a = upper[j + c];
          const V a_l = lower[j + c];
          const V f = f_[j + c];
          u[c] = L::Fma(a, f, u[c]);
          l[c] = L::Fma(a_l, f, l[c]);
          w_[j + c] = L::Fma(a_l, f_l, L::Fma(a, f_u, w_[j + c]));
        }
      }
      w_[i] = L::Fma(lower[i], f_l, L::Fma(upper[i], f_u, u[0] + u[1]));
      w_[i + 1] = L::Fma(lower[i + 1], f_l, L::Fma(lower[i], f_u, l[0] + l[1]));
    }
  }

  // f_F -= A_FF^-1 w_F in the lanes of `poor`, kept where rho falls.
  [[gnu::noinline]] void Refine(M poor) {
    const V rho = rho_square_;
    V before[kBatchMaxRows];
    for (int i = 0; i < row_count(); ++i) {
      before[i] = q_[i];
      w_[i] = L::Masked(poor & L::SignOf(sign_[i]), w_[i] * scale_[i] * b_scale_);
    }
    for (int i = 0; i < row_count(); ++i) {
      V sum = L::Fnma(kInTurn ? tableau_[Place(i, i)] : pivot_[i], w_[i], q_[i]);
      for (int j = 0; j < row_count(); ++j) {
        if (j != i) sum = L::Fnma(tableau_[PlaceOfAny(i, j)], w_[j], sum);
      }
      q_[i] = L::Select(poor & L::SignOf(sign_[i]), sum, before[i]);
    }
    WriteForces();
    Check();
    const M worse = rho < rho_square_;
    if (!L::Any(worse)) return;
    for (int i = 0; i < row_count(); ++i) q_[i] = L::Select(worse, before[i], q_[i]);
    WriteForces();
    Check();
  }

  void Judge() {
    // SmallPivoting::Answer::rounding, squared, with D_ii = 4 for forces and b.
    // By the lane's own rows: what it is worth must not depend on its neighbours.
    alignas(64) double rows_of[kLaneCount];
    for (int l = 0; l < kLaneCount; ++l) rows_of[l] = group_->items[l].n;
    const V n = L::Load(rows_of);
    const V part = L::Set(2 * 2 * tableau::kRounding) * (n + L::Set(tableau::kTermsBesideRows)) * size_;
    const V rounding = n * (part * part) / b_square_;
    const M rows_clear = part <= L::Set(tableau::kHiddenInRow * group_->row_limit) * least_row_;
    const M clear = rows_clear & (rounding <= L::Set(group_->rounding_limit * group_->rounding_limit));
    const M right = solid_ & clear & (rho_square_ <= L::Set(group_->rho_limit * group_->rho_limit));
    M rows = rows_met_;
    if (L::Bits(right & rows) != kAllLanes) rows = WholeRowsMeet();
    group_->met = L::Bits(right & rows);
    const M close = rho_square_ <= L::Set(group_->close_rho_limit * group_->close_rho_limit);
    group_->close = L::Bits(solid_ & close & rows);
  }

  // As in Check, with the whole of (|A| |f| + |b|)_i.
  [[gnu::noinline]] M WholeRowsMeet() const {
    const V limit = L::Set(group_->row_limit);
    M met = L::FromBits(kAllLanes);
    for (int i = 0; i < row_count(); ++i) {
      V size = L::Abs(b_[i]);
      for (int j = 0; j < row_count(); ++j) size = L::Fma(L::Abs(matrix_[PlaceOfAny(i, j)]), L::Abs(f_[j]), size);
      const V force = matrix_[Place(i, i)] * f_[i];
      const V defect = L::Abs(L::Select(joint_[i], w_[i], L::Min(force, w_[i])));
      met &= defect <= limit * size;
    }
    return met;
  }

  void StoreForces() {
    double* to[kLaneCount];
    int n = group_->items[0].n;
    for (int l = 0; l < kLaneCount; ++l) {
      to[l] = group_->items[l].f;
      if (group_->items[l].n != n) n = 0;
    }
    if (n > 0) {
      StoreAll(to, n);
    } else {
      for (int i = 0; i < row_count(); ++i) {
        alignas(64) double values[kLaneCount];
        L::Store(values, f_[i]);
        for (int l = 0; l < kLaneCount; ++l) {
          if (i < group_->items[l].n) to[l][i] = values[l];
        }
      }
    }
    alignas(64) double pivots[kLaneCount];
    L::Store(pivots, pivots_);
    for (int l = 0; l < kLaneCount; ++l) group_->pivots[l] = static_cast<int>(pivots[l]);
  }
  [[gnu::always_inline]] void StoreAll(double* const* to, int n) const {
    for (int j = 0; j < n; j += kLaneCount) {
      V part[kLaneCount];
      const int count = n - j < kLaneCount ? n - j : kLaneCount;
      for (int k = 0; k < kLaneCount; ++k) part[k] = f_[j + k];
      L::StoreTransposed(part, to, static_cast<std::size_t>(j), count);
    }
  }

  BatchGroup* group_;
  int n_;  // rows, made even
  V tableau_[kEntries];
  V matrix_[kEntries];  // in given units
  V q_[N], b_[N], sign_[N], least_[N], scale_[N], w_[N];
  V f_[N + kLaneCount];       // read in whole blocks
  V pivot_[kInTurn ? 1 : N];  // the diagonal of T, which has none of its own then
  V x_[kInTurn ? 1 : kPending][N], y_[kInTurn ? 1 : kPending][N];
  M joint_[N];
  M moved_, rows_met_, solid_;
  V noise_, pivots_, b_scale_, inverse_b_scale_, b_square_, rho_square_, size_, least_row_;
  int pending_;
  bool any_joint_;
};

// By the smallest even size that holds all lanes' rows.
template <int N = 2>
void SolveGroup(BatchGroup* group) {
  if (group->rows > kRowsInTurn || group->shift > 0) {
    using Kernel = TableauKernel<kBatchMaxRows>;
    static_assert(sizeof(Kernel) <= kBatchWorkspace);
    static_cast<Kernel*>(group->workspace)->Solve(group);
  } else if (group->rows <= N) {
    TableauKernel<N> kernel;
    kernel.Solve(group);
  } else if constexpr (N < kRowsInTurn) {
    SolveGroup<N + 2>(group);
  }
}

}  // namespace

void LCPBENCH_KERNEL(SolveGroup)(BatchGroup* group) { SolveGroup(group); }

}  // namespace lcpbench
