#pragma once

#include <Eigen/SparseCore>
#include <bit>
#include <cstdint>
#include <span>
#include <string>

namespace lcpbench {

/// What is wrong with the places where the rows of a compressed matrix begin, "starts[2] is 4, less than the 5 before
/// it"; "" where the first is 0, none is less than the one before it and the last is `end`.  O(starts)
/// @param starts    one number more than there are rows
/// @param name      of the array, for the message
/// @param end_name  what `end` is: "entries"
std::string WhyNotStarts(std::span<const int> starts, std::int64_t end, const char* name, const char* end_name);

/// What is wrong with the columns of a compressed matrix, "indices[4] is 3, expected a column in [0, 3)"; "" where all
/// are in [0, columns) and, within a row, ascend.  O(indices)
/// @param starts  for which WhyNotStarts found nothing
std::string WhyNotColumns(std::span<const int> starts, std::span<const int> indices, std::int64_t columns,
                          const char* name);

/// Whether every row of J holds all entries of two bodies of p columns each, as scenes have them: its values are a
/// StepRows::J then, and body[2 i], body[2 i + 1] are those of row i; -1 for a body whose inverse masses are all 0.
/// Else `body` is written in part.  O(n p)
/// @param starts, indices  of J, in any order and range
/// @param inverse_mass     a number a column
/// @param p                3 or 6, else no row is such a one
/// @param body             room for two numbers a row
bool FindTwoBodies(std::span<const int> starts, std::span<const int> indices, std::span<const double> inverse_mass,
                   int p, std::int32_t* body);
/// The same for one row by its 2 p columns, of J with so many.
template <int p>
bool FindTwoBodiesOfRow(const int* column, std::int64_t columns, const double* inverse_mass, std::int32_t* body) {
  const int first = column[0] / p, second = column[p] / p;
  if (column[0] < 0 || second <= first || column[p] > columns - p) return false;
  int differences = 0;
  for (int c = 0; c < p; ++c) differences |= (column[c] ^ (first * p + c)) | (column[p + c] ^ (second * p + c));
  if (differences != 0) return false;
  std::uint64_t of_first = 0, of_second = 0;  // bits of what is not 0, but for the sign of -0.0
  for (int c = 0; c < p; ++c) {
    of_first |= std::bit_cast<std::uint64_t>(inverse_mass[first * p + c]);
    of_second |= std::bit_cast<std::uint64_t>(inverse_mass[second * p + c]);
  }
  body[0] = of_first << 1U != 0 ? first : -1;
  body[1] = of_second << 1U != 0 ? second : -1;
  return true;
}

/// A compressed matrix as a caller's arrays hold it, by rows (CSR) or by columns (CSC).
struct CompressedArrays {
  Eigen::Index rows = 0;           ///< of the matrix
  Eigen::Index columns = 0;        ///< of the matrix
  bool by_columns = false;         ///< CSC
  std::span<const int> starts;     ///< a number for every row (or column) and one more
  std::span<const int> indices;    ///< the columns (or rows) of the entries, in any order within a row (or column)
  std::span<const double> values;  ///< the entries, as many as `indices`
  bool adds_parts = false;         ///< an entry may be stored in parts, as SciPy has it: it is their sum
};

/// The same matrix as a SparseMatrix (problem.h), each array copied once where it is by rows whose columns ascend.
/// O(rows + columns + entries)
/// @param name  of the matrix, for messages
/// @throws InputError naming the array, the place, what was expected and what was found: starts that do not fit,
///         indices out of range or, unless parts are added, twice in one row, numbers that are not finite
Eigen::SparseMatrix<double, Eigen::RowMajor, int> ToSparseMatrix(const CompressedArrays& arrays, const char* name);

/// Copies each array once, with room for no more: Eigen's assignment would keep it for up to twice the entries.
void CopyRows(const Eigen::Ref<const Eigen::SparseMatrix<double, Eigen::RowMajor, int>>& from,
              Eigen::SparseMatrix<double, Eigen::RowMajor, int>* to);

}  // namespace lcpbench
