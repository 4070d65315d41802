#pragma once

#include <cstddef>
#include <limits>

#include "solvers/linear_algebra/vector_register.h"
#include "solvers/rows/kernel.h"

/// Internal to solvers/rows/: the kernel of ProfileFactor, in an unnamed namespace as vector_register.h says.
namespace lcpbench {
namespace {

/// L D L^T panel by panel, each one subtracted from the rows below at once.
class ProfileKernel {
 public:
  explicit ProfileKernel(const ProfileWork& work) : t_(work) {}

  bool Factorize() {
    bool is_whole = true;
    for (Index j = 0; j < t_.rows; j += kPanel) {
      is_whole = FactorizeBlock(j) && is_whole;
      if (j + kPanel >= t_.rows) break;
      const Index last = t_.last_below[j + kPanel - 1];
      DivideBelow(j, last);
      SubtractBelow(j, last);
    }
    return is_whole;
  }

  void Solve(double* y) const {
    for (Index a = 0; a < t_.rows; ++a) {
      const double* const row = Row(a);
      V sum = {};
      const Index begin = t_.first[a] / kWidth * kWidth;
      const Index end = a / kWidth * kWidth;
      for (Index k = begin; k < end; k += kWidth) sum = L::Fma(L::Load(row + k), L::Load(y + k), sum);
      double rest = L::Sum(sum);
      for (Index k = begin < end ? end : begin; k < a; ++k) rest += row[k] * y[k];
      y[a] -= rest;
    }
    for (Index a = 0; a < t_.rows; ++a) y[a] /= Row(a)[a];
    for (Index a = t_.rows - 1; a >= 0; --a) {
      const double* const row = Row(a);
      const double own = y[a];
      const V owns = L::Set(own);
      const Index begin = t_.first[a] / kWidth * kWidth;
      const Index end = a / kWidth * kWidth;
      for (Index k = begin; k < end; k += kWidth) L::Store(y + k, L::Fnma(owns, L::Load(row + k), L::Load(y + k)));
      for (Index k = begin < end ? end : begin; k < a; ++k) y[k] -= own * row[k];
    }
  }

 private:
  using L = Lanes;
  using V = L::V;
  using Index = std::ptrdiff_t;
  static constexpr Index kWidth = L::kWidth;
  static constexpr Index kPanel = kProfilePanel;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  double* Row(Index a) const { return t_.L + t_.begin[a]; }

  // The diagonal block at column j; false if a row is left out.
  bool FactorizeBlock(Index j) {
    bool is_whole = true;
    for (Index r = 0; r < kPanel && j + r < t_.rows; ++r) {
      double* const own = Row(j + r) + j;
      for (Index c = 0; c <= r; ++c) {
        block_[r][c] = own[c];
        for (Index k = 0; k < c; ++k) block_[r][c] -= own[k] * block_[c][k];
        if (c < r) own[c] = block_[r][c] * inverse_[c];
      }
      own[r] = block_[r][r];
      if (!(own[r] > t_.floor[j + r])) {
        own[r] = kInfinity;
        is_whole = false;
      }
      inverse_[r] = 1 / own[r];
    }
    return is_whole;
  }

  // The panel's columns below its block, to row `last`: into `columns` as they are, into L over their pivots.
  void DivideBelow(Index j, Index last) {
    const ProfileKernel own = *this;  // a copy, so that it stays in registers
    const auto& block = own.block_;
    const auto& inverse = own.inverse_;
    double* const column[kPanel] = {t_.columns, t_.columns + t_.stride, t_.columns + 2 * t_.stride,
                                    t_.columns + 3 * t_.stride};
    for (double* const c : column) {
      for (Index i = j; i < j + kPanel; ++i) c[i] = 0;
    }
    for (Index i = j + kPanel; i <= last; ++i) {
      double v[kPanel] = {};
      if (own.t_.first[i] < j + kPanel) {
        double* const row = own.Row(i) + j;
        v[0] = row[0];
        const double f0 = v[0] * inverse[0];
        v[1] = row[1] - f0 * block[1][0];
        const double f1 = v[1] * inverse[1];
        v[2] = row[2] - f0 * block[2][0] - f1 * block[2][1];
        const double f2 = v[2] * inverse[2];
        v[3] = row[3] - f0 * block[3][0] - f1 * block[3][1] - f2 * block[3][2];
        row[0] = f0;
        row[1] = f1;
        row[2] = f2;
        row[3] = v[3] * inverse[3];
      }
      for (int c = 0; c < kPanel; ++c) column[c][i] = v[c];
    }
  }

  // What the panel takes from the rows below it.
  void SubtractBelow(Index j, Index last) const {
    const double* const c0 = t_.columns;
    const double* const c1 = c0 + t_.stride;
    const double* const c2 = c1 + t_.stride;
    const double* const c3 = c2 + t_.stride;
    const Index begin = (j + kPanel) / kWidth * kWidth;
    for (Index i = j + kPanel; i <= last; ++i) {
      if (t_.first[i] >= j + kPanel) continue;
      double* const own = Row(i);
      const V f0 = L::Set(own[j]);
      const V f1 = L::Set(own[j + 1]);
      const V f2 = L::Set(own[j + 2]);
      const V f3 = L::Set(own[j + 3]);
      // What lies beyond the diagonal in a register is never read as a number of the row.
      for (Index k = begin; k <= i; k += kWidth) {
        const V of_01 = L::Fnma(f1, L::Load(c1 + k), L::Fnma(f0, L::Load(c0 + k), L::Load(own + k)));
        L::Store(own + k, L::Fnma(f3, L::Load(c3 + k), L::Fnma(f2, L::Load(c2 + k), of_01)));
      }
    }
  }

  const ProfileWork t_;
  // A panel's diagonal block: L D by rows, and the inverse of D.
  double block_[kPanel][kPanel];
  double inverse_[kPanel];
};

bool FactorizeProfile(const ProfileWork& work) { return ProfileKernel(work).Factorize(); }
void SolveProfile(const ProfileWork& work, double* y) { ProfileKernel(work).Solve(y); }

}  // namespace
}  // namespace lcpbench
