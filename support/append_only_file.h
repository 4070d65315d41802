#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <sys/types.h>

namespace lcpbench {

/// Hands over every line of a file of JSON lines but a last one that was torn.
/// @param expected  what a line is, for error texts
/// @param take      the line as JSON and as text; for any other line it may throw nlohmann::json::exception, or
///                  InputError with what was found
/// @return bytes of these lines
/// @throws InputError where the file cannot be read, or has another line, naming file and line
std::uintmax_t ReadJsonLines(const std::string& path, const std::string& expected,
                             const std::function<void(const nlohmann::json& line, const std::string& text)>& take);

/// A file of JSON lines that is appended to and never changed: what a campaign has run so far. Every append is written
/// by one call, so that a killed campaign loses at most what was in flight, and a machine that goes down the last two
/// seconds; a last line that was torn is cut off when the file is opened again. Of an append that failed, on a full
/// disk, nothing stays; where the disk does not take what it was given, nothing that it was not known to have.
class AppendOnlyFile {
 public:
  /// Opens or creates the file and hands over every line that it has, as ReadJsonLines.
  /// @throws InputError as ReadJsonLines, and where it cannot be written
  AppendOnlyFile(const std::string& path, const std::string& expected,
                 const std::function<void(const nlohmann::json& line)>& take);
  ~AppendOnlyFile();
  AppendOnlyFile(const AppendOnlyFile&) = delete;
  AppendOnlyFile& operator=(const AppendOnlyFile&) = delete;

  /// @throws OutputError where writing or synchronising fails
  void Append(const std::vector<nlohmann::ordered_json>& lines);
  /// Waits until the disk has all lines. @throws OutputError
  void Synchronise();

 private:
  [[noreturn]] void CutAndFail(off_t size, int error);

  std::string path_;
  int file_ = -1;
  off_t on_disk_ = 0;        // bytes that it has for certain, or had when it was opened
  double synchronised_ = 0;  // when
};

}  // namespace lcpbench
