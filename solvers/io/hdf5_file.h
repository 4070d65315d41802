#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// The types of datasets that are read.
enum class Hdf5Kind { kIntegers, kReals, kText };

/// A dataset that the caller wants.
struct Hdf5Request {
  std::string path;                  ///< of the dataset in the file, "/group/name"
  Hdf5Kind kind = Hdf5Kind::kReals;  ///< a dataset of another type is refused
};

/// A dataset of rank 0 or 1: 32-bit integers, 64-bit IEEE numbers, or one text of fixed length.
struct Hdf5Dataset {
  std::vector<int> integers;  ///< of kIntegers, else empty
  std::vector<double> reals;  ///< of kReals, else empty
  std::string text;           ///< of kText, else ""
};

/// Those of the requested datasets that the file holds, by their paths.
///
/// libhdf5 was not made for files that wish it ill: it crashes on some, and allocates what others promise. So it runs
/// in a forked child, which may open no other file, write none, and whose memory and processor time are limited in
/// proportion to the file's size (memory not under sanitizers, which reserve more than any limit); datasets come back
/// through a pipe. All of them together take no more memory than the file, whatever it promises. The child runs
/// libhdf5 after fork without exec, so that where other threads use libhdf5 themselves at that moment (its builds
/// without thread safety do not allow that anyhow) the child may fail or, until its time is up, hang; the caller's
/// memory is safe.
/// Refused are datasets of other types or ranks, in chunks, compressed, virtual or stored in other files, links that
/// are not hard, and datasets whose values the file does not hold.
/// @throws InputError `path: ...` naming the dataset, what was expected and what was found; also where the file cannot
/// be opened, is none, or ends the child
std::map<std::string, Hdf5Dataset> ReadHdf5(const std::string& path, const std::vector<Hdf5Request>& requests);

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
