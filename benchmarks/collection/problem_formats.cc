#include "benchmarks/collection/problem_formats.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cstddef>
#include <iostream>
#include <limits>
#include <set>
#include <utility>

#include "benchmarks/collection/format_program.h"
#include "solvers/io/file_ending.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/matrix_market.h"
#include "solvers/linear_algebra/islands.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/json_field.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

LcpProblem ReadMarket(const std::string& path, const ReadingOptions&) { return ReadMarketProblem(path).problem; }
template <const char* format>
void Write(const LcpProblem& problem, const std::string& path) {
  WriteWithPython(problem, format, path);
}

void WriteJsonLine(const LcpProblem& problem, const std::string& path) {
  TextOrGzipOutput file(path);
  file.Write(FormatLcpRecord(problem) + '\n');
  file.Close();
}

// The other rows alone.
LcpProblem WithoutFrictionRows(const LcpProblem& problem) {
  const Index n = problem.size();
  std::vector<Index> kept;
  for (Index i = 0; i < n; ++i) {
    if (problem.kind(i) != RowKind::kFriction) kept.push_back(i);
  }
  const auto m = static_cast<Index>(kept.size());
  SparseMatrix P(m, n);
  for (Index k = 0; k < m; ++k) P.insert(k, kept[static_cast<std::size_t>(k)]) = 1;
  return problem.WithRows(P, P * problem.b(), BoundsOfRows(problem, kept));
}

constexpr char kHdf5[] = "hdf5", kSiconos[] = "dat", kQps[] = "qps", kNpz[] = "npz";

const std::vector<ProblemFormat>& Formats() {
  static const std::vector<ProblemFormat> formats{{"jsonl", {}, true, nullptr, WriteJsonLine},
                                                  {"mtx", {".mtx"}, true, ReadMarket, WriteMarketProblem},
                                                  {kHdf5, {".hdf5", ".h5"}, false, ReadWithPython, Write<kHdf5>},
                                                  {kSiconos, {".dat"}, true, ReadWithPython, Write<kSiconos>},
                                                  {kQps, {".qps", ".mps"}, true, ReadWithPython, Write<kQps>},
                                                  {kNpz, {".npz"}, false, ReadWithPython, Write<kNpz>}};
  return formats;
}

void Tell(const std::string& text) { std::cerr << "lcpbench: " << Printable(text) << std::endl; }

// Runs `act`; an InputError becomes one line on standard error. @return 0, or 2 then
int TellRefusal(const std::function<void()>& act) {
  try {
    act();
    return 0;
  } catch (const InputError& error) {
    Tell(error.what());
    return kMisuse;
  }
}

// What is refused of one file.
class Refusals {
 public:
  void Add(const std::string& text, const std::string& where) {
    constexpr std::size_t kMostTold = 10;
    const std::string reason = text.starts_with(where) ? text.substr(where.size()) : text;
    if (reasons_.size() < kMostTold && reasons_.insert(reason).second) return Tell(text);
    ++untold_;
  }
  void Close(const std::string& path) const {
    if (untold_ > 0) Tell((path == "-" ? "<stdin>" : path) + ": and " + std::to_string(untold_) + " more");
  }

 private:
  std::set<std::string> reasons_;
  int untold_ = 0;
};

// Hands problems that are read to a handler, those that nearly are symmetric made so, and tells of what was done.
class Taker {
 public:
  Taker(const ReadingOptions& options, const PlacedProblemHandler& handle) : options_(options), handle_(handle) {}

  std::function<void(const std::string& line, const std::string& where)> OfLines() {
    return [this](const std::string& line, const std::string& where) {
      LcpRecord record = ParseLcpRecord(line, where);
      unknown_.insert(record.unknown_members.begin(), record.unknown_members.end());
      Take(std::move(record), where, line);
    };
  }
  void TakeFile(const std::string& path) { Take({ReadProblemFile(path, options_), {}, ""}, path, ""); }

  // Names the unknown members of the file that was read last, in one line on standard error.
  void TellUnknownMembers(const std::string& path) {
    if (unknown_.empty()) return;
    std::cerr << "lcpbench: " << Printable(path == "-" ? "<stdin>" : path)
              << ": warning: ignored members that no problem has: '" << boost::algorithm::join(unknown_, "', '") << "'"
              << std::endl;
    unknown_.clear();
  }
  // How many were made symmetric, in one line on standard error.
  void TellSymmetrized() const {
    if (made_ > 0) std::cerr << "symmetrized: " << made_ << ", of an asymmetry of at most " << most_made_;
    if (left_ > 0) {
      std::cerr << (made_ > 0 ? "; " : "") << "left as they are: " << left_ << ", of an asymmetry of at least "
                << least_left_;
    }
    if (made_ + left_ > 0) std::cerr << std::endl;
  }

