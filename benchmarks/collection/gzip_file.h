#pragma once

#include <zlib.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// The lines of a file, plain or compressed by gzip (RFC 1952, several members in a row included).
class LineReader {
 public:
  /// @param path  - for standard input
  /// @throws InputError where it cannot be opened for reading
  explicit LineReader(const std::string& path);

  /// The next line without its end; false at the end of the file.
  /// @throws InputError naming the file where compressed data end early or are damaged, MemoryRefusal where a line is
  ///         longer than memory allows; lines before are given first
  bool Next(std::string* line);

  const std::string& name() const { return name_; }
  std::size_t number() const { return number_; }  ///< of the last line, from 1

 private:
  bool Fill();

  std::string name_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
  std::vector<char> block_;
  std::size_t at_ = 0;
  std::size_t end_ = 0;
  std::size_t number_ = 0;
};

/// Writes `text` compressed by gzip, without name and time: the same text gives the same bytes.
/// As WriteTextFile, with its errors
void WriteGzipFile(const std::string& path, const std::string& text);

/// Calls `handle(line, "file:line")` for every non-empty line of a file ("-" is standard input), plain or compressed.
/// @throws InputError where the file cannot be read or has no line, and what `handle` throws
void ReadEachLine(const std::string& path,
                  const std::function<void(const std::string& line, const std::string& where)>& handle);

/// Runs `act`; what it refuses with InputError is told on standard error, in one line, if `aloud`. @return 0, or 2 then
int TellRefusal(const std::function<void()>& act, bool aloud = true);

/// ReadEachLine for several files, going on after a line or file that is refused (TellRefusal), so that nothing already
/// computed is lost. Of a file at most ten refused lines are told, then how many more there are. @return 0, or 2 when
/// something was refused
int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle);

}  // namespace lcpbench
