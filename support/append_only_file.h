#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lcpbench {

/// A file of JSON lines that is appended to and never changed: what a campaign has run so far. Every append is written
/// by one call, so that a killed campaign loses at most what was in flight, and a machine that goes down the last two
/// seconds; a last line that was torn is cut off when the file is opened again.
class AppendOnlyFile {
 public:
  /// Opens or creates the file and hands over every line that it has.
  /// @param expected  what a line is, for error texts
  /// @param take      may throw nlohmann::json::exception for what is no such line
  /// @throws InputError where it cannot be written, or has another line, naming file and line
  AppendOnlyFile(const std::string& path, const std::string& expected,
                 const std::function<void(const nlohmann::json& line)>& take);
  ~AppendOnlyFile();
  AppendOnlyFile(const AppendOnlyFile&) = delete;
  AppendOnlyFile& operator=(const AppendOnlyFile&) = delete;

  /// @throws InputError where writing fails
  void Append(const std::vector<nlohmann::ordered_json>& lines);

 private:
  std::string path_;
  int file_ = -1;
  double synchronised_ = 0;  // with the disk, when
};

}  // namespace lcpbench
