#include "benchmarks/collection/problem_formats.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "benchmarks/collection/gzip_file.h"
#include "solvers/io/fclib_file.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/siconos_text.h"
#include "support/exit_status.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

LcpProblem ReadMarket(const std::string& path) { return ReadMarketProblem(path).problem; }
LcpProblem ReadFclib(const std::string& path) { return ReadFclibProblem(path).problem; }

void WriteJsonLine(const LcpProblem& problem, const std::string& path) {
  std::ofstream file(path);
  if (file) file << FormatLcpRecord(problem) << '\n';
  file.close();
  if (!file) throw InputError(path + ": cannot be written");
}

struct Format {
  ProblemFormat format;
  const char* name;
  std::vector<std::string> extensions;
  LcpProblem (*read)(const std::string& path);  // of one problem; null where a file has many
  void (*write)(const LcpProblem& problem, const std::string& path);
};

const std::array<Format, 4>& Formats() {
  static const std::array<Format, 4> formats{
      Format{ProblemFormat::kJsonLines, "jsonl", {}, nullptr, WriteJsonLine},
      {ProblemFormat::kMatrixMarket, "mtx", {".mtx"}, ReadMarket, WriteMarketProblem},
      {ProblemFormat::kFclib, "hdf5", {".hdf5", ".h5"}, ReadFclib, WriteFclibProblem},
      {ProblemFormat::kSiconos, "dat", {".dat"}, ReadSiconosProblem, WriteSiconosProblem}};
  return formats;
}

const Format& Of(ProblemFormat format) {
  return *std::find_if(Formats().begin(), Formats().end(), [&](const Format& each) { return each.format == format; });
}

}  // namespace

ProblemFormat FormatOfFile(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const Format& format : Formats()) {
    const auto& extensions = format.extensions;
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) return format.format;
  }
  return ProblemFormat::kJsonLines;
}

std::string NameOf(ProblemFormat format) { return Of(format).name; }

ProblemFormat FormatNamed(const std::string& name) {
  std::string names;
  for (const Format& format : Formats()) {
    if (name == format.name) return format.format;
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw InputError("expected a format of " + names + ", found '" + name + "'");
}

int ForEachProblem(const std::vector<std::string>& files, const std::function<void(const LcpRecord& record)>& handle) {
  int status = 0;
  for (const std::string& path : files) {
    const Format& format = Of(FormatOfFile(path));
    if (format.read == nullptr) {
      const int read = ForEachLine(
          {path}, [&](const std::string& line, const std::string& where) { handle(ParseLcpRecord(line, where)); });
      status = std::max(status, read);
      continue;
    }
    try {
      handle({format.read(path), {}, ""});
    } catch (const InputError& error) {
      std::cerr << "lcpbench: " << error.what() << std::endl;
      status = kMisuse;
    }
  }
  return status;
}

LcpProblem ReadProblemFile(const std::string& path) {
  const Format& format = Of(FormatOfFile(path));
  if (format.read == nullptr) throw InputError(path + ": expected a file of one problem, found JSON lines");
  return format.read(path);
}

void WriteProblemFile(const LcpProblem& problem, const std::string& path, ProblemFormat format) {
  Of(format).write(problem, path);
}

}  // namespace lcpbench
