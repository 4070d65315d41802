#pragma once

#include <fstream>
#include <string>

namespace lcpbench {

/// The whole file. @throws InputError where it cannot be read
std::string ReadTextFile(const std::string& path);

/// Writes a whole file, or to standard output for "-". @throws InputError where it cannot be written
void WriteTextFile(const std::string& path, const std::string& text);

/// A file that is written piece by piece, or standard output for "-".
class TextOutput {
 public:
  /// @throws InputError where the file cannot be written
  explicit TextOutput(const std::string& path);

  std::ostream& stream();
  const std::string& name() const { return name_; }  ///< for texts
  /// Writes and flushes, so that an interrupted run keeps what it has. @throws InputError where that fails
  void Write(const std::string& text);

 private:
  std::string name_;
  std::ofstream file_;
};

}  // namespace lcpbench
