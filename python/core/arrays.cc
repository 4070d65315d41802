// By NumPy's C interface: reading an argument through __dlpack__ or the buffer protocol takes a tenth of a microsecond
// to a whole one, this some nanoseconds.
#include "python/core/arrays.h"

#include <numpy/arrayobject.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

#include "support/input_error.h"

namespace lcpbench::python {
namespace {

template <typename T>
constexpr int kType = NPY_DOUBLE;
template <>
constexpr int kType<float> = NPY_FLOAT;
template <>
constexpr int kType<std::int32_t> = NPY_INT32;
template <>
constexpr int kType<std::int64_t> = NPY_INT64;
template <>
constexpr int kType<unsigned char> = NPY_UINT8;

PyArrayObject* AsArray(nb::handle value) { return reinterpret_cast<PyArrayObject*>(value.ptr()); }

bool HasType(PyArrayObject* array, int type) {
  const int found = PyArray_TYPE(array);
  return found == type || (type == NPY_INT64 && found == NPY_LONGLONG) || (type == NPY_UINT8 && found == NPY_BOOL);
}

// Takes the message of the Python error that is set, and clears it.
std::string TakePythonError() {
  const nb::python_error error;
  return nb::str(error.value()).c_str();
}

constexpr int kAnyDimensions = -1;

// Masked entries, which are missing, also of arrays in a list. What an array is made of must not have any: NumPy drops
// the mask.
void RequireUnmasked(nb::handle value, const char* name) {
  if (PyArray_CheckExact(value.ptr()) || PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr())) return;
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
    for (const nb::handle item : value) RequireUnmasked(item, name);
  } else if (nb::hasattr(value, "mask") && nb::cast<bool>(nb::module_::import_("numpy.ma").attr("is_masked")(value))) {
    Refuse(name, "has masked entries, expected numbers for all");
  }
}

// A copy, or the array itself where it is of the type and without gaps already.
nb::object Convert(nb::handle value, const char* name, int type, int dimensions, int flags, const char* expected) {
  nb::object array = ToArray(value, name);
  if (dimensions != kAnyDimensions && PyArray_NDIM(AsArray(array)) != dimensions) {
    Refuse(name, std::string("expected ") + expected + ", found " + std::to_string(PyArray_NDIM(AsArray(array))) +
                     " dimensions");
  }
  // An empty list is an array of float64.
  if (PyArray_SIZE(AsArray(array)) == 0 && PyArray_TYPE(AsArray(array)) == NPY_DOUBLE) flags |= NPY_ARRAY_FORCECAST;
  array = nb::steal(PyArray_FromArray(AsArray(array), PyArray_DescrFromType(type), flags));
  if (!array.is_valid()) Refuse(name, std::string("expected ") + expected + ": " + TakePythonError());
  return array;
}

// Integers of T, from wider ones that are in its range.
template <typename T>
nb::object Narrow(nb::handle value, const char* name, int dimensions) {
  const nb::object wide = Convert(value, name, NPY_INT64, dimensions, NPY_ARRAY_CARRAY_RO, "an array of integers");
  T* narrow = nullptr;
  nb::object array = NewVector<T>(PyArray_SIZE(AsArray(wide)), &narrow);
  const auto* numbers = static_cast<const std::int64_t*>(PyArray_DATA(AsArray(wide)));
  for (Index i = 0; i < PyArray_SIZE(AsArray(wide)); ++i) {
    if (!std::in_range<T>(numbers[i])) {
      Refuse(name, "entry " + std::to_string(i) + " is " + std::to_string(numbers[i]) + ", expected at most " +
                       std::to_string(std::numeric_limits<T>::max()));
    }
    narrow[i] = static_cast<T>(numbers[i]);
  }
  return array;
}

template <typename T>
Vector<T> Read(nb::handle value, const char* name, int dimensions) {
  RequireUnmasked(value, name);
  nb::object owner = nb::borrow(value);
  if (!PyArray_Check(value.ptr()) || (dimensions != kAnyDimensions && PyArray_NDIM(AsArray(value)) != dimensions) ||
      !HasType(AsArray(value), kType<T>) || !PyArray_ISCARRAY_RO(AsArray(value))) {
    if constexpr (std::is_integral_v<T> && sizeof(T) < sizeof(std::int64_t)) {
      owner = Narrow<T>(value, name, dimensions);
    } else {
      owner = Convert(value, name, kType<T>, dimensions, NPY_ARRAY_CARRAY_RO,
                      std::is_integral_v<T> ? "an array of integers" : "an array of numbers");
    }
  }
  PyArrayObject* const array = AsArray(owner);
  return {std::move(owner), static_cast<const T*>(PyArray_DATA(array)), PyArray_SIZE(array)};
}

}  // namespace

void Refuse(const char* name, const std::string& what) { throw InputError(std::string(name) + ": " + what); }

template <typename T>
Vector<T> ReadVector(nb::handle value, const char* name) {
  return Read<T>(value, name, 1);
}

template <typename T>
Vector<T> ReadFlat(nb::handle value, const char* name) {
  return Read<T>(value, name, kAnyDimensions);
}

template <typename T>
Vector<T> ReadVector(nb::handle value, const char* name, Index size, const char* what) {
  Vector<T> read = ReadVector<T>(value, name);
  if (read.size != size) {
    Refuse(name, "has " + std::to_string(read.size) + " entries, expected " + what + " = " + std::to_string(size));
  }
  return read;
}

Eigen::VectorXd ReadEigen(nb::handle value, const char* name) {
  const Vector<double> read = ReadVector<double>(value, name);
  return Eigen::Map<const Eigen::VectorXd>(read.data, read.size);
}

