#include "benchmarks/collection/problem_formats.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/collection/npz_file.h"
#include "solvers/io/fclib_file.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/qps_text.h"
#include "solvers/io/siconos_text.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

LcpProblem ReadMarket(const std::string& path, const ReadingOptions&) { return ReadMarketProblem(path).problem; }
LcpProblem ReadFclib(const std::string& path, const ReadingOptions& options) {
  return ReadFclibProblem(path, {options.fclib_triplets, options.without_friction}).problem;
}
LcpProblem ReadSiconos(const std::string& path, const ReadingOptions& options) {
  return ReadSiconosProblem(path, options.without_friction);
}

void WriteJsonLine(const LcpProblem& problem, const std::string& path) {
  WriteTextFile(path, FormatLcpRecord(problem) + '\n');
}

const std::vector<ProblemFormat>& Formats() {
  static const std::vector<ProblemFormat> formats{{"jsonl", {}, nullptr, WriteJsonLine},
                                                  {"mtx", {".mtx"}, ReadMarket, WriteMarketProblem},
                                                  {"hdf5", {".hdf5", ".h5"}, ReadFclib, WriteFclibProblem},
                                                  {"dat", {".dat"}, ReadSiconos, WriteSiconosProblem},
                                                  {"qps", {".qps", ".mps"}, nullptr, WriteQpsProblem},
                                                  {"npz", {".npz"}, nullptr, WriteNpzProblem}};
  return formats;
}

// With (A + A^T) / 2, symmetric bit for bit, of a problem without factors. Nothing else is proved of it any more.
LcpProblem Symmetrized(const LcpProblem& problem) {
  MatrixFacts facts;
  facts.symmetric = true;
  // Halves first, so that nothing overflows.
  if (problem.given_form() == MatrixForm::kDense) {
    const Eigen::MatrixXd& A = problem.DenseA();
    return LcpProblem::FromDense(problem.id(), 0.5 * A + 0.5 * A.transpose(), problem.b(), problem.bounds(), facts);
  }
  const SparseMatrix& A = problem.SparseA();
  const SparseMatrix turned = A.transpose();
  return LcpProblem::FromSparse(problem.id(), 0.5 * A + 0.5 * turned, problem.b(), problem.bounds(), facts);
}

// Makes matrices symmetric that nearly are, and tells of how many.
class Symmetrizer {
 public:
  explicit Symmetrizer(std::optional<double> bound) : bound_(bound) {}

  void Take(LcpRecord* record) {
    const double asymmetry = bound_ ? record->problem.Asymmetry() : 0;
    if (asymmetry == 0) return;
    if (asymmetry > *bound_) {
      ++left_;
      least_left_ = std::min(least_left_, asymmetry);
      return;
    }
    // What is known of the answer is known of the other matrix.
    *record = {
        Symmetrized(record->problem), {}, record->category, std::max(asymmetry, record->symmetrized.value_or(0))};
    ++made_;
    most_made_ = std::max(most_made_, asymmetry);
  }
  // In one line on standard error.
  void Tell() const {
    if (made_ > 0) std::cerr << "symmetrized: " << made_ << ", of an asymmetry of at most " << most_made_;
    if (left_ > 0) {
      std::cerr << (made_ > 0 ? "; " : "") << "left as they are: " << left_ << ", of an asymmetry of at least "
                << least_left_;
    }
    if (made_ + left_ > 0) std::cerr << std::endl;
  }

 private:
  std::optional<double> bound_;
  int made_ = 0, left_ = 0;
  double most_made_ = 0, least_left_ = std::numeric_limits<double>::infinity();
};

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

int ForEachProblem(const std::vector<std::string>& files, const ReadingOptions& options,
                   const std::function<void(const LcpRecord& record)>& handle) {
  int status = 0;
  Symmetrizer symmetrizer(options.symmetrize);
  const auto take = [&](LcpRecord record) {
    symmetrizer.Take(&record);
    handle(record);
  };
  for (const std::string& path : files) {
    const ProblemFormat& format = FormatOfFile(path);
    if (!format.is_lines()) {
      status |= TellRefusal([&] {
        if (format.read == nullptr) throw InputError(path + ": files of " + format.name + " are written, not read");
        take({format.read(path, options), {}, ""});
      });
    } else {
      status |= ForEachLine(
          {path}, [&](const std::string& line, const std::string& where) { take(ParseLcpRecord(line, where)); });
    }
  }
  symmetrizer.Tell();
  return status;
}

}  // namespace lcpbench
