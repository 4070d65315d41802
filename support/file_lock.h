#pragma once

#include <string>

namespace lcpbench {

/// An exclusive lock on a file (flock), for one writer of a folder at a time. It ends with the object, or with the
/// process however that ends; programs that the process starts do not inherit it. The file stays, and says who held it
/// last.
class FileLock {
 public:
  /// Creates the file where it is missing, and does not wait.
  /// @throws InputError naming process and host of the holder where there is one; where the file cannot be locked
  explicit FileLock(const std::string& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace lcpbench
