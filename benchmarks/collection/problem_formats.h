#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/io/json_lines.h"

namespace lcpbench {

/// How problems are read, where a user may choose.
struct ReadingOptions {
  /// What the list p of FCLib's triplets has: "rows-first" (fclib.h) or "columns-first" (Siconos). "": what the ranges
  /// of the indices allow, refused where both fit.
  std::string fclib_triplets;
  /// Friction rows are dropped, in all formats.
  bool without_friction = false;
  /// Both tangents of FCLib's and Siconos' contacts in space are read, a friction row each: a square in the place of
  /// the disc.
  bool box_friction = false;
  /// A whose LcpProblem::Asymmetry() is not 0 and at most this becomes (A + A^T) / 2, dense or sparse as it was.
  std::optional<double> symmetrize;
};

/// A file format of problems: solvers/io/json_lines.h, solvers/io/matrix_market.h, or one of format_program.h.
struct ProblemFormat {
  const char* name;  ///< "jsonl", "mtx", "hdf5", "dat", "qps", "npz"
  /// Endings of its files, in small letters (EndingOf). Files with any other ending, and -, are JSON lines.
  std::vector<std::string_view> endings;
  bool is_text;  ///< may be compressed by gzip, with .gz after the ending
  /// The problem of a file; null of JSON lines, where a file has many.
  /// @throws InputError as the format's reader
  LcpProblem (*read)(const std::string& path, const ReadingOptions& options);
  /// One problem to a file. @throws InputError where the format cannot hold it or it cannot be written
  void (*write)(const LcpProblem& problem, const std::string& path);

  bool is_lines() const { return endings.empty(); }  ///< JSON lines
};

/// By the ending, whatever its case, and with or without .gz behind it.
const ProblemFormat& FormatOfFile(const std::string& path);
/// The same for a file to read or write. @throws InputError for .gz behind the ending of a binary format
const ProblemFormat& UsableFormatOfFile(const std::string& path);
/// @throws InputError for an unknown name
const ProblemFormat& FormatNamed(const std::string& name);

/// The problem of a file of any format but JSON lines.
/// @throws InputError as the format's reader
LcpProblem ReadProblemFile(const std::string& path, const ReadingOptions& options);

/// ReadEachLine (gzip_file.h) for several files, going on after a line or file that is refused with InputError (one
/// line on standard error), so that nothing already computed is lost. A file whose first line is not a JSON object is a
/// wrong one: one line says so, and the rest is not read. In other files each reason is reported once, ten at most,
/// then the number of further lines. @return 0, or 2 when something was refused
int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle);

/// Calls `handle` for every problem of every file, of JSON lines one after the other. What is refused with InputError,
/// by the reader or by `handle`, is reported on standard error as by ForEachLine, and the next problem is taken.
/// Standard error also has how many matrices were symmetrized, and how many not, and for every file of JSON lines which
/// members no problem has (LcpRecord::unknown_members).
/// @return 0, or 2 when something was refused
int ForEachProblem(const std::vector<std::string>& files, const ReadingOptions& options,
                   const std::function<void(const LcpRecord& record)>& handle);
/// The same, also with "file:line" and the line as it stands; of other formats with the file, and "".
using PlacedProblemHandler =
    std::function<void(const LcpRecord& record, const std::string& where, const std::string& line)>;
int ForEachProblem(const std::vector<std::string>& files, const ReadingOptions& options,
                   const PlacedProblemHandler& handle);
/// The problems of one file, as ForEachProblem. @throws InputError for the first that is refused
void ReadEachProblem(const std::string& path, const ReadingOptions& options, const PlacedProblemHandler& handle);

}  // namespace lcpbench
