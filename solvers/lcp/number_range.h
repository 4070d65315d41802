#pragma once

#include <bit>
#include <cstdint>

/// Internal to solvers/: whether numbers leave the range in which methods may multiply two or three of them.
namespace lcpbench {

/// Absolute values of numbers that are not 0.
struct MagnitudeRange {
  double least;  ///< > 0
  double most;   ///< finite
};
/// Products of two or three do not leave the range of doubles (LcpProblem::has_extreme_matrix, has_extreme_b).
inline constexpr MagnitudeRange kFactorRange{0x1p-64, 0x1p64};
/// The range of entries of A.
inline constexpr MagnitudeRange kEntryRange{0x1p-192, 0x1p192};
/// The range of entries of b.
inline constexpr MagnitudeRange kLoadRange{0x1p-300, 0x1p128};

/// Whether any number has its sign set: -0.0 too, and one that is not a number. O(count)
inline bool HasSign(const double* values, std::int64_t count) {
  std::uint64_t signs = 0;
  for (std::int64_t i = 0; i < count; ++i) signs |= std::bit_cast<std::uint64_t>(values[i]);
  return signs >> 63U != 0;
}

/// Looks at numbers by the bits of their absolute values, which ascend as the numbers do, NaN and infinity last, and by
/// signs of differences: without a branch, and with what even the baseline instruction set does several at a time.
class NumberRange {
 public:
  /// Nothing has been looked at yet.
  explicit NumberRange(const MagnitudeRange& range)
      : least_(std::bit_cast<std::uint64_t>(range.least)), most_(std::bit_cast<std::uint64_t>(range.most)) {}

  /// O(count)
  template <typename Real>
  void Look(const Real* values, std::int64_t count) {
    std::uint64_t small = 0;
    std::uint64_t large = 0;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::uint64_t size = std::bit_cast<std::uint64_t>(static_cast<double>(values[i])) & ~kSign;
      large |= most_ - size;
      small |= (size - least_) & (0 - size);
    }
    small_ |= small;
    large_ |= large;
  }

  /// No number is outside the range, zeros apart.
  bool is_within() const { return ((small_ | large_) & kSign) == 0; }
  /// A number that is not 0 below the range.
  bool has_small() const { return (small_ & kSign) != 0; }
  /// A number above the range, infinity or NaN.
  bool has_large() const { return (large_ & kSign) != 0; }

 private:
  static constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;
  std::uint64_t least_, most_;
  std::uint64_t small_ = 0;
  std::uint64_t large_ = 0;
};

}  // namespace lcpbench
