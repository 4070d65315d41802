#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/io/json_lines.h"

namespace lcpbench {

/// A file format of problems: json_lines.h, matrix_market.h, fclib_file.h or siconos_text.h.
struct ProblemFormat {
  const char* name;                          ///< "jsonl", "mtx", "hdf5", "dat"
  std::vector<std::string_view> extensions;  ///< of its files; JSON lines have any other, and - for standard input
  /// The problem of a file; null of JSON lines, where a file has many. @throws InputError as the format's reader
  LcpProblem (*read)(const std::string& path);
  /// One problem to a file. @throws InputError where the format cannot hold it or it cannot be written
  void (*write)(const LcpProblem& problem, const std::string& path);
};

/// By the extension.
const ProblemFormat& FormatOfFile(const std::string& path);
/// @throws InputError for an unknown name
const ProblemFormat& FormatNamed(const std::string& name);

/// Calls `handle` for every problem of every file, of JSON lines one after the other. What is refused with InputError,
/// by the reader or by `handle`, is told on standard error, one line each, and the next problem is taken.
/// @return 0, or 2 when something was refused
int ForEachProblem(const std::vector<std::string>& files, const std::function<void(const LcpRecord& record)>& handle);

}  // namespace lcpbench
