#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <memory>
#include <ostream>
#include <string>

#include "support/text_file.h"

namespace lcpbench {

/// A text file that is read, plain or compressed by gzip (RFC 1952, several members in a row included), whatever its
/// name. The operation that meets damaged data throws; what stands before them is delivered first.
/// Memory: one line, and a block.
class TextInput : public std::istream {
 public:
  /// @param path  - for standard input
  /// @throws InputError where it cannot be opened for reading; later naming the file where compressed data end early or
  ///         are damaged, MemoryRefusal where a line is longer than memory allows
  explicit TextInput(const std::string& path);
  ~TextInput() override;

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
};

/// The lines of a file, see TextInput.
class LineReader {
 public:
  /// @throws as TextInput
  explicit LineReader(const std::string& path);

  /// The next line without its end; false at the end of the file. @throws as TextInput
  bool Next(std::string* line);

  const std::string& name() const { return name_; }  ///< the path, "<stdin>" for -
  std::size_t number() const { return number_; }     ///< of the last line, from 1

 private:
  std::string name_;
  TextInput input_;
  std::size_t number_ = 0;
};

/// A file that is written as by TextOutput, compressed by gzip where its name ends in .gz: without name and time, so
/// that the same text gives the same bytes.
class TextOrGzipOutput {
 public:
  /// @throws as TextOutput, and so do the others
  explicit TextOrGzipOutput(const std::string& path);
  ~TextOrGzipOutput();

  std::ostream& stream();  ///< as TextOutput
  /// Writes; flushes what is not compressed.
  void Write(const std::string& text);
  /// Writes everything; Close() then only gives the file its name.
  void Finish();
  /// As TextOutput, of what is finished.
  void Synchronise() { file_.Synchronise(); }
  void Close();  ///< as TextOutput

 private:
  class Deflation;
  TextOutput file_;
  std::unique_ptr<Deflation> deflation_;  // none: plain
  std::ostream deflated_{nullptr};
};

/// Writes a whole file, whose name ends in .gz, and waits until the disk has it. @throws as TextOutput
void WriteGzipFile(const std::string& path, const std::string& text);

/// Calls `handle(line, "file:line")` for every non-empty line of a file ("-" is standard input), plain or compressed.
/// @throws InputError where the file cannot be read or has no line, and what `handle` throws
void ReadEachLine(const std::string& path,
                  const std::function<void(const std::string& line, const std::string& where)>& handle);

}  // namespace lcpbench
