#pragma once

#include <string>
#include <vector>

#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"

namespace lcpbench {

/// All problems of a file, one a line.
inline std::vector<LcpRecord> ReadLcpFile(const std::string& path) {
  std::vector<LcpRecord> records;
  ReadEachLine(
      path, [&](const std::string& line, const std::string& where) { records.push_back(ParseLcpRecord(line, where)); });
  return records;
}

/// Problems of tests/data/reports.
inline std::vector<LcpProblem> ReportedProblems(const std::string& name) {
  std::vector<LcpProblem> problems;
  for (const LcpRecord& record : ReadLcpFile(LCPBENCH_SOURCE_DIR "/tests/data/reports/" + name + ".jsonl")) {
    problems.push_back(record.problem);
  }
  return problems;
}

}  // namespace lcpbench