 private:
  void Take(LcpRecord record, const std::string& where, const std::string& line) {
    if (options_.without_friction && !record.problem.friction_rows().empty()) {
      record = {WithoutFrictionRows(record.problem), {}, record.category, record.symmetrized};
    }
    const double asymmetry = options_.symmetrize ? record.problem.Asymmetry() : 0;
    if (asymmetry > options_.symmetrize.value_or(0)) {
      ++left_;
      least_left_ = std::min(least_left_, asymmetry);
    } else if (asymmetry > 0) {
      // What is known of the answer is known of the other matrix.
      record = {Symmetrized(record.problem), {}, record.category, std::max(asymmetry, record.symmetrized.value_or(0))};
      ++made_;
      most_made_ = std::max(most_made_, asymmetry);
    }
    handle_(record, where, line);
  }

  const ReadingOptions& options_;
  const PlacedProblemHandler& handle_;
  std::set<std::string> unknown_;
  int made_ = 0, left_ = 0;
  double most_made_ = 0, least_left_ = std::numeric_limits<double>::infinity();
};

}  // namespace

const ProblemFormat& FormatOfFile(const std::string& path) {
  const std::string ending = EndingOf(path).format;
  for (const ProblemFormat& format : Formats()) {
    if (std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end()) return format;
  }
  return Formats().front();
}

const ProblemFormat& UsableFormatOfFile(const std::string& path) {
  const ProblemFormat& format = FormatOfFile(path);
  const FileEnding name = EndingOf(path);
  if (format.is_text || !name.is_gzip) return format;
  throw InputError(path + ": files of " + format.name + " are not compressed by gzip, expected a name like " +
                   IdOfFile(path) + name.format);
}

const ProblemFormat& FormatNamed(const std::string& name) {
  std::vector<std::string> names;
  for (const ProblemFormat& format : Formats()) {
    if (name == format.name) return format;
    names.emplace_back(format.name);
  }
  throw InputError("expected a format of " + boost::algorithm::join(names, ", ") + ", found '" + name + "'");
}

LcpProblem ReadProblemFile(const std::string& path, const ReadingOptions& options) {
  return UsableFormatOfFile(path).read(path, options);
}

int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle) {
  int status = 0;
  for (const std::string& path : files) {
    Refusals refusals;
    bool is_first = true;
    status |= TellRefusal([&] {
      ReadEachLine(path, [&](const std::string& line, const std::string& where) {
        try {
          handle(line, where);
        } catch (const NotJsonError& error) {
          if (is_first) throw InputError(error.what() + std::string("; expected JSON lines, an object on each"));
          refusals.Add(error.what(), where);
          status |= kMisuse;
        } catch (const InputError& error) {
          refusals.Add(error.what(), where);
          status |= kMisuse;
        }
        is_first = false;
      });
    });
    refusals.Close(path);
  }
  return status;
}

int ForEachProblem(const std::vector<std::string>& files, const ReadingOptions& options,
                   const PlacedProblemHandler& handle) {
  int status = 0;
  Taker taker(options, handle);
  for (const std::string& path : files) {
    status |= FormatOfFile(path).is_lines() ? ForEachLine({path}, taker.OfLines())
                                            : TellRefusal([&] { taker.TakeFile(path); });
    taker.TellUnknownMembers(path);
  }
  taker.TellSymmetrized();
  return status;
}

int ForEachProblem(const std::vector<std::string>& files, const ReadingOptions& options,
                   const std::function<void(const LcpRecord& record)>& handle) {
  return ForEachProblem(files, options,
                        [&handle](const LcpRecord& record, const std::string&, const std::string&) { handle(record); });
}

void ReadEachProblem(const std::string& path, const ReadingOptions& options, const PlacedProblemHandler& handle) {
  Taker taker(options, handle);
  if (FormatOfFile(path).is_lines()) {
    ReadEachLine(path, taker.OfLines());
  } else {
    taker.TakeFile(path);
  }
  taker.TellUnknownMembers(path);
  taker.TellSymmetrized();
}

}  // namespace lcpbench
