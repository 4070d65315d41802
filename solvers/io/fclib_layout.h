#pragma once

#include <limits>

namespace lcpbench::fclib_layout {

// Where fclib's files keep what, and our own group beside; see fclib_file.h.

inline constexpr int kMost = std::numeric_limits<int>::max() - 1;
inline constexpr int kCompressedColumns = -1;
inline constexpr int kCompressedRows = -2;
inline constexpr int kLeastDimension = 2;
inline constexpr int kMostDimension = 3;

inline constexpr char kDimension[] = "/fclib_local/spacedim";
inline constexpr char kW[] = "/fclib_local/W";
inline constexpr char kV[] = "/fclib_local/V";
inline constexpr char kR[] = "/fclib_local/R";
inline constexpr char kQ[] = "/fclib_local/vectors/q";
inline constexpr char kMu[] = "/fclib_local/vectors/mu";
inline constexpr char kS[] = "/fclib_local/vectors/s";
inline constexpr char kNormalForces[] = "/solution/r";
inline constexpr char kBilateralForces[] = "/solution/l";
inline constexpr char kOwnGroup[] = "/lcpbench";
inline constexpr char kId[] = "/lcpbench/id";
inline constexpr char kRowOrder[] = "/lcpbench/row_order";
inline constexpr char kJ[] = "/lcpbench/J";
inline constexpr char kInverseMass[] = "/lcpbench/inverse_mass";

}  // namespace lcpbench::fclib_layout
