#pragma once

#include <string>

#include "benchmarks/collection/problem_formats.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

// Formats that the Python package lcpbench.formats (python/lcpbench/formats) reads and writes: a program beside the
// command, which is started for the first file and goes on until the command ends. Problems go both ways as JSON lines,
// bit for bit. What the program does with hostile files: python/lcpbench/formats/program.py. Not for several threads.

/// Reads a file of FCLib (.hdf5, .h5), Siconos (.dat), QPS or npz.
/// @throws InputError naming file, line or field, what was expected and what was found; also where the program cannot
/// be started
LcpProblem ReadWithPython(const std::string& path, const ReadingOptions& options);

/// The same problem gives the same bytes.
/// @param format  "hdf5", "dat", "qps" or "npz"
/// @throws InputError where the format cannot hold the problem, and as TextOrGzipOutput
void WriteWithPython(const LcpProblem& problem, const std::string& format, const std::string& path);

}  // namespace lcpbench
