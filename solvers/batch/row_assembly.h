#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "solvers/batch/kernel.h"
#include "solvers/linear_algebra/vector_register.h"

/// Internal to solvers/batch/: A = J M^-1 J^T of one problem per lane, straight from the rows of StepRows.
///
/// J enters the lanes by transposed blocks. Of rows i and j, each side of i meets the side of j that is on the same
/// body in that lane, or none: a choice between two vectors, then p fused operations a side.
namespace lcpbench {
namespace {

template <int p, typename Real>
class RowAssembly {
 public:
  explicit RowAssembly(const BatchGroup& group, const Real* const* J) : group_(group), n_(group.rows) {
    for (int k = 0; k < 2 * p * n_; k += kWidth) {
      const int left = 2 * p * n_ - k;
      L::LoadTransposed(J, static_cast<std::size_t>(k), left < kWidth ? left : kWidth, J_ + k);
    }
  }

  /// Writes the lower triangle, by rows, and b. Which lanes can be used: no body is out of range, no inverse mass
  /// negative, and where A_ii is 0 the row is. What is not finite makes A_ii or w so, which no later test passes.
  Lanes::M Assemble(Lanes::V* matrix, Lanes::V* b) {
    LoadLoads(b);
    M usable = LoadBodies();
    M signs = L::FromBits(0);
    for (int i = 0; i < n_; ++i) {
      if (i < group_.next_rows) FetchNext(i);
      V* const J = J_ + 2 * p * i;
      V momentum[2 * p];
      LoadMasses(i, momentum);
      const M is_joined = (first_[i] == second_[i]) & (first_[i] != kNone);
      if (L::Any(is_joined)) JoinSides(is_joined, J);
      for (int c = 0; c < 2 * p; ++c) {
        signs |= reinterpret_cast<M>(momentum[c]);
        momentum[c] = momentum[c] * J[c];
      }
      V* const row = matrix + i * (i + 1) / 2;
      for (int j = 0; j <= i; ++j) {
        const V* const other = J_ + 2 * p * j;
        const auto first_first = L::Equal(first_[i], first_[j]);
        const auto first_second = L::Equal(first_[i], second_[j]);
        const auto second_first = L::Equal(second_[i], first_[j]);
        const auto second_second = L::Equal(second_[i], second_[j]);
        V of_first = momentum[0] * L::Choose(first_first, other[0], first_second, other[p]);
        V of_second = momentum[p] * L::Choose(second_first, other[0], second_second, other[p]);
        for (int c = 1; c < p; ++c) {
          of_first = L::Fma(momentum[c], L::Choose(first_first, other[c], first_second, other[p + c]), of_first);
          of_second =
              L::Fma(momentum[p + c], L::Choose(second_first, other[c], second_second, other[p + c]), of_second);
        }
        row[j] = of_first + of_second;
      }
      const M vanishes = row[i] == L::Set(0);
      if (L::Any(vanishes)) usable &= ~(vanishes & Acts(i));
    }
    return usable & ~(signs < 0);
  }

 private:
  using L = Lanes;
  using V = L::V;
  using M = L::M;
  static constexpr int kWidth = L::kWidth;
  static constexpr long long kNone = 0xffffffff;  // the body -1, without its sign

  void LoadLoads(V* b) const {
    const double* from[kWidth];
    for (int l = 0; l < kWidth; ++l) from[l] = group_.items[l].b;
    for (int i = 0; i < n_; i += kWidth) {
      V part[kWidth];
      const int count = n_ - i < kWidth ? n_ - i : kWidth;
      L::LoadTransposed(from, static_cast<std::size_t>(i), count, part);
      for (int k = 0; k < count; ++k) b[i + k] = part[k];
    }
  }

  // At once, as many lines would have to wait for each other.
  void FetchNext(int i) const {
    constexpr std::ptrdiff_t kRowBytes = std::ptrdiff_t{2} * p * sizeof(Real);
    const std::ptrdiff_t side_0 = std::ptrdiff_t{2} * i;
    for (int l = 0; l < kWidth; ++l) {
      const BatchGroup::Next& next = group_.next[l];
      const char* const J = next.J + i * kRowBytes;
      __builtin_prefetch(J);
      __builtin_prefetch(J + kRowBytes - 1);
      if (i % 8 == 0) {
        __builtin_prefetch(next.b + i);
        __builtin_prefetch(next.f + i, 1);
        __builtin_prefetch(next.later_body + side_0);
      }
      for (int side = 0; side < 2; ++side) {
        const std::int64_t body = next.body[side_0 + side];
        // What is out of range is refused later: to fetch it does no harm.
        FetchMass(group_.inverse_mass, p * body);
      }
    }
  }

