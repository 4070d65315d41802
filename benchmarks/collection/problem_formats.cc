#include "benchmarks/collection/problem_formats.h"

#include <algorithm>
#include <filesystem>

#include "benchmarks/collection/gzip_file.h"
#include "solvers/io/fclib_file.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/siconos_text.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

LcpProblem ReadMarket(const std::string& path) { return ReadMarketProblem(path).problem; }
LcpProblem ReadFclib(const std::string& path) { return ReadFclibProblem(path).problem; }

void WriteJsonLine(const LcpProblem& problem, const std::string& path) {
  WriteTextFile(path, FormatLcpRecord(problem) + '\n');
}

const std::vector<ProblemFormat>& Formats() {
  static const std::vector<ProblemFormat> formats{{"jsonl", {}, nullptr, WriteJsonLine},
                                                  {"mtx", {".mtx"}, ReadMarket, WriteMarketProblem},
                                                  {"hdf5", {".hdf5", ".h5"}, ReadFclib, WriteFclibProblem},
                                                  {"dat", {".dat"}, ReadSiconosProblem, WriteSiconosProblem}};
  return formats;
}

}  // namespace

const ProblemFormat& FormatOfFile(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const ProblemFormat& format : Formats()) {
    const auto& extensions = format.extensions;
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) return format;
  }
  return Formats().front();
}

const ProblemFormat& FormatNamed(const std::string& name) {
  std::string names;
  for (const ProblemFormat& format : Formats()) {
    if (name == format.name) return format;
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw InputError("expected a format of " + names + ", found '" + name + "'");
}

int ForEachProblem(const std::vector<std::string>& files, const std::function<void(const LcpRecord& record)>& handle) {
  int status = 0;
  for (const std::string& path : files) {
    if (const auto read = FormatOfFile(path).read) {
      status |= TellRefusal([&] { handle({read(path), {}, ""}); });
    } else {
      status |= ForEachLine(
          {path}, [&](const std::string& line, const std::string& where) { handle(ParseLcpRecord(line, where)); });
    }
  }
  return status;
}

}  // namespace lcpbench
