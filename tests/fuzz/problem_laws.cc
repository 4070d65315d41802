#include "tests/fuzz/laws.h"

#include <sstream>

#include "solvers/io/json_lines.h"
#include "solvers/io/matrix_market.h"
#include "tests/fuzz/error_law.h"
#include "tests/solvers/lcp/same_problem.h"

namespace lcpbench {
namespace {

// Matrices of more rows are read, and not made: memory for empty rows is the caller's affair.
constexpr Index kMostRows = 100'000;

}  // namespace

std::string BrokenJsonLineLaw(const std::string& text) {
  constexpr char kPlace[] = "file:1";
  return BrokenReadingLaw(kPlace, [&](bool* is_read) -> std::string {
    const LcpProblem problem = ParseLcpRecord(text, kPlace).problem;
    if (!problem.b().allFinite()) return "b is not finite";
    const std::string written = FormatLcpRecord(problem);
    *is_read = true;
    return DifferenceOfProblems(ParseLcpRecord(written, kPlace).problem, problem);
  });
}

std::string BrokenMatrixMarketLaw(const std::string& text) {
  return BrokenReadingLaw("file:", [&](bool* is_read) -> std::string {
    std::istringstream input(text);
    std::stringstream written;
    const MarketMatrix matrix = ReadMarketMatrix(input, "file");
    if (matrix.rows > kMostRows) return {};
    const SparseMatrix sparse = matrix.ToSparse();
    WriteMarketMatrix(sparse, written);
    *is_read = true;
    return SameBits(ReadMarketMatrix(written, "file").ToSparse(), sparse) ? "" : "another matrix";
  });
}

}  // namespace lcpbench
