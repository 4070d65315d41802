#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/first_order/sweeps/scaled_rows.h"
#include "solvers/linear_algebra/sides_of_bodies.h"
#include "solvers/rows/kernel.h"
#include "solvers/rows/matrix_arrays.h"

namespace lcpbench {

/// L D L^T of A_FF + diag(shift), F the active rows of a symmetric A, which is stored by rows from its first nonzero to
/// the diagonal (its profile); the factor stays within that of the rows of F, which are packed [Jennings 1966]. A pivot
/// that is rounding (below tableau::kLeastPivot of A_ii) leaves its row out: its x is 0.
///
/// Cost: a factorization takes the sum of squared column heights of the profile. Only Reserve allocates.
class ProfileFactor {
 public:
  /// Numbers of the profile per row that room is made for, on average, unless asked for more.
  static constexpr Index kMostProfile = 256;
  /// A shift that holds a singular A_FF up and leaves little in w, in units of A_ii.
  static constexpr double kShift = 1e-9;

  /// @throws InputError if this machine lacks the instructions
  explicit ProfileFactor(InstructionSet instructions = InstructionSet::kBest) : kernel_(FindRowsKernel(instructions)) {}

  /// For matrices of up to `max_rows` rows, with profiles of up to `profile` numbers, rows filled up to whole
  /// registers.
  void Reserve(Index max_rows, Index profile);
  void Reserve(Index max_rows) { Reserve(max_rows, kMostProfile * max_rows); }

  /// A as it is given; makes room for it.
  void Take(const MatrixArrays& A);
  /// A~ = G G^T, by the rows that bodies share. False where the profile is more than there is room for.
  bool FindProfile(const ScaledRows& rows);
  void Assemble(const ScaledRows& rows);
  /// What a factorization with all rows active costs, in processor cycles, roughly.
  double cost() const { return cost_; }

  /// @param is_active  n, 1 for the rows of F
  /// @param shift      added to the diagonal, >= 0; with `more`, n numbers, unless it is nullptr
  /// @returns whether no row was left out
  bool Factorize(const unsigned char* is_active, double shift, const double* more);
  /// x_F := (A_FF + diag(shift))^-1 x_F; other entries are left as they are.
  void Solve(double* x);

 private:
  // Where the rows of a lower triangle stand.
  struct Profile {
    std::vector<std::int32_t> first, last_below;  // by row: its first column, the lowest row that reaches its column
    std::vector<std::int64_t> begin;              // where column 0 of it would stand, in whole registers from there on
    void Reserve(Index max_rows);
    Index LayOut(Index n);
  };

  double* row_of_L(Index a) { return L_.data() + of_L_.begin[static_cast<std::size_t>(a)]; }
  double* row(Index i) { return A_.data() + of_A_.begin[static_cast<std::size_t>(i)]; }  // by column, to the diagonal
  template <typename First>
  bool LayOut(Index n, const First& first);
  void Clear();  // A = 0
  template <Index p>
  void AssembleOf(const ScaledRows& rows);
  void Pack(const unsigned char* is_active, double shift, const double* more);
  ProfileWork Work();

  const RowsKernel& kernel_;
  Index n_ = 0, m_ = 0;  // rows of A, of F
  double cost_ = 0;
  Profile of_A_, of_L_;
  std::vector<std::int32_t> rows_, place_;       // F; by row how many rows of F come before
  std::vector<std::int32_t> first_row_;          // by body
  Eigen::VectorXd A_, L_, columns_, floor_, y_;  // columns_: of a panel, L D; floor_: least pivots; y_: x_F
  SidesOfBodies sides_;                          // of the rows that Assemble has been through
};

}  // namespace lcpbench
