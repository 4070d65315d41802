#pragma once

#include "solvers/lcp/problem.h"
#include "solvers/lcp/settings.h"

namespace lcpbench {

/// Options that the dense pivoting solvers (dantzig, lemke) share.
struct PivotOptions {
  /// Row d depends on the active rows F if y.A y <= rank_tolerance (y.D y) for y = (-A_FF^-1 A_Fd, 1), D = diag A: if y
  /// shows that D^-1/2 A D^-1/2 on F + d has an eigenvalue <= rank_tolerance. Independent of units and row scaling. The
  /// default lies between the rounding of A (n epsilon) and the eigenvalues of contacts with mass ratios up to 1e8
  /// (about 1e-9). In (0, 1).
  double rank_tolerance = 1e-12;
  /// Before the method takes over, blocks of rows enter and leave F at once; after a warm start they always do.
  bool block_start = true;
  /// Larger problems are refused as unsupported before anything is allocated: three n x n arrays take 2.4 GB at the
  /// default, and pivoting on them minutes. In [1, 100000].
  Index max_rows = 10'000;

  /// Keys `rank_tolerance`, `block_start` (yes, no) and `max_rows`.
  void ReadShared(SettingsReader* reader);
};

}  // namespace lcpbench