  // Lanes with bodies out of range get none at all.
  M LoadBodies() {
    const IndexPair* from[kWidth];
    for (int l = 0; l < kWidth; ++l) from[l] = reinterpret_cast<const IndexPair*>(group_.body[l]);
    M unknown = L::FromBits(0);
    for (int i = 0; i < n_; i += kWidth) {
      V part[kWidth];
      const int count = n_ - i < kWidth ? n_ - i : kWidth;
      L::LoadTransposed(from, static_cast<std::size_t>(i), count, part);
      for (int k = 0; k < count; ++k) {
        const M first = reinterpret_cast<M>(part[k]) & kNone;
        const M second = reinterpret_cast<M>(reinterpret_cast<Unsigned>(part[k]) >> 32U);
        first_[i + k] = first;
        second_[i + k] = second;
        unknown |= (group_.bodies - ((first + 1) & kNone)) | (group_.bodies - ((second + 1) & kNone));
      }
    }
    unknown = unknown < 0;
    for (int i = 0; i < n_ && L::Any(unknown); ++i) {
      first_[i] |= unknown & kNone;
      second_[i] |= unknown & kNone;
    }
    return ~unknown;
  }

  // The inverse masses of row i's first, then of its second body; 0 for none.
  void LoadMasses(int i, V* mass) const {
    static constexpr double kNothing[p] = {};
    alignas(64) long long bodies[2][kWidth];
    std::memcpy(bodies[0], &first_[i], sizeof(M));
    std::memcpy(bodies[1], &second_[i], sizeof(M));
    for (int side = 0; side < 2; ++side) {
      const double* from[kWidth];
      for (int l = 0; l < kWidth; ++l) {
        const long long body = bodies[side][l];
        from[l] = body == kNone ? kNothing : group_.inverse_mass + p * body;
      }
      V part[kWidth];
      for (int c = 0; c < p; c += kWidth) {
        const int count = p - c < kWidth ? p - c : kWidth;
        L::LoadTransposed(from, static_cast<std::size_t>(c), count, part);
        for (int k = 0; k < count; ++k) mass[side * p + c + k] = part[k];
      }
    }
  }

  // Both sides of a row on one body: they act as their sum.
  [[gnu::noinline]] static void JoinSides(M is_joined, V* J) {
    for (int c = 0; c < p; ++c) {
      J[c] = J[c] + L::Masked(is_joined, J[p + c]);
      J[p + c] = L::Masked(~is_joined, J[p + c]);
    }
  }

  // Where row i has a number that is not 0 on a body that can move.
  [[gnu::noinline]] M Acts(int i) const {
    V mass[2 * p];
    LoadMasses(i, mass);
    M acts = L::FromBits(0);
    for (int c = 0; c < 2 * p; ++c) acts |= (mass[c] != L::Set(0)) & (J_[2 * p * i + c] != L::Set(0));
    return acts;
  }

  using Unsigned [[gnu::vector_size(sizeof(V))]] = unsigned long long;

  const BatchGroup& group_;
  int n_;
  V J_[2 * p * kBatchMaxRows + kWidth];  // loaded in whole blocks
  M first_[kBatchMaxRows], second_[kBatchMaxRows];
};

template <int p>
Lanes::M AssembleRowsOf(BatchGroup* group, Lanes::V* matrix, Lanes::V* b) {
  if (group->J[0] != nullptr) return RowAssembly<p, double>(*group, group->J).Assemble(matrix, b);
  return RowAssembly<p, float>(*group, group->J_single).Assemble(matrix, b);
}

[[gnu::noinline]] Lanes::M AssembleRows(BatchGroup* group, Lanes::V* matrix, Lanes::V* b) {
  return group->columns_per_body == 3 ? AssembleRowsOf<3>(group, matrix, b) : AssembleRowsOf<6>(group, matrix, b);
}

}  // namespace
}  // namespace lcpbench
