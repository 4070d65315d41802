#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solvers/io/json_lines.h"

namespace lcpbench {

/// The file formats of problems.
enum class ProblemFormat {
  kJsonLines,     ///< json_lines.h; any other extension, and - for standard input or output
  kMatrixMarket,  ///< matrix_market.h; .mtx
  kFclib,         ///< fclib_file.h; .hdf5, .h5
  kSiconos,       ///< siconos_text.h; .dat
};

/// By the extension.
ProblemFormat FormatOfFile(const std::string& path);

/// "jsonl", "mtx", "hdf5" and "dat", also the extensions that files of these formats are given.
std::string NameOf(ProblemFormat format);
/// @throws InputError for another name
ProblemFormat FormatNamed(const std::string& name);

/// Calls `handle` for every problem of every file, of JSON lines one after the other. What is refused with InputError,
/// by the reader or by `handle`, is told on standard error, one line each, and the next problem is taken.
/// @return 0, or 2 when something was refused
int ForEachProblem(const std::vector<std::string>& files, const std::function<void(const LcpRecord& record)>& handle);

/// The problem of a file of any format but JSON lines. @throws InputError as the format's reader
LcpProblem ReadProblemFile(const std::string& path);

/// One problem to a file of this format. @throws InputError where the format cannot hold it or it cannot be written
void WriteProblemFile(const LcpProblem& problem, const std::string& path, ProblemFormat format);

}  // namespace lcpbench
