#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace lcpbench {

/// One to four numbers or bytes of a binary file overwritten where they stand: what is inserted or cut out moves all
/// addresses behind it, and then hardly anything but the first lines of a reader is tried.
inline std::string OverwrittenBytes(std::string bytes, std::mt19937_64* random) {
  if (bytes.empty()) return bytes;
  static constexpr std::array<std::uint64_t, 12> kIntegers{
      0, 1, 2, 3, 0xff, 0xffff, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff, UINT64_MAX, 1'000'000'000'000};
  static constexpr std::array<double, 6> kReals{
      0.0, -0.0, 1e-3, 1e308, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()};
  const auto below = [random](std::size_t end) { return static_cast<std::size_t>((*random)() % end); };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    static constexpr std::array<std::size_t, 5> kWidths{1, 2, 4, 4, 8};
    const std::size_t width = kWidths[below(kWidths.size())];
    if (width > bytes.size()) continue;
    // Numbers stand at multiples of four mostly.
    std::size_t at = below(bytes.size() - width + 1);
    if (below(4) != 0) at -= at % (width < 4 ? 1 : 4);
    std::uint64_t value = (*random)();
    switch (below(4)) {
      case 0:
        value = kIntegers[below(kIntegers.size())];
        break;
      case 1:
        std::memcpy(&value, &kReals[below(kReals.size())], sizeof value);
        break;
      case 2:  // a little more or less
        std::memcpy(&value, bytes.data() + at, width);
        value += below(5) - 2;
        break;
      default:
        break;
    }
    std::memcpy(bytes.data() + at, &value, width);
  }
  return bytes;
}

}  // namespace lcpbench
