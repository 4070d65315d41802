#pragma once

#include <cstdint>

/// Internal to solvers/pivoting/: what SmallPivoting and its kernels, one for each instruction set, know of each other.
/// Plain types only: this header is compiled with every set of flags.
namespace lcpbench {

/// Which row changes sides next.
enum class TableauRule : std::uint8_t {
  kMostViolated,  ///< principal pivoting on the most violated row
  kDriven,        ///< Dantzig's: row by row, each driven to w = 0 while those before it stay right [Baraff 1994]
  kAlongPath,     ///< Lemke's: what reaches 0 first as z falls from 1 to 0 in w = A f + b + z d
};

/// A problem of n rows, its answer, and the room to find it in. Vectors have `stride` numbers, matrices that many a
/// row: n in whole registers, aligned to them, padded by zeros.
struct TableauWork {
  // The problem in given units.
  int n = 0;
  int stride = 0;
  double* matrix = nullptr;    ///< A, all of it; scaled afterwards
  double* diagonal = nullptr;  ///< scaled afterwards, as b
  double* b = nullptr;
  int* joints = nullptr;  ///< bilateral rows, ascending
  int joint_count = 0;
  int* guess = nullptr;  ///< rows that may be active, ascending, joints among them; changed
  int guess_count = 0;
  TableauRule rule = TableauRule::kMostViolated;
  double row_limit = 0;
  bool is_assembled = true;  ///< entries of A are rounded sums, not given numbers
  bool (*is_late)(const void* clock) = nullptr;
  const void* clock = nullptr;  ///< nullptr: no limit

  // The answer (SmallPivoting::Answer), in scaled units: f = scale force / b_scale, w = w / (scale b_scale).
  double* force = nullptr;
  double* w = nullptr;
  double* scale = nullptr;
  double b_scale = 1;
  double rho = 0;
  double rounding = 0;
  bool rows_meet = false;
  bool rows_are_clear = false;
  int pivots = 0;

  // Room.
  double* tableau = nullptr;
  double* pivot = nullptr;  ///< the tableau's diagonal
  double* q = nullptr;
  double* weight = nullptr;          ///< what q is compared in; 0 where it may have any sign
  double* blocked_weight = nullptr;  ///< the weight of a row that may not be moved for now, else 0
  double* side = nullptr;            ///< -1 in F, 1 outside
  double* root = nullptr;            ///< A_ii^1/2
  double* inverse_root = nullptr;
  double* least_force = nullptr;  ///< 0 or, of joints, -infinity
  double* correction = nullptr;
  double* cover = nullptr;   ///< of kAlongPath: d, exchanged as b is
  double* exchange[4] = {};  ///< x and y of two pivots
  int* rows = nullptr;
  int* columns = nullptr;
};

/// The kernel of one instruction set.
struct TableauKernel {
  int width;                         ///< of a register
  bool (*solve)(TableauWork* work);  ///< false, with nothing written, unless all of the diagonal is positive
};

bool SolveTableauSse2(TableauWork* work);
bool SolveTableauAvx2(TableauWork* work);
bool SolveTableauAvx512(TableauWork* work);

}  // namespace lcpbench
