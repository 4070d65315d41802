#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// Writes a new HDF5 file of groups and lists, the same bytes for the same values. Not for several threads at once.
/// Every failure is an InputError `path: cannot be written`.
class Hdf5Writer {
 public:
  /// Takes the place of a file of this name.
  explicit Hdf5Writer(const std::string& path);
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Of a path "/a/b" where "/a" is there.
  void AddGroup(const std::string& group);
  /// A list of 32-bit integers, of a path whose group is there.
  void AddIntegers(const std::string& dataset, const std::vector<int>& values);
  /// A list of `count` 64-bit numbers.
  void AddReals(const std::string& dataset, const double* values, std::size_t count);
  /// One text of fixed length.
  void AddText(const std::string& dataset, const std::string& text);
  /// Only then is everything written.
  void Close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lcpbench
