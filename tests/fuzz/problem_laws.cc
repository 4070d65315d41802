#include "tests/fuzz/problem_laws.h"

#include <algorithm>
#include <cstring>
#include <sstream>

#include "solvers/lcp/input_error.h"
#include "solvers/lcp/json_lines.h"
#include "solvers/lcp/matrix_market.h"

namespace lcpbench {
namespace {

constexpr char kPlace[] = "file:1";
// Matrices of more rows are read, and not made: memory for empty rows is the caller's affair.
constexpr Index kMostRows = 100'000;

std::string LawOfErrors(const InputError& error, const std::string& beginning) {
  const std::string text = error.what();
  if (text.find('\n') != std::string::npos) return "an error of several lines: " + text;
  return text.rfind(beginning, 0) == 0 ? "" : "an error that does not begin with its place: " + text;
}

bool SameBits(const double* a, const double* b, Index n) {
  return n == 0 || std::memcmp(a, b, sizeof(double) * static_cast<size_t>(n)) == 0;
}

bool Same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && SameBits(a.data(), b.data(), a.size());
}

bool Same(const SparseMatrix& a, const SparseMatrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.rows() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         SameBits(a.valuePtr(), b.valuePtr(), a.nonZeros());
}

}  // namespace

std::string BrokenJsonLineLaw(const std::string& text) {
  std::string written;
  try {
    const LcpRecord record = ParseLcpRecord(text, kPlace);
    const LcpProblem& problem = record.problem;
    if (!problem.b().allFinite()) return "b is not finite";
    written = FormatLcpRecord(problem);
    const LcpProblem back = ParseLcpRecord(written, kPlace).problem;
    if (back.has_factors() != problem.has_factors()) return "another form";
    if (!Same(back.b(), problem.b())) return "another b";
    if (back.bilateral_rows() != problem.bilateral_rows()) return "other bilateral rows";
    if (problem.has_factors()) {
      if (!Same(back.inverse_mass(), problem.inverse_mass()) || !Same(back.J(), problem.J())) return "other factors";
    } else if (!Same(back.SparseA(), problem.SparseA())) {
      return "another A";
    }
  } catch (const InputError& error) {
    if (!written.empty()) return std::string("what was written is refused: ") + error.what();
    return LawOfErrors(error, kPlace);
  }
  return {};
}

std::string BrokenMatrixMarketLaw(const std::string& text) {
  std::stringstream written;
  bool is_written = false;
  try {
    std::istringstream input(text);
    const MarketMatrix matrix = ReadMarketMatrix(input, "file");
    if (matrix.rows > kMostRows) return {};
    const SparseMatrix sparse = matrix.ToSparse();
    WriteMarketMatrix(sparse, written);
    is_written = true;
    if (!Same(ReadMarketMatrix(written, "file").ToSparse(), sparse)) return "another matrix";
  } catch (const InputError& error) {
    if (is_written) return std::string("what was written is refused: ") + error.what();
    return LawOfErrors(error, "file:");
  }
  return {};
}

}  // namespace lcpbench
