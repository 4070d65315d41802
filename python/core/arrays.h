#pragma once

#include <nanobind/nanobind.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench::python {

namespace nb = nanobind;

/// Refuses an argument: a ValueError "NAME: WHAT".
/// @throws InputError
[[noreturn]] void Refuse(const char* name, const std::string& what);

/// A one-dimensional argument: the caller's own memory where that is an array of T without gaps, else a copy. `owner`
/// keeps it alive.
template <typename T>
struct Vector {
  nb::object owner;
  const T* data = nullptr;
  Index size = 0;
};

/// T: double, std::int32_t, std::int64_t or unsigned char (a mask of bool).
/// @param value  an array, or what NumPy makes one of without losing digits; integers of any width within T's range.
///               Masked arrays must not have masked entries
/// @throws InputError naming the argument
template <typename T>
Vector<T> ReadVector(nb::handle value, const char* name);

/// As ReadVector, with the number of entries that it must have.
/// @param what  the number in words: "n"
template <typename T>
Vector<T> ReadVector(nb::handle value, const char* name, Index size, const char* what);

/// As ReadVector, of an array of any shape, in the order C. T: also float.
template <typename T>
Vector<T> ReadFlat(nb::handle value, const char* name);

/// As ReadVector<double>, as an Eigen vector of its own.
Eigen::VectorXd ReadEigen(nb::handle value, const char* name);

/// A two-dimensional argument without gaps: the caller's own memory, whatever its order, else a copy.
struct DenseMatrix {
  nb::object owner;
  const double* data = nullptr;
  Index rows = 0, columns = 0;
  bool by_columns = false;  ///< order F; both orders where a matrix has one row or column
};
/// @throws InputError naming the argument
DenseMatrix ReadMatrix(nb::handle value, const char* name);

/// The memory of an array that a result is written to: float64, without gaps, writable, of `size` entries.
/// @throws InputError naming the argument
double* ReadOutput(nb::handle value, const char* name, Index size);

/// A new array of `size` float64 (or of T), not initialised; `data` is its memory.
template <typename T>
nb::object NewVector(Index size, T** data);

/// A read-only array that shows the memory of `owner`, which it keeps alive.
nb::object ViewOf(const Eigen::VectorXd& values, nb::handle owner);

/// What NumPy makes of an argument: the array itself, or a new one.
/// @throws InputError naming the argument
nb::object ToArray(nb::handle value, const char* name);
/// Whether an argument is an array of NumPy's.
bool IsArray(nb::handle value);
/// Whether it is one of float32.
bool IsFloatArray(nb::handle value);
/// Rows that are bilateral, as a mask: the caller's own where that is an array of n bool; else of integers, which are
/// rows. None: nothing, without data.
/// @throws InputError naming the argument
Vector<unsigned char> ReadBilateral(nb::handle value, Index n);

/// A number. None: `if_none`.
/// @throws InputError naming the argument
double ReadNumber(nb::handle value, const char* name, double if_none);

/// To be called once, before all others: loads NumPy.
void ImportNumpy();

}  // namespace lcpbench::python
