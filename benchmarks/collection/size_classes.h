#pragma once

#include <array>
#include <limits>
#include <string_view>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Problems are compared within classes of their number of rows, everywhere: in campaigns, README, report and
/// `lcpbench recommend`. Result files carry the table (campaign.json), so that readers need no copy of it.
struct SizeClass {
  std::string_view key;  ///< of files and tables
  Index least;           ///< rows
  Index most;            ///< rows
  /// How many problems a stream of this class has at least: the collection's own and, to fill up, others of the same
  /// recipes with further seeds. 0: problems are timed one by one, without a stream.
  int stream;
};

inline constexpr std::array kSizeClasses{
    SizeClass{"1", 1, 1, 1000},
    SizeClass{"2-3", 2, 3, 1000},
    SizeClass{"4-6", 4, 6, 1000},
    SizeClass{"7-12", 7, 12, 1000},
    SizeClass{"13-30", 13, 30, 1000},
    SizeClass{"31-100", 31, 100, 256},
    SizeClass{"101-300", 101, 300, 64},
    SizeClass{"301-1000", 301, 1000, 64},
    SizeClass{"1001-1e4", 1001, 10'000, 0},
    SizeClass{"1e4-1e5", 10'001, 100'000, 0},
    SizeClass{"1e5-1e6", 100'001, std::numeric_limits<Index>::max(), 0},
};

/// The class of a problem with so many rows, at least one.
constexpr const SizeClass& SizeClassOf(Index rows) {
  for (const SizeClass& size_class : kSizeClasses) {
    if (rows <= size_class.most) return size_class;
  }
  return kSizeClasses.back();
}

}  // namespace lcpbench
