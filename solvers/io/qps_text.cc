#include "solvers/io/qps_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "solvers/io/contact_rows.h"
#include "solvers/io/text_words.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Ids may have spaces, and line ends.
std::string OneWord(std::string id) {
  std::replace_if(
      id.begin(), id.end(), [](unsigned char c) { return c <= ' ' || c >= 0x7f; }, '_');
  return id.empty() ? "_" : id;
}

}  // namespace

void RequireQp(const LcpProblem& problem) {
  RequireNoFriction(problem, true);
  if (problem.Asymmetry() == 0) return;
  throw InputError("problem '" + problem.id() +
                   "': expected a symmetric A, as that of a QP is, found an asymmetry of " +
                   RoundTripDigits(problem.Asymmetry()) + "; --symmetrize makes a small one 0");
}

void WriteQpsText(const LcpProblem& problem, std::ostream& output) {
  RequireQp(problem);
  const SparseMatrix& A = problem.SparseA();
  const auto column = [](Index i) { return "f" + std::to_string(i + 1); };
  output << "NAME " << OneWord(problem.id()) << "\nROWS\n N obj\nCOLUMNS\n";
  for (Index i = 0; i < problem.size(); ++i) {
    output << ' ' << column(i) << " obj " << RoundTripDigits(problem.b()[i]) << '\n';
  }
  output << "RHS\n";
  if (!problem.bilateral_rows().empty() || !problem.bounded_rows().empty()) output << "BOUNDS\n";
  for (const Index row : problem.bilateral_rows()) output << " FR bounds " << column(row) << '\n';
  for (const BoundedRow& row : problem.bounded_rows()) {
    const auto bound = [&](const char* kind) -> std::ostream& {
      return output << ' ' << kind << " bounds " << column(row.row);
    };
    if (std::isfinite(row.lower)) {
      bound("LO") << ' ' << RoundTripDigits(row.lower) << '\n';
    } else {
      bound("MI") << '\n';
    }
    if (std::isfinite(row.upper)) bound("UP") << ' ' << RoundTripDigits(row.upper) << '\n';
  }
  output << "QUADOBJ\n";
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
      if (it.col() < i || it.value() == 0) continue;
      output << ' ' << column(i) << ' ' << column(it.col()) << ' ' << RoundTripDigits(it.value()) << '\n';
    }
  }
  output << "ENDATA\n";
}

void WriteQpsProblem(const LcpProblem& problem, const std::string& path) {
  WriteFile(path, [&](std::ostream& file) { WriteQpsText(problem, file); });
}

}  // namespace lcpbench
