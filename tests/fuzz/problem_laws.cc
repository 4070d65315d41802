#include "tests/fuzz/problem_laws.h"

#include <sstream>

#include "solvers/io/json_lines.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/siconos_text.h"
#include "support/input_error.h"
#include "tests/fuzz/error_law.h"
#include "tests/solvers/lcp/same_problem.h"

namespace lcpbench {
namespace {

constexpr char kPlace[] = "file:1";
// Matrices of more rows are read, and not made: memory for empty rows is the caller's affair.
constexpr Index kMostRows = 100'000;

}  // namespace

std::string BrokenJsonLineLaw(const std::string& text) {
  std::string written;
  try {
    const LcpRecord record = ParseLcpRecord(text, kPlace);
    const LcpProblem& problem = record.problem;
    if (!problem.b().allFinite()) return "b is not finite";
    written = FormatLcpRecord(problem);
    const std::string difference = DifferenceOfProblems(ParseLcpRecord(written, kPlace).problem, problem);
    if (!difference.empty()) return difference;
  } catch (const InputError& error) {
    if (!written.empty()) return std::string("what was written is refused: ") + error.what();
    return BrokenErrorLaw(error.what(), kPlace);
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
    if (!SameBits(ReadMarketMatrix(written, "file").ToSparse(), sparse)) return "another matrix";
  } catch (const InputError& error) {
    if (is_written) return std::string("what was written is refused: ") + error.what();
    return BrokenErrorLaw(error.what(), "file:");
  }
  return {};
}

std::string BrokenSiconosLaw(const std::string& text) {
  std::stringstream written;
  bool is_written = false;
  try {
    std::istringstream input(text);
    const LcpProblem problem = ReadSiconosText(input, "file", "id");
    if (!problem.b().allFinite()) return "b is not finite";
    WriteSiconosText(problem, written);
    is_written = true;
    const LcpProblem back = ReadSiconosText(written, "file", "id");
    if (back.given_form() != problem.given_form()) return "another form";
    return DifferenceOfProblems(back, problem);
  } catch (const InputError& error) {
    if (is_written) return std::string("what was written is refused: ") + error.what();
    return BrokenErrorLaw(error.what(), "file:");
  }
}

}  // namespace lcpbench
