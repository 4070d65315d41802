#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <ostream>
#include <streambuf>
#include <string>

namespace lcpbench {

/// The whole file. @throws InputError where it cannot be read, or is longer than that [bytes]
std::string ReadTextFile(const std::string& path, std::size_t most_bytes = std::numeric_limits<std::size_t>::max());

/// Removes what a process that was killed left of a TextOutput in a folder that nobody else writes to.
void RemoveUnfinished(const std::string& folder);

/// Writes a whole file as TextOutput does, or to standard output for "-".
/// @throws InputError where it cannot be created, OutputError where it cannot be written to its end
void WriteTextFile(const std::string& path, const std::string& text);

/// Writes to a file descriptor. What fails is thrown once, with its errno, out of the operation on the stream, if the
/// stream's exceptions() have badbit; afterwards nothing more is written.
class DescriptorBuffer : public std::streambuf {
 public:
  DescriptorBuffer(int descriptor, std::string name);

 protected:
  int_type overflow(int_type c) override;
  int sync() override;  ///< @throws OutputError

 private:
  int descriptor_;
  std::string name_;
  std::string block_;
};

/// While it lives, std::cout throws OutputError at the first output that is lost. A standard stream that was closed at
/// the start stays one that fails, whatever is opened.
class CheckedStandardOutput {
 public:
  CheckedStandardOutput();
  ~CheckedStandardOutput();
  CheckedStandardOutput(const CheckedStandardOutput&) = delete;
  CheckedStandardOutput& operator=(const CheckedStandardOutput&) = delete;

 private:
  DescriptorBuffer buffer_;
  std::streambuf* before_;
};

/// A file that is written piece by piece, or standard output for "-". A regular file is written beside its place, as
/// .lcpbench-XXXXXX in the same folder, and takes its place, or that of the file a symbolic link leads to, when it is
/// closed; it has the permissions of the file that it replaces, and may be made of it. One that is not closed leaves
/// nothing, unless the process is killed. Pipes, devices and what is below /dev and /proc are written directly.
class TextOutput {
 public:
  /// @throws InputError where the file cannot be created, OutputError where there is no space for it
  explicit TextOutput(const std::string& path);
  ~TextOutput();
  TextOutput(const TextOutput&) = delete;
  TextOutput& operator=(const TextOutput&) = delete;

  /// Throws OutputError out of the operation that fails.
  std::ostream& stream();
  /// Writes and flushes. @throws OutputError where that fails
  void Write(const std::string& text);
  /// Waits until the disk has a regular file, so that it is complete also after a power failure. @throws OutputError
  void Synchronise();
  /// What was written is complete. @throws OutputError where it cannot be written to its end or not take its place
  void Close();

 private:
  void Open(const std::string& path);

  std::string name_;
  std::string target_;  // "" where the file is written directly
  std::string beside_;  // "" where there is none
  int descriptor_ = -1;
  std::unique_ptr<DescriptorBuffer> buffer_;
  std::ostream file_{nullptr};
};

}  // namespace lcpbench