DenseMatrix ReadMatrix(nb::handle value, const char* name) {
  RequireUnmasked(value, name);
  nb::object owner = nb::borrow(value);
  const auto is_usable = [](PyArrayObject* array) {
    return PyArray_NDIM(array) == 2 && HasType(array, NPY_DOUBLE) &&
           (PyArray_ISCARRAY_RO(array) || PyArray_ISFARRAY_RO(array));
  };
  if (!PyArray_Check(value.ptr()) || !is_usable(AsArray(value))) {
    owner = Convert(value, name, NPY_DOUBLE, 2, NPY_ARRAY_CARRAY_RO, "a two-dimensional array of numbers");
  }
  PyArrayObject* const array = AsArray(owner);
  return {std::move(owner), static_cast<const double*>(PyArray_DATA(array)), PyArray_DIM(array, 0),
          PyArray_DIM(array, 1), PyArray_IS_F_CONTIGUOUS(array) != 0};
}

double* ReadOutput(nb::handle value, const char* name, Index size) {
  RequireUnmasked(value, name);
  PyArrayObject* const array = AsArray(value);
  if (!PyArray_Check(value.ptr()) || !HasType(array, NPY_DOUBLE) || !PyArray_ISCARRAY(array) ||
      PyArray_SIZE(array) != size) {
    Refuse(name, "expected a writable array of " + std::to_string(size) + " float64 without gaps");
  }
  return static_cast<double*>(PyArray_DATA(array));
}

template <typename T>
nb::object NewVector(Index size, T** data) {
  npy_intp shape = size;
  nb::object array = nb::steal(PyArray_SimpleNew(1, &shape, kType<T>));
  if (!array.is_valid()) throw nb::python_error();
  *data = static_cast<T*>(PyArray_DATA(AsArray(array)));
  return array;
}

nb::object ViewOf(const Eigen::VectorXd& values, nb::handle owner) {
  npy_intp shape = values.size();
  nb::object array = nb::steal(PyArray_New(&PyArray_Type, 1, &shape, NPY_DOUBLE, nullptr,
                                           const_cast<double*>(values.data()), 0, NPY_ARRAY_CARRAY_RO, nullptr));
  if (!array.is_valid()) throw nb::python_error();
  Py_INCREF(owner.ptr());  // which the array takes
  if (PyArray_SetBaseObject(AsArray(array), owner.ptr()) != 0) throw nb::python_error();
  return array;
}

bool IsFloatArray(nb::handle value) { return PyArray_Check(value.ptr()) && PyArray_TYPE(AsArray(value)) == NPY_FLOAT; }

nb::object ToArray(nb::handle value, const char* name) {
  RequireUnmasked(value, name);
  nb::object array = nb::steal(PyArray_FromAny(value.ptr(), nullptr, 0, 0, 0, nullptr));
  if (!array.is_valid()) Refuse(name, "expected an array: " + TakePythonError());
  return array;
}

bool IsArray(nb::handle value) { return PyArray_Check(value.ptr()); }

Vector<unsigned char> ReadBilateral(nb::handle value, Index n) {
  if (value.is_none()) return {};
  if (PyArray_CheckExact(value.ptr()) && PyArray_TYPE(AsArray(value)) == NPY_BOOL) {
    return ReadVector<unsigned char>(value, "bilateral", n, "n");
  }
  const nb::object given = ToArray(value, "bilateral");
  if (PyArray_TYPE(AsArray(given)) == NPY_BOOL) return ReadVector<unsigned char>(given, "bilateral", n, "n");
  const auto rows = ReadVector<std::int64_t>(given, "bilateral");
  unsigned char* mask = nullptr;
  Vector<unsigned char> read{NewVector(n, &mask), nullptr, n};
  read.data = mask;
  std::fill_n(mask, n, 0);
  const RowBounds bounds = RowBounds::WithBilateralRows(n, {rows.data, rows.data + rows.size});
  std::copy(bounds.bilateral.begin(), bounds.bilateral.end(), mask);
  return read;
}

double ReadNumber(nb::handle value, const char* name, double if_none) {
  if (value.is_none()) return if_none;
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1 && PyErr_Occurred() != nullptr) Refuse(name, "expected a number: " + TakePythonError());
  return number;
}

void ImportNumpy() {
  if (PyArray_ImportNumPyAPI() < 0) throw nb::python_error();
}

template Vector<double> ReadVector(nb::handle value, const char* name);
template Vector<std::int32_t> ReadVector(nb::handle value, const char* name);
template Vector<std::int64_t> ReadVector(nb::handle value, const char* name);
template Vector<unsigned char> ReadVector(nb::handle value, const char* name);
template Vector<double> ReadVector(nb::handle value, const char* name, Index size, const char* what);
template Vector<std::int32_t> ReadVector(nb::handle value, const char* name, Index size, const char* what);
template Vector<std::int64_t> ReadVector(nb::handle value, const char* name, Index size, const char* what);
template Vector<unsigned char> ReadVector(nb::handle value, const char* name, Index size, const char* what);
template Vector<double> ReadFlat(nb::handle value, const char* name);
template Vector<float> ReadFlat(nb::handle value, const char* name);
template Vector<std::int32_t> ReadFlat(nb::handle value, const char* name);
template nb::object NewVector(Index size, double** data);
template nb::object NewVector(Index size, std::int32_t** data);
template nb::object NewVector(Index size, std::int64_t** data);
template nb::object NewVector(Index size, unsigned char** data);

}  // namespace lcpbench::python
