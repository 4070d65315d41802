#pragma once

/// Internal to solvers/: the numbers that pivoting on a dense tableau goes by, one problem at a time (SmallPivoting)
/// and one per lane (solvers/batch/tableau_kernel.h). A is scaled to A_ii in [1, 4), the largest |b_i| to [1, 2).
namespace lcpbench::tableau {

/// A pivot below this part of the row's diagonal entry (or of the inverse's scale) is rounding: the row depends on F.
inline constexpr double kLeastPivot = 1e-11;
/// Violations below this part of the largest force or gap are rounding.
inline constexpr double kNoise = 1e-14;
/// rho up to which the basic point is not refined. Lanes take an upper bound of rho, up to twice as large, and refining
/// one lane delays all.
inline constexpr double kGoodEnough = 1e-14;
inline constexpr double kGoodEnoughInLanes = 1e-13;
/// An answer of a larger rho counts as failed, whatever the tolerance: other solvers do better.
inline constexpr double kMostRho = 1e-9;
/// Backward errors in double of at most this part of what is allowed pass in extended precision, too.
inline constexpr double kMargin = 0.1;
/// What rounding may add to a row's backward error, in parts of the limit with that margin: the rest of what is
/// allowed.
inline constexpr double kHiddenInRow = 1 / kMargin - 1;
/// Where A is assembled from rows, rounding makes a gap, a sum over n of its entries, wrong by at most (n +
/// kTermsBesideRows) kRounding D_ii^1/2 |D^1/2 f|_1, since |J_i| M^-1 |J_j|^T is at most (A_ii A_jj)^1/2: of a row
/// whose terms cancel that may be all there is.
inline constexpr double kRounding = 0x1p-51;
inline constexpr double kTermsBesideRows = 8;

}  // namespace lcpbench::tableau
