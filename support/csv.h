#pragma once

#include <fstream>
#include <string>
#include <vector>

namespace lcpbench {

/// A CSV file (RFC 4180 quoting) written row by row and flushed after each, so that an interrupted run keeps its rows.
class CsvWriter {
 public:
  /// @throws InputError when the file cannot be written
  CsvWriter(const std::string& path, const std::vector<std::string>& columns);

  /// @throws OutputError where it cannot be written
  void Row(const std::vector<std::string>& cells);

  static std::string Cell(double value);  ///< shortest text that reads back to the same double; "inf", "nan"
  static std::string Cell(bool value) { return value ? "true" : "false"; }

 private:
  std::string path_;
  std::ofstream file_;
  std::size_t columns_;
};

}  // namespace lcpbench
