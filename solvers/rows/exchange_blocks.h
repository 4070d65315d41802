#pragma once

#include <algorithm>
#include <limits>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Block principal pivoting [Kostreva 1978; Judice, Pires 1994] as BandPivoting and ProfilePivoting do it: all rows of
/// wrong sign change sides after each basic point, while their number falls. (BlockPivoting, which proves
/// infeasibility and goes on row by row, has more ends and its own loop.)
/// @param most_rounds  basic points
/// @param patience     rounds without fewer wrong rows than ever before that end it; one more where they are few
/// @param find         makes the basic point of the active rows; false: it could not, or time is up
/// @param exchange     lets the wrong rows change sides, and returns how many they are
/// @param few          so many wrong rows
/// @returns whether no row is wrong at the last basic point
template <typename Find, typename Exchange>
bool ExchangeBlocks(int most_rounds, int patience, const Find& find, const Exchange& exchange, Index few = 0) {
  Index least = std::numeric_limits<Index>::max();
  int left = patience;
  for (int round = 0; round < most_rounds && find(); ++round) {
    const Index wrong = exchange();
    if (wrong == 0) return true;
    left = wrong >= least ? left - 1 : patience + (wrong <= few ? 1 : 0);
    if (left == 0) return false;
    least = std::min(least, wrong);
  }
  return false;
}

}  // namespace lcpbench
